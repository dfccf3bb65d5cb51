"""Messages between a campaign and its own worker processes: pickled values, each preceded by its length.

``send`` and ``receive`` connect processes that RoadGPT started on one machine. ``pickled`` and ``unpickled``
also serve the executor ``ray``, whose workers may run on other machines of its cluster. Nothing else is read.
"""

import pickle
import struct
from typing import IO, Any

HEAD = struct.Struct("<Q")


def pickled(value: Any) -> bytes:
    """Returns a value as bytes."""
    return pickle.dumps(value, pickle.HIGHEST_PROTOCOL)


def unpickled(data: bytes) -> Any:
    """Returns the value that was pickled into these bytes."""
    return pickle.loads(data)  # noqa: S301 - from our own process


def send(stream: IO[bytes], message: Any) -> None:
    """Sends a message.

    Raises:
        OSError: the other process has ended.
    """
    body = pickled(message)
    stream.write(HEAD.pack(len(body)) + body)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Returns the next message.

    Raises:
        EOFError: the other process has ended.
    """
    (length,) = HEAD.unpack(_exactly(stream, HEAD.size))
    return unpickled(_exactly(stream, length))


def _exactly(stream: IO[bytes], count: int) -> bytes:
    data = stream.read(count)
    if len(data) != count:
        raise EOFError
    return data
