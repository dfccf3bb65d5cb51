"""Connects to one BeamNG and uses it for many roads: starts or finds BeamNG when needed, and restarts it when
it fails."""

import atexit
import logging
import socket
from contextlib import AbstractContextManager, suppress
from importlib import import_module
from importlib.metadata import version
from typing import Any

from roadgpt.drive.simulators.beamng import slots
from roadgpt.drive.simulators.beamng.compatibility import mismatch_advice, protocol_at, warn_if_untested
from roadgpt.drive.simulators.beamng.launch import BeamngProcess, binary_of, command_line
from roadgpt.drive.simulators.beamng.settings import BeamngSettings
from roadgpt.drive.simulators.beamng.tracking import CarGeometry
from roadgpt.drive.simulators.beamng.watchdog import Watchdog
from roadgpt.errors import PartError, SimulatorError, to_install

# Flat levels in order of preference, and the heights of their ground in metres.
LEVELS = {"tig": -28.0, "tech_ground": 0.0, "smallgrid": 0.0}


def client() -> Any:
    """Returns the Python package beamngpy, which is imported at the first call.

    Raises:
        PartError: beamngpy is not installed.
    """
    try:
        package = import_module("beamngpy")
    except ImportError as error:
        raise PartError(
            f"the simulator 'beamng' needs beamngpy ({error}); run {to_install('beamng')}"
        ) from error
    # It logs every failed attempt, which without a handler would go to the screen; we report the result.
    logging.getLogger("beamngpy").addHandler(logging.NullHandler())
    return package


