"""Measures how tightly lines beside a centre line bend, such as the middle or the edge of a lane, and reports
junctions where they bend too tightly."""

import math
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from roadgpt.check.finding import Finding
from roadgpt.check.network_places import junction_finding
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.network import Junction, Network, NetworkRoad, Route

ROUNDING = 1e-9  # m
GRID = np.linspace(0.0, 1.0, 33)  # ratio of the length of a piece, where its lane varies in width
INSIDE = 1e-9  # m before the end of a road, where the width is evaluated instead of at the end


class LaneBend(NamedTuple):
    """Where a line bends most: the station of the centre line and the radius of the line, in metres."""

    s: float
    radius: float


def bends_below(
    rule: str,
    network: Network,
    route: Route | None,
    least: float,
    what: str,
    bends_at: Callable[[Network, Junction], Iterable[LaneBend | None]],
) -> tuple[Finding, ...]:
    """Returns a Finding for each junction or roundabout with a bend below ``least`` metres.

    ``what`` names the line and has a ``{}`` for its radius, as in ``str.format``. ``bends_at`` gives the
    bends of a junction, with traffic on the right.
    """
    found = []
    seen = network.right_hand
    for _, junctions in network.nodes:
        bends = [bend for each in junctions for bend in bends_at(seen, seen.junction(each.id))]
        radius = min((bend.radius for bend in bends if bend is not None), default=least)
        if radius < least - ROUNDING:
            wanted = "give the island" if junctions[0].kind == "roundabout" else "ask for a kerb with"
            advice = f"{wanted} a larger radius or turn the arms apart"
            told = f"{what.format(radius)}, tighter than {least:g} m; {advice}"
            found.append(junction_finding(rule, route, junctions[0], told))
    return tuple(found)


def tightest_bend(member: NetworkRoad, share: float, only_right: bool = False) -> LaneBend | None:
    """Returns the tightest bend of a line along the right lane of a connecting road (through a junction).
    With ``only_right``, bends to the left are ignored. None: the line has no such bend. A radius of 0 means
    that the line folds.

    The line lies to the right of the centre line, at a distance of ``share`` times the width of the lane: 0.5
    for the middle of the lane, 1 for its right edge. Where the width varies, the line is not an arc even if
    the centre line is an arc. Source: the curvature of x(s) = c(s) + d(s) n(s), by Frenet's formulas.
    """
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    if isinstance(width, CubicProfile):
        s, curvature = _sampled(member, share)
        bends = -curvature if only_right else np.abs(curvature)
        worst = int(bends.argmax())
        at, bend = float(s[worst]), float(bends[worst])
    else:
        rows = _exact(plan, -share * width)
        at, bend = max(((s, -k if only_right else abs(k)) for s, k in rows), key=lambda row: row[1])
    return LaneBend(at, 1 / bend) if bend > 0 else None


def _exact(plan: PieceCurve, t: float) -> Iterator[tuple[float, float]]:
    """Yields stations and curvatures at the ends of a parallel curve's pieces, where curvature is extreme."""
    s = 0.0
    for piece in plan.pieces:
        for at, k in ((s, piece.k0), (s + piece.length, piece.k1)):
            along = 1 - t * k
            yield at, k / along if along > 0 else math.copysign(math.inf, k)
        s += piece.length


def _sampled(member: NetworkRoad, share: float) -> tuple[Array, Array]:
    """Returns stations and curvatures of a curve at ``share`` of a width that varies."""
    s, k, slope, *widths = _frames(member)
    d, d1, d2 = (-share * each for each in widths)
    along = 1 - d * k
    with np.errstate(divide="ignore", invalid="ignore"):  # where the curve folds
        bend = (along * (d2 + along * k) + d1 * (2 * d1 * k + d * slope)) / np.hypot(along, d1) ** 3
    return s, np.where(along > 0, bend, np.copysign(np.inf, k))


@lru_cache(maxsize=128)
def _frames(member: NetworkRoad) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Returns stations of a connecting road, the curvature there and its change per metre, and the width of
    the lane with the first and second derivative of this width.
    """
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    assert isinstance(width, CubicProfile)
    length, k0, k1 = np.array([(piece.length, piece.k0, piece.k1) for piece in plan.pieces]).T[..., None]
    k = (k0 + (k1 - k0) * GRID).ravel()
    s = (np.cumsum(length)[:, None] - length + length * GRID).ravel()
    slope = np.repeat((k1 - k0) / length, len(GRID), axis=1).ravel()
    at = np.minimum(s, plan.length - INSIDE)
    return s, k, slope, width.height(at), width.grade(at), width.vertical_curvature(at)
