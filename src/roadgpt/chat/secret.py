"""Keys: held in one place, shown masked, and taken out of every text that comes back from a server."""

import re
from dataclasses import dataclass, field
from typing import Any

from roadgpt.errors import ChatError

GONE = "(key)"
# What looks like a key, also one that a server made shorter: sk-..., sk-proj-ab****yz; "Bearer ...".
LOOKS_LIKE_A_KEY = re.compile(r"\b(?:sk|rk|pk)-[\w*.\-]{6,}|(?i:\bbearer\s+)[\w~+/=.\-]{8,}")
SHORTEST = 8  # letters of a key that are looked for in texts; shorter ones would be found in every other word


@dataclass(frozen=True)
class Key:
    """A key and where it comes from; shows itself masked."""

    value: str = field(repr=False)
    origin: str

    def __str__(self) -> str:
        return masked(self.value)


NO_KEY = Key("none", "nowhere")
"""For servers that want no key; the library insists on one."""


def masked(value: str) -> str:
    """A key that can be shown: how it begins, and how long it is."""
    head = value[:3] if len(value) >= 20 else ""
    return f"{head}... ({len(value)} letters)"


def usable(key: Key) -> Key:
    """The key without blanks around it.

    Raises:
        ChatError: it holds what no header can carry; the sentence does not show it.
    """
    value = key.value.strip()
    if not value or not re.fullmatch(r"[!-~]+", value):
        raise ChatError(
            f"the key from {key.origin} holds blanks or letters that no key has, or is empty; "
            "copy it again from where it was issued"
        )
    return Key(value, key.origin)


def redacted(value: Any, key: Key) -> Any:
    """A text, or all texts in lists and dictionaries, without the key and what looks like one."""
    if isinstance(value, str):
        if len(key.value) >= SHORTEST and key.value in value:
            value = value.replace(key.value, GONE)
        return LOOKS_LIKE_A_KEY.sub(GONE, value)
    if isinstance(value, dict):
        return {redacted(name, key): redacted(item, key) for name, item in value.items()}
    if isinstance(value, list):
        return [redacted(item, key) for item in value]
    return value
