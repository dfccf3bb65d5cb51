"""Draws designs of networks for tests: JSON data with one to four junctions of all kinds.

Junctions and arms are drawn without looking at the map, so roads may overlap.
"""

from typing import Any

import numpy as np

KINDS = ("t_junction", "y_junction", "crossroads", "star", "roundabout")
CONTROLS = ("none", "priority", "yield", "stop", "lights")


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


def _junction(rng: np.random.Generator) -> dict[str, Any]:
    kind = str(rng.choice(KINDS))
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
