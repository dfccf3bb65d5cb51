"""Makes new roads by varying tested roads, and checks each before it is driven.

    VariationTask --mutate elements--> place on the map --> fast checks --> build --> every rule --> Candidate
                                                      '--> Sketch --chosen--> build --> every rule --^

A VariationTask holds everything that a worker needs, on any machine. A mutation is a pure function of a
road's elements and a random generator; if a mutated road violates a requirement or leaves the map, another
one is tried. Every Candidate satisfies all requirements of the Brief and all rules: ``check.inspect`` checks
the road that will be driven. A Sketch takes about a tenth of the time of a Candidate, because no road is
built and no rule is applied: a search compares many sketches, and builds only what it wants to drive.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import exp
from typing import Any, Literal, NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.check import inspect
from roadgpt.design import draft_road
from roadgpt.design.elements import as_written, design_of, elements_of
from roadgpt.design.layout import MapPose, PlacedPlan, bends_of, keeps_clear, place, walk
from roadgpt.design.variety import PlanShape, shape_of
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.geometry import interpolate
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.road import Design, World, build
from roadgpt.road.design import MAX_INCLINE
from roadgpt.road.road import MOST_CONTROL_POINTS, control_stations
from roadgpt.run.execution import features_of
from roadgpt_search.behaviour import DRIVEN, behaviour_of_samples
from roadgpt_search.surrogate import RoadSamples, RoadStations, features_of_samples, stations_of

STRAIGHTS = (1.0, 150.0)  # m
TURNS = (12.0, 200.0)  # degrees
TRANSITIONS = (0.1, 16.0)  # m; at 0.1 m the curvature changes at once
OVER_LEAST_RADIUS = 1.03  # times the world's smallest radius: a spline through points 2 m apart is tighter
WIDEST = 120.0  # m, of a radius
STRETCH = 0.45  # standard deviation of the logarithm of a length, a radius, a transition
SWING = 22.0  # degrees, standard deviation
SLOPE = 2.5  # percent, standard deviation
CHANGED_TOO = 0.5  # probability that a crossover of two roads is mutated, too
MOST_ELEMENTS = 24  # of a road
PACKED = (0.05, 0.8)  # share of their lengths that straights keep when all are shortened
NEW_STRAIGHT = (3.0, 45.0)  # m, length of an inserted straight
NEW_TURN = (20.0, 120.0)  # degrees, of an inserted turn
ENLARGED = 0.25  # standard deviation of the logarithm by which a whole plan is scaled
REDRAWN = (0.1, 1.2)  # logarithm of the widest radius of redrawn turns over the smallest allowed one
SPARED = 0.5  # largest share of straights that a road with redrawn turns keeps
SHORT = 30.0  # m, longest of these straights
INTERPOLATED = Element._fields[: Element._fields.index("vertical_radius") + 1]

Rng = np.random.Generator
Make = Callable[[Elements, Rng, World], Elements]


class Mutation(NamedTuple):
    """A type of mutation, such as reversing the direction of a turn."""

    make: Make  # a function that returns the mutated elements
    weight: float  # how often this mutation is chosen, relative to the other mutations
    is_numeric: bool
    """True if the mutation keeps the sequence of turns and straights and changes only numbers."""


def mutated(elements: Elements, rng: Rng, world: World, numeric: float = 0.0) -> Elements:
    """Returns the elements after one to three random mutations; with the probability ``numeric`` only
    lengths, angles, radii and slopes change."""
    some = NUMERIC_ONES if rng.random() < numeric else [*MUTATIONS.values()]
    weights = np.array([one.weight for one in some])
    for number in rng.choice(len(some), size=1 + rng.integers(3), p=weights / weights.sum()):
        elements = some[int(number)].make(elements, rng, world)
    return elements


def crossed_over(one: Elements, other: Elements, rng: Rng) -> Elements:
    """Joins the first elements of one road to the last elements of another road; returns at most 24
    elements. Both roads are cut at random."""
    first, last = int(rng.integers(1, len(one) + 1)), int(rng.integers(len(other)))
    return (one[:first] + other[last:])[:MOST_ELEMENTS]


def interpolated(one: Elements, other: Elements, share: float) -> Elements | None:
    """Returns a road between two roads; ``share`` 0 gives the first road, 1 the second. Returns None if the
    roads' sequences of turns and straights differ."""
    if [np.sign(element.turn) for element in one] != [np.sign(element.turn) for element in other]:
        return None

    def between(a: Any, b: Any) -> Any:
        return a if a == b else (1 - share) * (a or 0.0) + share * (b or 0.0)

    out = []
    for pair in zip(one, other, strict=True):
        mixed = {name: between(*(getattr(each, name) for each in pair)) for name in INTERPOLATED}
        out.append(Element(**mixed | {"vertical_radius": mixed["vertical_radius"] or None}))
    return tuple(out)


