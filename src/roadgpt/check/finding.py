"""What a rule has to say about one place on a road."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One rule's sentence. A place is given where there is one: station ``s`` and the point, in metres."""

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Nobody can drive in spite of it: there is no road, or no room for a car."""
