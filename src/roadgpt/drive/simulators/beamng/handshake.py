"""Exchanges the first message with the program that listens on a port, to find out whether that program is
BeamNG, and which protocol version it uses.

A message consists of its length (four bytes, big-endian) and one MessagePack map; the first message is named
Hello.
"""

import socket
import struct
from importlib import import_module
from typing import Any

from roadgpt.errors import SimulatorError

MOST = 1 << 20  # bytes, the largest answer to Hello that is accepted


def is_taken(host: str, port: int) -> bool:
    """Returns whether a program listens on this port."""
    try:
        with socket.create_connection((host, port), timeout=1.0):
            return True
    except OSError:
        return False


def protocol_at(host: str, port: int, protocol: str, patience: float) -> str:
    """Sends a first message with the given protocol version, and returns the version in BeamNG's answer.

    Raises:
        OSError: no program listens on the port, or no answer came within ``patience`` seconds.
        SimulatorError: the program that listens on the port is not BeamNG.
    """
    msgpack: Any = import_module("msgpack")

    hello = msgpack.packb({"type": "Hello", "protocolVersion": protocol, "_id": 0}, use_bin_type=True)
    with socket.create_connection((host, port), timeout=patience) as link:
        link.sendall(struct.pack("!I", len(hello)) + hello)
        try:
            (length,) = struct.unpack("!I", _exactly(link, 4))
            answer: Any = msgpack.unpackb(_exactly(link, length), raw=False) if length <= MOST else None
        except (ValueError, EOFError) as error:
            raise _stranger(host, port) from error
    if not isinstance(answer, dict) or "protocolVersion" not in answer:
        raise _stranger(host, port)
    return str(answer["protocolVersion"])


def _exactly(link: socket.socket, length: int) -> bytes:
    parts = b""
    while len(parts) < length:
        part = link.recv(length - len(parts))
        if not part:
            raise EOFError
        parts += part
    return parts


def _stranger(host: str, port: int) -> SimulatorError:
    return SimulatorError(
        f"the program that listens on {host}:{port} is not BeamNG.tech; name another --beamng-port"
    )
