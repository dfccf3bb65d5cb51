"""Reads the routes with junctions that a language model proposes, moves them onto the map, and checks them.

An answer has the fields of a design file; junctions stand in a list or in numbered fields (junction1,
junction2, ...). What does not apply to a junction is null or left out. The answer is read by the reader of
design files, which refuses what it does not know.

Nothing else of a proposed route is changed. If the setting ``repair`` is "none", the route is not even moved.
What is wrong is stated in sentences that name its segments and junctions, so that the model can correct it:

    segment 3: near (262, 125): road 2 leaves the map by 12.3 m at x = 250; the map runs from 0 to 250 m
    junction 1 at s = 62 m: asked to turn left, turns -90 degrees
    segments 2 to 3: asked for 2 turns, has 1
"""

import re
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from roadgpt import check
from roadgpt.brief.junctions import LaneKind, PlainKind
from roadgpt.brief.model import Brief
from roadgpt.chat import Chat
from roadgpt.chat.json_schema import fixed_description
from roadgpt.chat.model import Repair
from roadgpt.chat.strict_json import plain
from roadgpt.check import Finding
from roadgpt.check.footprint import footprint
from roadgpt.check.route_promises import stretches_of
from roadgpt.design.answer import AnswerRoad, AnswerSegment, Number, in_file_format, with_list
from roadgpt.design.asking import rules, the_first
from roadgpt.design.dialogue import DesignTask, Outcome, whole
from roadgpt.design.layout import LEAST_EDGE
from roadgpt.errors import DesignError, UsageError
from roadgpt.network import NetworkDesign, Route, build_route, made_from, read_network_design
from roadgpt.network.design import KEY
from roadgpt.network.stretch_profiles import refuse_other_lanes
from roadgpt.road import World

RULES = "chat_junction_rules.txt"
"""Prompt file with the rules for junctions; a language model gets them after the rules for roads."""
ON_ROAD = re.compile(r"^on the road from s = [^:]*: ")
CENTIMETRES = 2  # decimals of a start that is moved
ROUTES = "routes with junctions, medians or traffic on the left are"
ALIKE = "not compared with earlier roads of the campaign"
LEFT_OUT: dict[Repair, str] = {
    "none": f"{ROUTES} {ALIKE}",
    "place": f"{ROUTES} moved onto the map, but neither rotated nor raised, and {ALIKE}",
    "full": f"{ROUTES} moved onto the map, but not repaired otherwise, and {ALIKE}",
}
"""Sentence on what is not done for routes, for each value of the setting ``repair``."""
MOST_SAID = 300  # characters of an objection to an answer
Exit = Annotated[int, Field(strict=True)]


def _part(description: str) -> ConfigDict:
    """Returns the configuration of a part of an answer; unknown fields are kept for the reader of designs."""
    return ConfigDict(extra="allow", **fixed_description(description))


class AnswerRouteSegment(AnswerSegment):
    """One segment of a route; it may have the optional fields of design files, such as its radius."""

    model_config = _part("One segment of an answer.")


class AnswerLanes(BaseModel):
    """The lanes of a road in a language model's answer."""

    model_config = _part("The lanes of a road.")

    forward: int | None = Field(None, description="In the direction of the drive, 1 to 4; null for 1.")
    backward: int | None = Field(None, description="Oncoming, 0 to 4; null for 1.")
    width: Number | None = Field(None, description="Of each lane, metres; null for the usual width.")
    centre: str | None = Field(None, description="solid, broken, double or none; null for the usual line.")
    divided: bool | None = Field(None, description="true for a median.")


class AnswerArm(BaseModel):
    """A road at a junction in a language model's answer."""

    model_config = _part("A road at a junction.")

    angle: Number = Field(description="Degrees from straight on, left positive.")
    length: Number | None = Field(None, description="Metres; null for the arm that the route takes.")
    control: str | None = Field(None, description="Its sign, if it is not the usual one.")
    one_way: str | None = Field(None, description="in, out or null.")


class AnswerJunction(BaseModel):
    """A junction, a ramp or a change of lanes in a language model's answer."""

    model_config = _part("A junction, a ramp or a change of lanes.")

    after: int = Field(description="Number of segments before it.")
    kind: Literal[PlainKind, "merge", "diverge", LaneKind]
    take: str | Exit | None = Field(
        None, description="left, right, straight, ramp, main, or number of the exit."
    )
    control: str | None = Field(None, description="priority, yield, stop, lights or none.")
    arms: list[AnswerArm] = Field([], description="Of a junction: all roads but that of arrival.")
    kerb: Number | None = Field(None, description="Metres.")
    radius: Number | None = Field(None, description="Of a roundabout's island, metres.")
    ring_lanes: int | None = Field(None, description="Of a roundabout, 1 or 2.")
    crosswalk: bool | None = Field(None, description="true for crosswalks.")
    side: str | None = Field(None, description="left or right, of ramps and lanes.")
    length: Number | None = Field(None, description="Of ramps and lanes, metres.")
    taper: Number | None = Field(None, description="Of ramps, metres.")
    lanes: AnswerLanes | None = Field(None, description="Of the road behind it, if they change.")


class AnswerNetwork(AnswerRoad):
    """The answer of a language model that is asked for a route with junctions."""

    model_config = fixed_description("A route with junctions.")

    segments: Sequence[AnswerRouteSegment] = Field(description="In driving order.")
    lanes: AnswerLanes | None = Field(None, description="Of the first road; null for one in each direction.")
    junctions: list[AnswerJunction] = Field([], description="In driving order.")

    @model_validator(mode="before")
    @classmethod
    def _junctions_from_numbered_fields(cls, data: Any) -> Any:
        """Converts RoadGPT's numbered fields junction1, junction2, ... to the list ``junctions``."""
        return with_list(data, "junctions", KEY)


def network_design_of(
    answer: AnswerNetwork, world: World, left_hand: bool
) -> tuple[NetworkDesign, tuple[str, ...]]:
    """Returns the NetworkDesign of an answer, and one sentence for each correction that was made to it.

    The World gives the width of lanes that have none. The model does not choose whether traffic drives on the
    left.

    Raises:
        UsageError: the answer is not a design; the message can be shown to the model.
    """
    data = in_file_format(answer, answer.segments) | {"left_hand": left_hand}
    if answer.lanes is not None:
        data["lanes"] = _lanes(answer.lanes, world)
    for number, junction in enumerate(answer.junctions, 1):
        row = {name: each for name, each in junction.model_dump(exclude_none=True).items() if each != []}
        if isinstance(row.get("take"), str) and row["take"].strip().isdecimal():
            row["take"] = int(row["take"])
        if junction.lanes is not None:
            row["lanes"] = _lanes(junction.lanes, world)
        data[f"junction{number}"] = row
    try:
        return read_network_design(data)
    except UsageError as error:  # it may name a field that the model made up
        raise UsageError(plain(str(error), MOST_SAID)) from error


def _lanes(lanes: AnswerLanes, world: World) -> dict[str, Any]:
    return {"width": world.section.lane_width, **lanes.model_dump(exclude_none=True)}


def route_outcome(chat: Chat, task: DesignTask) -> Outcome:
    """Asks for whole routes until one is free of errors or all rounds are used up; returns the best one.

    The rules of the task are those for roads; those for junctions are added.

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
    """Returns the route of an answer, moved onto the map if ``repair`` allows, and what is wrong with it.

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
