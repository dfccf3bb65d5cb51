"""What a driver's process and ours say to each other: a kind, a length, and so many bytes.

Down go pickles, which are ours, and views as numbers. Up come three numbers or JSON: reading what a driver's
process sends runs none of its code here.
"""

import os
import struct
from typing import NamedTuple

MAKE, SCENE, START, VIEW, FORGET = range(5)  # kinds that go down
MADE, COMMAND, FAILED = range(3)  # kinds that come up

HEAD = struct.Struct("<BI")
SEEN = struct.Struct("<13dBHH")
"""A view without road and world: its numbers; is there no picture, the last one, or a new one behind it; its
height and width."""
ANSWER = struct.Struct("<3d")
NO_PICTURE, SAME_PICTURE, NEW_PICTURE = range(3)
ROOM = 1 << 16  # bytes that are asked for at once, as many as a pipe holds
MOST = 1 << 20  # bytes of what may come up


class Message(NamedTuple):
    """One of them."""

    kind: int
    body: bytes


def send(number: int, kind: int, body: bytes = b"") -> None:
    """Write a message to a file number.

    Raises:
        OSError: nobody listens.
    """
    data = HEAD.pack(kind, len(body)) + body
    done = os.write(number, data)
    while done < len(data):
        done += os.write(number, memoryview(data)[done:])


def receive(number: int, most: int = 1 << 32) -> Message:
    """The next message from a file number.

    Raises:
        EOFError: the other end is gone, or sends what is no message.
        OSError: the same.
    """
    kind, length = HEAD.unpack(_exactly(number, HEAD.size))
    if length > most:
        raise EOFError
    return Message(kind, _exactly(number, length))


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
