"""Defines the data that a language model answers with if a route has junctions, and turns it into a
NetworkDesign.

The answer has the fields of a design file; junctions stand in a list or in numbered fields (junction1,
junction2, ...). What does not apply to a junction is null or left out. The answer is read by the reader of
design files, which refuses what it does not know.
"""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from roadgpt.brief.junctions import LaneKind, PlainKind
from roadgpt.chat.json_schema import fixed_description
from roadgpt.chat.strict_json import plain
from roadgpt.design.answer import AnswerRoad, AnswerSegment, Number, in_file_format
from roadgpt.errors import UsageError
from roadgpt.network import NetworkDesign, read_network_design
from roadgpt.network.design import KEY
from roadgpt.road import World

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
        if not isinstance(data, dict) or "junctions" in data:
            return data
        numbered = [(int(match[1]), key) for key in data if (match := KEY.fullmatch(str(key)))]
        return {**data, "junctions": [data[key] for _, key in sorted(numbered)]}


def network_design_of(
    answer: AnswerNetwork, world: World, left_hand: bool
) -> tuple[NetworkDesign, tuple[str, ...]]:
    """Returns the NetworkDesign of an answer, and one sentence for each correction that was made to it.

    Args:
        answer: the answer.
        world: the World, which gives the width of lanes that have none.
        left_hand: whether traffic drives on the left; a requirement that the model does not choose.

    Raises:
        UsageError: the answer is not a design; the message can be shown to the model.
    """
    data = in_file_format(answer, answer.segments) | {"left_hand": left_hand}
    if answer.lanes is not None:
        data["lanes"] = _lanes(answer.lanes, world)
    for number, junction in enumerate(answer.junctions, 1):
        row = {name: each for name, each in _plain(junction).items() if each != []}
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
    return {"width": world.section.lane_width, **_plain(lanes)}


def _plain(part: BaseModel) -> dict[str, Any]:
    return part.model_dump(exclude_none=True)


__all__ = ["AnswerNetwork", "network_design_of"]
