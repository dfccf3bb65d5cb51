"""Defines the data that a language model answers with, and turns it into a Design.

Models answer in RoadGPT's segment format, with a list of segments or with numbered fields (road_segment1,
road_segment2, ...). Answers are only validated as data and never executed.
"""

import re
from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field, model_validator

from roadgpt.chat.json_schema import fixed_description
from roadgpt.errors import UsageError
from roadgpt.road import Design, Segment, read_design
from roadgpt.road.design import KEY, MAX_SEGMENTS

FARTHEST = 100_000.0  # m, of a coordinate of a start; no map is larger
LETTERS = re.compile(r"[^a-z]")


def _plain_direction(value: Any) -> Any:
    """Reduces a short text to its letters in lower case ('Left.' to 'left'); the schema checks the word."""
    return LETTERS.sub("", value.lower()) if isinstance(value, str) and len(value) < 20 else value


Number = Annotated[float, Field(allow_inf_nan=False)]
Way = Annotated[Literal["left", "right", "straight"], BeforeValidator(_plain_direction)]


def with_list(data: Any, name: str, key: re.Pattern[str]) -> Any:
    """Returns the fields of an answer, with a list ``name`` in place of numbered fields like ``key``."""
    if not isinstance(data, dict) or name in data:
        return data
    numbered = sorted((int(match[1]), field) for field in data if (match := key.fullmatch(str(field))))
    return {**data, name: [data[field] for _, field in numbered]} if numbered else data


class AnswerSegment(BaseModel):
    """One segment of a language model's answer."""

    model_config = fixed_description("One segment of an answer.")

    distance: Number = Field(description="Length along the road, metres.")
    direction: Way = Field(description="left, right or straight.")
    incline: Number = Field(description="Slope in percent, uphill positive.")
    turn_degrees: Number = Field(description="Left positive, right negative, 0 of a straight.")


class AnswerStart(BaseModel):
    """The starting point and the heading of a road."""

    model_config = fixed_description("Where a road starts, and which way it looks.")

    starting_point: list[Number] = Field(description="x, y and z of the start, metres.")
    theta: Number = Field(description="Degrees: 0 along +x, 90 along +y.")


class AnswerRoad(AnswerStart):
    """The answer of a language model that is asked for a whole road."""

    model_config = fixed_description("A whole road.")

    segments: Sequence[AnswerSegment] = Field(description="In driving order.")

    @model_validator(mode="before")
    @classmethod
    def _from_numbered_fields(cls, data: Any) -> Any:
        """Converts RoadGPT's numbered fields road_segment1, road_segment2, ... to the list ``segments``."""
        return with_list(data, "segments", KEY)


class AnswerStep(AnswerSegment):
    """The answer of a language model that is asked for the next segment, and whether it is the last one."""

    model_config = fixed_description("The next segment, and whether it is the last one.")

    last: bool = Field(description="Is the road finished with this segment?")


def design_of(start: AnswerStart, segments: Sequence[AnswerSegment]) -> tuple[Design, tuple[str, ...]]:
    """Returns the Design of an answer, and one sentence for each correction that was made to it.

    Raises:
        UsageError: the answer is not a design; the message can be shown to the model.
    """
    return read_design(in_file_format(start, segments))


def in_file_format(start: AnswerStart, segments: Sequence[AnswerSegment]) -> dict[str, Any]:
    """Returns the start and the segments of an answer as they stand in a design file.

    Raises:
        UsageError: there are too many segments, or the start is not a place on any map.
    """
    if len(segments) > MAX_SEGMENTS:
        raise UsageError(f"the road has {len(segments):,} segments; {MAX_SEGMENTS} is the limit")
    point = [*start.starting_point, 0.0] if len(start.starting_point) == 2 else start.starting_point
    if len(point) != 3 or max(abs(v) for v in point) > FARTHEST:
        raise UsageError("starting_point is not a place on the map; give x, y and z in metres")
    numbered = {
        f"road_segment{number}": segment.model_dump(include=set(Segment.model_fields))
        for number, segment in enumerate(segments, 1)
    }
    return {"starting_point": point, "theta": start.theta % 360, **numbered}
