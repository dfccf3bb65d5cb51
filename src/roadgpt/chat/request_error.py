"""Defines the error for a failed request to a server, and decides which failures may be temporary."""

from dataclasses import dataclass

BUSY = {408, 409, 425, 429, 500, 502, 503, 504, 529}  # statuses after which a retry may help
SPENT_UP = ("insufficient_quota", "billing", "credit")  # words in a 429 for which waiting does not help


@dataclass
class RequestError(Exception):
    """Raised if a request to a server fails."""

    sentence: str
    status: int | None = None
    details: str = ""
    """The server's own error message in lower case."""
    parameter: str = ""


def is_spent_up(status: int, message: str) -> bool:
    """Returns True if a server's error message says that the account has no credit left."""
    return status == 429 and any(word in message.lower() for word in SPENT_UP)
