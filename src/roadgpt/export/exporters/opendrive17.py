"""Exports roads as ASAM OpenDRIVE 1.7, for programs that do not read version 1.8 yet.

Source: ASAM OpenDRIVE 1.7.0, user guide and XML schema."""

from roadgpt.export.exporters.opendrive import OpenDrive


class OpenDrive17(OpenDrive):
    """ASAM OpenDRIVE 1.7: as 1.8, without the boundaries of junctions."""

    name = "opendrive17"
    suffix = ".1.7.xodr"
    revision = 7
