"""Defines the Finding: one violation of a rule by a road."""

from dataclasses import dataclass

from roadgpt.road import Road


@dataclass(frozen=True, slots=True)
class Finding:
    """One violation of a rule: the name of the rule and a sentence that describes the violation. ``s`` is the
    station and (x, y) the point of the violation, in metres. All three are None for a violation that concerns
    the whole road. If only the point is known, only ``s`` is None."""

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Whether the road cannot be driven at all, for example because it is too short for a car."""


def findings_at(rule: str, road: Road, place: tuple[float, str] | None) -> tuple[Finding, ...]:
    """Returns the Finding for a station in metres and what is wrong there; no Finding for None."""
    if place is None:
        return ()
    s, what = place
    x, y, _ = (float(v) for v in road.at(s))
    return (Finding(rule, f"at s = {s:.0f} m: {what}", s, x, y),)
