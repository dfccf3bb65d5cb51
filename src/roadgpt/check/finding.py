"""Defines the Finding: one violation of a rule by a road."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One violation of a rule: the name of the rule and a sentence that describes the violation.

    ``s`` is the station in metres and (x, y) the point of the violation in metres. They are None for a
    violation that concerns the whole road.
    """

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Whether the road cannot be driven at all, for example because it is too short for a car."""
