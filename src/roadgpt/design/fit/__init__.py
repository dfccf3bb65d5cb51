"""Changes the free elements of a road as little as needed to meet requirements. Main function: ``fit``.

    elements --look--> what is wrong? --least_change--> lengths and turns --slopes--> look --> ... --> Look

A repair leaves all elements of a proposal free. An edit freezes every element that the request does not name:
its lengths, turns and radii stay exactly as they are. The road as a whole may be shifted or rotated, so that
it stays inside the map.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, floor, inf, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.words import LEAST_STRAIGHT, Range
from roadgpt.check.matching import fits, turn_complaints
from roadgpt.check.measures import MeasuredFeature, Measures, measure
from roadgpt.check.rules import below_floor, inside_map
from roadgpt.check.rules.promises import complaints
from roadgpt.design.fit.grades import graded
from roadgpt.design.fit.limits import MARGINS, TIGHT, Margins, limits_of
from roadgpt.design.fit.solver import Aim, PlanPolyline, least_change, polyline_of
from roadgpt.design.layout import moved_onto_map
from roadgpt.design.road_elements import (
    RoadElement,
    RoadElements,
    numbered,
    seen_as,
    shows_slopes,
    shows_turns,
    with_segments,
)
from roadgpt.design.writing import ABOVE_GROUND, start_height
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Geometry, Road, Segment, World, build
from roadgpt.road.design import MAX_TURN

MOST_SEGMENTS = 60  # that are free; on a road with more, none is fitted
ROUNDS = 2  # of solving: the second with the transitions that came of the first
TENTH, CENTIMETRE = 10.0, 100.0  # per degree or metre, per metre: how changed numbers are written
SHORTEST_TRANSITION = 0.1  # m
FADES = 3.0, 2.0  # m by which a straight, or a turn, may be measured shorter than it is written


class Requirements(NamedTuple):
    """The requirements for a road, in addition to those for each of its elements."""

    world: World
    """The size of the map, and the limits that the rules check."""
    outline: Outline = Outline(groups=(), turns=Range())
    """Requirements for the whole road; none by default."""
    brief: Brief | None = None
    """The Brief that the rule ``promises`` compares with the road. If it is None, each measured element is
    compared with its own requirement.
    """
    before: Design | None = None
    """The road before an edit; the parabolas between its slopes are kept. None for a proposal; then each turn
    must be measured with the slope that was proposed for it.
    """
    geometry: Geometry = "arcs"


@dataclass(frozen=True)
class Look:
    """A design with the road that was built from it, the findings of the rules, and measurements."""

    design: Design
    """The design, moved inside the map and above the ground if necessary."""
    elements: RoadElements
    road: Road
    findings: tuple[check.Finding, ...]
    requirements: Requirements

    @cached_property
    def found(self) -> Measures:
        """The measured turns, straights and grades."""
        return measure(self.road.centreline())

    @cached_property
    def objection(self) -> str:
        """A sentence that says which rule or requirement the road does not meet; empty if it meets all of
        them.
        """
        if self.findings:
            return self.findings[0].sentence
        if not shows_turns(self.found, self.elements):
            wanted, shown = sum(element.is_turn for element in self.elements), len(self.found.turns)
            if wanted != shown:
                return f"{shown} turns would be seen and not {wanted}, as some run into each other"
            return "a turn would be seen to the wrong side"
        if self.requirements.before is None and not shows_slopes(self.found, self.elements):
            return "a turn would be seen on another slope"
        return "" if self.requirements.brief else _unmet(self.elements, self.found, self.requirements.outline)

    @property
    def keeps_all_but_slopes(self) -> bool:
        """Whether the road breaks no rule, and has all turns, each to the required side, when measured."""
        return not self.findings and shows_turns(self.found, self.elements)


def look(design: Design, elements: RoadElements, requirements: Requirements) -> Look:
    """Builds, checks and measures the road of a design, moved inside the map and above the ground if
    possible.
    """
    world, geometry = requirements.world, requirements.geometry
    road = world.lay(build(design, geometry))
    moved = _moved(design, road, world)
    if moved != design:
        road = world.lay(build(moved, geometry))
    return Look(moved, elements, road, check.inspect(road, requirements.brief, world), requirements)


def _moved(design: Design, road: Road, world: World) -> Design:
    if inside_map.inspect(road, None, world):
        # a design that becomes a spline is placed as if it were built of arcs, which lie close by
        design = moved_onto_map(design, world) or design
    if below_floor.inspect(road, None, world):
        x, y, _ = design.starting_point
        height = start_height(design.segments, world.site.z_floor + ABOVE_GROUND)
        design = design.model_copy(update={"starting_point": (x, y, height)})
    return design


def _unmet(elements: RoadElements, found: Measures, outline: Outline) -> str:
    """What is asked of an element, or of the whole road, and is measured otherwise."""
    turns = 0
    for element in elements:
        turns += element.is_turn
        asked = element.asked
        seen = seen_as(element.name, elements, found) if asked else None
        if asked and not seen and asked.length and asked.length.lo >= LEAST_STRAIGHT:
            return f"a straight of {element.length:.1f} m would not be seen"
        if not asked or not seen or fits(seen, asked):
            continue
        if element.is_turn:
            return turn_complaints(turns, seen, asked)[0].sentence
        wanted = f"asked for {asked.length or 'any'} m at {asked.grade or 'any'} %"
        return f"the straight would be {seen.length:.1f} m long at {seen.grade:.1f} %, {wanted}"
    return next((complaint.sentence for complaint in complaints(found, outline)), "")


def fit(
    design: Design,
    elements: RoadElements,
    requirements: Requirements,
    frozen: Collection[str] = frozenset(),
) -> Look:
    """Finds a road that meets all requirements and differs from the design as little as possible.

    Args:
        design: The road as it was proposed, or after the steps of an edit.
        elements: The turns and straights of the road in driving order, each with its requirement; together
            they contain all segments of the design.
        requirements: The other requirements for the road.
        frozen: Names of the elements whose lengths, turns and radii stay as they are.

    Returns:
        A Look at that road, with an empty ``objection``. If no such road is found, a Look at a road that
        meets everything except the proposed slopes, or else at the design, moved inside the map if possible.

    Raises:
        UsageError: No road can be built from these segments.
    """
    elements = numbered(elements)
    if requirements.before is None:
        first = look(design, elements, requirements)
    else:
        first = _on_grades(design, elements, requirements)
    free = np.array([element.name not in frozen for element in elements for _ in element.segments])
    if not first.objection or not 1 <= free.sum() <= MOST_SEGMENTS:
        return first
    best, last = None, first
    for margins in MARGINS if requirements.before is None else (TIGHT, *MARGINS):
        segments = _planned(first, last, free, margins)
        if segments is None:  # there is no such road; with wider margins even less
            break
        if requirements.before and segments == last.design.segments:
            continue
        planned = first.design.model_copy(update={"segments": segments})
        last = _on_grades(planned, first.elements, requirements)
        if not last.objection:
            return last if requirements.before else _restored(last, first)
        if best is None and requirements.before is None and last.keeps_all_but_slopes:
            best = last
    return best or first


def _on_grades(design: Design, elements: RoadElements, needs: Requirements) -> Look:
    """Returns the road with grades that are measured as required."""
    design = graded(design, elements, needs.outline, needs.world, needs.before)
    return look(design, with_segments(elements, design.segments), needs)


def _planned(
    first: Look, last: Look, free: NDArray[np.bool_], margins: Margins
) -> tuple[Segment, ...] | None:
    """The segments with lengths and turns that keep the limits."""
    world, outline = first.requirements.world, first.requirements.outline
    proposed = first.design.segments
    lengths = np.array([s.distance for s in proposed])
    turns = np.radians([s.turn_degrees for s in proposed])
    elements = _as_written(first, last)
    now: tuple[Segment, ...] | None = None
    for _ in range(ROUNDS):
        figure = polyline_of(now or proposed)
        rows, most = limits_of(proposed, elements, figure.peak, outline, world, margins)
        found = least_change(Aim(lengths, turns, free, figure, rows, most, world, margins))
        if found is None:
            break
        now = _written(proposed, found.lengths, found.turns, free, world.limits.min_radius * margins.radius)
    return now


def _as_written(first: Look, last: Look) -> RoadElements:
    """The elements, with lengths, angles and radii asked for as they must be written to be measured so."""
    figure = polyline_of(last.design.segments)
    is_seen = first.requirements.brief is None and shows_turns(last.found, last.elements)
    out = []
    for element, now in zip(first.elements, last.elements, strict=True):
        asked = element.asked if element.segments else None
        if asked:
            seen = seen_as(now.name, last.elements, last.found) if is_seen else None
            asked = _shifted(asked, now, seen, figure)
        out.append(replace(element, asked=asked))
    return tuple(out)


def _shifted(asked: Feature, now: RoadElement, seen: MeasuredFeature | None, figure: PlanPolyline) -> Feature:
    """What must be written so that the ranges of a feature are measured."""
    degrees, radius, length = asked.degrees, asked.radius, asked.length
    if seen is None:
        if length and length.lo > 0:
            length = Range(length.lo + FADES[bool(now.degrees)], length.hi)
        return replace(asked, length=length)
    if length:
        more = now.length - seen.length
        length = Range(length.lo + more, length.hi + more)
    if degrees:
        more = abs(now.degrees) - seen.degrees
        most = MAX_TURN * len(now.segments)
        degrees = Range(degrees.lo + more, min(degrees.hi + more, max(most, abs(now.degrees))))
    if radius:
        tightest = min(
            segment.distance / max(figure.peak[i], 1.0) / radians(abs(segment.turn_degrees))
            for i, segment in zip(now.members, now.segments, strict=True)
            if segment.turn_degrees
        )
        radius = Range(radius.lo * tightest / seen.radius, radius.hi * tightest / seen.radius)
    return replace(asked, degrees=degrees, radius=radius, length=length)


def _written(
    proposed: tuple[Segment, ...], lengths: Array, turns: Array, free: NDArray[np.bool_], radius: float
) -> tuple[Segment, ...]:
    """Segments with new measures, rounded; radii and transitions grow with them, or give way."""
    out = []
    for segment, length, turn, may_change in zip(proposed, lengths, turns, free, strict=True):
        if not may_change:
            out.append(segment)
            continue
        distance, degrees = (
            _rounded(float(length), segment.distance),
            _rounded(float(np.degrees(turn)), segment.turn_degrees),
        )
        update: dict[str, float | None] = {"distance": distance, "turn_degrees": degrees}
        if segment.radius and degrees:
            grown = segment.radius * (distance / segment.distance) * (segment.turn_degrees / degrees)
            fits_in = grown >= radius
            update["radius"] = (
                ceil(grown * CENTIMETRE) / CENTIMETRE
                if fits_in and grown != segment.radius
                else segment.radius
                if fits_in
                else None
            )
            if not fits_in:
                update["transition"] = None
        transition = update.get("transition", segment.transition)
        if degrees and not update.get("radius"):
            most = max(distance - radius * abs(np.radians(degrees)), SHORTEST_TRANSITION)
            if (transition or min(distance / 4, 12.0)) > most:
                update["transition"] = floor(most * TENTH) / TENTH
        out.append(segment.model_copy(update=update))
    return tuple(out)


def _rounded(value: float, before: float) -> float:
    """To a tenth; what was written, where hardly anything changed."""
    return before if abs(value - before) <= 0.005 * abs(before) else round(value * TENTH) / TENTH


def _restored(mended: Look, first: Look) -> Look:
    """The road with all that need not have changed put back as proposed, the smallest changes first."""
    trials: list[tuple[float, int, str]] = []
    pairs = zip(first.design.segments, mended.design.segments, strict=True)
    for index, (one, other) in enumerate(pairs):
        for name in ("distance", "turn_degrees", "incline", "transition", "vertical_radius", "radius"):
            before, after = getattr(one, name), getattr(other, name)
            if before != after:
                away = abs((before or 12.0) - (after or 12.0)) / max(abs(before or 12.0), 1.0)
                trials.append((inf if name == "radius" else away, index, name))
    for _, index, name in sorted(trials):
        rows = list(mended.design.segments)
        was, now = first.design.segments[index], rows[index]
        if name == "radius" and (was.distance, was.turn_degrees) != (now.distance, now.turn_degrees):
            continue  # it belongs to them
        rows[index] = now.model_copy(update={name: getattr(was, name)})
        segments = tuple(rows)
        tried = first.design.model_copy(update={"segments": segments})
        seen = look(tried, with_segments(first.elements, segments), first.requirements)
        if not seen.objection:
            mended = seen
    return mended
