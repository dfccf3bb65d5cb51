"""Divides the lanes of a road into lanelets, for formats that describe roads as chains of lanelets.

Lanelets that lie side by side share the line between them. Consecutive lanelets of a lane share their end
points. A lane is left out of the sections in which it has no width.
"""

from dataclasses import dataclass

import numpy as np

from roadgpt.export.edges import lines, stations
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.profile import Marking

LENGTH = 50.0  # m, approximate length of a section
LEAST = 1.0  # m, minimum length of a section
DECIMALS = 4  # of a metre
THIN = 0.05  # m; a lane that is nowhere wider in a section is left out of it


@dataclass(frozen=True, eq=False)
class LaneletBound:
    """A line between two lanes, or at an edge of the carriageway: a polyline ``(n, 3)`` along the road."""

    points: Array
    marking: Marking


@dataclass(frozen=True, eq=False)
class LaneletSection:
    """The driving lanes between two stations, from right to left.

    Lanes are numbered as in OpenDRIVE: -1, -2, ... to the right of the centre line, where they run along the
    road, and 1, 2, ... to the left, where they run against it.
    """

    start: float
    end: float
    lanes: tuple[int, ...]
    bounds: tuple[LaneletBound, ...]
    """The bounds of the lanes from right to left. There is one more bound than there are lanes."""

    def bounds_of(self, lane: int) -> tuple[LaneletBound, LaneletBound]:
        """Returns the bounds of a lane: the one towards the centre line, and the outer one."""
        place = self.lanes.index(lane)
        right, left = self.bounds[place], self.bounds[place + 1]
        return (left, right) if lane < 0 else (right, left)


def lanelet_sections(road: Road, world: World) -> list[LaneletSection]:
    """Returns the consecutive sections of a road from its start to its end; there is at least one.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    profile = world.profile_of(road)
    fine = stations(road, profile.paved_reach)
    count = max(1, round(road.length / LENGTH))
    cuts = np.linspace(0.0, road.length, count + 1)
    cuts = _with_ends_of_lanes(cuts, profile)
    out = []
    for start, end in zip(cuts.tolist(), cuts[1:].tolist(), strict=False):
        s = np.r_[start, fine[(fine > start + 1e-3) & (fine < end - 1e-3)], end]
        out.append(_section(road, profile, s))
    return out


def _with_ends_of_lanes(cuts: Array, profile: Profile) -> Array:
    """Adds the stations at which a lane begins or ends."""
    forward, backward = profile.count
    widths = [lane.width for lane in (*profile.right[:forward], *profile.left[:backward])]
    for width in (width for width in widths if isinstance(width, CubicProfile)):
        ends = [s for s in width.stations if abs(float(width.height(s))) < THIN / 10]
        for s in (s for s in ends if np.abs(cuts - s).min() > LEAST and cuts[0] < s < cuts[-1]):
            cuts = np.sort(np.r_[cuts, s])
    return cuts


def _section(road: Road, profile: Profile, s: Array) -> LaneletSection:
    forward, backward = profile.count
    left, right = profile.lane_edges(s)
    edges = {-n: t for n, t in enumerate(right[:forward], 1)}
    edges |= {0: np.zeros(len(s))} | dict(enumerate(left[:backward], 1))
    marks = {-n: lane.marking for n, lane in enumerate(profile.right[:forward], 1)}
    marks |= {0: profile.centre_marking} | {n: lane.marking for n, lane in enumerate(profile.left, 1)}
    lanes = [
        lane
        for lane in [*range(-forward, 0), *range(1, backward + 1)]
        if np.abs(edges[lane] - edges[lane - int(np.sign(lane))]).max() > THIN
    ]
    kept = [*(lane for lane in lanes if lane < 0), 0, *(lane for lane in lanes if lane > 0)]
    made = lines(road, s, [edges[lane] for lane in kept])
    bounds = [
        LaneletBound(np.round(points, DECIMALS) + 0.0, marks[lane])
        for points, lane in zip(made, kept, strict=True)
    ]
    return LaneletSection(float(s[0]), float(s[-1]), tuple(lanes), tuple(bounds))
