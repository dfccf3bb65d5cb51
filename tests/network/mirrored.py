"""Mirrors designs of networks as JSON data, without the project's own mirror: a second opinion."""

import copy
from typing import Any

OTHER = {"left": "right", "right": "left"}


def in_mirror(data: dict[str, Any]) -> dict[str, Any]:
    """A design with left and right exchanged, for the same side of traffic; numbers of exits stay."""
    made = copy.deepcopy(data)
    made["starting_point"][1] *= -1
    made["theta"] *= -1
    _turn_segments(made)
    for key, part in made.items():
        if key.startswith("junction"):
            for field in ("take", "side"):
                if field in part:
                    part[field] = OTHER.get(part[field], part[field])
            if "turn_lanes" in part:
                part["turn_lanes"] = [OTHER[side] for side in part["turn_lanes"]]
            if part["kind"].startswith("lane_") and "side" not in part:
                part["side"] = "left"  # without one, it is the right
            for arm in part.get("arms", ()):
                arm["angle"] *= -1
                _turn_segments(arm)
    return made


def _turn_segments(parts: dict[str, Any]) -> None:
    for key, part in parts.items():
        if key.startswith("road_segment"):
            part["direction"] = OTHER.get(part["direction"], part["direction"])
            part["turn_degrees"] *= -1