class Session:
    """A connection to one BeamNG, with the geometry of its car."""

    def __init__(self, settings: BeamngSettings) -> None:
        """Starts nothing yet."""
        self.settings = settings
        self.game: BeamngProcess | None = None
        self.bng: Any = None
        self.level = ""
        self.roads = 0
        """Roads driven since BeamNG was started."""
        self.has_loaded = False
        """Whether BeamNG has already loaded a road for this process, and so compiled its shaders."""
        self.laid = 0
        """Number of roads that this process has placed; makes their names unique."""
        self.body: CarGeometry | None = None
        self.gain: float | None = None
        """Radians of the front wheels per unit of steering input; negative if a positive input steers to the
        right."""
        self.reported_gain: float | None = None
        """Radians of the front wheels per unit of the steering input that BeamNG reports. BeamNG may report
        the opposite sign of the input that was sent."""
        self.vehicle: Any = None
        self.watchdog = Watchdog(self._sockets, self._kill)
        self._slot: slots.Slot | None = None

    @property
    def ground(self) -> float:
        """Height of the level's ground in metres."""
        return LEVELS.get(self.level, 0.0)

    def ready(self) -> None:
        """Makes sure that BeamNG is ready to load a road.

        Raises:
            PartError: beamngpy is not installed or does not match BeamNG; BeamNG is not in the given folder
                or is not BeamNG.tech; or it has no suitable level. In each case no road can be driven.
            SimulatorError: BeamNG does not start or does not answer.
        """
        if self.bng is not None and self.settings.launches and self.roads >= self.settings.recycle:
            self.close()
        if self.bng is None:
            self._open()

    def _open(self) -> None:
        package = client()
        settings = self.settings
        if self._slot is None:
            self._slot = slots.take(settings)
        host, port = settings.host, self._slot.port
        try:
            if settings.home is not None:
                words = command_line(binary_of(settings.home), settings, port, self._slot.user)
                self.game = BeamngProcess(words, host, port)
                self._slot.note(self.game.process.pid)
                self.game.wait(settings.start_timeout)
            self._check_pair(host, port)
            with self.watchdog.within(settings.start_timeout, "it was starting"):
                self.bng = package.BeamNGpy(host, port, quit_on_close=False)
                self.bng.open(launch=False)
                self._prepare()
        except BaseException:
            self.drop()
            raise

    def _check_pair(self, host: str, port: int) -> None:
        ours = str(import_module("beamngpy.connection").Connection.PROTOCOL_VERSION)
        try:
            theirs = protocol_at(host, port, ours, self.settings.start_timeout)
        except OSError as error:
            raise SimulatorError(
                f"BeamNG on {host}:{port} does not answer ({error}); end it and start it anew"
            ) from error
        if theirs != ours:
            raise PartError(mismatch_advice(theirs, ours, version("beamngpy")))
        warn_if_untested(version("beamngpy"))

    def _prepare(self) -> None:
        """Chooses the level, and sets the physics to fixed steps."""
        if self.bng.tech_enabled() is False:
            raise PartError("this is BeamNG.drive or has no tech.key; RoadGPT needs BeamNG.tech")
        there = set(self.bng.scenario.get_levels())
        wanted = [self.settings.level] if self.settings.level else list(LEVELS)
        self.level = next((name for name in wanted if name in there), "")
        if not self.level:
            raise PartError(
                f"BeamNG has no level {' or '.join(wanted)}; name another with --beamng-level, there are: "
                f"{', '.join(sorted(there)[:20])}"
            )
        self.step_evenly()
        self.bng.control.pause()
        self.roads = 0

    def step_evenly(self) -> None:
        """Sets the physics to steps of equal length; loading a level may change this setting."""
        self.bng.settings.set_deterministic(self.settings.rate)
        # Without a number of steps per second, a step is a frame of unknown length.
        self.bng.settings.set_steps_per_second(self.settings.rate)

    def loading(self) -> AbstractContextManager[None]:
        """Returns a context manager that limits the time for loading a road; the first road may take
        minutes."""
        if self.has_loaded:
            return self.watchdog.within(self.settings.load_timeout, "it was loading a road")
        patience = max(self.settings.first_load_timeout, self.settings.load_timeout)
        logging.getLogger("roadgpt").warning(
            "roadgpt: BeamNG loads its first road, and may compile its shaders for some minutes "
            "(limit %g s, set ROADGPT_BEAMNG_FIRST_LOAD_TIMEOUT)",
            patience,
        )
        return self.watchdog.within(patience, "it was loading its first road")

    def close(self) -> None:
        """Asks BeamNG to quit if RoadGPT started it; otherwise disconnects from it."""
        game, bng = self.game, self.bng
        if bng is not None:
            with suppress(Exception), self.watchdog.within(self.settings.poll_timeout, "it was closing"):
                if game is not None:
                    bng.control.quit_beamng()
                bng.disconnect()
        if game is not None:
            game.end()
        self._forget()

    def drop(self) -> None:
        """Kills BeamNG if RoadGPT started it; otherwise closes the connection without waiting for an
        answer.
        """
        for each in self._sockets():
            with suppress(OSError):
                each.close()
        self._kill()
        self._forget()

    def leave(self) -> None:
        """Closes the session and releases its port."""
        self.close()
        if self._slot is not None:
            self._slot.release()
            self._slot = None

    def _forget(self) -> None:
        self.game = self.bng = self.vehicle = self.body = self.gain = self.reported_gain = None
        self.watchdog = Watchdog(self._sockets, self._kill)

    def _kill(self) -> None:
        if self.game is not None:
            self.game.kill()

    def _sockets(self) -> list[socket.socket]:
        """Returns the sockets that beamngpy currently uses for BeamNG and for the car; it may replace them at
        any time."""
        found = []
        for holder in (self.bng, self.vehicle):
            link = getattr(getattr(holder, "connection", None), "skt", None)
            if isinstance(inner := getattr(link, "skt", None), socket.socket):
                found.append(inner)
        return found


_sessions: dict[BeamngSettings, Session] = {}


def session_of(settings: BeamngSettings) -> Session:
    """Returns this process's session for these settings. If there is none, creates it and ends any session
    with other settings."""
    if settings not in _sessions:
        leave_all()  # one BeamNG at a time is enough for a graphics card
        _sessions[settings] = Session(settings)
    return _sessions[settings]


@atexit.register
def leave_all() -> None:
    """Ends every BeamNG that this process has started, and disconnects from any other."""
    for session in _sessions.values():
        session.leave()
    _sessions.clear()
