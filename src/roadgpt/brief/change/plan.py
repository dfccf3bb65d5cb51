"""Writes a change request as one short line, called a plan, and reads it back.

    turn 2: radius x0.75; end: slope down; turn all but(turn 1): side left; add hairpin right after(turn 2)

Changes are separated by ``;``. A change either consists of a place, a colon and what is to be changed there,
or it begins with ``add``. The page docs/reference/plans.md describes the language.
"""

from collections.abc import Iterator

from roadgpt.brief.change.parser import DOSES, MEASURES, NUMBERS, ChangeParser
from roadgpt.brief.change.request import HALVES, SUPERLATIVES, Change, EditRequest, Place, Target
from roadgpt.errors import EditError


def change_plan(request: EditRequest) -> str:
    """Returns the plan of a change request, without the text of the request."""
    return "; ".join(_change(change) for change in request.changes)


def _change(change: Change) -> str:
    if change.what == "add":
        return " ".join(["add", *_added(change)])
    place = _place(change.target) if change.target else "road"
    return f"{place}: {' '.join(_wish(change))}"


def _wish(change: Change) -> Iterator[str]:
    if change.what == "count":
        low, high = ("..", "") if change.bound < 0 else ("", ".." if change.bound else "")
        yield f"x{low}{_number(change.to or 0)}{high}"
        return
    if change.what == "move":
        assert change.place is not None
        yield _position(change.place)
        return
    yield change.what
    if change.what == "swap" and change.like is not None:
        yield f"={_place(change.like)}"
    if change.what == "side":
        yield change.side or "other"
    if change.what == "shape":
        yield from (word for word in (change.kind, change.sharpness) if word)
    if change.way and change.what == "slope":
        yield change.slope or ""
    if change.what in MEASURES:
        yield from _value(change)


def _value(change: Change) -> Iterator[str]:
    place = _place(change.like) if change.like is not None else ""
    if place and not change.is_compared:
        yield {-1: f"..{place}", 0: f"={place}", 1: f"{place}.."}[change.bound]
    elif change.to is not None:
        number = _number(change.to)
        yield {-1: f"..{number}", 0: f"={number}", 1: f"{number}.."}[change.bound]
    elif change.by is not None:
        yield f"{'+' if change.more > 0 else '-'}{_number(change.by)}"
    elif change.times is not None:
        yield f"x{_number(change.times)}"
    elif change.more:
        yield from (word for word, dose in DOSES.items() if dose == change.dose)
        yield "more" if change.more > 0 else "less"
    if change.is_compared:
        yield f"={place}"


def _added(change: Change) -> Iterator[str]:
    assert change.target is not None
    yield change.kind or change.target.noun or "turn"
    if change.count != 1:
        yield f"x{change.count}"
    yield from (word for word in (change.side, change.sharpness, change.slope) if word)
    for key, field in NUMBERS.items():
        if (value := getattr(change, field)) is not None:
            yield f"{key}={_number(value)}"
    if change.is_whole:
        yield "whole"
    if change.place:
        yield _position(change.place)


def _position(place: Place) -> str:
    if place.target is None:
        return f"at_{place.how}"
    inner = [_place(target) for target in (place.target, place.other) if target]
    return f"{place.how}({', '.join(inner)})"


def _place(target: Target) -> str:
    """Returns the text of a target; without a noun it becomes a turn, which is how ``pointing`` reads it."""
    words: list[str] = [target.kind or target.noun or "turn"]
    if target.numbers:
        words.append(",".join(map(str, target.numbers)))
    words += ["all"] if target.every else []
    words += ["middle"] if target.middle else []
    words += [name for name, most in SUPERLATIVES.items() if most == target.most]
    words += [f"x{target.count}"] if target.count is not None else []
    words += [word for word in (target.side, target.sharpness, target.way, target.size) if word]
    for key in ("deg", "len"):
        if (value := getattr(target, NUMBERS[key])) is not None:
            words.append(f"{key}={_number(value)}")
    words += [name for name, half in HALVES.items() if half == target.half]
    words += [_position(target.place)] if target.place else []
    words += [f"but({_place(target.but)})"] if target.but else []
    return " ".join(words)


def _number(value: float) -> str:
    """Returns a number in plain decimals, never with an exponent."""
    return f"{value:.6f}".rstrip("0").rstrip(".")


def read_change_plan(line: str) -> EditRequest:
    """Returns the changes that a plan describes.

    Raises:
        EditError: A word or number is not part of the language, or is in the wrong place; the message names
            it.
    """
    changes = tuple(ChangeParser(part).change() for part in line.split(";") if part.strip())
    if not changes:
        raise EditError("the plan names no change; write for example: turn 2: radius x0.75")
    return EditRequest(line, changes)
