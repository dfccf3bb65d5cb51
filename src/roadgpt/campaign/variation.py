"""Makes new roads by varying tested roads, and checks each before it is driven.

    VariationTask --mutate elements--> place on the map --> fast checks --> build --> every rule --> Candidate

A VariationTask holds everything that a worker needs to run ``make_candidate``, on any machine. If a
mutated road violates a requirement or leaves the map, another mutation is tried. Every Candidate satisfies
all requirements of the Brief and all rules: ``check.inspect`` checks the road that will be driven.
"""

from typing import Literal, NamedTuple

import numpy as np

from roadgpt import check
from roadgpt.brief.element import Elements
from roadgpt.brief.model import Brief
from roadgpt.campaign.mutation import interpolated, varied
from roadgpt.design import draft_road
from roadgpt.design.elements import as_written, elements_of
from roadgpt.design.layout import MapPose, PlacedPlan, keeps_clear, place, walk
from roadgpt.design.variety import PlanShape, shape_of
from roadgpt.design.writing import design_of
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.road import Design, World, build

TRIES = 8  # mutations that are tried for one candidate, at most
BOLD = 3  # of TRIES; later tries mostly change only numbers, which violates fewer requirements
NUMERIC = (0.4, 0.9)  # probability that only numbers change: in the bold tries, and in the others
NOBODY = Brief()

Kind = Literal["draft", "wild", "vary", "cross", "between"]


class VariationContext(NamedTuple):
    """The requirements, world and rules that all candidates of a cell share."""

    brief: Brief | None
    """The requirements; None if there are none."""
    world: World
    """The map, and the limits that the rules apply."""
    rules: Literal["strict", "sbft"] = "strict"
    """With "sbft", a road must also pass the validator of the competition."""
    axes: tuple[str, ...] = ()
    """Names of the features that a sketch needs."""
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
    origin: str
    """Text that is stored with the candidate and says where it comes from."""
    seed: tuple[int, ...]
    """Seed of the random generator; a road between two parents needs none."""
    setting: VariationContext
    share: float = 0.5
    """Position of a road between its two parents: 0 gives the first parent, 1 the second."""
    numeric: float = NUMERIC[0]
    """Probability, 0 to 1, that a sketch keeps the sequence of turns and straights of its parent."""


class Candidate(NamedTuple):
    """A road that satisfies all requirements and rules."""

    design: Design
    origin: str
    """Text that says where the road comes from, taken from its task."""
    shape: PlanShape
    """Shape of the road seen from above, from which the distance between two candidates is computed."""


def make_candidate(task: VariationTask) -> Candidate | None:
    """Returns the candidate that a task describes; None if no valid road was found that meets the Brief.
    Tasks of the kind "wild" belong to ``sketch.sketch``."""
    rng = np.random.default_rng(task.seed)
    setting = task.setting
    if task.kind == "between":
        return _between(task)
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


def _between(task: VariationTask) -> Candidate | None:
    """Returns a road between the two parents, which starts at a place between their starts; None if the
    roads do not correspond or the new road is not valid."""
    (one, other), share = task.parents, task.share
    elements = interpolated(elements_of(one.segments), elements_of(other.segments), share)
    if elements is None:
        return None
    (x0, y0, _), (x1, y1, _) = one.starting_point, other.starting_point
    turned = (other.theta - one.theta + 180) % 360 - 180
    where = MapPose(
        round(x0 + share * (x1 - x0), 2),
        round(y0 + share * (y1 - y0), 2),
        round((one.theta + share * turned) % 360, 1) % 360,
    )
    return validated(design_of(elements, where, task.setting.world), task.setting, task.origin)


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
        if check.inspect(road, setting.brief, setting.world):
            return None
        if (
            setting.rules == "sbft"
            and not check.sbft_verdict(road.control_points(), setting.world.site.map_size)[0]
        ):
            return None
    except (RoadGPTError, ValueError):  # a spline of this road cannot be laid: it is no candidate
        return None
    samples = road.sample()
    return Candidate(design, origin, shape_of(samples.s, samples.x + 1j * samples.y))
