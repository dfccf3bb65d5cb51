"""Computes the edge points of a road from its nodes."""

from __future__ import annotations

import math
from typing import Any, List, Sequence, Tuple

from self_driving.beamng_pose import BeamNGPose

List4DTuple = List[Tuple[float, float, float, float]]
List2DTuple = List[Tuple[float, float]]
Place = Tuple[float, float]


class RoadPoints:
    """The nodes of a road's centre line, each with a point on the left edge and one on the right, at right
    angles to the line to the next node (for the last node, from the previous one)."""

    def __init__(self) -> None:
        self.middle: List[Any] = []
        self.right: List[Any] = []
        self.left: List[Any] = []
        self.n = 0

    @classmethod
    def from_nodes(cls, middle_nodes: Sequence[Sequence[float]]) -> RoadPoints:
        return cls().add_middle_nodes(middle_nodes)

    def add_middle_nodes(self, middle_nodes: Sequence[Sequence[float]]) -> RoadPoints:
        assert len(self.middle) + len(middle_nodes) >= 2, "a road needs two nodes or more"
        assert all(len(node) >= 4 for node in middle_nodes), "a node is (x, y, height, width)"
        self.middle += list(middle_nodes)
        self.n = len(self.middle)
        edges = [self.calc_point_edges(one, after) for one, after in zip(self.middle, self.middle[1:])]
        self.left = [left for left, _ in edges]
        self.right = [right for _, right in edges]
        right, left = self.calc_point_edges(self.middle[-1], self.middle[-2])
        self.left.append(left)
        self.right.append(right)
        return self

    @classmethod
    def calc_point_edges(cls, p1: Sequence[float], p2: Sequence[float]) -> Tuple[Place, Place]:
        """Returns the left and right edge points at the node ``p1``, given the next node ``p2``."""
        x, y = p2[0] - p1[0], p2[1] - p1[1]
        way, half = math.sqrt(x * x + y * y), p1[3] / 2
        # coinciding nodes have no direction: not a number, as with the competition's library
        x, y = (x / way * half, y / way * half) if way else (math.nan, math.nan)
        return (p1[0] - y, p1[1] + x), (p1[0] + y, p1[1] - x)

    @staticmethod
    def angle_to_quat(angle: Sequence[float]) -> Tuple[float, float, float, float]:
        """Converts the angles roll, pitch and yaw in degrees to a quaternion (x, y, z, w)."""
        roll, pitch, yaw = (math.radians(a) / 2 for a in angle)
        sr, cr, sp, cp = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
        sy, cy = math.sin(yaw), math.cos(yaw)
        return (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )

    def vehicle_start_pose(
        self, meters_from_road_start: float = 2.5, road_point_index: int = 0
    ) -> BeamNGPose:
        """Returns the pose in which the competition places the car at the start: in the middle of the right
        lane, ``meters_from_road_start`` metres after the node with the index ``road_point_index``."""
        assert self.n > road_point_index, f"there are {self.n} nodes, and no number {road_point_index}"
        here, after = self.middle[road_point_index], self.middle[road_point_index + 1]
        edge = self.right[road_point_index]
        x, y = after[0] - here[0], after[1] - here[1]
        share = meters_from_road_start / math.sqrt(x * x + y * y)
        x, y = x * share, y * share
        place = ((here[0] + edge[0]) / 2 + x, (here[1] + edge[1]) / 2 + y, here[2])
        return BeamNGPose(pos=place, rot=self.angle_to_quat((0, 0, math.degrees(math.atan2(-x, -y)))))

    def new_imagery(self) -> Any:
        return BeamNGRoadImagery(self)

    def plot_on_ax(self, ax: Any) -> None:
        ax.set_facecolor("#7D9051")
        for points, colour in ((self.middle, "#FEA952"), (self.left, "white"), (self.right, "white")):
            ax.plot([p[0] for p in points], [p[1] for p in points], color=colour, linewidth=1)
        ax.axis("equal")


class BeamNGRoadImagery:
    """Draws and saves the picture of one road."""

    def __init__(self, road_points: RoadPoints) -> None:
        self.road_points = road_points
        self._figure: Any = None

    @classmethod
    def from_sample_nodes(cls, sample_nodes: Any) -> BeamNGRoadImagery:
        return cls(RoadPoints().add_middle_nodes(sample_nodes))

    def plot(self) -> None:
        from matplotlib.figure import Figure

        self._figure = Figure()
        self.road_points.plot_on_ax(self._figure.subplots())

    def save(self, image_path: Any) -> None:
        if self._figure is None:
            self.plot()
        self._figure.savefig(image_path)
