"""The error of a failed request to a server, and the waiting time before the next attempt."""

import random
import time
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from typing import Any

BUSY = {408, 409, 425, 429, 500, 502, 503, 504, 529}  # statuses after which a retry may help
SPENT_UP = ("insufficient_quota", "billing", "credit")  # words in a 429 for which waiting does not help
FIRST_WAIT, LONGEST_WAIT = 0.5, 8.0  # s, between retries if the server does not say how long
PATIENCE = 120.0  # s, the longest wait that a server may ask for


@dataclass
class RequestError(Exception):
    """Raised if a request to a server failed."""

    sentence: str
    status: int | None = None
    details: str = ""
    """The server's own error message in lower case."""
    parameter: str = ""
    wait: float | None = None
    """The number of seconds that the server asks the client to wait; None if it does not say."""
    is_retryable: bool = False
    """True if the same request may succeed later."""


def retry_after(headers: Any) -> float | None:
    """Returns the waiting time in seconds that a retry-after header, in any of its forms, asks for; else
    None.
    """
    for name, unit in (("retry-after-ms", 0.001), ("retry-after", 1.0)):
        text = headers.get(name)
        if not text:
            continue
        try:
            seconds = float(text) * unit
        except ValueError:
            try:
                seconds = parsedate_to_datetime(text).timestamp() - time.time()
            except (ValueError, TypeError, OverflowError):
                continue
        if seconds == seconds:
            return max(0.0, seconds)
    return None


def retry_delay(fault: RequestError, attempt: int) -> float | None:
    """Returns the seconds until the next attempt; None if the server asks for more than PATIENCE seconds."""
    if fault.wait is not None:
        if fault.wait > PATIENCE:
            fault.sentence += f"; it asks to wait {fault.wait:.0f} s, so try again later"
            return None
        return fault.wait
    usual: float = min(FIRST_WAIT * 2.0**attempt, LONGEST_WAIT)
    return usual * random.uniform(0.75, 1.25)
