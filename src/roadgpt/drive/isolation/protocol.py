"""Defines the packets between RoadGPT and a driver's process: one byte for the kind, a length, and the body.

Packets to the driver's process are pickles made by RoadGPT, and views as packed numbers. Packets from it are
three numbers or JSON, so reading them runs no code of the driver in RoadGPT's process.
"""

import os
import struct
from typing import NamedTuple

MAKE, SCENE, START, VIEW, FORGET = range(5)  # kinds of packets to the driver's process
MADE, COMMAND, FAILED = range(3)  # kinds of packets from it

HEAD = struct.Struct("<BI")
SEEN = struct.Struct("<13dBHH")
"""A view without road and world: its 13 numbers; whether it has no image, the previous one, or a new one that
follows; height and width of the image."""
ANSWER = struct.Struct("<3d")
NO_PICTURE, SAME_PICTURE, NEW_PICTURE = range(3)
ROOM = 1 << 16  # bytes that are read at once, as many as a pipe holds
MOST = 1 << 20  # bytes, the largest packet that the driver's process may send


class Packet(NamedTuple):
    """One packet."""

    kind: int
    body: bytes


def send(number: int, kind: int, body: bytes = b"") -> None:
    """Writes a packet to a file descriptor.

    Raises:
        OSError: the other end is closed.
    """
    data = HEAD.pack(kind, len(body)) + body
    done = os.write(number, data)
    while done < len(data):
        done += os.write(number, memoryview(data)[done:])


def receive(number: int, most: int = 1 << 32) -> Packet:
    """Reads the next packet from a file descriptor.

    Raises:
        EOFError: the other end is closed, or sent something that is not a packet.
        OSError: reading failed.
    """
    kind, length = HEAD.unpack(_exactly(number, HEAD.size))
    if length > most:
        raise EOFError
    return Packet(kind, _exactly(number, length))


def _exactly(number: int, length: int) -> bytes:
    data = os.read(number, min(length, ROOM)) if length else b""
    if len(data) == length:
        return data
    parts, missing = [data], length - len(data)
    while missing and parts[-1]:
        parts.append(os.read(number, min(missing, ROOM)))
        missing -= len(parts[-1])
    if missing:
        raise EOFError
    return b"".join(parts)
