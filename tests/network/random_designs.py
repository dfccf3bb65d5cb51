"""Draws designs of networks for tests: JSON data with one to four junctions of all kinds, with or without
several lanes, merges and exits.

Junctions and arms are drawn without looking at the map, so roads may overlap.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

KINDS = ("t_junction", "y_junction", "crossroads", "star", "roundabout")
CROSSINGS = KINDS[:-1]
CONTROLS = ("none", "priority", "yield", "stop", "lights")
CENTRES = ("solid", "broken", "double", "none")


def random_design(seed: int) -> dict[str, Any]:
    """Returns a design with junctions in RoadGPT's JSON format; the same seed gives the same design."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 5))
    data: dict[str, Any] = {
        "starting_point": [float(rng.uniform(0, 250)), float(rng.uniform(0, 250)), float(rng.uniform(-5, 5))],
        "theta": float(rng.uniform(-180, 180)),
    }
    if rng.random() < 0.5:
        data["lanes"] = {"width": float(rng.uniform(2.75, 4.5))}
    segments = 0
    for number in range(1, count + 2):
        for _ in range(int(rng.integers(1, 4))):
            segments += 1
            data[f"road_segment{segments}"] = _segment(rng)
        if number <= count:
            data[f"junction{number}"] = {"after": segments, **_junction(rng)}
    return data


def _segment(rng: np.random.Generator) -> dict[str, Any]:
    side = str(rng.choice(["left", "right", "straight", "straight"]))
    turn = 0.0 if side == "straight" else float(rng.uniform(15, 70)) * (1 if side == "left" else -1)
    return {
        "distance": float(rng.uniform(25, 80)),
        "direction": side,
        "incline": float(rng.uniform(-8, 8)) if rng.random() < 0.5 else 0.0,
        "turn_degrees": turn,
    }


def _junction(rng: np.random.Generator, kinds: Sequence[str] = KINDS) -> dict[str, Any]:
    kind = str(rng.choice(kinds))
    angles = _angles(rng, kind)
    return {
        "kind": kind,
        "take": int(rng.integers(1, len(angles) + 1)),
        "control": str(rng.choice(CONTROLS)),
        "kerb": float(rng.uniform(4, 12)),
        "radius": float(rng.uniform(14, 30)),
        "arms": [{"angle": float(angle)} for angle in angles],
    }


def _angles(rng: np.random.Generator, kind: str) -> list[float]:
    usual = {
        "t_junction": [[-90, 90], [0, 90], [-90, 0]][int(rng.integers(3))],
        "y_junction": [-60, 60],
        "crossroads": [-90, 0, 90],
        "star": [-108, -36, 36, 108],
        "roundabout": [[-90, 0, 90], [-60, 60], [-108, -36, 36, 108]][int(rng.integers(3))],
    }[kind]
    return [angle + float(rng.uniform(-12, 12)) for angle in usual]


def random_lanes_design(seed: int) -> dict[str, Any]:
    """Returns a design with several lanes, one-way roads, ramps, and lanes that end, begin or are changed."""
    rng = np.random.default_rng(10_000 + seed)
    count = int(rng.integers(1, 5))
    lanes = _lanes(rng)
    data: dict[str, Any] = {
        "starting_point": [float(rng.uniform(0, 250)), float(rng.uniform(0, 250)), float(rng.uniform(-5, 5))],
        "theta": float(rng.uniform(-180, 180)),
        "lanes": lanes,
    }
    segments, is_rightmost = 0, True
    for number in range(1, count + 2):
        for _ in range(int(rng.integers(1, 4))):
            segments += 1
            data[f"road_segment{segments}"] = _segment(rng)
        if number <= count:
            place, lanes, is_rightmost = _place(rng, lanes, is_rightmost)
            data[f"junction{number}"] = {"after": segments, **place}
    return data


Place = tuple[dict[str, Any], dict[str, Any], bool]
"""What the route passes, the lanes behind it, and whether the route is known to be in the rightmost one."""


