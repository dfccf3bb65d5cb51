"""Measures how far a car is outside its lane.

The Python interpreter that runs the test generator must have shapely.
"""

from __future__ import annotations

import math
from typing import Any, Tuple

CORNERS = ("rear_bottom_left", "rear_bottom_right", "front_bottom_right", "front_bottom_left")


class OutOfBoundsMonitor:
    """Counts how often a car leaves its lane, and measures how far it is outside. The state of the car comes
    from ``get_state().pos`` and ``get_vehicle_bbox()`` of ``vehicle_state_reader``."""

    def __init__(self, road_polygon: Any, vehicle_state_reader: Any, tolerance: float = 0.95) -> None:
        self.road_polygon, self.vehicle_state_reader = road_polygon, vehicle_state_reader
        self.oob_counter = 0
        self.last_is_oob = False
        self.last_max_oob_percentage = 0.0
        self.tolerance = tolerance

    def get_oob_info(self, wrt: str = "right", oob_bb: bool = True) -> Tuple[bool, int, float, float, float]:
        """Updates the counter, and returns whether the car is outside, by ``is_oob_bb`` if ``oob_bb`` is set,
        else by ``is_oob``; how many times it has left the lane; the largest fraction of it outside the right
        lane since then (NaN if ``oob_bb`` is False); its ``oob_distance``, and its ``oob_percentage``."""
        is_oob = self.is_oob_bb(wrt) if oob_bb else self.is_oob(wrt)
        if oob_bb:
            self.update_oob_percentage(is_oob)
        self.update_oob_counter(is_oob)
        largest = self.last_max_oob_percentage if oob_bb else math.nan
        return is_oob, self.oob_counter, largest, self.oob_distance(wrt), self.oob_percentage(wrt)

    def update_oob_counter(self, is_oob: bool) -> None:
        self.oob_counter += is_oob and not self.last_is_oob
        self.last_is_oob = is_oob

    def update_oob_percentage(self, is_oob: bool) -> None:
        if is_oob:
            share = self.oob_percentage()
            self.last_max_oob_percentage = (
                max(self.last_max_oob_percentage, share) if self.last_is_oob else share
            )

    def oob_percentage(self, wrt: str = "right") -> float:
        """Returns the fraction of the car's bounding box, 0 to 1, that is outside a lane ("right" or "left"),
        or outside the road for any other value of ``wrt``."""
        box = self._get_car_bbox_polygon()
        return 1 - float(box.intersection(self._of(wrt, "polygon")).area) / float(box.area)

    def is_oob_bb(self, wrt: str = "right") -> bool:
        return self.oob_percentage(wrt) > self.tolerance

    def oob_distance(self, wrt: str = "right") -> float:
        """Returns the distance in metres from the car to the edge of the lane or road, negative outside: half
        its width minus the distance from the car to its centre line."""
        share = 4.0 if wrt in ("right", "left") else 2.0
        return float(self.road_polygon.road_width / share - self._of(wrt, "polyline").distance(self._place()))

    def is_oob(self, wrt: str = "right") -> bool:
        """Returns whether the car's centre is outside the lane or the road."""
        return not self._of(wrt, "polygon").contains(self._place())

    def _of(self, wrt: str, kind: str) -> Any:
        return getattr(self.road_polygon, f"{wrt}_{kind}" if wrt in ("right", "left") else kind)

    def _place(self) -> Any:
        from shapely.geometry import Point

        return Point(self.vehicle_state_reader.get_state().pos)

    def _get_car_bbox_polygon(self) -> Any:
        from shapely.geometry import Polygon

        box = self.vehicle_state_reader.get_vehicle_bbox()
        return Polygon([box[corner][:2] for corner in CORNERS])
