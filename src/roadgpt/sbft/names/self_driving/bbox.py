"""The box of a map."""

from roadgpt.sbft.road_polygon import RoadBoundingBox

__all__ = ["RoadBoundingBox"]
