"""Exports comma-separated values: one row per metre of the road, and one row per time step of the drive."""

from pathlib import Path

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import finite

STEP = 1.0  # m
DECIMALS = 6
ROAD = "s_m,x_m,y_m,z_m,heading_rad,curvature_per_m,grade,lane_width_m,verge_m"
DRIVE = "time_s,x_m,y_m,z_m,heading_rad,pitch_rad,roll_rad,speed_mps"


class Csv:
    """Comma-separated tables of the road (a row per metre, with heading, curvature, grade and widths) and of
    the drive.

    The default cross-section is level and has one lane of constant width in each direction. For any other
    cross-section, the table also contains the superelevation, and the offset of the outer edge of each lane
    and shoulder. Lanes are numbered as in OpenDRIVE. For a route through a network, the table contains only
    the route."""

    name = "csv"
    suffix = ".csv"
    draws_edges = False
    holds_junctions = True
    needs_route = True
    lacks = ("the land around",)

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the road to ``path``, and the drive to NAME.drive.csv unless ``poses`` is None."""
        of, profile, names = road.sample(STEP), world.profile_of(road), ROAD
        columns = [of.s, of.x, of.y, of.z, of.heading, of.curvature, of.grade]
        columns += [profile.width(of.s), profile.shoulder(of.s)]
        if profile != Profile.of(1, 1, world.section.lane_width, world.section.shoulder):
            left, right = profile.lane_edges(of.s)
            edges = dict(enumerate(left, 1)) | {-n: t for n, t in enumerate(right, 1)}
            numbers = sorted(edges, reverse=True)
            names = ",".join([ROAD, "superelevation_rad", *(f"lane_{n}_edge_m" for n in numbers)])
            columns += [profile.superelevation(of.s), *(edges[n] for n in numbers)]
        _write(path, names, columns)
        if poses is not None:
            p = poses
            columns = [p.time, p.x, p.y, p.z, p.heading, p.pitch, p.roll, p.speed]
            _write(path.with_name(path.name.removesuffix(self.suffix) + ".drive.csv"), DRIVE, columns)


def _write(path: Path, header: str, columns: list[Array]) -> None:
    table = np.round(finite(np.column_stack(columns)), DECIMALS) + 0.0
    rows = [",".join(map(repr, row)) for row in table.tolist()]
    path.write_bytes("\n".join([header, *rows, ""]).encode())
