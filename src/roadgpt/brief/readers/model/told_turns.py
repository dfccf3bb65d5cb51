"""Finds how many turns a description says that its road has."""

import re

from roadgpt.brief.readers.model.nouns import COUNTED, ONE_TURN

NOUN = rf"(?:{'|'.join(sorted({*COUNTED, *ONE_TURN}, key=len, reverse=True))})"
COUNT = re.compile(
    rf"(?<!\w )\b(\d+) (?:\w+ )?(?:{NOUN})\b|\b(?:with|mit|avec|con|of|has|have) (\d+) {NOUN}\b"
)
OF_PART = ("first", "last", "other", "ersten", "letzten", "anderen", "les", "las", "los", "le")
PART = "".join(f"(?<!{word} )" for word in OF_PART)
ANY_COUNT = re.compile(rf"{PART}\b(\d+) (?:\w+ )?{NOUN}\b")
"""A number of turns that are not a part of others."""


def told_turns(said: str) -> int | None:
    """Returns the number of turns in words, as networks read them; None if there is none, or several."""
    found = {int(first or second) for first, second in COUNT.findall(said)}
    return found.pop() if len(found) == 1 and len({*ANY_COUNT.findall(said)}) <= 1 else None
