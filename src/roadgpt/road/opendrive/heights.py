"""Reads the elevation of an OpenDRIVE file, and converts it to the Road's stations."""

from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.geometry import CubicProfile, ElevationProfile, GradeProfile, shifted
from roadgpt.geometry.curve import Array
from roadgpt.road.opendrive.lanes import Lanes
from roadgpt.road.opendrive.tree import cubics

SAME = 1e-9  # m, and as a ratio: heights and grades closer than this are treated as equal
CLOSE = 1e-6  # m between the starts of two cubics
STEP = 0.05  # m; a remark is made about a larger step
APART = 1.0  # m between the stations of the heights of a centre line beside the reference line


def elevation(road: Element) -> CubicProfile:
    """Returns the height of a road as a function of its station; 0 if the file states no elevation."""
    return cubics(road.findall("elevationProfile/elevation"), "s") or CubicProfile.constant(0.0)


def plain(profile: CubicProfile, length: float) -> ElevationProfile:
    """Returns a profile of constant grades and parabolas as a GradeProfile, and any other one unchanged."""
    stations = [s for s in profile.stations if s < length - SAME]
    stations = [0.0, *(s for s in stations if s > SAME)]
    table = profile.cubics(np.array(stations))
    if np.abs(table[:, 3]).max() > 0:
        return profile
    rows = list(zip(stations, table.tolist(), strict=True))
    for (s, (a, b, c, _)), (end, (z, grade, _, _)) in pairwise(rows):
        u = end - s
        if abs(a + u * (b + u * c) - z) > SAME * max(1.0, abs(z)) or abs(b + 2 * u * c - grade) > SAME:
            return profile
    (s, (_, b, c, _)) = rows[-1]
    grades = (*table[:, 1].tolist(), b + 2 * (length - s) * c)
    return GradeProfile(float(table[0, 0]), (*stations, length), grades)


def jumps(profile: CubicProfile, length: float) -> str | None:
    """Returns a sentence about the largest step in height; None if no step is larger than 5 cm."""
    worst, where = 0.0, 0.0
    for s, end in pairwise(profile.stations):
        if end < length:
            step = abs(float(profile.height(end) - profile.height(np.nextafter(end, s))))
            worst, where = max((worst, where), (step, end))
    return f"its height jumps by {worst:.2f} m at s = {where:.1f}" if worst > STEP else None


def edge_heights(heights: CubicProfile, lanes: Lanes) -> CubicProfile:
    """Returns the heights of the inner edge of the driving lanes, as functions of the station in the file.
    ``heights`` are those of the reference line. The edge has other heights than this line only where the road
    has superelevation and the edge lies beside this line."""
    if lanes.angle is None or not any(any(cubic) for cubic in lanes.angle.coefficients):
        return heights
    even = np.linspace(0.0, lanes.length, max(2, round(lanes.length / APART) + 1))
    joints = [s for s in (*lanes.joints(), *heights.stations) if 0.0 < s < lanes.length]
    s = np.unique(np.r_[even, joints])
    s = s[np.r_[True, np.diff(s) > CLOSE]]
    if np.abs(lanes.edge_on_surface(s)[0]).max() < SAME:
        return heights
    length = np.diff(s)
    inside = np.minimum(CLOSE, length / 4)
    z0, g0 = _edge_height(heights, lanes, s[:-1] + inside)
    z1, g1 = _edge_height(heights, lanes, s[1:] - inside)
    z0, z1 = z0 - inside * g0, z1 + inside * g1
    rise = (z1 - z0) / length
    c, d = (3 * rise - 2 * g0 - g1) / length, (g0 + g1 - 2 * rise) / length**2
    return CubicProfile.of_table(s[:-1].tolist(), np.column_stack([z0, g0, c, d]))


def _edge_height(heights: CubicProfile, lanes: Lanes, s: Array) -> tuple[Array, Array]:
    """Returns the height of the edge and its change per metre. With superelevation e and grade g, the edge at
    offset t lies t sin e / cos(atan g) above the reference line."""
    assert lanes.angle is not None
    t, slope = lanes.edge_on_surface(s)
    angle, grade = lanes.angle.height(s), heights.grade(s)
    steep = np.hypot(1.0, grade)
    rise = t * np.sin(angle)
    change = (
        slope * np.sin(angle) + t * np.cos(angle) * lanes.angle.grade(s)
    ) * steep + rise * grade * heights.vertical_curvature(s) / steep
    return heights.height(s) + rise * steep, grade + change


def carried_over(profile: CubicProfile, s: Array, stations: Array) -> CubicProfile:
    """Converts cubic functions of the station in the file to functions of the station on the Road. The two
    stations differ where the centre line is longer or shorter than the reference line.

    ``s`` are increasing stations of the file in metres, ``stations`` the corresponding stations of the Road.
    In between, the conversion is linear."""
    cuts = np.array(profile.stations)
    behind = np.clip(np.searchsorted(s, cuts), 1, len(s) - 1)
    apart = np.minimum(cuts - s[behind - 1], s[behind] - cuts)
    places, s = s, np.sort(np.r_[s, cuts[apart > CLOSE]])
    stations = np.interp(s, places, stations)
    # evaluated in the middle: rounding may put a start just before the cubic that begins there
    half = np.diff(s) / 2
    table = shifted(profile.cubics(s[:-1] + half), -half)
    scale = (np.diff(s) / np.diff(stations))[:, None] ** np.arange(4)
    return CubicProfile.of_table(stations[:-1].tolist(), table * scale)
