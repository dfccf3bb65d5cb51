"""Functions on the coordinates of road nodes."""

from __future__ import annotations

import math
from typing import Sequence, Tuple


def get_node_coords(node: Sequence[float]) -> Tuple[float, float, float]:
    return node[0], node[1], node[2]


def points_distance(p1: Sequence[float], p2: Sequence[float]) -> float:
    return math.sqrt(math.fsum((a - b) ** 2 for a, b in zip(get_node_coords(p1), get_node_coords(p2))))
