"""Exchanges messages with a generator's process as JSON Lines: one JSON value per line."""

import json
from typing import IO, Any

Message = dict[str, Any]


def send(stream: IO[bytes], message: Message) -> None:
    """Writes a message as one line of JSON; numbers that are not finite are written as NaN or Infinity."""
    stream.write(json.dumps(message, default=_plain).encode() + b"\n")
    stream.flush()


def received(line: bytes) -> Message | None:
    """Returns the message in a line; None if the line is not a JSON object."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def _plain(value: Any) -> Any:
    """Converts numbers of other libraries, such as numpy's."""
    item = getattr(value, "item", None)
    return item() if callable(item) else str(value)
