"""Draws pictures of roads; the interpreter that runs the test generator must have matplotlib."""

from self_driving.road_points import BeamNGRoadImagery

__all__ = ["BeamNGRoadImagery"]
