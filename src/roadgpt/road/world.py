"""Defines the World: the map, lanes, shoulders, friction and limits that all roads of a campaign share."""

import re
from dataclasses import replace
from typing import Annotated, Any

from pydantic import AfterValidator, AliasChoices, BaseModel, ConfigDict, Field, model_serializer

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.profile import Profile
from roadgpt.road.road import Road
from roadgpt.road.superelevation import superelevation

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
STEEPEST = 0.12  # ratio, largest superelevation of bends
OWN = {"lanes": "1+1", "lane_width_end": None, "bank": "none"}
"""Fields that only roads with a cross-section of their own need; files leave out these defaults."""


def lanes_in(text: str) -> str:
    """Returns the numbers of lanes along the road and against it without blanks, such as "2+1".

    Raises:
        ValueError: The text has another form; the message says which one is needed.
    """
    plain = text.replace(" ", "")
    if not re.fullmatch(r"[1-4]\+[0-4]", plain):
        raise ValueError("give 1 to 4 lanes along the road, a plus and 0 to 4 against it, such as 2+1")
    return plain


def bank_in(value: str | float, most: float = STEEPEST, unit: str = "a ratio") -> str | float:
    """Returns the superelevation of bends, which is "none", "auto" or a number from 0 to ``most``.

    Raises:
        ValueError: The value is something else; the message says what to give, in this unit.
    """
    if value in ("none", "auto") or (isinstance(value, float) and 0 <= value <= most):
        return value
    raise ValueError(f"give 'none', 'auto' or {unit} from 0 to {most:g}")


Lanes = Annotated[str, AfterValidator(lanes_in)]


class World(BaseModel):
    """Map, lanes, shoulders, friction and limits. Most defaults are those of the RoadGPT thesis."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    map_size: Annotated[float, Field(ge=50, le=10_000)] = 250.0
    """Side length of the square map in metres. One corner of the map is at (0, 0)."""
    lanes: Lanes = "1+1"
    """Number of lanes along the road, and number of oncoming lanes.

    The tested car keeps to the rightmost lane.
    """
    lane_width: Positive = 4.0
    """Width of every lane in metres."""
    lane_width_end: Positive | None = None
    """Width of every lane in metres at the end of the road, reached smoothly from ``lane_width`` at the
    start; None for a constant width.
    """
    bank: Annotated[str | float, AfterValidator(bank_in)] = "none"
    """Superelevation of bends: "none", "auto" for the values of CD 109, or one ratio for all bends."""
    verge: NotNegative = Field(3.0, validation_alias=AliasChoices("verge", "shoulder"))
    """Width in metres of the firm shoulder beside the carriageway.

    With 0 the road floats above the ground, as in the RoadGPT thesis.
    """
    friction: Annotated[float, Field(gt=0, le=2)] = 1.0
    """Friction coefficient: 1.0 for dry asphalt, about 0.6 wet, about 0.35 on snow."""
    speed_limit: Positive = 70 / 3.6
    """Speed limit in m/s. The default is the competition's 70 km/h."""
    oob_tolerance: Annotated[float, Field(gt=0, le=1)] = 0.95
    """Fraction of the car's area, 0 to 1, that may be outside its lane before the test fails."""
    lane_departure: bool = False
    """Whether the test also fails as soon as a front tyre crosses the outer edge of a lane marking.

    Source: UN Regulation No. 157, 5.2.1.
    """
    min_radius: Positive = 14.326
    """Minimum radius of a turn in metres. The default is 47 ft, the tightest turn of the SBFT rules."""
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15
    """Steepest grade, uphill or downhill, that the validity rules allow, as a ratio."""
    z_floor: float = -28.0
    """Height in metres of the flat ground of the simulator's map."""
    min_length: NotNegative = 20.0

    @model_serializer(mode="wrap")
    def _without_usual(self, dump: Any) -> dict[str, Any]:
        data: dict[str, Any] = dump(self)
        return {name: value for name, value in data.items() if name not in OWN or value != OWN[name]}

    def profile_of(self, road: Road) -> Profile:
        """Returns the cross-section of a road: ``road.profile``, or this World's cross-section if that is
        None.

        Raises:
            UsageError: This World has banked bends, but the road has no superelevation because it was not
                passed through ``lay``.
        """
        if road.profile is not None:
            return road.profile
        if self.bank != "none":
            raise UsageError("the road has no superelevation yet; use the road that world.lay(road) returns")
        return self.usual_profile(road.length)

    def lay(self, road: Road) -> Road:
        """Returns the road with this World's lanes and banked bends.

        A road that has a cross-section of its own keeps it. If this World has the usual two lanes of one
        width and no banked bends, the road is returned unchanged.
        """
        if road.profile is not None or all(getattr(self, name) == usual for name, usual in OWN.items()):
            return road
        profile = self.usual_profile(road.length)
        if self.bank != "none":
            angle = superelevation(road.plan, profile.paved_reach, self.speed_limit, self.bank_ratio)
            profile = replace(profile, superelevation_angle=angle)
        return road.with_profile(profile)

    def usual_profile(self, length: float) -> Profile:
        """Returns the cross-section of a road of this length in metres, without superelevation.

        It applies to every road whose own ``profile`` is None.
        """
        forward, backward = map(int, self.lanes.split("+"))
        return Profile.of(forward, backward, self._width(length), self.verge)

    def _width(self, length: float) -> float | CubicProfile:
        """Returns the width of the lanes, which changes from start to end without a kink."""
        first, last = self.lane_width, self.lane_width_end
        if last is None or last == first:
            return first
        return CubicProfile.smooth([(0.0, first), (length, last)])

    @property
    def bank_ratio(self) -> float | None:
        """The superelevation of all bends as a ratio; None if ``bank`` gives no number."""
        return self.bank if isinstance(self.bank, float) else None

    @property
    def road_width(self) -> float:
        """Twice the largest distance in metres between the centre line and an edge of the carriageway."""
        count = max(int(each) for each in self.lanes.split("+"))
        return 2 * count * max(self.lane_width, self.lane_width_end or 0.0)
