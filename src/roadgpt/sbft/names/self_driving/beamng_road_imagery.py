"""Draws pictures of roads. The Python interpreter that runs the test generator must have matplotlib."""

from __future__ import annotations

from typing import Any

from self_driving.road_points import RoadPoints


class BeamNGRoadImagery:
    """Draws and saves the picture of one road."""

    def __init__(self, road_points: RoadPoints) -> None:
        """Takes a road; nothing is drawn yet."""
        self.road_points = road_points
        self._figure: Any = None

    @classmethod
    def from_sample_nodes(cls, sample_nodes: Any) -> BeamNGRoadImagery:
        """Returns an object that can draw the road with these nodes, each [x, y, height, width] in metres."""
        return cls(RoadPoints().add_middle_nodes(sample_nodes))

    def plot(self) -> None:
        """Draws the road in a new figure, which ``save`` writes to a file."""
        from matplotlib.figure import Figure

        self._figure = Figure()
        self.road_points.plot_on_ax(self._figure.subplots())

    def save(self, image_path: Any) -> None:
        """Saves the picture; the suffix of the file name, such as ".svg", sets the format."""
        if self._figure is None:
            self.plot()
        self._figure.savefig(image_path)