def _lanes(rng: np.random.Generator) -> dict[str, Any]:
    found: dict[str, Any] = {"forward": int(rng.integers(1, 4)), "backward": int(rng.integers(0, 3))}
    if rng.random() < 0.2:
        found |= {"forward": 1, "backward": 0}
    found["width"] = float(rng.uniform(2.75, 4.5))
    if rng.random() < 0.5:
        found["centre"] = str(rng.choice(CENTRES))
    return found


def _place(rng: np.random.Generator, lanes: dict[str, Any], is_rightmost: bool) -> Place:
    forward, backward = lanes["forward"], lanes["backward"]
    allowed = {
        "crossing": True,
        "roundabout": max(forward, backward) < 3,
        "main": True,
        "from ramp": (forward, backward) == (1, 0),
        "to ramp": True,
        "lane_drop": forward > 1,
        "lane_gain": forward < 4,
        "lane_change": forward > 1 and is_rightmost,
    }
    what = str(rng.choice([each for each, is_allowed in allowed.items() if is_allowed]))
    if what in ("crossing", "roundabout"):
        found = _junction(rng, (what,) if what == "roundabout" else CROSSINGS)
        behind = _lanes(rng) if rng.random() < 0.6 and what == "crossing" else None
        if what == "roundabout":
            found["ring_lanes"] = int(rng.integers(max(forward, backward), 3))
        return {**found, **({"lanes": behind} if behind else {})}, behind or lanes, False
    length = {"length": float(rng.uniform(10, 150))} if rng.random() < 0.7 else {}
    if what == "main":
        kind = str(rng.choice(["merge", "diverge"]))
        return {"kind": kind, "take": "main", **length, **_side(lanes)}, lanes, is_rightmost
    if what == "from ramp":
        behind = _lanes(rng)
        side = _side(behind)
        return {"kind": "merge", "take": "ramp", "lanes": behind, **length, **side}, behind, False
    if what == "to ramp":
        behind = {**lanes, "forward": 1, "backward": 0}
        return {"kind": "diverge", "take": "ramp", **length, **_side(lanes)}, behind, True
    if what == "lane_change":
        return {"kind": what, "side": "left"}, lanes, False
    side = str(rng.choice(["left", "right"]))
    behind = {**lanes, "forward": forward + (1 if what == "lane_gain" else -1)}
    return {"kind": what, "side": side, **length}, behind, False


def _side(lanes: dict[str, Any]) -> dict[str, str]:
    """The side of a ramp of a road with these lanes: of half of the one-way roads the left."""
    is_left = not lanes["backward"] and round(1e6 * lanes["width"]) % 2
    return {"side": "left"} if is_left else {}


def random_turn_lanes_design(seed: int) -> dict[str, Any]:
    """Returns a design with two or three T-junctions or crossroads, some of which have turn lanes."""
    rng = np.random.default_rng(20_000 + seed)
    data: dict[str, Any] = {
        "starting_point": [float(rng.uniform(0, 250)), float(rng.uniform(0, 250)), float(rng.uniform(-5, 5))],
        "theta": float(rng.uniform(-180, 180)),
        "lanes": {**_lanes(rng), "backward": int(rng.integers(0, 4))},
    }
    count = int(rng.integers(2, 4))
    for number in range(1, count + 2):
        data[f"road_segment{2 * number - 1}"] = _segment(rng)
        data[f"road_segment{2 * number}"] = {**_segment(rng), "distance": float(rng.uniform(75, 110))}
        if number <= count:
            angles = [[-90.0, 0.0, 90.0], [0.0, 90.0], [-90.0, 0.0]][int(rng.integers(3))]
            sides = [["left"], ["right"], ["left", "right"]][int(rng.integers(3))]
            data[f"junction{number}"] = {
                "after": 2 * number,
                "kind": "crossroads" if len(angles) == 3 else "t_junction",
                "take": int(rng.integers(1, len(angles) + 1)),
                "control": str(rng.choice(CONTROLS)),
                "kerb": float(rng.uniform(6, 12)),
                "arms": [{"angle": angle + float(rng.uniform(-12, 12))} for angle in angles],
                "turn_lanes": [side for side in sides if {"left": 90.0, "right": -90.0}[side] in angles],
                "turn_length": float(rng.uniform(15, 35)),
            }
    return data
