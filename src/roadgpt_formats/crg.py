"""Exports the road surface as ASAM OpenCRG 1.2 in ASCII form, for tyre and vehicle dynamics models.

Source: ASAM OpenCRG 1.2.0, user guide and file format. The surface is smooth: it has
the heights of the road and no roughness."""

import math
from pathlib import Path

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.export.ego import Poses
from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import finite

STEP = 0.1  # m between cross sections
MOST = 200_000  # cross sections; longer roads have a wider step
RULER = "$" * 72  # ends the header
NOTHING = "*" * 20  # a field without a value
ROUNDS = 3  # of the iteration that finds the station of a point beside the centre line
CLOSEST = 0.05  # share of the radius: least distance from the centre of a bend that the iteration assumes
ROOM = 0.99  # largest width as a share of the radius, so that the surface does not reach a bend's centre


class Crg:
    """ASAM OpenCRG as text: a smooth surface along the centre line, for tyre and vehicle dynamics models."""

    name = "crg"
    suffix = ".crg"
    lacks = ("the land around",)
    draws_edges = False

    def doubts(self, road: Road, world: World) -> tuple[str, ...]:
        """Says where the surface ends before the shoulders do."""
        bend, profile = np.abs(road.sample(STEP).curvature), world.profile_of(road)
        if bend.max() * profile.reach < ROOM:
            return ()
        s = road.sample(STEP).s[bend.argmax()]
        return (f"the bend at s = {s:.0f} m has no room for the shoulders; they are narrower everywhere",)

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the surface of lanes and shoulders.

        ``poses`` is ignored, because OpenCRG cannot hold a drive."""
        path.write_bytes(document(road, world).encode("ascii"))


def document(road: Road, world: World) -> str:
    """Returns the text of the file: a header, then one line per cross-section with heading and two heights.

    The heights are those at the right and at the left edge of the surface. If a bend is too tight for the
    shoulders, the shoulders are narrower along the whole road.

    Raises:
        ExportError: The radius of a bend is less than the distance from the centre line to an edge of the
            carriageway, or a number is not finite."""
    count = min(MOST, max(1, math.ceil(road.length / STEP)))
    step = road.length / count
    points = finite(road.at(np.linspace(0.0, road.length, count + 1)))
    headings = np.array(_headings(points[:, :2].tolist(), step))
    right, left = _across(headings, step, world.profile_of(road), road.length)
    columns = [headings.tolist(), *(_heights(road, points, t).tolist() for t in (right, left))]
    phi, *edges = ([f"{value:20.12e}" for value in column] for column in columns)
    rows = ["".join(fields) for fields in zip([NOTHING, *phi], *edges, strict=True)]
    return "\n".join([*_header(road.length, step, points, headings, right, left), *rows, ""])


def _heights(road: Road, points: Array, t: float) -> Array:
    """Returns the heights of the surface beside the points of the centre line, ``t`` metres to their left."""
    if road.profile is None or road.profile.superelevation_angle is None:
        return points[:, 2]
    s = np.linspace(0.0, road.length, len(points))
    room = np.maximum(1 - road.curvature(s) * t, CLOSEST)
    at = s
    for _ in range(ROUNDS):  # on a grade, points of an inclined surface are shifted along the road
        angle, pitch = road.profile.superelevation(at), np.arctan(road.grade(at))
        at = s + t * np.tan(angle) * np.sin(pitch) / room
    return finite(road.at(at, t / np.cos(road.profile.superelevation(at)))[:, 2])


def _header(
    length: float, step: float, points: Array, headings: Array, right: float, left: float
) -> list[str]:
    """Returns the lines that define the reference line, the surface's width, and the columns of a row."""
    (x, y), phi = points[0, :2], headings[[0, -1]]
    end_x, end_y = x + step * np.cos(headings).sum(), y + step * np.sin(headings).sum()
    numbers = {"start_u": 0.0, "end_u": length, "increment": step, "start_x": x, "start_y": y}
    numbers |= {"start_phi": phi[0], "end_x": end_x, "end_y": end_y, "end_phi": phi[1]}
    sides = {"v_right": right, "v_left": left, "v_increment": left - right}
    return [
        "$CT",
        "RoadGPT: smooth road, heights along the centre line",
        "$",
        "$ROAD_CRG_MODS",  # empty: the road stays where it is
        "$",
        "$ROAD_CRG",
        *(f"{'reference_line_' + name:<26}= {value:.16e}" for name, value in numbers.items()),
        *(f"{'long_section_' + name:<26}= {value:.16e}" for name, value in sides.items()),
        "$",
        "$KD_DEFINITION",
        "#:LDFI",
        f"U:reference line u,m,0.0,{step!r}",
        "D:reference line phi,rad",
        "D:long section 1,m",
        "D:long section 2,m",
        "$",
        RULER,
    ]


def _headings(points: list[list[float]], step: float) -> list[float]:
    """Returns the heading in radians from each cross-section to the next, ``(n - 1,)``.

    A program that reads the file computes each point from the previous one by a step of constant length in
    the given direction. Each direction therefore points from the computed point, not from the exact one, to
    the next point of the road, so that errors across the road do not add up."""
    x, y = points[0]
    out = []
    for target_x, target_y in points[1:]:
        heading = math.atan2(target_y - y, target_x - x)
        out.append(heading)
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
    return out


def _across(headings: Array, step: float, profile: Profile, length: float) -> tuple[float, float]:
    """Returns how far lanes and shoulders reach to the right and left, as offsets in metres, reduced to what
    the tightest bend allows."""
    turns = np.abs(wrap_angle(np.diff(headings)))
    place = step * int(turns.argmax()) if len(turns) else 0.0
    room = ROOM * step / math.sin(min(float(turns.max(initial=1e-12)), math.pi / 2))
    if room < profile.paved_reach:
        raise ExportError(
            f"OpenCRG cannot hold the bend at s = {place:.0f} m, whose radius of {room:.1f} m is less than a "
            "lane is wide; use wider bends or a narrower lane"
        )
    rims = profile.rims(np.linspace(0.0, length, len(headings) + 1))
    return max(float(rims.right.min()), -room), min(float(rims.left.max()), room)
