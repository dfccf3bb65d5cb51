"""Writes a change in words, for messages about a request that a reader turned into a plan."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from roadgpt.brief.change.request import Change, EditRequest, Place, Target
from roadgpt.language.table import PARTS, ROADS

ORDINALS = ("", "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")
UNITS = {"degrees": " degrees", "metres": " m", "percent": " %"}
SUPERLATIVES = PARTS["place"]["most"].words
WAYS: Mapping[str, str] = ROADS["grades"]


def spoken(request: EditRequest) -> EditRequest:
    """Returns a request whose changes and places have plain English as their ``words``."""
    return replace(request, changes=tuple(_change_with_words(change) for change in request.changes))


def _change_with_words(change: Change) -> Change:
    named = {
        name: replace(target, words=of_target(target))
        for name in ("target", "like")
        if (target := getattr(change, name)) is not None
    }
    return replace(change, **named, words=of_change(change))


def of_change(change: Change) -> str:
    """Returns a change in words, such as 'the radius of turn 2 at most 30 m'."""
    there = of_target(change.target) if change.target else "the road"
    match change.what:
        case "add":
            return _added(change)
        case "count":
            return f"{_bounded(change, f'{change.to or 0:g}')} {_adjectives(change.target)}turns"
        case "move":
            return f"{there} moved {_position(change.place).replace('at the', 'to the')}"
        case "swap" if change.like:
            return f"{there} and {of_target(change.like)} swapped"
        case "side":
            return f"{there} to the {change.side or 'other side'}"
        case "shape":
            return f"{there} as a {' '.join(filter(None, (change.sharpness, change.kind or 'turn')))}"
        case "slope" if change.way:
            return " ".join(filter(None, (there, change.steepness, WAYS[change.way])))
        case what if what in ROADS["wishes"]:
            return str(ROADS["wishes"][what]).format(there)
    return f"the {change.what} of {there} {_value(change)}"


def _value(change: Change) -> str:
    unit = UNITS[ROADS["measures"][change.what]]
    other = f"that of {of_target(change.like)}" if change.like else ""
    if change.times is not None:
        return f"{change.times:g} times {other}".rstrip() if other else f"times {change.times:g}"
    if change.by is not None:
        how = "more" if change.more > 0 else "less"
        return f"{change.by:g}{unit} {how}" + (f" than {other}" if other else "")
    if change.to is not None or other:
        return _bounded(change, other or f"{change.to:g}{unit}")
    size = "a little " if change.dose < 1 else "much " if change.dose > 1 else ""
    return size + ("larger" if change.more > 0 else "smaller")


def _bounded(change: Change, value: str) -> str:
    return {-1: f"at most {value}", 0: value, 1: f"at least {value}"}[change.bound]


def _added(change: Change) -> str:
    noun = change.kind or (change.target.noun if change.target else None) or "turn"
    sizes = (("degrees", " degrees"), ("radius", " m of radius"), ("length", " m"), ("grade", " %"))
    numbers = [f"{value:g}{unit}" for name, unit in sizes if (value := getattr(change, name)) is not None]
    number, plural = ("a", "") if change.count == 1 else (f"{change.count}", "s")
    what = " ".join(
        filter(None, (number, "new", change.sharpness, change.side, noun.replace("_", " ") + plural))
    )
    what += f" of {' and '.join(numbers)}" if numbers else ""
    what += f" {WAYS[change.way]}" if change.way else ""
    return f"{what} {_position(change.place)}" if change.place else what


def _position(place: Place | None) -> str:
    if place is None or place.target is None:
        return f"{'in' if place.how == 'middle' else 'at'} the {place.how}" if place else ""
    first = of_target(place.target)
    if place.how == "between":
        return f"between {first} and {of_target(place.other)}"
    return f"{place.how.replace('_', ' ')} {first}{' on' if place.how == 'from' else ''}"


def _adjectives(target: Target | None) -> str:
    words = (target.sharpness, target.side, target.way and WAYS[target.way], target.size) if target else ()
    return "".join(f"{word} " for word in words if word)


def _numbered(noun: str, numbers: Sequence[int]) -> str:
    if min(numbers) > 0:
        return f"{noun}{'s' if numbers[1:] else ''} {_listed([f'{number}' for number in numbers])}"
    return f"the {_listed([_ordinal(number) for number in numbers])} {noun}"


def _ordinal(number: int) -> str:
    if number == -1:
        return "last"
    name = ORDINALS[abs(number)] if abs(number) < len(ORDINALS) else f"{abs(number)}th"
    return name if number > 0 else f"{name}-last"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def of_target(target: Target | None) -> str:
    """Returns places in words, such as 'the last left turn' or 'the first 60 m'."""
    if target is None:
        return "the road"
    noun = (target.kind or target.noun or "turn").replace("_", " ")
    if target.is_distance:
        said = f"the {'first' if noun == 'start' else 'last'} {target.length:g} m"
    elif noun in ("road", "start", "end"):
        said = f"the {ORDINALS[target.half]} half of the road" if target.half else f"the {noun}"
    else:
        sizes = ((target.degrees, " degree "), (target.length, " m "))
        most = next((f"{name} " for name, most in SUPERLATIVES.items() if most == target.most), "")
        before = "".join(f"{value:g}{unit}" for value, unit in sizes if value is not None)
        full = f"{most}{_adjectives(target)}{before}{'middle ' if target.middle else ''}{noun}"
        count = f"{target.count} " if target.count is not None else ""
        if target.numbers:
            said = _numbered(full, target.numbers)
        elif target.every:
            said = f"all {count}{full}s"
        else:
            said = f"the {count}{full}{'s' if count else ''}"
    said += f" {_position(target.place)}" if target.place else ""
    return said + (f" except {of_target(target.but)}" if target.but else "")
