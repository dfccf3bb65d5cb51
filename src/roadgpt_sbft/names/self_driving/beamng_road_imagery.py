"""The class that draws pictures of roads; generators import the class from a module of this name. The Python
interpreter that runs the test generator must have matplotlib.
"""

from self_driving.road_points import BeamNGRoadImagery

__all__ = ["BeamNGRoadImagery"]