def varied(parents: Sequence[Elements], rng: Rng, world: World, numeric: float, rounds: int = 1) -> Elements:
    """Returns one parent after ``rounds`` of ``mutated``, or a crossover of two, of which half are mutated as
    well."""
    elements = crossed_over(parents[0], parents[1], rng) if len(parents) > 1 else parents[0]
    if len(parents) > 1 and rng.random() >= CHANGED_TOO:
        return elements
    for _ in range(rounds):
        elements = mutated(elements, rng, world, numeric)
    return elements


def _mirrored(elements: Elements, rng: Rng, world: World) -> Elements:
    return tuple(element._replace(turn=-element.turn) if element.turn else element for element in elements)


def _longer(element: Element, rng: Rng, world: World) -> Element:
    return element._replace(straight=_scaled(element.straight, STRAIGHTS, rng))


def _tighter(element: Element, rng: Rng, world: World) -> Element:
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    return element._replace(radius=_scaled(element.radius, (least, WIDEST), rng))


def _farther(element: Element, rng: Rng, world: World) -> Element:
    size = np.clip(abs(element.turn) + SWING * rng.standard_normal(), *TURNS)
    return element._replace(turn=float(np.copysign(size, element.turn)))


def _smoother(element: Element, rng: Rng, world: World) -> Element:
    return element._replace(transition=_transition(rng))


def _steeper(element: Element, rng: Rng, world: World) -> Element:
    most = min(100 * world.limits.max_grade, MAX_INCLINE) - 0.2
    return element._replace(
        incline=float(np.clip(element.incline + SLOPE * rng.standard_normal(), -most, most))
    )


def _swapped(elements: Elements, rng: Rng, world: World) -> Elements:
    i, j = (int(n) for n in rng.integers(len(elements), size=2))
    row = list(elements)
    row[i], row[j] = row[j], row[i]
    return tuple(row)


