"""Finds out which protocol version BeamNG uses, lists which versions of BeamNG.tech and beamngpy work
together, and gives advice for versions that do not.

BeamNG and beamngpy each send a protocol version in their first message, and beamngpy continues only if both
are the same. RoadGPT therefore drives with every pair of versions that passes this check, and logs a warning
if it has not been tested with the installed beamngpy.

Sources: BeamNGpy 1.36's compatibility page for the versions, and the source code of BeamNGpy's releases for
the protocols.
"""

import logging
import socket
import struct
from importlib import import_module
from typing import Any, NamedTuple

from roadgpt.errors import SimulatorError

MOST = 1 << 20  # bytes, the largest answer to the first message that is accepted


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
    """Returns advice for a user whose BeamNG and beamngpy use different protocols. BeamNG uses the protocol
    ``game``; beamngpy has this ``version`` and uses the protocol ``client``.
    """
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
    """Sends a first message with the given protocol version to the program that listens on a port, and
    returns the version in BeamNG's answer.

    A message consists of its length (four bytes, big-endian) and one MessagePack map; the first message is
    named Hello.

    Raises:
        OSError: no program listens on the port, or no answer came within ``patience`` seconds.
        SimulatorError: the program that listens on the port is not BeamNG.
    """
    msgpack: Any = import_module("msgpack")

    hello = msgpack.packb({"type": "Hello", "protocolVersion": protocol, "_id": 0}, use_bin_type=True)
    with socket.create_connection((host, port), timeout=patience) as link:
        link.sendall(struct.pack("!I", len(hello)) + hello)
        try:
            with link.makefile("rb") as said:
                (length,) = struct.unpack("!I", said.read(4))
                answer: Any = msgpack.unpackb(said.read(length), raw=False) if length <= MOST else None
        except (ValueError, struct.error) as error:
            raise _stranger(host, port) from error
    if not isinstance(answer, dict) or "protocolVersion" not in answer:
        raise _stranger(host, port)
    return str(answer["protocolVersion"])


def _stranger(host: str, port: int) -> SimulatorError:
    return SimulatorError(
        f"the program that listens on {host}:{port} is not BeamNG.tech; name another --beamng-port"
    )
