"""Defines the Finding: one violation of a rule by a road."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One violation of a rule: the name of the rule and a sentence that describes the violation.

    ``s`` is the station and (x, y) the point of the violation, in metres. All three are None for a violation
    that concerns the whole road. If only the point is known, only ``s`` is None.
    """

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Whether the road cannot be driven at all, for example because it is too short for a car."""
