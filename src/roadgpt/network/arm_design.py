"""Defines the ArmDesign: a road at a junction, other than the road on which the route arrives.

In RoadGPT's JSON format, an arm has an angle and, if it is not straight and level, segments of its own:

    {"angle": 90, "road_segment1": {"distance": 40, "direction": "left", "incline": 3, "turn_degrees": 30}}
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from roadgpt.brief.junctions import Control
from roadgpt.errors import UsageError
from roadgpt.road import Segment, read_design
from roadgpt.road.design import KEY, MAX_SEGMENTS, FrozenFields, Length

STUB = 25.0  # m, length of an arm whose length is not given


class ArmDesign(FrozenFields):
    """A road at a junction, other than the road on which the route arrives."""

    angle: Annotated[float, Field(gt=-180, lt=180)]
    """Direction out of the junction in degrees, from the direction of arrival, positive to the left."""
    length: Length | None = None
    """Length in metres of a straight, level arm; None for ``STUB``; not for the arm that the route takes."""
    control: Control | None = None
    """The sign or the light on this arm; None for the one that follows from the junction's ``control``."""
    one_way: Literal["in", "out"] | None = None
    """One-way traffic: "in" to the junction or "out" of it; None for both ways; not for the arm taken."""
    segments: Annotated[tuple[Segment, ...], Field(max_length=MAX_SEGMENTS)] = ()
    """The segments of the arm out of the junction, also if its traffic drives in; empty for a straight, level
    arm; not with ``length`` and not for the arm that the route takes.
    """

    @model_validator(mode="after")
    def _check_length(self) -> "ArmDesign":
        if self.segments and self.length is not None:
            raise PydanticCustomError("two_lengths", "has length and road segments; leave one of them out")
        return self

    @property
    def stretch(self) -> tuple[Segment, ...]:
        """The segments of the road of the arm, out of the junction: those given, or a straight, level one."""
        return self.segments or (Segment(distance=self.length or STUB, direction="straight"),)

    def mirrored(self) -> "ArmDesign":
        """Returns the arm with left and right exchanged."""
        segments = tuple(segment.mirrored() for segment in self.segments)
        return self.model_copy(update={"angle": 0.0 - self.angle, "segments": segments})


def read_segments(what: str, raw: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Reads the segments of an arm, as those of a road. Returns the fields of an ArmDesign, and remarks.
    Fields other than the segments are returned unchanged. ``what`` names the arm in remarks and errors.
    Raises UsageError if a segment cannot be read, or if ``raw`` has the field ``segments``.
    """
    own = {key: each for key, each in raw.items() if KEY.fullmatch(str(key))}
    fields = {key: each for key, each in raw.items() if key not in own}
    if "segments" in fields:
        raise UsageError(f"{what} has a field 'segments' that is unknown; give road_segment1, ... instead")
    if not own:
        return fields, ()
    try:
        design, remarks = read_design({"starting_point": (0.0, 0.0, 0.0), "theta": 0.0, **own})
    except UsageError as error:
        raise UsageError(f"{what}: {error}") from error
    return {**fields, "segments": design.segments}, tuple(f"{what}: {each}" for each in remarks)
