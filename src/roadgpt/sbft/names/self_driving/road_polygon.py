"""The area of a road."""

from roadgpt.sbft.road_polygon import RoadPolygon

__all__ = ["RoadPolygon"]
