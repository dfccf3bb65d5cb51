"""Exports roads as tests of the SBFT tool competition, with an additional list of points that have
heights."""

import json
from pathlib import Path

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.road import Road, World
from roadgpt.road.edges import finite
from roadgpt.road.road import CONTROL_SPACING

DECIMALS = 5
STEP = 1.0  # m


class Sbft:
    """The SBFT competition's test as JSON: control points for its spline, and points with heights."""

    name = "sbft"
    suffix = ".sbft.json"
    draws_edges = False
    lacks = ("the land around",)

    def doubts(self, road: Road, world: World) -> tuple[str, ...]:
        """Says so if the control points are too few for the road."""
        apart = road.length / (len(road.control_points()) - 1)
        said = f"its control points are {apart:.1f} m apart, so bends may become tighter"
        return (said,) if road.nodes is None and apart > CONTROL_SPACING else ()

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the test without a result. Campaigns write results to their ``test.NNNN.json`` files."""
        points = {"road_points": road.control_points(), "interpolated_points": road.axis(road.sample(STEP).s)}
        data = {name: (np.round(finite(each), DECIMALS) + 0.0).tolist() for name, each in points.items()}
        path.write_bytes((json.dumps(data) + "\n").encode())
