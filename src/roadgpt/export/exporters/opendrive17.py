"""Exports roads as ASAM OpenDRIVE 1.7, for programs that do not read version 1.8 yet.

Source: ASAM OpenDRIVE 1.7.0, user guide and XML schema.
"""

from pathlib import Path

from roadgpt.export.exporters.opendrive import write
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World

REVISION_17 = 7  # ASAM OpenDRIVE 1.7


class OpenDrive17:
    """ASAM OpenDRIVE 1.7: as 1.8, without the boundaries of junctions."""

    name = "opendrive17"
    suffix = ".1.7.xodr"
    holds_junctions = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file, and beside it ``NAME.1.7.route.json`` with the roads and lanes to drive.

        ``poses`` is ignored, because OpenDRIVE cannot hold a drive.
        """
        write(road, path, world, REVISION_17)
