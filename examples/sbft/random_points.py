"""A generator for the SBFT tool competition: four points anywhere on the map, and a spline through them.

Works in the competition's own pipeline and in ours:

    cd examples/sbft
    roadgpt compete sbft --module-name random_points --class-name RandomPoints --test-budget 50
"""

import os
import random

from code_pipeline.tests_generation import RoadTestFactory

POINTS = 4
MARGIN = 10.0  # m that the points keep from the border; the spline between them keeps none


class RandomPoints:
    """The usual naive baseline: most of its roads are invalid."""

    def __init__(self, executor=None, map_size=None):
        self.executor = executor
        self.map_size = map_size
        self.random = random.Random(int(os.environ.get("GENERATOR_SEED", "1")))

    def start(self):
        """Test after test, until the budget is over."""
        while not self.executor.is_over():
            self.executor.execute_test(RoadTestFactory.create_road_test(self.road()))

    def road(self):
        """Control points in metres."""
        return [(self.coordinate(), self.coordinate()) for _ in range(POINTS)]

    def coordinate(self):
        """Somewhere on the map."""
        return self.random.uniform(MARGIN, self.map_size - MARGIN)
