"""Handles API keys: they are only shown masked, and are removed from every text that a server returns."""

import re
from dataclasses import dataclass, field
from typing import Any

from roadgpt.errors import ChatError

GONE = "(key)"
# What looks like a key, also one that a server abbreviated: sk-..., sk-proj-ab****yz; "Bearer ...".
LOOKS_LIKE_A_KEY = re.compile(r"\b(?:sk|rk|pk)-[\w*.\-]{6,}|(?i:\bbearer\s+)[\w~+/=.\-]{8,}")
SHORTEST = 8  # characters of a key that is searched for in texts; shorter ones would match ordinary words


@dataclass(frozen=True)
class Key:
    """An API key and its origin. If a Key is converted to text, the text is masked."""

    value: str = field(repr=False)
    origin: str

    def __str__(self) -> str:
        return masked(self.value)


NO_KEY = Key("none", "nowhere")
"""A placeholder for servers that need no key: the library always requires a key."""


def masked(value: str) -> str:
    """Returns a form of a key that may be shown: its length and, if it is long, its first 3 characters."""
    head = value[:3] if len(value) >= 20 else ""
    return f"{head}... ({len(value)} letters)"


def usable(key: Key) -> Key:
    """Returns the key without surrounding blanks. Raises ChatError, without showing the key, if the key is
    empty or has characters that an HTTP header cannot contain."""
    value = key.value.strip()
    if not value or not re.fullmatch(r"[!-~]+", value):
        raise ChatError(
            f"the key from {key.origin} holds blanks or letters that no key has, or is empty; "
            "copy it again from where it was issued"
        )
    return Key(value, key.origin)


def redacted(value: Any, key: Key) -> Any:
    """Removes the key, and everything that looks like a key, from a text or from all texts in lists and
    dictionaries."""
    if isinstance(value, str):
        if len(key.value) >= SHORTEST and key.value in value:
            value = value.replace(key.value, GONE)
        return LOOKS_LIKE_A_KEY.sub(GONE, value)
    if isinstance(value, dict):
        return {redacted(name, key): redacted(item, key) for name, item in value.items()}
    if isinstance(value, list):
        return [redacted(item, key) for item in value]
    return value