def _inserted(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the elements with a new turn, followed by a new straight, at a random place."""
    if len(elements) >= MOST_ELEMENTS:
        return elements
    at = int(rng.integers(len(elements) + 1))
    incline = elements[min(at, len(elements) - 1)].incline
    turn, radius = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN)), _tight(rng, world, 0.5)
    new = Element(turn=turn, radius=radius, transition=_transition(rng), incline=incline)
    straight = Element(straight=float(rng.uniform(*NEW_STRAIGHT)), incline=incline)
    return (*elements[:at], new, straight, *elements[at:])


def _removed(elements: Elements, rng: Rng, world: World) -> Elements:
    at = int(rng.integers(len(elements)))
    return elements[:at] + elements[at + 1 :] if len(elements) > 1 else elements


def _cut_out(elements: Elements, rng: Rng, world: World) -> Elements:
    first, last = sorted(int(n) for n in rng.integers(len(elements) + 1, size=2))
    return elements[first:last] if last > first else elements


def _packed(elements: Elements, rng: Rng, world: World) -> Elements:
    share = rng.uniform(*PACKED)
    return tuple(
        one if one.turn else one._replace(straight=max(one.straight * share, STRAIGHTS[0]))
        for one in elements
    )


def _wound(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the elements with two tight turns to opposite sides, without a straight between them."""
    if len(elements) + 1 >= MOST_ELEMENTS:
        return elements
    at = int(rng.integers(len(elements) + 1))
    incline = elements[min(at, len(elements) - 1)].incline
    side, radius = float(rng.choice((-1, 1))), _tight(rng, world, 0.2)
    pair = (
        Element(0.0, hand * float(rng.uniform(*NEW_TURN)), radius, _transition(rng), incline)
        for hand in (side, -side)
    )
    return (*elements[:at], *pair, *elements[at:])


def _enlarged(elements: Elements, rng: Rng, world: World) -> Elements:
    """Scales the plan of the road: all straights and radii by the same factor."""
    factor = exp(ENLARGED * float(rng.standard_normal()))
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    return tuple(
        one._replace(radius=float(np.clip(one.radius * factor, least, WIDEST)))
        if one.turn
        else one._replace(straight=float(np.clip(one.straight * factor, *STRAIGHTS)))
        for one in elements
    )


def redrawn(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the road with new random turns in place of its turns. Most straights are left out; the other
    straights get new random lengths of at most 30 m."""
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    most, spared = float(rng.uniform(*REDRAWN)), rng.uniform(0.0, SPARED)
    out = []
    for one in elements:
        if one.turn:
            turn = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN))
            radius = least * exp(float(rng.uniform(0.0, most)))
            out.append(one._replace(turn=turn, radius=radius, transition=_transition(rng)))
        elif rng.random() < spared:
            out.append(one._replace(straight=float(rng.uniform(STRAIGHTS[0], SHORT))))
    return tuple(out) or elements


def _backwards(elements: Elements, rng: Rng, world: World) -> Elements:
    """Reverses the direction of driving: left turns become right turns, and climbs become descents."""
    radii = [None, *(element.vertical_radius for element in reversed(elements[1:]))]
    return tuple(
        element._replace(
            turn=-element.turn if element.turn else 0.0,
            incline=-element.incline + 0.0,
            vertical_radius=radius,
        )
        for element, radius in zip(reversed(elements), radii, strict=True)
    )


def _of_one(change: Callable[[Element, Rng, World], Element], kind: str) -> Make:
    def make(elements: Elements, rng: Rng, world: World) -> Elements:
        found = [i for i, one in enumerate(elements) if kind in ("any", "turn" if one.turn else "straight")]
        if not found:
            return elements
        index = found[int(rng.integers(len(found)))]
        return (*elements[:index], change(elements[index], rng, world), *elements[index + 1 :])

    return make


MUTATIONS: dict[str, Mutation] = {
    "longer": Mutation(_of_one(_longer, "straight"), 3.0, True),
    "tighter": Mutation(_of_one(_tighter, "turn"), 3.0, True),
    "farther": Mutation(_of_one(_farther, "turn"), 3.0, True),
    "smoother": Mutation(_of_one(_smoother, "turn"), 1.0, True),
    "steeper": Mutation(_of_one(_steeper, "any"), 1.0, True),
    "other hand": Mutation(_of_one(lambda one, rng, world: one._replace(turn=-one.turn), "turn"), 1.0, False),
    "swapped": Mutation(_swapped, 1.0, False),
    "inserted": Mutation(_inserted, 1.5, False),
    "removed": Mutation(_removed, 1.0, False),
    "cut out": Mutation(_cut_out, 1.0, False),
    "packed": Mutation(_packed, 1.0, True),
    "wound": Mutation(_wound, 1.0, False),
    "enlarged": Mutation(_enlarged, 1.5, True),
    "redrawn": Mutation(redrawn, 0.5, False),
    "mirrored": Mutation(_mirrored, 0.5, False),
    "backwards": Mutation(_backwards, 0.5, False),
}
NUMERIC_ONES = [one for one in MUTATIONS.values() if one.is_numeric]


def _tight(rng: Rng, world: World, spread: float) -> float:
    """Draws a radius in metres, mostly near the smallest one of the world."""
    return min(world.limits.min_radius * OVER_LEAST_RADIUS * exp(float(rng.exponential(spread))), WIDEST)


def _transition(rng: Rng) -> float:
    """Draws the length of a clothoid in metres; lengths of every order of magnitude are equally likely."""
    return exp(float(rng.uniform(*np.log(TRANSITIONS))))


def _scaled(value: float, limits: tuple[float, float], rng: Rng) -> float:
    return float(np.clip(value * np.exp(STRETCH * rng.standard_normal()), *limits))


TRIES = 8  # mutations that are tried for one candidate, at most
BOLD = 3  # of TRIES; later tries mostly change only numbers, which violates fewer requirements
NUMERIC = (0.4, 0.9)  # probability that only numbers change: in the bold tries, and in the others
NOBODY = Brief()

Kind = Literal["draft", "wild", "vary", "cross", "between"]


class VariationContext(NamedTuple):
    """The requirements, world and rules that all candidates of a cell share."""

    brief: Brief | None  # the requirements; None if there are none
    world: World  # the map, and the limits that the rules apply
    rules: Literal["strict", "sbft"] = "strict"
    """With "sbft", a road must also pass the validator of the competition."""
    axes: tuple[str, ...] = ()  # names of the features that a sketch needs
    is_interpolated: bool = False
    """Whether roads are driven as the competition interpolates them, by a spline through points 2 m apart."""


class VariationTask(NamedTuple):
    """Describes one candidate to make, so that any worker can make it."""

    kind: Kind
    """What to make: a new draft ("draft"), a mutated parent ("vary"), a crossover of two parents ("cross"), a
    road between two parents ("between"), or, only as a sketch, a draft after three rounds of mutations
    ("wild")."""
    parents: tuple[Design, ...]
    """The parent roads: none for a draft, one for a mutation, two for a crossover or an interpolation."""
    origin: str  # text that is stored with the candidate and says where it comes from
    seed: tuple[int, ...]  # seed of the random generator; a road between two parents needs none
    setting: VariationContext
    share: float = 0.5  # position of a road between its two parents: 0 gives the first parent, 1 the second
    numeric: float = NUMERIC[0]
    """Probability, 0 to 1, that a sketch keeps the sequence of turns and straights of its parent."""


class Candidate(NamedTuple):
    """A road that satisfies all requirements and rules."""

    design: Design
    origin: str  # text that says where the road comes from, taken from its task
    shape: PlanShape
    """Shape of the road seen from above, from which the distance between two candidates is computed."""


def make_candidate(task: VariationTask) -> Candidate | None:
    """Returns the candidate that a task describes; None if no valid road was found that meets the Brief.
    Tasks of the kind "wild" belong to ``sketch.sketch``."""
    rng = np.random.default_rng(task.seed)
    setting = task.setting
    if task.kind == "between":
        (one, other), share = task.parents, task.share
        between = interpolated(elements_of(one.segments), elements_of(other.segments), share)
        if between is None:
            return None
        (x0, y0, _), (x1, y1, _) = one.starting_point, other.starting_point
        turned = (other.theta - one.theta + 180) % 360 - 180
        x, y = round(x0 + share * (x1 - x0), 2), round(y0 + share * (y1 - y0), 2)
        where = MapPose(x, y, round((one.theta + share * turned) % 360, 1) % 360)
        return validated(design_of(between, where, setting.world), setting, task.origin)
    if task.kind == "draft":
        design = draft(setting, rng)
        return validated(design, setting, task.origin) if design else None
    parents = [elements_of(design.segments) for design in task.parents]
    for attempt in range(TRIES):
        elements = varied(parents, rng, setting.world, NUMERIC[attempt >= BOLD])
        room = room_for(elements, setting, rng)
        found = room and validated(design_of(elements, room.place, setting.world), setting, task.origin)
        if found:
            return found
    return None


def draft(setting: VariationContext, rng: np.random.Generator) -> Design | None:
    """Returns a draft of the planner, which the competition may reject; None if no road could be designed."""
    try:
        return draft_road(setting.brief or NOBODY, setting.world, seed=int(rng.integers(2**53)))
    except DesignError:
        return None


def room_for(elements: Elements, setting: VariationContext, rng: np.random.Generator) -> PlacedPlan | None:
    """Places a road at random on the map; returns None if it does not fit there, or if its parts overlap."""
    written = [as_written(element) for element in elements]
    line = walk(written)
    where = place(line, setting.world, rng)
    if where is None or not keeps_clear(line, setting.world, with_shoulders=False):
        return None
    return PlacedPlan(written, line, where)


def validated(design: Design, setting: VariationContext, origin: str) -> Candidate | None:
    """Builds the road of a design; returns None if it violates a requirement or a rule."""
    try:
        road = setting.world.lay(build(design))
        if inspect(road, setting.brief, setting.world):
            return None
        if setting.rules == "sbft" and inspect(road, None, setting.world, "sbft"):
            return None
    except (RoadGPTError, ValueError):  # a spline of this road cannot be laid: it is no candidate
        return None
    samples = road.sample()
    return Candidate(design, origin, shape_of(samples.s, samples.x + 1j * samples.y))


SKETCH_TRIES = 6  # mutations that are tried for one sketch, until one fits on the map
ROUNDS = 3  # rounds of mutations that turn a draft into a wild one
ANEW = 0.5  # probability that the turns of a draft are redrawn before these rounds
FINER = 6  # steps between control points; fewer would miss the road where its curvature changes at once
SKETCH_BOLD = 2  # of TRIES; later tries mostly change only numbers, which violates fewer requirements


class Sketch(NamedTuple):
    """A road that fits on the map, but has not been built or checked."""

    elements: Elements
    place: MapPose
    origin: str  # text that says where the road comes from, taken from its task
    features: dict[str, float]  # features of the road that are known without a drive, by name
    surrogate_features: Array  # input features of the surrogate model, ``(n,)``
    stations: RoadStations  # the road at the places where the car may leave its lane


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
    for attempt in range(SKETCH_TRIES if parents else 0):
        numeric = task.numeric if attempt < SKETCH_BOLD else NUMERIC[1]
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
    Where curvature changes at once, the spline through the control points is tighter than the road."""
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


def _features_of_line(points: Array, axes: Sequence[str], brief: Brief | None) -> dict[str, float]:
    """Computes features from points ``(n, 3)`` of the centre line, about one per metre. Returns, by name, the
    features in ``axes`` that need no drive."""
    found = features_of(points)
    if not set(axes) <= {*found, *DRIVEN}:
        step = np.diff(points[:, :2], axis=0)
        heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
        found |= behaviour_of_samples(points, heading, brief)
    return {axis: found[axis] for axis in axes if axis in found}


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
    features = _features_of_line(points, setting.axes, setting.brief)
    world = setting.world
    seen = features_of_samples(samples, world)
    return Sketch(elements, where, origin, features, seen, stations_of(samples, world))
