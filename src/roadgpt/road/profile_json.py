"""Reads and writes cross-sections as the field ``profile`` of a road file.

A width is a number, or rows ``[s, a, b, c, d]``. At a distance ``u`` in metres after station ``s``, the width
is ``a + b u + c u^2 + d u^3`` metres. The superelevation is always written as rows, with values in radians.
"""

from collections.abc import Mapping, Sequence
from typing import Any, get_args

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.profile import Kind, Lane, Marking, Profile, Width

KNOWN = {"left", "right", "driven", "centre_marking", "superelevation", "offset", "median", "left_hand"}
ONLY_NETWORKS = "traffic drives on the left on the roads of networks only"
MOST_LANES = 20  # on one side
MOST_ROWS = 20_000
WIDEST = 100.0  # m, of a lane or shoulder
LARGEST = 1e12  # greatest absolute value of a station or a coefficient
STEEPEST = 0.35  # rad, of superelevation


def profile_to_json(profile: Profile) -> dict[str, Any]:
    """Returns the cross-section as JSON data, from which ``profile_from_json`` restores it."""
    out = {
        "left": [_lane_to_json(lane) for lane in profile.left],
        "right": [_lane_to_json(lane) for lane in profile.right],
        "driven": profile.driven,
        "centre_marking": profile.centre_marking,
    }
    if profile.median:
        out["median"] = profile.median
    if profile.offset != 0:
        out["offset"] = _written(profile.offset)
    if profile.left_hand:
        out["left_hand"] = True
    angle = profile.superelevation_angle
    return out if angle is None else {**out, "superelevation": _rows(angle)}


def profile_from_json(data: Any) -> Profile:
    """Restores a cross-section from JSON data as returned by ``profile_to_json``.

    Raises:
        UsageError: A field is missing, unknown, of the wrong type or out of range.
    """
    try:
        _only(data, KNOWN)
        angle = data.get("superelevation")
        driven = data["driven"]
        if not isinstance(driven, int) or isinstance(driven, bool):
            raise ValueError("driven is the index of a lane along the road")
        if not isinstance(left_hand := data.get("left_hand", False), bool):
            raise ValueError("left_hand is true or false")
        return Profile(
            _lanes(data["left"]),
            _lanes(data["right"]),
            driven,
            _one_of(data["centre_marking"], Marking),
            None if angle is None else _cubics(angle, STEEPEST),
            _width(data.get("offset", 0.0), -WIDEST),
            _median(data.get("median", 0.0)),
            left_hand,
        )
    except KeyError as error:
        raise UsageError(f"the profile of the road cannot be read: {error} is missing; add it") from error
    except (TypeError, ValueError, OverflowError) as error:
        raise UsageError(f"the profile of the road cannot be read: {error}; correct the file") from error


def _lane_to_json(lane: Lane) -> dict[str, Any]:
    return {"kind": lane.kind, "width": _written(lane.width), "marking": lane.marking}


def _written(width: Width) -> float | list[list[float]]:
    return _rows(width) if isinstance(width, CubicProfile) else width


def _rows(cubics: CubicProfile) -> list[list[float]]:
    return [[s, *row] for s, row in cubics.rows]


def _lanes(rows: Any) -> tuple[Lane, ...]:
    if not isinstance(rows, list) or len(rows) > MOST_LANES:
        raise ValueError(f"lanes are a list of up to {MOST_LANES} objects with kind, width and marking")
    for row in rows:
        _only(row, {"kind", "width", "marking"})
    return tuple(
        Lane(_one_of(row["kind"], Kind), _width(row["width"]), _one_of(row["marking"], Marking))
        for row in rows
    )


def _width(data: Any, least: float = 0.0) -> Width:
    if isinstance(data, list):
        return _cubics(data, WIDEST)
    if isinstance(data, bool) or not isinstance(data, (int, float)) or not least <= data <= WIDEST:
        raise ValueError(f"a width is a number from {least:g} to {WIDEST:g}, or rows [s, a, b, c, d]")
    return float(data)


def _median(data: Any) -> float:
    width = _width(data)
    if isinstance(width, CubicProfile):
        raise ValueError(f"a median is a number from 0 to {WIDEST:g}")
    return width


def _cubics(rows: Any, most: float) -> CubicProfile:
    if not isinstance(rows, list) or not 0 < len(rows) <= MOST_ROWS:
        raise ValueError(f"1 to {MOST_ROWS:,} rows [s, a, b, c, d] are needed")
    if any(
        not isinstance(row, list) or len(row) != 5 or any(isinstance(v, bool) for v in row) for row in rows
    ):
        raise ValueError("a row has five numbers [s, a, b, c, d]")
    numbers = [tuple(float(v) for v in row) for row in rows]
    if not all(abs(v) <= LARGEST for row in numbers for v in row):
        raise ValueError(f"a number is not finite, or beyond {LARGEST:g}")
    cubics = CubicProfile(tuple(row[0] for row in numbers), tuple((a, b, c, d) for _, a, b, c, d in numbers))
    if found := cubics.beyond(-most, most):
        raise ValueError(f"a value is {found[1]:g} at s = {found[0]:g} m, beyond {most:g}")
    return cubics


def _only(data: Any, known: set[str]) -> None:
    if not isinstance(data, Mapping):
        raise ValueError("a profile and each of its lanes is a JSON object")
    unknown = sorted(set(map(str, data)) - known)
    if unknown:
        raise ValueError(
            f"the field '{unknown[0][:40]}' is unknown; the fields are {', '.join(sorted(known))}"
        )


def _one_of(value: Any, choices: Any) -> Any:
    names: Sequence[str] = get_args(choices)
    if value not in names:
        raise ValueError(f"'{str(value)[:40]}' is unknown; give {' or '.join(names)}")
    return value
