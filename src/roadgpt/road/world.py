"""Defines the World: the map, lanes, shoulders, friction and limits that all roads of a campaign share."""

from typing import Annotated

from pydantic import AliasChoices, BaseModel, ConfigDict, Field

from roadgpt.road.profile import Profile

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]

LINE = 0.12  # m, width of a painted line: narrow mark of rural roads (Germany, RMS-1)


class World(BaseModel):
    """Map, lanes, shoulders, friction and limits. Most defaults are those of the RoadGPT thesis."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    map_size: Annotated[float, Field(ge=50, le=10_000)] = 250.0
    """Side length of the square map in metres. One corner of the map is at (0, 0)."""
    lane_width: Positive = 4.0
    verge: NotNegative = Field(3.0, validation_alias=AliasChoices("verge", "shoulder"))
    """Width in metres of the firm shoulder beside the carriageway.

    With 0 the road floats above the ground, as in the RoadGPT thesis.
    """
    friction: Annotated[float, Field(gt=0, le=2)] = 1.0
    """Friction coefficient: 1.0 for dry asphalt, about 0.6 wet, about 0.35 on snow."""
    speed_limit: Positive = 70 / 3.6
    """Speed limit in m/s. The default is the competition's 70 km/h."""
    oob_tolerance: Annotated[float, Field(gt=0, le=1)] = 0.95
    """Share of the car's area, 0 to 1, that may be outside its lane before the test fails."""
    lane_departure: bool = False
    """Whether the test also fails as soon as a front tyre crosses the outer edge of a lane marking.

    Source: UN Regulation No. 157, 5.2.1.
    """
    min_radius: Positive = 14.326
    """Least radius of a turn in metres. The default is 47 ft, the tightest turn of the SBFT rules."""
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15
    """Steepest grade that rules allow, uphill or downhill, as a ratio."""
    z_floor: float = -28.0
    """Height in metres of the level's ground."""
    min_length: NotNegative = 20.0

    @property
    def profile(self) -> Profile:
        """The cross-section that all roads of this World have."""
        return Profile(self.lane_width, self.verge)

    @property
    def road_width(self) -> float:
        """The largest width of the carriageway in metres."""
        return 2 * self.profile.paved_reach

    @property
    def marking_edges(self) -> tuple[float, float]:
        """The offsets of the outer edges of the markings on the left and on the right of the driven lane.

        They are in metres to the left of the middle of the road. The centre line marking is painted over the
        middle of the road. The edge line is painted inside the lane, up to its outer edge.
        """
        return LINE / 2, -self.profile.paved_reach
