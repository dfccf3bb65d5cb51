"""The local time that a description tells, such as "2:15 p.m.", "0615 hrs" or "17h20"."""

import re
from collections.abc import Iterator

from roadgpt.brief.languages import word_set

HOURS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]
TIME = re.compile(
    r"(?<![\d.,:/-])(?P<hour>[01]?\d|2[0-3])(?P<between>[:.h])(?P<minute>[0-5]\d)(?![\d:./]|,\d)"
    r"(?P<sign>\s*(?:hrs|hours|uhr|o'clock|h)\b)?(?:\s*(?P<half>[ap])\.?\s?m\b)?"
)
"""Hours and minutes; a point between them tells a time only with a word behind it."""
FOUR_DIGITS = re.compile(r"\b(?P<hour>[01]\d|2[0-3])(?P<minute>[0-5]\d)\s*(?:hrs|hours)\b")
FULL_HOUR = re.compile(
    r"(?<![\d.,:/-])(?P<hour>1[0-2]|0?[1-9])\s*(?P<half>[ap])\.?\s?m\b"
    r"|(?<![\d.,:/-])(?P<uhr>[01]?\d|2[0-3])\s*(?:uhr|o'clock)\b"
    rf"|\b(?P<word>{'|'.join(HOURS)}|1[0-2]|[1-9]) in the (?P<part>morning|afternoon|evening)\b"
)
LATER = re.compile(r"^[\s,]*in the (?:afternoon|evening)\b")
SURE_BEFORE = re.compile(r"(?:\bat|\babout|\baround|\bum|\bgegen|\bore|\balle|\bà|\blas|\(|,)\s*$")


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
