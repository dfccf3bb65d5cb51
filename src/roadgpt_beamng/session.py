"""Connects to one BeamNG and uses it for many roads: starts or finds BeamNG when needed, restarts it when it
fails, and gives advice where the versions of BeamNG.tech and beamngpy do not match.

BeamNG and beamngpy each send a protocol version in their first message, and beamngpy continues only if both
are the same. RoadGPT therefore drives with every pair of versions that passes this check, and logs a warning
if it has not been tested with the installed beamngpy.

Sources: BeamNGpy 1.36's compatibility page for the versions, and the source code of BeamNGpy's releases for
the protocols.
"""

import atexit
import logging
import socket
import struct
from contextlib import AbstractContextManager, suppress
from importlib import import_module
from importlib.metadata import version
from typing import Any, NamedTuple

from roadgpt.errors import PartError, SimulatorError, to_install
from roadgpt_beamng.launch import BeamngProcess, Slot, binary_of, command_line, take
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_beamng.tracking import CarGeometry
from roadgpt_beamng.watchdog import Watchdog

LARGEST_ANSWER = 1 << 20  # bytes, in answer to the first message
# Flat levels in order of preference, and the heights of their ground in metres.
LEVELS = {"tig": -28.0, "tech_ground": 0.0, "smallgrid": 0.0}


class VersionPair(NamedTuple):
    """Versions of BeamNG.tech and beamngpy that work together, and their protocol."""

    tech: str
    client: str
    protocol: str
    is_tried: bool = False
    """Whether RoadGPT's tests pass with this version of beamngpy."""


VERSION_PAIRS = (
    VersionPair("0.39", "1.36", "v1.27", True),
    VersionPair("0.38", "1.35.1", "v1.26", True),
    VersionPair("0.37", "1.34.1", "v1.24", True),
    VersionPair("0.36", "1.33.1", "v1.23", True),
    VersionPair("0.35", "1.32", "v1.23", True),
    VersionPair("0.34", "1.31", "v1.22", True),
    VersionPair("0.33", "1.30", "v1.22", True),
    VersionPair("0.26", "1.24", "v1.19"),
)


def client() -> Any:
    """Returns the Python package beamngpy, which is imported at the first call."""
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
        self._slot: Slot | None = None

    @property
    def ground(self) -> float:
        """Height of the level's ground in metres."""
        return LEVELS.get(self.level, 0.0)

    def ready(self) -> None:
        """Makes sure that BeamNG is ready to load a road. Raises PartError where no road can ever be driven,
        such as without beamngpy, and SimulatorError where BeamNG does not start or does not answer."""
        if self.bng is not None and self.settings.launches and self.roads >= self.settings.recycle:
            self.close()
        if self.bng is None:
            self._open()

    def _open(self) -> None:
        package = client()
        settings = self.settings
        if self._slot is None:
            self._slot = take(settings)
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
        """Limits the time for loading a road; the first road may take minutes."""
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
        """Kills BeamNG if RoadGPT started it; otherwise closes the connection without waiting."""
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
        """Returns the sockets that beamngpy uses at present; it may replace them at any time."""
        found = []
        for holder in (self.bng, self.vehicle):
            link = getattr(getattr(holder, "connection", None), "skt", None)
            if isinstance(inner := getattr(link, "skt", None), socket.socket):
                found.append(inner)
        return found


def session_of(settings: BeamngSettings) -> Session:
    """Returns this process's session for these settings, and ends any with other settings."""
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


def warn_if_untested(version: str) -> None:
    """Logs a warning if this version of beamngpy has not been tested with RoadGPT."""
    if any(pair.is_tried and pair.client == version for pair in VERSION_PAIRS):
        return
    tried = ", ".join(pair.client for pair in VERSION_PAIRS if pair.is_tried)
    logging.getLogger("roadgpt").warning(
        "roadgpt: beamngpy %s has not been tried with RoadGPT, which uses it anyway; tested versions: %s",
        version,
        tried,
    )


def mismatch_advice(game: str, client: str, version: str) -> str:
    """Returns advice for a BeamNG of the protocol ``game`` and a beamngpy of another one, ``client``."""
    theirs = [pair for pair in VERSION_PAIRS if pair.protocol == game]
    ours = [pair for pair in VERSION_PAIRS if pair.protocol == client]
    said = f"BeamNG.tech {' or '.join(pair.tech for pair in theirs)}" if theirs else "this BeamNG.tech"
    start = f"{said} uses protocol {game}, and the installed beamngpy {version} uses {client}"
    techs = " or ".join(pair.tech for pair in ours)
    other = f"install BeamNG.tech {techs}" if ours else "install the BeamNG.tech that goes with it"
    if not theirs:
        table = ", ".join(f"{pair.tech} with {pair.client}" for pair in VERSION_PAIRS if pair.is_tried)
        return f"{start}; {other}, or the beamngpy that goes with yours ({table})"
    return f"{start}; run 'python -m pip install beamngpy=={theirs[0].client}', or {other}"


def protocol_at(host: str, port: int, protocol: str, patience: float) -> str:
    """Sends a first message (Hello), and returns the protocol version in BeamNG's answer. A message is its
    length (four bytes, big-endian) and one MessagePack map. Raises OSError if nobody listens or answers in
    time."""
    msgpack: Any = import_module("msgpack")

    hello = msgpack.packb({"type": "Hello", "protocolVersion": protocol, "_id": 0}, use_bin_type=True)
    with socket.create_connection((host, port), timeout=patience) as link:
        link.sendall(struct.pack("!I", len(hello)) + hello)
        try:
            with link.makefile("rb") as said:
                (length,) = struct.unpack("!I", said.read(4))
                answer: Any = (
                    msgpack.unpackb(said.read(length), raw=False) if length <= LARGEST_ANSWER else None
                )
        except (ValueError, struct.error) as error:
            raise _stranger(host, port) from error
    if not isinstance(answer, dict) or "protocolVersion" not in answer:
        raise _stranger(host, port)
    return str(answer["protocolVersion"])


def _stranger(host: str, port: int) -> SimulatorError:
    return SimulatorError(
        f"the program that listens on {host}:{port} is not BeamNG.tech; name another --beamng-port"
    )


_sessions: dict[BeamngSettings, Session] = {}
