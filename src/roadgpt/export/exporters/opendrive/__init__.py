"""Exports roads and networks as ASAM OpenDRIVE 1.8. Version 1.7 also defines all elements that are
written, except the boundaries of junctions.

Source: ASAM OpenDRIVE 1.8.1, user guide and XML schema.
"""

import json
from pathlib import Path

from roadgpt.export.exporters.opendrive.xodr import REVISION, ROAD, document
from roadgpt.export.poses import Poses
from roadgpt.network import Route
from roadgpt.road import Road, World

__all__ = ["ROAD", "OpenDrive", "document"]

ROUTE = ".route.json"
"""Suffix of the file that names the roads and lanes of a route: ``{"route": [[road, lane], ...]}``."""


class OpenDrive:
    """ASAM OpenDRIVE 1.8 with exact lines, arcs, spirals and parabolas, or fitted cubics for a spline."""

    name = "opendrive"
    suffix = ".xodr"
    holds_junctions = True
    revision = REVISION

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file, and beside it, with the suffix ``.route.json``, the roads and lanes to drive, in
        driving order. For a map without a route, this is an empty list.

        ``poses`` is ignored, because OpenDRIVE cannot hold a drive.
        """
        path.write_bytes(document(road, world, self.revision).to_text().encode())
        if isinstance(road, Route):
            legs = road.to_route_json()
        else:
            profile = world.profile_of(road)
            legs = {"route": [[ROAD, profile.along_ids[profile.driven]]]}
        path.with_suffix(ROUTE).write_text(json.dumps(legs) + "\n")
