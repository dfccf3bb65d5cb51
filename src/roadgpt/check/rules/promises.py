"""Requires the road to meet its Brief: the turns in order, the straights between them, and the grades.

The requirements are given as ranges in an Outline. They are compared with what ``check.measures`` measures on
the centre line of the road. Additional straights are allowed. If the description leaves a count open ("at
least three right turns, then a hairpin"), the turns of the road are assigned to the requested groups so that
as few turns as possible violate a requirement."""

from collections.abc import Iterator
from itertools import pairwise

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import COUNTS, NO_TURN, ROAD, WHOLE_SLOPES
from roadgpt.check.finding import Finding
from roadgpt.check.matching import Complaint, fits, likeness_complaints, sequence_complaints, turn_complaints
from roadgpt.check.measures import LEVEL, Measures, measure
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the requested and the measured value for each requirement that the road does not meet."""
    if brief is None:
        return ()
    asked = outline(brief, world.site.map_size)
    found = []
    for broken in complaints(measure(road.centreline(), asked.widest), asked):
        x, y = (None, None) if broken.s is None else road.at(min(broken.s, road.length))[:2].tolist()
        found.append(Finding("promises", broken.sentence, broken.s, x, y))
    return tuple(found)


def complaints(found: Measures, asked: Outline) -> list[Complaint]:
    """Returns one Complaint for each requirement of an Outline that a measured road does not meet."""
    out = list(_counts(found, asked))
    if len(found.turns) in asked.turns:
        out += sequence_complaints(found, asked)
        if asked.alike:
            out += likeness_complaints(found, asked)
    for number, turn in enumerate(found.turns, 1):
        out += turn_complaints(number, turn, asked.each_turn)
    out += _slopes(found, asked)
    for name, row in ROAD.items():
        span, value = getattr(asked, name), getattr(found, name)
        if span and value not in span:
            text = f"asked for {row.asked.format(span)}, has {row.measured.format(value)}"
            out.append(Complaint(text, on_heights=row.on_heights))
    return out + list(_ends(found, asked))


def _counts(found: Measures, asked: Outline) -> Iterator[Complaint]:
    number = len(found.turns)
    counts = {"turns": number, "left": found.count("left"), "right": found.count("right")}
    for name, has in counts.items():
        span: Range = getattr(asked, name)
        if has not in span:
            plural = "" if span.lo == span.hi == 1 else "s"
            yield Complaint(f"asked for {span} {COUNTS[name]}{plural}, has {has}")
    if number in asked.turns and asked.turns.hi == 0 and found.turning not in NO_TURN:
        yield Complaint(f"asked for a straight road, turns {found.turning:.1f} degrees in all")
    for second, (one, other) in enumerate(pairwise(found.turns), 2):
        if asked.alternating and one.side == other.side:
            text = f"asked for turns to alternate, turns {second - 1} and {second} both go {one.side}"
            yield Complaint(text, other.start)


def _slopes(found: Measures, asked: Outline) -> Iterator[Complaint]:
    """Checks the whole road: up or down on average and nowhere the other way, or level everywhere."""
    low, high, mean = found.lowest_grade, found.highest_grade, found.grade
    whole = 100 * found.climb / found.length
    is_so = {
        "up": whole >= LEVEL and low > -LEVEL,
        "down": whole <= -LEVEL and high < LEVEL,
        "flat": low > -LEVEL and high < LEVEL,
    }
    if asked.grade and not is_so[asked.grade]:
        grades = f"{whole:.1f} % on average and {low:.1f} to {high:.1f} % over 20 m"
        yield Complaint(
            f"asked for a road that {WHOLE_SLOPES[asked.grade]} all the way, has {grades}", on_heights=True
        )
    if asked.grade in ("up", "down") and asked.grade_range and mean not in asked.grade_range:
        yield Complaint(f"asked for a mean grade of {asked.grade_range} %, has {mean:.1f} %", on_heights=True)


def _ends(found: Measures, asked: Outline) -> Iterator[Complaint]:
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
