"""Defines the Incident: one thing that a car did wrong on a route through junctions."""

from dataclasses import dataclass
from typing import Literal

IncidentKind = Literal["out of lane", "wrong turn", "wrong way", "off road", "stop line"]


@dataclass(frozen=True)
class Incident:
    """One thing that the car did wrong, where it began."""

    kind: IncidentKind
    at_s: float
    """Station of the car's centre of gravity in metres."""
    at_xy: tuple[float, float]
    """Position of the car's centre of gravity in metres."""
    at_time: float
    """Seconds since the start."""
