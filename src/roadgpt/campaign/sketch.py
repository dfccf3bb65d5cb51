"""Makes sketches of roads: turns and straights, their place on the map, and the surrogate's features.

    VariationTask --mutate--> place on the map --> Sketch --chosen--> build --> every rule --> Candidate

A sketch takes about a tenth of the time of a candidate, because no road is built and no rule is applied. So
a search can compare many sketches, and build only the roads that it wants to drive.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Elements
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.campaign.behaviour import behaviour_of_line
from roadgpt.campaign.departure import RoadStations, stations_of
from roadgpt.campaign.mutation import redrawn, varied
from roadgpt.campaign.surrogate_features import RoadSamples, features_of_samples
from roadgpt.campaign.variation import (
    NOBODY,
    NUMERIC,
    Candidate,
    VariationContext,
    VariationTask,
    draft,
    room_for,
    validated,
)
from roadgpt.design.elements import as_written, elements_of
from roadgpt.design.layout import MapPose, PlacedPlan, bends_of, walk
from roadgpt.design.variety import PlanShape, shape_of
from roadgpt.design.writing import design_of
from roadgpt.geometry import interpolate
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.road import Design
from roadgpt.road.road import MOST_CONTROL_POINTS, control_stations

TRIES = 6  # mutations that are tried for one sketch, until one fits on the map
ROUNDS = 3  # rounds of mutations that turn a draft into a wild one
ANEW = 0.5  # probability that the turns of a draft are redrawn before these rounds
FINER = 6  # steps between control points; fewer would miss the road where its curvature changes at once
BOLD = 2  # of TRIES; later tries mostly change only numbers, which violates fewer requirements


class Sketch(NamedTuple):
    """A road that fits on the map, but has not been built or checked."""

    elements: Elements
    place: MapPose
    origin: str
    """Text that says where the road comes from, taken from its task."""
    features: dict[str, float]
    """Features of the road that are known without a drive, by name."""
    surrogate_features: Array
    """Input features of the surrogate model, ``(n,)``."""
    stations: RoadStations
    """The road at the places where the car may leave its lane."""


@lru_cache(maxsize=16)  # every sketch of a cell asks
def _turns_of(brief: Brief) -> Range:
    return outline(brief).turns


def sketch(task: VariationTask) -> Sketch | None:
    """Returns the sketch that a task describes. Returns None if the road to mutate could not be drafted, or
    if every attempt gave a road that leaves the map, overlaps itself or has the wrong number of turns."""
    rng = np.random.default_rng(task.seed)
    if task.kind == "wild":
        found = draft(task.setting, rng)
        parents = [elements_of(found.segments)] if found else []
        if parents and rng.random() < ANEW:
            parents = [redrawn(parents[0], rng, task.setting.world)]
    else:
        parents = [elements_of(design.segments) for design in task.parents]
    asked = _turns_of(task.setting.brief or NOBODY)
    for attempt in range(TRIES if parents else 0):
        numeric = task.numeric if attempt < BOLD else NUMERIC[1]
        elements = varied(parents, rng, task.setting.world, numeric, ROUNDS if task.kind == "wild" else 1)
        if not asked.lo <= sum(element.turn != 0 for element in elements) <= asked.hi:
            continue
        room = room_for(elements, task.setting, rng)
        if room is not None:
            return _sketched(elements, room, task.origin, task.setting)
    return None


def sketch_of(known: tuple[Design, VariationContext]) -> tuple[Sketch, PlanShape]:
    """Returns the sketch and the shape of an existing design of a cell."""
    design, setting = known
    elements = elements_of(design.segments)
    x, y, _ = design.starting_point
    written = [as_written(element) for element in elements]
    line = walk(written)
    room = PlacedPlan(written, line, MapPose(x, y, design.theta))
    return _sketched(elements, room, "", setting), shape_of(line.s, line.z)


def candidate_of(work: tuple[Sketch, VariationContext]) -> Candidate | None:
    """Builds the road of a sketch of a cell; returns None if it violates a requirement or a rule."""
    one, setting = work
    return validated(design_of(one.elements, one.place, setting.world), setting, one.origin)


def _driven_line(room: PlacedPlan, setting: VariationContext) -> Complex:
    """Returns points of the line that is driven, about one per metre, as x + iy before the road is placed.

    Where the curvature changes at once, the spline through a road's control points is tighter than the road.
    """
    if not setting.is_interpolated:
        return room.line.z
    knots, bends, _ = bends_of(room.elements)
    stations = control_stations(room.line.s, np.interp(room.line.s, knots, bends, right=0.0))
    if len(stations) < MOST_CONTROL_POINTS:
        points = walk(room.elements, FINER * (len(stations) - 1)).z[::FINER]
    else:  # unequally spaced
        points = room.line.z[np.unique(np.round(stations / room.line.s[1]).astype(int))]
    x, y = interpolate(np.stack([points.real, points.imag], axis=1)).T
    return np.asarray(x + 1j * y)


def _sketched(elements: Elements, room: PlacedPlan, origin: str, setting: VariationContext) -> Sketch:
    line, where = room.line, room.place
    knots, bends, length = bends_of(room.elements)
    ends = np.cumsum([element.length for element in elements])
    inclines = np.array([element.incline for element in elements])
    grade = inclines[np.minimum(np.searchsorted(ends, line.s), len(elements) - 1)] / 100
    middle = setting.world.section.profile(max(length, 1.0)).middle(line.s)
    samples = RoadSamples(line.s, np.interp(line.s, knots, bends, right=0.0), grade, middle)
    plan = _driven_line(room, setting) * np.exp(1j * np.radians(where.theta))
    climb = np.concatenate([[0.0], np.cumsum(grade[:-1] * np.diff(line.s))])
    heights = np.interp(np.linspace(0.0, line.s[-1], len(plan)), line.s, climb)
    points = np.stack([plan.real + where.x, plan.imag + where.y, heights], axis=1)
    features = behaviour_of_line(points, setting.axes, setting.brief)
    world = setting.world
    seen = features_of_samples(samples, world)
    return Sketch(elements, where, origin, features, seen, stations_of(samples, world))
