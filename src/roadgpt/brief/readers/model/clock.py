"""The local time that a description tells, such as "2:15 p.m.", "0615 hrs" or "17h20"."""

import re
from collections.abc import Iterator

from roadgpt.brief.languages import TABLE, pattern_of, word_set

HOURS = TABLE["clock"]["hours"].split()
TIME, FOUR_DIGITS, FULL_HOUR, LATER, SURE_BEFORE = (
    pattern_of(name, "clock") for name in ("time", "four_digits", "full_hour", "later", "sure_before")
)


def told_time(words: str) -> str | None:
    """Returns the time that a description tells, as HH:MM; None if it tells none, or several."""
    found = {*_times(words.lower())}
    return found.pop() if len(found) == 1 else None


def _times(text: str) -> Iterator[str]:
    for at in TIME.finditer(text):
        is_told = at["sign"] or at["half"] or SURE_BEFORE.search(text[: at.start()]) or len(at["hour"]) > 1
        if at["half"] or at["sign"] or (is_told and at["between"] != "."):
            yield _as_time(int(at["hour"]), int(at["minute"]), at["half"], text[at.end() :])
    for at in FOUR_DIGITS.finditer(text):
        yield _as_time(int(at["hour"]), int(at["minute"]), None, text[at.end() :])
    for at in FULL_HOUR.finditer(text):
        if at["word"]:
            hour = HOURS.index(at["word"]) + 1 if at["word"] in HOURS else int(at["word"])
            yield _as_time(hour, 0, "a" if at["part"] == "morning" else "p", "")
        else:
            yield _as_time(int(at["hour"] or at["uhr"]), 0, at["half"], text[at.end() :])
    if word_set("noon").intersection(re.findall(r"\w+", text)):
        yield "12:00"


def _as_time(hour: int, minute: int, half: str | None, behind: str) -> str:
    if (half == "p" or (half is None and LATER.match(behind))) and hour < 12:
        hour += 12
    if half == "a" and hour == 12:
        hour = 0
    return f"{hour:02d}:{minute:02d}"
