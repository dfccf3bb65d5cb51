"""Writes elevation, superelevation and lane widths: parabolas and cubics exactly, splines as fitted
cubics.
"""

import numpy as np

from roadgpt.export.exporters.opendrive.hermite import at, cubics
from roadgpt.export.exporters.opendrive.plan import breaks_of
from roadgpt.export.markup import XmlElement
from roadgpt.geometry import CubicProfile, GradeProfile, shifted
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

TOLERANCE = 1e-4  # m, between heights and their cubics
SAME = 1e-5  # m; a cubic this close to the continuation of the previous one is left out
EQUAL = 1e-12  # greatest difference between the coefficients of two cubics that are taken as equal


def elevations(road: Road) -> list[XmlElement]:
    """Returns the ``elevation`` elements of a road in the order of their stations, beginning at station 0."""
    stations, table = _table(road)
    return _elements("elevation", "s", stations, table)


def level_height(road: Road) -> float | None:
    """Returns the height in metres of a road with a grade of 0 throughout, such as a road in a junction.

    None is returned for any other road, and for a level road whose elevation is not a GradeProfile with two
    stations.
    """
    profile = road.elevation
    if isinstance(profile, GradeProfile) and len(profile.stations) == 2 and not any(profile.grades):
        return profile.z0
    return None


def rows(name: str, station: str, profile: CubicProfile, length: float) -> list[XmlElement]:
    """Returns one XML element for each cubic of a profile, up to the end of the road; the first is at station
    0.

    A cubic that is identical to the continuation of the previous one is left out. ``station`` names the
    attribute for the station at which a cubic begins.
    """
    if profile.stations[0] == 0 and not any(1e-9 < s < length - 1e-9 for s in profile.stations):
        return [XmlElement(name, dict(zip((station, *"abcd"), (0.0, *profile.coefficients[0]), strict=True)))]
    stations = _within(profile.stations, length)
    table = profile.cubics(stations)
    kept = [0]
    for n in range(1, len(stations)):
        carried = shifted(table[kept[-1]], stations[n] - stations[kept[-1]])
        if not np.allclose(carried, table[n], rtol=0.0, atol=EQUAL):
            kept.append(n)
    return _elements(name, station, stations[kept], table[kept])


def _elements(name: str, station: str, stations: Array, table: Array) -> list[XmlElement]:
    return [
        XmlElement(name, dict(zip((station, *"abcd"), row, strict=True)))
        for row in np.column_stack([stations, table]).tolist()
    ]


def _table(road: Road) -> tuple[Array, Array]:
    """Returns stations ``(n,)`` and coefficients ``(n, 4)``. From each station on, the height is a cubic of
    the distance from that station."""
    profile, length = road.elevation, road.length
    if (level := level_height(road)) is not None:
        return np.zeros(1), np.array([[level, 0.0, 0.0, 0.0]])
    if isinstance(profile, GradeProfile):
        stations = _within(profile.stations[:-1], length)
        half = profile.vertical_curvature(stations) / 2
        rows = [profile.height(stations), profile.grade(stations), half, np.zeros_like(half)]
        return stations, np.column_stack(rows)
    if isinstance(profile, CubicProfile):
        stations = _within(profile.stations, length)
        return stations, profile.cubics(stations)

    def height(s: Array) -> Array:
        return np.asarray(profile.height(s))[:, None]

    def grade(s: Array) -> Array:
        return np.asarray(profile.grade(s))[:, None]

    stations, found = cubics(height, grade, breaks_of(road.plan), TOLERANCE)
    return _without_repetition(stations, found)


def _without_repetition(stations: Array, found: Array) -> tuple[Array, Array]:
    """Returns the cubics without those that only continue the previous one."""
    kept = [0]
    for i in range(1, len(found)):
        last, length = found[kept[-1]][None], stations[i + 1] - stations[i]
        u = np.array([0.0, length / 2, length])
        carried = at(np.repeat(last, 3, axis=0), stations[i] - stations[kept[-1]] + u)
        if np.abs(carried - at(np.repeat(found[i][None], 3, axis=0), u)).max() > SAME:
            kept.append(i)
    return stations[kept], found[kept][:, :, 0]


def _within(stations: tuple[float, ...], length: float) -> Array:
    """Returns station 0, followed by those of the given stations that lie inside the road."""
    return np.array([0.0, *(s for s in stations if 1e-9 < s < length - 1e-9)])
