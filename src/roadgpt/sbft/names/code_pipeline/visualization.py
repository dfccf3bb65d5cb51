"""Shows nothing: pictures are drawn by ``roadgpt sbft --plot`` and ``roadgpt plot``."""

from typing import Any


class RoadTestVisualizer:
    """Takes tests and draws none."""

    def __init__(self, map_size: float) -> None:
        """For a square map."""
        self.map_size = map_size
        self.last_submitted_test: Any = None

    def visualize_road_test(self, the_test: Any) -> None:
        """Keep the test in mind."""
        self.last_submitted_test = the_test
