"""Random segment lists as a language model writes them: whole numbers, and no idea of where they lead.

Numbers are multiples of five where a model would say them so. RoadGPT's own checks accept about three in ten.
"""

from typing import Any

import numpy as np

SIDES = {"left": 1, "right": -1, "straight": 0}


def random_list(rng: np.random.Generator) -> dict[str, Any]:
    """A dictionary in RoadGPT's format; every direction agrees with the sign of its turn."""
    start = [int(v) for v in rng.integers(20, 181, 2)]
    out: dict[str, Any] = {
        "starting_point": [*start, int(rng.choice([0, 0, -10, 5, 10]))],
        "theta": int(rng.integers(0, 72) * 5),
    }
    for number in range(1, int(rng.integers(3, 8)) + 1):
        side = str(rng.choice(["left", "right", "straight"], p=(0.37, 0.37, 0.26)))
        turn = SIDES[side] * int(rng.integers(4, 15)) * 5
        incline = int(rng.choice([0, 0, *range(-10, 11), 12, 15]))
        out[f"road_segment{number}"] = {
            "distance": int(rng.integers(3, 11)) * 5,
            "direction": side,
            "incline": incline,
            "turn_degrees": turn,
        }
    return out


def random_lists(count: int, seed: int) -> list[dict[str, Any]]:
    """So many of them; the same seed, the same lists."""
    rng = np.random.default_rng(seed)
    return [random_list(rng) for _ in range(count)]
