"""The class that draws pictures of roads, under the name of module by which generators import it. The Python
interpreter that runs the test generator must have matplotlib.
"""

from self_driving.road_points import BeamNGRoadImagery

__all__ = ["BeamNGRoadImagery"]
