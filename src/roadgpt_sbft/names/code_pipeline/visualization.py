"""Accepts requests to draw and ignores them; ``roadgpt compete sbft --plot`` and ``roadgpt view --format``
draw pictures."""

from __future__ import annotations

from typing import Any


class _ShapelyPolygon:
    def __init__(self, *corners: Any) -> None:
        self._corners = corners

    def __get__(self, instance: Any, owner: Any = None) -> Any:
        from shapely.geometry import Polygon

        return Polygon(self._corners)


class RoadTestVisualizer:
    """Accepts tests without drawing them."""

    little_triangle = _ShapelyPolygon((10, 0), (0, -5), (0, 5))
    square = _ShapelyPolygon((5, 5), (5, -5), (-5, -5), (-5, 5))

    def __init__(self, map_size: float) -> None:
        self.map_size = map_size
        self.last_submitted_test_figure: Any = None
        self.last_submitted_test: Any = None

    def visualize_road_test(self, the_test: Any) -> None:
        self.last_submitted_test = the_test
