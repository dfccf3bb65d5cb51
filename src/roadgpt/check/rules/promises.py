"""Requires the road to meet its Brief: the turns in order, the straights between them, and the grades.

The requirements are given as ranges in an Outline. They are compared with what ``check.measures`` measures on
the centre line of the road. Additional straights are allowed. If the description leaves a count open ("at
least three right turns, then a hairpin"), the turns of the road are assigned to the requested groups so that
as few turns as possible violate a requirement.
"""

from collections.abc import Iterator
from typing import NamedTuple

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.words import NO_TURN, Range
from roadgpt.check.finding import Finding
from roadgpt.check.matching import Complaint, fits, sequence_complaints, turn_complaints
from roadgpt.check.measures import LEVEL, Measures, measure
from roadgpt.road import Road, World

ROOMY = 150.0  # m: a map with this side length holds a sweeping turn of 60 m radius with its straights


class _Whole(NamedTuple):
    """A quantity of the whole road: its value, the range asked for, and the sentence about it."""

    value: float
    asked: Range | None
    sentence: str
    on_heights: bool = True


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the requested and the measured value for each requirement that the road does not meet."""
    if brief is None:
        return ()
    asked = promises_of(brief, world)
    broken = complaints(measure(road.centreline(), asked.widest), asked)
    return tuple(_finding(road, complaint) for complaint in broken)


def promises_of(brief: Brief, world: World) -> Outline:
    """Returns the requirements of a Brief for a road on the map of ``world``, as an Outline."""
    return outline(brief, world.map_size >= ROOMY, world.map_size)


def complaints(found: Measures, asked: Outline) -> list[Complaint]:
    """Returns one Complaint for each requirement of an Outline that a measured road does not meet."""
    out = list(_counts(found, asked))
    if len(found.turns) in asked.turns:
        out += sequence_complaints(found, asked)
    for number, turn in enumerate(found.turns, 1):
        out += turn_complaints(number, turn, asked.each_turn)
    out += _slopes(found, asked)
    for value, span, sentence, on_heights in _wholes(found, asked):
        if span is not None and value not in span:
            out.append(Complaint(sentence.format(asked=span), on_heights=on_heights))
    return out + list(_ends(found, asked))


def _finding(road: Road, complaint: Complaint) -> Finding:
    if complaint.s is None:
        return Finding("promises", complaint.sentence)
    x, y, _ = (float(v) for v in road.at(min(complaint.s, road.length)))
    return Finding("promises", complaint.sentence, complaint.s, x, y)


def _counts(found: Measures, asked: Outline) -> Iterator[Complaint]:
    number = len(found.turns)
    if number not in asked.turns:
        yield Complaint(f"asked for {_many(asked.turns, 'turn')}, has {number}")
    elif asked.turns.hi == 0 and found.turning not in NO_TURN:
        yield Complaint(f"asked for a straight road, turns {found.turning:.1f} degrees in all")
    left, right = found.count("left"), found.count("right")
    if left not in asked.left:
        yield Complaint(f"asked for {_many(asked.left, 'left turn')}, has {left}")
    if right not in asked.right:
        yield Complaint(f"asked for {_many(asked.right, 'right turn')}, has {right}")
    if asked.alternating:
        for second, (one, other) in enumerate(zip(found.turns, found.turns[1:], strict=False), 2):
            if one.side == other.side:
                yield Complaint(
                    f"asked for turns to alternate, turns {second - 1} and {second} both go {one.side}",
                    other.start,
                )


def _many(span: Range, what: str) -> str:
    return f"{span} {what}" if span.lo == span.hi == 1 else f"{span} {what}s"


def _slopes(found: Measures, asked: Outline) -> Iterator[Complaint]:
    """Checks the whole road: up or down on average and nowhere the other way, or level everywhere."""
    low, high = found.lowest_grade, found.highest_grade
    if asked.grade == "up" and not (found.grade >= LEVEL and low > -LEVEL):
        worst = f"{found.grade:.1f} % on average and {low:.1f} % at its lowest over 20 m"
        yield Complaint(f"asked for a road that climbs all the way, has {worst}", on_heights=True)
    elif asked.grade == "down" and not (found.grade <= -LEVEL and high < LEVEL):
        worst = f"{found.grade:.1f} % on average and {high:.1f} % at its highest over 20 m"
        yield Complaint(f"asked for a road that falls all the way, has {worst}", on_heights=True)
    elif asked.grade == "flat" and not (low > -LEVEL and high < LEVEL):
        yield Complaint(
            f"asked for a flat road, has grades from {low:.1f} to {high:.1f} % over 20 m", on_heights=True
        )


def _wholes(found: Measures, asked: Outline) -> tuple[_Whole, ...]:
    mean = asked.grade_range if asked.grade in ("up", "down") else None
    return (
        _Whole(found.grade, mean, f"asked for a mean grade of {{asked}} %, has {found.grade:.1f} %"),
        _Whole(
            found.steepest,
            asked.steepest,
            f"asked for a steepest place of {{asked}} %, has {found.steepest:.1f} %",
        ),
        _Whole(
            found.turning,
            asked.turning,
            f"asked for {{asked}} degrees of turning in all, has {found.turning:.0f}",
            False,
        ),
        _Whole(found.climb, asked.climb, f"asked for a climb of {{asked}} m, has {found.climb:.1f} m"),
        _Whole(
            found.hills,
            asked.hills,
            f"asked for {{asked}} changes between climbing and falling, has {found.hills}",
        ),
        _Whole(
            found.length, asked.length, f"asked for a length of {{asked}} m, has {found.length:.0f} m", False
        ),
    )


def _ends(found: Measures, asked: Outline) -> Iterator[Complaint]:
    """Checks the first and the last feature.

    A lead-in or lead-out straight counts only if one was asked for.
    """
    for feature, index, says in ((asked.starts, 0, "start"), (asked.ends, -1, "end")):
        if feature is None:
            continue
        among = found.turns if feature.kind == "turn" else found.features
        last = among[index] if among else None
        if last is None or last.kind != feature.kind:
            yield Complaint(f"asked to {says} with a {feature.name}, does not")
        elif feature.kind == "turn":
            number = len(found.turns) if index else 1
            yield from turn_complaints(number, last, feature)
        elif not (fits(last, feature) or fits(last.pieces[index], feature)):
            text = f"asked to {says} with another straight than the one it has"
            yield Complaint(text, last.start, on_heights=feature.grade is not None)
