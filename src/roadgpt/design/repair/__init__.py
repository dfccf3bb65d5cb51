"""Repairs a proposed Design by the smallest change that makes it valid and meets its Brief: ``repair``.

    none   nothing is touched
    place  the road is moved, turned only where that is not enough, and raised above the ground
    full   then lengths and angles, radii and grades are changed as little as it takes; turns, their sides and
           whether they go up, down or level stay those that were proposed

What cannot be repaired comes back placed at best; ``check.inspect`` says what is still wrong with it.
"""

from collections.abc import Sequence
from math import ceil, floor
from typing import Literal, NamedTuple

import numpy as np

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline
from roadgpt.check.measures import measure
from roadgpt.check.rules.promises import promises_of
from roadgpt.design.layout import moved_onto_map
from roadgpt.design.repair.changes import changes_between
from roadgpt.design.repair.limits import MARGINS, Margins, limits_of
from roadgpt.design.repair.polyline import polyline_of
from roadgpt.design.repair.slopes import sloped
from roadgpt.design.repair.solving import Aim, solved
from roadgpt.design.repair.wishes import with_wishes
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_as_proposed, shows, shows_turns
from roadgpt.design.writing import ABOVE_GROUND, start_height
from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Segment, World, build

How = Literal["none", "place", "full"]
MOST_SEGMENTS = 60  # of a list that is repaired in full; on more, a road of a map's size is no longer a list
ROUNDS = 2  # of solving: the second with the transitions that came of the first
TENTH, CENTIMETRE = 10.0, 100.0  # per degree or metre, per metre: how changed numbers are written
SHORTEST_TRANSITION = 0.1  # m


class Repaired(NamedTuple):
    """A repaired Design, and sentences that say what was changed."""

    design: Design
    changes: tuple[str, ...]


def repair(design: Design, brief: Brief | None, world: World, how: How = "none") -> Repaired:
    """Returns the proposed design, made valid as far as ``how`` allows.

    Args:
        design: as proposed.
        brief: what was asked for, if anything was.
        world: map and limits.
        how: "none", "place" or "full"; see above.
    """
    if how == "none":
        return Repaired(design, ())
    try:
        after = _in_place(design, world)
        elements = elements_as_proposed(design.segments)
        if how == "full" and not _is_fine(after, elements, brief, world):
            after = _mended(design, elements, brief, world) or after
    except (UsageError, ValueError, np.linalg.LinAlgError):  # of no such geometry a road can be built
        return Repaired(design, ())
    return Repaired(after, changes_between(design, after))


def _is_fine(design: Design, proposed: Sequence[RoadElement], brief: Brief | None, world: World) -> bool:
    """Is the road valid, true to its Brief, and does it show what was proposed?"""
    road = build(design)
    return not check.inspect(road, brief, world) and shows(measure(road.centreline()), proposed)


def _in_place(design: Design, world: World) -> Design:
    """The design inside the map and above the ground; as it is, where it lies there or is too large."""
    found = {finding.rule for finding in check.inspect(build(design), None, world)}
    if "inside_map" in found:
        design = moved_onto_map(design, world) or design
    if "below_floor" in found:
        x, y, _ = design.starting_point
        height = start_height(design.segments, world.z_floor + ABOVE_GROUND)
        design = design.model_copy(update={"starting_point": (x, y, height)})
    return design


class _Aims(NamedTuple):
    """What a proposal is held to: its elements with what was asked of each, of the whole, and the Brief."""

    elements: RoadElements
    outline: Outline
    brief: Brief | None


def _mended(design: Design, elements: RoadElements, brief: Brief | None, world: World) -> Design | None:
    """The design with the smallest change of its measures; None where none was found."""
    if len(design.segments) > MOST_SEGMENTS:
        return None
    held_to = [_Aims(elements, promises_of(Brief(), world), None)]
    if brief:
        outline = promises_of(brief, world)
        asked = with_wishes(elements, outline)
        if asked:  # else it has not the turns that were asked for, and is made valid only
            held_to.insert(0, _Aims(asked, outline, brief))
    best: Design | None = None
    for aims in held_to:
        for margins in MARGINS:
            mended = _with_margins(design, aims, world, margins)
            if mended is None:  # there is no such road; with wider margins even less
                break
            if _is_fine(mended, elements, aims.brief, world):
                return _restored(mended, design, aims, world)
            best = best or _second_best(mended, aims, world)
        if best:
            break
    return best


def _second_best(mended: Design, aims: _Aims, world: World) -> Design | None:
    """A road that is true to its Brief, where that meant slopes other than those proposed; else None."""
    road = build(mended)
    if check.inspect(road, aims.brief, world):
        return None
    return mended if shows_turns(measure(road.centreline()), aims.elements) else None


def _with_margins(design: Design, aims: _Aims, world: World, margins: Margins) -> Design | None:
    segments = _solved(design.segments, aims, world, margins)
    if segments is None:
        return None
    planned = design.model_copy(update={"segments": segments})
    return _in_place(sloped(planned, design.segments, aims.elements, aims.outline, world), world)


def _solved(
    proposed: tuple[Segment, ...], aims: _Aims, world: World, margins: Margins
) -> tuple[Segment, ...] | None:
    """The segments with lengths and turns that keep the limits."""
    lengths = np.array([s.distance for s in proposed])
    turns = np.radians([s.turn_degrees for s in proposed])
    now: tuple[Segment, ...] | None = None
    for _ in range(ROUNDS):
        figure = polyline_of(now or proposed)
        rows, most = limits_of(proposed, aims.elements, figure, aims.outline, world, margins)
        found = solved(Aim(lengths, turns, figure, rows, most, world, margins))
        if found is None:
            break
        now = _written(proposed, found.lengths, found.turns, world.min_radius * margins.radius)
    return now


def _written(
    proposed: tuple[Segment, ...], lengths: Array, turns: Array, radius: float
) -> tuple[Segment, ...]:
    """Segments with new measures, rounded; radii and transitions grow with them, or give way."""
    out = []
    for segment, length, turn in zip(proposed, lengths, turns, strict=True):
        distance, degrees = (
            _rounded(float(length), segment.distance),
            _rounded(float(np.degrees(turn)), segment.turn_degrees),
        )
        update: dict[str, float | None] = {"distance": distance, "turn_degrees": degrees}
        if segment.radius and degrees:
            grown = segment.radius * (distance / segment.distance) * (segment.turn_degrees / degrees)
            fits = grown >= radius
            update["radius"] = (
                ceil(grown * CENTIMETRE) / CENTIMETRE
                if fits and grown != segment.radius
                else segment.radius
                if fits
                else None
            )
            if not fits:
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


def _restored(mended: Design, design: Design, aims: _Aims, world: World) -> Design:
    """With all that need not have changed put back as it was proposed, the smallest changes first."""
    trials: list[tuple[float, int, str]] = []
    for index, (one, other) in enumerate(zip(design.segments, mended.segments, strict=True)):
        for name in ("distance", "turn_degrees", "incline", "transition", "vertical_radius"):
            before, after = getattr(one, name), getattr(other, name)
            if before != after:
                away = abs((before or 12.0) - (after or 12.0)) / max(abs(before or 12.0), 1.0)
                trials.append((away, index, name))
    for _, index, name in sorted(trials):
        segments = list(mended.segments)
        segments[index] = segments[index].model_copy(update={name: getattr(design.segments[index], name)})
        tried = design.model_copy(update={"segments": tuple(segments)})
        tried = _in_place(tried, world)
        if _is_fine(tried, aims.elements, aims.brief, world):
            mended = tried
    return mended


__all__ = ["How", "Repaired", "repair"]
