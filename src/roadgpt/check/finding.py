"""What a rule objects to at one place on a road."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One rule's sentence.

    ``s`` is the station and (x, y) the point, in metres, where there is a single place.
    """

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Whether the road cannot be driven at all: there is no road, or no room for a car."""
