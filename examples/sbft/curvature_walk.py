"""A generator for the SBFT tool competition: a random walk in curvature.

cd examples/sbft
roadgpt compete sbft --module-name curvature_walk --class-name CurvatureWalk --test-budget 50
"""

import math
import os
import random

from code_pipeline.tests_generation import RoadTestFactory

STEP = 10.0  # m of one curvature
PARTS = 5  # points per step: 2 m apart, so that the competition's spline keeps the curvature
STEPS = 17
TIGHTEST = 0.066  # 1/m: 15 m, a little wider than the 14.3 m that the competition allows
CHANGE = 0.03  # 1/m, at most, from one step to the next


class CurvatureWalk:
    """Bends follow each other smoothly; about two roads of three are valid."""

    def __init__(self, executor=None, map_size=None):
        self.executor = executor
        self.map_size = map_size
        self.random = random.Random(int(os.environ.get("GENERATOR_SEED", "1")))

    def start(self):
        """Test after test, until the budget is over."""
        while not self.executor.is_over():
            points = road_of(self.curvatures(), self.random.uniform(0, 2 * math.pi), self.map_size)
            self.executor.execute_test(RoadTestFactory.create_road_test(points))

    def curvatures(self):
        """1/m, one for each step."""
        bend, bends = self.random.uniform(-TIGHTEST, TIGHTEST), []
        for _ in range(STEPS):
            bend = min(max(bend + self.random.uniform(-CHANGE, CHANGE), -TIGHTEST), TIGHTEST)
            bends.append(bend)
        return bends


def road_of(curvatures, heading, map_size):
    """The road that has these curvatures, laid into the middle of the map: points in metres, 2 m apart."""
    x = y = 0.0
    points = [(x, y)]
    for bend in curvatures:
        for _ in range(PARTS):
            heading += bend * STEP / PARTS
            x += math.cos(heading) * STEP / PARTS
            y += math.sin(heading) * STEP / PARTS
            points.append((x, y))
    east = map_size / 2 - (min(p[0] for p in points) + max(p[0] for p in points)) / 2
    north = map_size / 2 - (min(p[1] for p in points) + max(p[1] for p in points)) / 2
    return [(x + east, y + north) for x, y in points]
