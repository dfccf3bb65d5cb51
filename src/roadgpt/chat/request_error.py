"""A request that came to nothing, and how long to wait before it is tried again."""

import random
import time
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from typing import Any

BUSY = {408, 409, 425, 429, 500, 502, 503, 504, 529}  # statuses after which the same question may be answered
SPENT_UP = ("insufficient_quota", "billing", "credit")  # what a 429 says that no waiting helps
FIRST_WAIT, LONGEST_WAIT = 0.5, 8.0  # s, between retries where the server does not say how long
PATIENCE = 120.0  # s, the longest wait that a server may ask for


@dataclass
class RequestError(Exception):
    """A request that came to nothing."""

    sentence: str
    status: int | None = None
    said: str = ""
    """What the server says about it, in small letters."""
    parameter: str = ""
    wait: float | None = None
    """Seconds that the server asks for."""
    is_retryable: bool = False
    """Can the same request do better later?"""


def retry_after(headers: Any) -> float | None:
    """Seconds of retry-after, however it is said."""
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
    """Seconds until the next try; None: longer than anyone waits."""
    if fault.wait is not None:
        if fault.wait > PATIENCE:
            fault.sentence += f"; it asks to wait {fault.wait:.0f} s, come back then"
            return None
        return fault.wait
    usual: float = min(FIRST_WAIT * 2.0**attempt, LONGEST_WAIT)
    return usual * random.uniform(0.75, 1.25)
