"""Defines the messages between RoadGPT and a driver's process. A message is four bytes with the length of its
body, followed by the body.

RoadGPT sends requests as pickles. The driver's process answers in JSON, so that RoadGPT can read the answers
without running the driver's code.
"""

import os
import struct

HEAD = struct.Struct("<I")
ROOM = 1 << 16  # bytes that are read at once, as many as a pipe holds
MOST = 1 << 24  # bytes, the largest answer that the driver's process may send
SAME_PICTURE = "same"
"""Sent instead of an image that is the same as in the previous request."""


def send(number: int, body: bytes) -> None:
    """Writes a message to the file descriptor ``number``.

    Raises:
        OSError: the other end is closed.
    """
    data = HEAD.pack(len(body)) + body
    done = os.write(number, data)
    while done < len(data):
        done += os.write(number, memoryview(data)[done:])


def receive(number: int, most: int = 1 << 32) -> bytes:
    """Reads the next message from the file descriptor ``number``; the message may have at most ``most``
    bytes.

    Raises:
        EOFError: the other end is closed, or sent invalid data.
        OSError: reading failed.
    """
    (length,) = HEAD.unpack(_exactly(number, HEAD.size))
    if length > most:
        raise EOFError
    return _exactly(number, length)


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
