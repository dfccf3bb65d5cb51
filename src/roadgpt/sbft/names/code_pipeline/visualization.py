"""Shows nothing: pictures are drawn by ``roadgpt compete sbft --plot`` and ``roadgpt view --format``."""

from __future__ import annotations

from typing import Any

from roadgpt_inside import elsewhere


class _Shape:
    """A polygon of shapely, made when it is asked for."""

    def __init__(self, *corners: Any) -> None:
        self._corners = corners

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        from shapely.geometry import Polygon

        return Polygon(self._corners)


class RoadTestVisualizer:
    """Takes tests and draws none."""

    little_triangle = _Shape((10, 0), (0, -5), (0, 5))
    square = _Shape((5, 5), (5, -5), (-5, -5), (-5, 5))

    def __init__(self, map_size: float) -> None:
        """For a square map."""
        self.map_size = map_size
        self.last_submitted_test_figure: Any = None
        self.last_submitted_test: Any = None

    def visualize_road_test(self, the_test: Any) -> None:
        """Keep the test in mind."""
        self.last_submitted_test = the_test


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
