"""The line between us and a generator's process: one JSON value per line, on its input and output."""

import json
from typing import IO, Any

Message = dict[str, Any]


def send(stream: IO[bytes], message: Message) -> None:
    """Write a message; numbers that are not finite travel as Python's JSON writes them."""
    stream.write(json.dumps(message, default=_plain).encode() + b"\n")
    stream.flush()


def received(line: bytes) -> Message | None:
    """The message in a line; None where there is none."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def _plain(value: Any) -> Any:
    """Numbers of other libraries, as numpy's."""
    item = getattr(value, "item", None)
    return item() if callable(item) else str(value)
