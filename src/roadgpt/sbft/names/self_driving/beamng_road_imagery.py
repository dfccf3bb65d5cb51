"""Pictures of roads; they need matplotlib in the generator's interpreter."""

from __future__ import annotations

from typing import Any

from roadgpt_inside import elsewhere
from self_driving.road_points import RoadPoints


class BeamNGRoadImagery:
    """A road and its picture."""

    def __init__(self, road_points: RoadPoints) -> None:
        """Nothing is drawn yet."""
        self.road_points = road_points
        self._figure: Any = None

    @classmethod
    def from_sample_nodes(cls, sample_nodes: Any) -> BeamNGRoadImagery:
        """Of nodes [x, y, height, width]."""
        return cls(RoadPoints().add_middle_nodes(sample_nodes))

    def plot(self) -> None:
        """Draw it."""
        from matplotlib.figure import Figure

        self._figure = Figure()
        self.road_points.plot_on_ax(self._figure.subplots())

    def save(self, image_path: Any) -> None:
        """Write it, as the name's ending says."""
        if self._figure is None:
            self.plot()
        self._figure.savefig(image_path)


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
