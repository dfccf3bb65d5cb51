"""Defines the packets between RoadGPT and a driver's process: one byte for the kind, a length, and the body.

Packets to the driver's process contain pickles made by RoadGPT, or views as packed numbers. Packets from the
driver's process contain three numbers or JSON, so that RoadGPT can read them without running the driver's
code.
"""

import os
import struct
from typing import NamedTuple

MAKE, SCENE, START, VIEW, FORGET = range(5)  # kinds of packets to the driver's process
MADE, COMMAND, FAILED = range(3)  # kinds of packets from it

HEAD = struct.Struct("<BI")
SEEN = struct.Struct("<13dBHH")
"""Format of a View without its road and world: 13 numbers; a code for no image, the previous image, or a new
image that follows; and the height and width of the image."""
ANSWER = struct.Struct("<3d")
NO_PICTURE, SAME_PICTURE, NEW_PICTURE = range(3)
ROOM = 1 << 16  # bytes that are read at once, as many as a pipe holds
MOST = 1 << 20  # bytes, the largest packet that the driver's process may send


class Packet(NamedTuple):
    """One packet: its kind and its body."""

    kind: int
    body: bytes


def send(number: int, kind: int, body: bytes = b"") -> None:
    """Writes a packet to the file descriptor ``number``.

    Raises:
        OSError: the other end is closed.
    """
    data = HEAD.pack(kind, len(body)) + body
    done = os.write(number, data)
    while done < len(data):
        done += os.write(number, memoryview(data)[done:])


def receive(number: int, most: int = 1 << 32) -> Packet:
    """Reads the next packet from the file descriptor ``number``; its body may have at most ``most`` bytes.

    Raises:
        EOFError: the other end is closed, or sent invalid data.
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
