"""One BeamNG for many roads: started or found when it is first needed, begun anew when it fails or is old."""

import atexit
import logging
import socket
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from importlib import import_module
from importlib.metadata import version
from typing import Any

from roadgpt.drive.simulators.beamng import slots
from roadgpt.drive.simulators.beamng.body import Body
from roadgpt.drive.simulators.beamng.launch import Game, binary_of, command_line
from roadgpt.drive.simulators.beamng.pairs import cure, warn_of
from roadgpt.drive.simulators.beamng.settings import Settings
from roadgpt.drive.simulators.beamng.watchdog import Watchdog
from roadgpt.drive.simulators.beamng.wire import protocol_at
from roadgpt.errors import PartError, SimulatorError

# Levels that are flat, in the order of our liking, and the heights of their ground in metres.
LEVELS = {"tig": -28.0, "tech_ground": 0.0, "smallgrid": 0.0}


def client() -> Any:
    """The package beamngpy, imported now.

    Raises:
        PartError: it is not installed.
    """
    try:
        package = import_module("beamngpy")
    except ImportError as error:
        raise PartError(
            f"the simulator 'beamng' needs beamngpy ({error}); say python -m pip install 'roadgpt[beamng]'"
        ) from error
    # It tells of every failed try, which without a handler would go to the screen; we say what came of it.
    logging.getLogger("beamngpy").addHandler(logging.NullHandler())
    return package


class Session:
    """The connection to one BeamNG, and what was learnt of it."""

    def __init__(self, settings: Settings) -> None:
        """Nothing is started yet."""
        self.settings = settings
        self.game: Game | None = None
        self.bng: Any = None
        self.level = ""
        self.roads = 0
        """Driven since BeamNG was started."""
        self.has_loaded = False
        """Has BeamNG loaded a road for this process, and so compiled its shaders?"""
        self.laid = 0
        """Scenes laid by this process, for names that are used once."""
        self.body: Body | None = None
        self.gain: float | None = None
        """Radians of the front wheels per unit of steering input; negative where that turns right."""
        self.told: float | None = None
        """The same for the input that BeamNG tells of, which need not have the sign of ours."""
        self.vehicle: Any = None
        self.watchdog = Watchdog(self._sockets, self._kill)
        self._slot: slots.Slot | None = None

    @property
    def ground(self) -> float:
        """Height of the level's ground, metres."""
        return LEVELS.get(self.level, 0.0)

    def ready(self) -> None:
        """See that a BeamNG is there that can take a road.

        Raises:
            PartError: beamngpy is not installed or of another version than BeamNG, BeamNG is not where it is
                said to be or not BeamNG.tech, or has no level for our roads: no road could be driven.
            SimulatorError: it does not start or does not answer.
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
                self.game = Game(words, host, port)
                self._slot.note(self.game.process.pid)
                self.game.wait(settings.start_timeout)
            self._check_pair(host, port)
            with self.within(settings.start_timeout, "it was starting"):
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
            raise PartError(cure(theirs, ours, version("beamngpy")))
        warn_of(version("beamngpy"))

    def _prepare(self) -> None:
        """Choose the level, and have physics in steps."""
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
        """Have physics in steps of one length; a level that is loaded may come with settings of its own."""
        self.bng.settings.set_deterministic(self.settings.rate)
        # Without a number of steps per second, a step is a frame of unknown length.
        self.bng.settings.set_steps_per_second(self.settings.rate)

    def loading(self) -> AbstractContextManager[None]:
        """Around the loading of a road; the first one may take minutes."""
        if self.has_loaded:
            return self.within(self.settings.load_timeout, "it was loading a road")
        patience = max(self.settings.first_load_timeout, self.settings.load_timeout)
        logging.getLogger("roadgpt").warning(
            "roadgpt: BeamNG loads its first road, and may compile its shaders for some minutes "
            "(it has %g s, ROADGPT_BEAMNG_FIRST_LOAD_TIMEOUT)",
            patience,
        )
        return self.within(patience, "it was loading its first road")

    @contextmanager
    def within(self, seconds: float, doing: str) -> Iterator[None]:
        """Calls inside that take longer are ended; see `Watchdog`."""
        with self.watchdog.within(seconds, doing):
            yield

    def close(self) -> None:
        """End our BeamNG politely, or let go of somebody else's."""
        game, bng = self.game, self.bng
        if bng is not None:
            with suppress(Exception), self.within(self.settings.poll_timeout, "it was closing"):
                if game is not None:
                    bng.control.quit_beamng()
                bng.disconnect()
        if game is not None:
            game.end()
        self._forget()

    def drop(self) -> None:
        """End our BeamNG, or let go of somebody else's, without a word to it."""
        for each in self._sockets():
            with suppress(OSError):
                each.close()
        self._kill()
        self._forget()

    def leave(self) -> None:
        """Close, and let others have the port."""
        self.close()
        if self._slot is not None:
            self._slot.release()
            self._slot = None

    def _forget(self) -> None:
        self.game = self.bng = self.vehicle = self.body = self.gain = self.told = None
        self.watchdog = Watchdog(self._sockets, self._kill)

    def _kill(self) -> None:
        if self.game is not None:
            self.game.kill()

    def _sockets(self) -> list[socket.socket]:
        """Those of the engine and of the car, as they are now: the client changes them by itself."""
        found = []
        for holder in (self.bng, self.vehicle):
            link = getattr(getattr(holder, "connection", None), "skt", None)
            if isinstance(inner := getattr(link, "skt", None), socket.socket):
                found.append(inner)
        return found


_sessions: dict[Settings, Session] = {}


def session_of(settings: Settings) -> Session:
    """The one session of this process for these settings."""
    if settings not in _sessions:
        leave_all()  # one BeamNG at a time is enough for a graphics card
        _sessions[settings] = Session(settings)
    return _sessions[settings]


@atexit.register
def leave_all() -> None:
    """End every BeamNG that this process started."""
    for session in _sessions.values():
        session.leave()
    _sessions.clear()
