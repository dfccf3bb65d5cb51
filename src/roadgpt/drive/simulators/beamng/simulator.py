"""The simulator ``beamng``: BeamNG.tech, controlled through beamngpy."""

from typing import TYPE_CHECKING

from roadgpt.drive.camera_sensor import camera_of
from roadgpt.drive.drive import Drive
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.simulators.beamng.drive_loop import record
from roadgpt.drive.simulators.beamng.loaded_road import LoadedRoad
from roadgpt.drive.simulators.beamng.session import Session, session_of
from roadgpt.drive.simulators.beamng.settings import BeamngSettings
from roadgpt.errors import RoadGPTError, SimulatorError

if TYPE_CHECKING:
    from roadgpt.drive import Driver
    from roadgpt.road import Road, World

TRIES = 2  # per road
IMITATES = "beamng_like"


class BeamngSimulator:
    """Simulates an ETK 800 in BeamNG.tech on a mesh road. Either BeamNG's AI drives, or the driver returns a
    command at every step.

    If the driver is ``beamng_like``, an imitation of BeamNG's AI, and the setting ``imitation`` is False, the
    AI itself drives, and ``Drive.driver`` is ``beamng_ai``. If BeamNG hangs, ends or loses its connection,
    the drive is repeated once with a new BeamNG process or connection; a second failure raises
    SimulatorError.
    """

    # The surfaces are those of the level's materials, and mesh roads that a client builds are level across.
    ignores = ("friction", "bank")
    single_roads_only = True

    def __init__(self, settings: BeamngSettings | None = None) -> None:
        """Uses these settings, or those of the environment variables if ``settings`` is None.

        Raises:
            UsageError: an environment variable has an invalid value.
        """
        self.settings = BeamngSettings.of() if settings is None else settings

    def simulate(
        self, road: "Road", world: "World", driver: "Driver", seed: int, keep_driving: bool = False
    ) -> Drive:
        """Implements `roadgpt.drive.Simulator.simulate`; the seed is passed to the driver, and also
        determines the random shifts (up to 1 cm) of the road's mesh."""
        session = session_of(self.settings)
        for tried in range(TRIES):
            try:
                session.ready()
                drive = self._once(session, road, world, driver, seed, keep_driving)
            except RoadGPTError:
                if session.watchdog.has_fired:
                    session.drop()
                raise
            except Exception as error:  # whatever a client raises whose game is gone
                session.drop()
                if tried + 1 == TRIES:
                    raise SimulatorError(
                        f"BeamNG failed {TRIES} times on this road: {str(error) or type(error).__name__}"
                    ) from error
            except BaseException:
                session.drop()
                raise
            else:
                session.roads += 1
                return drive
        raise AssertionError

    def _once(
        self,
        session: Session,
        road: "Road",
        world: "World",
        driver: "Driver",
        seed: int,
        keep_driving: bool,
    ) -> Drive:
        camera = camera_of(driver)
        ai_drives = getattr(driver, "name", "") == IMITATES and not self.settings.imitation
        guard = None if ai_drives else DriverGuard(driver)
        with LoadedRoad(session, road, world, seed) as loaded:
            if guard is None:
                return record(loaded, road, world, None, seed, keep_driving)
            loaded.take_the_wheel()
            if camera is not None:
                loaded.open_camera(camera)
            with guard.watched():
                guard.start(road, world, seed)
                return record(loaded, road, world, guard, seed, keep_driving)
