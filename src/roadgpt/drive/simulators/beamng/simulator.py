"""The simulator ``beamng``: BeamNG.tech through beamngpy."""

from typing import TYPE_CHECKING

from roadgpt.drive.drive import Drive
from roadgpt.drive.eyes import camera_of
from roadgpt.drive.seat import Seat
from roadgpt.drive.simulators.beamng.loop import record
from roadgpt.drive.simulators.beamng.session import Session, session_of
from roadgpt.drive.simulators.beamng.settings import Settings
from roadgpt.drive.simulators.beamng.stage import Stage
from roadgpt.errors import RoadGPTError, SimulatorError

if TYPE_CHECKING:
    from roadgpt.drive import Driver
    from roadgpt.road import Road, World

TRIES = 2  # of one road
IMITATES = "beamng_like"


class BeamngSimulator:
    """BeamNG.tech: an ETK 800 on a mesh road; BeamNG's AI drives, or the driver is asked at every step.

    Where the driver is ``beamng_like``, BeamNG's own AI, which it imitates, takes its seat (Drive.driver is
    ``beamng_ai`` then). A BeamNG that hangs, ends or loses its socket costs one more try of one road on a new
    BeamNG; a second time it is a SimulatorError of that road.
    """

    ignores = ("friction",)  # the surfaces are those of the level's materials

    def __init__(self, settings: Settings | None = None) -> None:
        """With these settings; None: what the environment says.

        Raises:
            UsageError: the environment says what cannot be.
        """
        self.settings = Settings.of() if settings is None else settings

    def simulate(
        self, road: "Road", world: "World", driver: "Driver", seed: int, keep_driving: bool = False
    ) -> Drive:
        """See `roadgpt.drive.Simulator`. The seed is the driver's, and moves the road by millimetres."""
        session = session_of(self.settings)
        for tried in range(TRIES):
            try:
                session.ready()
                drive = self._once(session, road, world, driver, seed, keep_driving)
            except RoadGPTError:
                if session.watchdog.has_bitten:
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
        seat = None if self._ai_drives(driver) else Seat(driver)
        with Stage(session, road, world, seed) as stage:
            if seat is None:
                return record(stage, road, world, None, seed, keep_driving)
            stage.take_the_wheel()
            if camera is not None:
                stage.open_camera(camera)
            with seat.watched():
                seat.start(road, world, seed)
                return record(stage, road, world, seat, seed, keep_driving)

    def _ai_drives(self, driver: "Driver") -> bool:
        return getattr(driver, "name", "") == IMITATES and not self.settings.imitation
