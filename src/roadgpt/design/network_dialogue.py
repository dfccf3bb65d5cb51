"""Checks the routes with junctions that a language model proposes, and moves them onto the map.

Nothing else of a proposed route is changed. What is wrong is stated in sentences that name its segments and
junctions, so that the model can correct it:

    segment 3: near (262, 125): road 2 leaves the map by 12.3 m at x = 250; the map runs from 0 to 250 m
    junction 1 at s = 62 m: asked to turn left, turns -90 degrees
    segments 2 to 3: asked for 2 turns, has 1
"""

import re

import numpy as np

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.chat import Chat
from roadgpt.chat.model import Repair
from roadgpt.check import Finding
from roadgpt.check.footprint import footprint
from roadgpt.check.route_promises import stretches_of
from roadgpt.design.asking import rules
from roadgpt.design.dialogue import DesignTask, Outcome, whole
from roadgpt.design.layout import LEAST_EDGE
from roadgpt.design.network_answer import AnswerNetwork, network_design_of
from roadgpt.design.objections import the_first
from roadgpt.errors import DesignError
from roadgpt.network import NetworkDesign, Route, build_route, made_from
from roadgpt.network.stretch_profiles import refuse_other_lanes
from roadgpt.road import World

RULES = "chat_junction_rules.txt"
"""The rules for junctions, which a language model gets behind those for roads."""
ON_ROAD = re.compile(r"^on the road from s = [^:]*: ")
CENTIMETRES = 2  # decimals of a start that is moved
ROUTES = "routes with junctions, medians or traffic on the left are"
ALIKE = "not compared with earlier roads of the campaign"
LEFT_OUT: dict[Repair, str] = {
    "none": f"{ROUTES} {ALIKE}",
    "place": f"{ROUTES} moved onto the map, but neither rotated nor raised, and {ALIKE}",
    "full": f"{ROUTES} moved onto the map, but not repaired otherwise, and {ALIKE}",
}
"""What is left out for routes, by the setting ``repair``."""


def route_outcome(chat: Chat, task: DesignTask) -> Outcome:
    """Asks for whole routes until one is free of errors or all rounds are used up; returns the best one.

    Args:
        chat: the language model.
        task: the route to design; its rules are those for roads.

    Raises:
        DesignError: no answer was a route, or the settings ask for a route segment by segment.
        UsageError: the World has lanes or banked bends that networks do not have.
        ReplyError: no answer could be read.
        ChatError: the model could not be asked.
    """
    if task.settings.strategy == "stepwise":
        raise DesignError(
            f"{ROUTES} designed as a whole, not segment by segment; leave out --strategy stepwise"
        )
    refuse_other_lanes(task.world)
    whole_task = task._replace(rules=f"{task.rules}\n\n{rules(RULES, task.world)}")
    outcome = whole(chat, whole_task, AnswerNetwork, judged_route)
    return outcome._replace(remarks=(LEFT_OUT[task.settings.repair], *outcome.remarks))


def judged_route(answer: AnswerNetwork, task: DesignTask, number: int, model: str) -> Outcome:
    """Returns the route of an answer, moved onto the map, and what is still wrong with it.

    Raises:
        UsageError: the answer is not a route, or no route can be built from it.
    """
    proposed, remarks = network_design_of(answer, task.world, task.brief.left_hand)
    moves = task.settings.repair != "none"
    design = moved_onto_map(proposed, task.world) if moves else proposed
    return Outcome(design, proposed, number, route_objections(design, task.brief, task.world), remarks, model)


def moved_onto_map(design: NetworkDesign, world: World) -> NetworkDesign:
    """Returns the design, moved no further than necessary so that its roads lie on the map; unchanged if the
    network is larger than the map.

    Raises:
        UsageError: no route can be built from the design.
    """
    bounds = footprint(build_route(design, world).network).bounds
    low, high = bounds[:, :2].min(axis=0) - LEAST_EDGE, bounds[:, 2:].max(axis=0) + LEAST_EDGE
    size = world.site.map_size
    if (high - low > size).any():
        return design
    move = np.maximum(-low, 0.0) + np.minimum(size - high, 0.0)
    if not move.any():
        return design
    x, y = (np.array(design.starting_point[:2]) + move).round(CENTIMETRES).tolist()
    return design.model_copy(update={"starting_point": (x, y, design.starting_point[2])})


def route_objections(design: NetworkDesign, brief: Brief, world: World) -> tuple[str, ...]:
    """Returns sentences that say what is wrong with a route; none if it is valid and meets its Brief.

    Args:
        design: the design to check.
        brief: the requirements.
        world: size of the map, and limits that the rules check, such as the steepest grade.

    Raises:
        UsageError: no route can be built from the design.
    """
    route = made_from(design, world)
    assert isinstance(route, Route)
    found = check.inspect(route, brief, world)
    return the_first(_said(finding, design, route) for finding in found)


def _said(finding: Finding, design: NetworkDesign, route: Route) -> str:
    """Returns the sentence of a finding, with the segments or the junction that it is about."""
    sentence = finding.sentence
    if finding.s is None or sentence.startswith("junction "):
        return sentence
    first = 1
    for n, ((start, road), segments) in enumerate(zip(stretches_of(route), design.stretches, strict=False)):
        if finding.s < start:
            return f"junction {n}: {sentence}"
        if finding.s <= start + road.length:
            last = first + len(segments) - 1
            if ON_ROAD.match(sentence):
                named = f"segment {first}" if last == first else f"segments {first} to {last}"
                return f"{named}: {ON_ROAD.sub('', sentence)}"
            ends = start + np.cumsum([segment.distance for segment in segments])
            number = first + int(np.searchsorted(ends, finding.s, side="right"))
            return f"segment {min(number, last)}: {sentence}"
        first += len(segments)
    return f"junction {len(design.junctions)}: {sentence}"


__all__ = ["judged_route", "moved_onto_map", "route_objections", "route_outcome"]
