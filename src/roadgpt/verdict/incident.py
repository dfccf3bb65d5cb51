from dataclasses import dataclass
from typing import Literal

IncidentKind = Literal["out of lane", "wrong turn", "wrong way", "off road", "stop line"]


@dataclass(frozen=True)
class Incident:
    """One thing that the car did wrong, with the place and the time at which it began."""

    kind: IncidentKind
    at_s: float
    """Station of the car's centre of gravity in metres."""
    at_xy: tuple[float, float]
    """Position (x, y) of the car's centre of gravity in metres."""
    at_time: float
    """Time in seconds since the start of the drive."""
