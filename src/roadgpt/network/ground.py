"""Computes where the ground beside a route ends.

The ground is the paved area of the network with its shoulders. At each station the ground reaches, at right
angles to the route and on both sides, from the reference line of the route to the first edge of this area.
The height of the ground is that of the route at the same station.
"""

from collections.abc import Sequence

import numpy as np

from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic
from roadgpt.network.network import Network
from roadgpt.network.passages import Passage
from roadgpt.network.paved import Area
from roadgpt.network.surface import ROUND
from roadgpt.road import Edges, Road

FARTHEST = 40.0  # m, from the reference line; ground farther away is left out
STEP = 0.5  # m, between the stations at which edges are computed
JUST = 1e-6  # m, before or behind a station, so that a jump of widths at the station does not matter
AROUND = 20.0  # m, before and after a junction, where kerbs may still curve


def ground_of(network: Network) -> Area:
    """Returns the paved area of a network, widened by the widest shoulder of its roads."""
    shoulder = max(each.shoulder for each in network.roads)
    area = network.paved
    return area.buffer(shoulder, quad_segs=ROUND) if shoulder > 0 else area


def edges_of_ground(route: Road, ground: Area, s: Array) -> Edges:
    """Returns the offsets in metres of the left and the right edge of the ground at stations ``s`` ``(n,)``.

    Where there is no edge within ``FARTHEST``, the offset is ``FARTHEST``, negative on the right.
    """
    import shapely

    boundary, starts = ground.boundary, route.plan.at(s)
    found = []
    for side in (1.0, -1.0):
        ends = route.at(s, side * FARTHEST)[:, :2]
        rays = shapely.linestrings(np.stack((starts, ends), axis=1))
        hits = shapely.intersection(rays, boundary)
        away = shapely.distance(shapely.points(starts), hits)
        found.append(side * np.where(np.isnan(away), FARTHEST, away))
    return Edges(*found)


def windows(passages: Sequence[Passage], length: float) -> list[tuple[float, float]]:
    """Returns the stretches of a route within ``AROUND`` metres of its passages, each as its first and last
    station in metres. Stretches that overlap are merged. ``length`` is that of the route in metres.
    """
    found: list[tuple[float, float]] = []
    for each in passages:
        low, high = max(0.0, each.start - AROUND), min(length, each.end + AROUND)
        if found and low <= found[-1][1]:
            found[-1] = (found[-1][0], high)
        else:
            found.append((low, high))
    return found


def shoulders_on_ground(
    route: Road, network: Network, passages: Sequence[Passage], starts: Sequence[float]
) -> tuple[CubicProfile, CubicProfile]:
    """Returns the widths in metres of the left and the right shoulder of a route, along its stations.

    The route leads through the passages of a network; ``starts`` are the stations at which its legs begin.
    Outside the stretches that ``windows`` returns, the shoulders are as wide as those of the roads; inside,
    they reach to the edge of the ground.
    """
    assert route.profile is not None
    ground, profile = ground_of(network), route.profile
    rows: tuple[list[tuple[float, Cubic]], list[tuple[float, Cubic]]] = ([], [])
    last = 0.0
    for low, high in windows(passages, route.length):
        s = np.linspace(low, high, max(2, round((high - low) / STEP) + 1))
        s = np.union1d(s, [each for each in starts if low < each < high])
        ends = edges_of_ground(route, ground, s)
        # lanes begin and end where a junction does, so the shoulder beside them jumps there
        after, before = profile.edges(s[:-1] + JUST), profile.edges(s[1:] - JUST)
        begins = (ends.left[:-1] - after.left, after.right - ends.right[:-1])
        stops = (ends.left[1:] - before.left, before.right - ends.right[1:])
        usuals = _usual(profile.rims(last), profile.edges(last))
        for side, begin, stop, usual in zip(rows, begins, stops, usuals, strict=True):
            if low > last:
                side.append((last, (usual, 0.0, 0.0, 0.0)))
            widths = np.maximum(begin, 0.0)
            slopes = (np.maximum(stop, 0.0) - widths) / np.diff(s)
            side += [
                (at, (a, b, 0.0, 0.0)) for at, a, b in np.column_stack((s[:-1], widths, slopes)).tolist()
            ]
        last = high
    for side, usual in zip(rows, _usual(profile.rims(last), profile.edges(last)), strict=True):
        end = min(last, route.length - 1e-6)
        while side and side[-1][0] >= end:
            side.pop()
        side.append((end, (usual, 0.0, 0.0, 0.0)))
    left, right = map(CubicProfile.of_rows, rows)
    return left, right


def _usual(rims: Edges, edges: Edges) -> tuple[float, float]:
    """Returns the widths of the shoulders outside junctions."""
    return float(rims.left - edges.left), float(edges.right - rims.right)
