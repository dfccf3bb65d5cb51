"""Requires kerbs of at least 3 m at junctions, and lanes of connecting roads of at least 5 m.

The kerb between two neighbouring arms is the right edge of the connecting road on which traffic turns right
from one arm to the next. With traffic on the left, it is the left edge of the connecting road on which
traffic turns left. The smallest radius of the kerb is measured; clothoids make it smaller than the radius of
an arc with the same ends. Source: Urban Street Design Guide (NACTO, 2013), corner radii: standard curb radii
are 10 to 15 ft.

Of every connecting road, the middle of the lane is measured. A car 4.7 m long can just follow 5 m: its
turning circle between kerbs usually has a diameter of 11 m. Then its outer front wheel runs on a radius of
5.5 m, and the middle of the car on a radius of about 4.7 m."""

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.network import Junction, Network, NetworkRoad
from roadgpt.road import Road, World

KERB, LANE = 3.0, 5.0  # m, least radii
EDGE, MIDDLE = 1.0, 0.5  # of the width of the lane
ROUNDING = 1e-9  # m
GRID = np.linspace(0.0, 1.0, 33)  # ratio of the length of a piece, where its lane varies in width
INSIDE = 1e-9  # m before the end of a road, where the width is evaluated instead of at the end


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction or roundabout with a kerb (``kerb_too_tight``) or a lane that is too tight, and
    the smallest radius there."""
    found, seen = [], network.right_hand
    kerb = "the kerb between two arms has a radius of {:.1f} m"
    lane = "the lane of a connecting road has a radius of {:.1f} m in its middle"
    for rule, least, line, radii_at in (
        ("kerb_too_tight", KERB, kerb, _kerbs),
        ("connection_too_tight", LANE, lane, _lanes),
    ):
        for _, junctions in network.nodes:
            radii = (radius for each in junctions for radius in radii_at(seen, seen.junction(each.id)))
            radius = min(radii, default=least)
            if radius < least - ROUNDING:
                wanted = "give the island" if junctions[0].kind == "roundabout" else "ask for a kerb with"
                advice = f"{wanted} a larger radius or turn the arms apart"
                told = f"{line.format(radius)}, tighter than {least:g} m; {advice}"
                found.append(junction_finding(rule, route, junctions[0], told))
    return tuple(found)


def _kerbs(network: Network, junction: Junction) -> Iterator[float]:
    ends = [arm.end for arm in junction.arms]
    following = dict(zip(ends, [*ends[1:], *ends[:1]], strict=True))
    for each in junction.connections:
        if following.get(each.incoming) == each.outgoing:
            yield tightest_radius(network.road(each.road), EDGE, only_right=True)


def _lanes(network: Network, junction: Junction) -> Iterator[float]:
    for each in junction.connections:
        yield tightest_radius(network.road(each.road), MIDDLE)


def tightest_radius(member: NetworkRoad, share: float, only_right: bool = False) -> float:
    """Returns the least radius in metres of a line along the right lane of a connecting road: 0 where the
    line folds, infinite without a bend. With ``only_right``, bends to the left are ignored.

    The line lies to the right of the centre line, at a distance of ``share`` times the width of the lane: 0.5
    for the middle of the lane, 1 for its right edge. Where the width varies, the line is not an arc even if
    the centre line is an arc. Source: the curvature of x(s) = c(s) + d(s) n(s), by Frenet's formulas."""
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    if isinstance(width, CubicProfile):
        k, slope, *widths = _frames(member)
        d, d1, d2 = (-share * each for each in widths)
        along = 1 - d * k
        with np.errstate(divide="ignore", invalid="ignore"):  # where the curve folds
            bends = (along * (d2 + along * k) + d1 * (2 * d1 * k + d * slope)) / np.hypot(along, d1) ** 3
    else:
        k = np.array([(piece.k0, piece.k1) for piece in plan.pieces])  # where curvature is extreme
        along = 1 + share * width * k
        with np.errstate(divide="ignore", invalid="ignore"):
            bends = k / along
    bends = np.where(along > 0, bends, np.copysign(np.inf, k))
    bend = float((-bends if only_right else np.abs(bends)).max())
    return 1 / bend if bend > 0 else math.inf


@lru_cache(maxsize=128)
def _frames(member: NetworkRoad) -> tuple[Array, Array, Array, Array, Array]:
    """Returns the curvature of a connecting road at many stations and its change per metre, and the width of
    the lane with the first and second derivative of this width."""
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    assert isinstance(width, CubicProfile)
    length, k0, k1 = np.array([(piece.length, piece.k0, piece.k1) for piece in plan.pieces]).T[..., None]
    k = (k0 + (k1 - k0) * GRID).ravel()
    s = (np.cumsum(length)[:, None] - length + length * GRID).ravel()
    slope = np.repeat((k1 - k0) / length, len(GRID), axis=1).ravel()
    at = np.minimum(s, plan.length - INSIDE)
    return k, slope, width.height(at), width.grade(at), width.vertical_curvature(at)
