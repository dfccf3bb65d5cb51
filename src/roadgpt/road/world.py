"""What every road of a campaign shares: the map, the limits of the rules, lanes, verge, friction."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]

LINE = 0.12  # m, width of a painted line: narrow mark of rural roads (Germany, RMS-1)


class World(BaseModel):
    """All in metres, seconds and ratios; the defaults are RoadGPT's, whose map is 250 m wide."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    map_size: Annotated[float, Field(ge=50, le=10_000)] = 250.0
    """Side of the square map, whose corner is (0, 0)."""
    lane_width: Positive = 4.0
    verge: NotNegative = 3.0
    """Firm ground at road level beside the carriageway; 0 lets the road float, as RoadGPT's mesh roads do."""
    friction: Annotated[float, Field(gt=0, le=2)] = 1.0
    """Of dry asphalt: 1.0; wet: about 0.6; snow: about 0.35."""
    speed_limit: Positive = 70 / 3.6
    """m/s; the competition's 70 km/h."""
    oob_tolerance: Annotated[float, Field(gt=0, le=1)] = 0.95
    """Share of the car that may be outside its lane."""
    lane_departure: bool = False
    """Has the car failed, too, where the outer edge of a front tyre passes the outer edge of a marking of its
    lane (UN Regulation No. 157, 5.2.1)?"""
    min_radius: Positive = 14.326
    """47 ft: the tightest turn of the SBFT rules."""
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15
    """Steepest slope, up or down."""
    z_floor: float = -28.0
    """Height of the level's ground."""
    min_length: NotNegative = 20.0

    @property
    def road_width(self) -> float:
        """Of the carriageway: one lane each way."""
        return 2 * self.lane_width

    @property
    def marking_edges(self) -> tuple[float, float]:
        """Outer edges of the markings left and right of the driven lane, metres to the left of the middle.

        The centre line is painted over the middle of the road; the edge line lies within the lane and ends
        where the lane does.
        """
        return LINE / 2, -self.lane_width
