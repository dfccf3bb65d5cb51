"""Collects the geometry and the lanes of one road for a page, as plain values."""

from typing import Any

import numpy as np

from roadgpt.errors import ExportError, UsageError
from roadgpt.export.edges import stations
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road

CHORD = 0.01  # m, largest distance between the road and the drawn lines
MILLIMETRES, FINE = 3, 5  # digits


def road_columns(
    road: Road, profile: Profile, reach: float | None = None, median: tuple[float, float] | None = None
) -> dict[str, Any]:
    """Returns a road's cross-section, and its geometry at stations close enough to draw the road. Values are
    in metres and radians, the curvature is in 1/m, and the grade is a ratio.

    ``reach`` is the largest offset of any line that is drawn along the road; None: the profile's ``reach``.
    ``median`` is the first and the last station of grass on the profile's median; None: the whole road.

    Raises:
        UsageError: A number of the road is not finite.
    """
    try:
        s = stations(road, profile.reach if reach is None else reach, CHORD)
    except ExportError as error:
        raise UsageError("the road has a number that is not finite; check it before it is shown") from error
    points = road.at(s)
    return {
        "length": road.length,
        "s": rounded(s, MILLIMETRES),
        "x": rounded(points[:, 0], MILLIMETRES),
        "y": rounded(points[:, 1], MILLIMETRES),
        "z": rounded(points[:, 2], MILLIMETRES),
        "heading": rounded(np.unwrap(road.heading(s)), FINE),
        "curvature": rounded(road.curvature(s), FINE),
        "grade": rounded(road.grade(s), FINE),
        "lanes": {**_lanes(profile, s), "median": _median(profile, median or (0.0, road.length))},
    }


def _median(profile: Profile, span: tuple[float, float]) -> dict[str, float] | None:
    """Returns which of the strips between two boundaries, from the left, is the median, and where it is
    green.
    """
    if not profile.median:
        return None
    at = profile.count[0] if profile.left_hand else profile.count[1]
    return {"strip": at, "from": round(span[0], MILLIMETRES), "to": round(span[1], MILLIMETRES)}


def _lanes(profile: Profile, s: Array) -> dict[str, Any]:
    """Returns the cross-section at the stations ``s``; offsets that are constant are given as one number."""
    rims, edges = profile.rims(s), profile.edges(s)
    shoulder = min((rims.left - edges.left).min(), (edges.right - rims.right).min())
    return {
        "bounds": [{"marking": mark, "t": _offsets(t)} for mark, t in profile.boundaries(s)],
        "driven": profile.boundaries_to_left,
        "middle": _offsets(profile.middle(s)),
        "rims": {"left": _offsets(rims.left), "right": _offsets(rims.right)},
        "shoulder": round(float(shoulder), MILLIMETRES),
        "reach": round(profile.reach, MILLIMETRES),
        "bank": None if profile.superelevation_angle is None else rounded(profile.superelevation(s), FINE),
    }


def _offsets(t: Array) -> float | list[float]:
    found = rounded(t, MILLIMETRES)
    return found[0] if len(set(found)) == 1 else found


def rounded(values: Array, digits: int) -> list[float]:
    """Returns the values as a list of numbers rounded to ``digits`` decimals."""
    return [round(float(value), digits) for value in values]
