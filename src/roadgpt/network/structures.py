"""Builds the solid parts of bridges and tunnels: parapets, decks and piers; walls, ceilings and portals.

The road's own surface is not among them. The clearance of tunnels is that of the German RABT: 4.5 m, and room
for lamps; other dimensions are usual ones."""

from collections.abc import Iterator

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground, Span
from roadgpt.network.network import Network, NetworkRoad
from roadgpt.network.surface import COVER, lines_of, sheet

PARAPET, THICK = 1.0, 0.25  # m, height and thickness
DEEP = (0.9, 1 / 22)  # m, least depth of a deck; depth as a share of the distance between piers
KERB = 0.03  # m, of shoulders above the road
PIER, PIERS = (1.4, 0.55), 28.0  # m along and share of the road's width across; m between piers
FOOTING = 1.0  # m by which piers reach into the ground
CLEAR = 5.0  # m from the road to the ceiling of a tunnel
FACE = (3.0, 0.6)  # m of a portal's wall beside the road, and above the land there


def solids(network: Network, ground: Ground) -> Iterator[Array]:
    """Yields the triangles ``(m, 3, 3)`` in metres of each bridge and each tunnel, seen from the side from
    which their corners turn counter-clockwise."""
    for span in ground.pavement.spans:
        member = network.road(span.road)
        build = _bridge if span.kind == "bridge" else _tunnel
        yield np.concatenate([*_walks(member, span), *build(member, span, ground)])


def _walks(member: NetworkRoad, span: Span) -> Iterator[Array]:
    """Yields what lies on the shoulders instead of grass."""
    if member.profile.has_shoulders:
        left_edge, right_edge, left, right = (
            _up(each, KERB) for each in lines_of(member, span.start, span.end)
        )
        yield sheet(left_edge, left)
        yield sheet(right, right_edge)


def _rims(member: NetworkRoad, span: Span) -> list[Array]:
    return lines_of(member, span.start, span.end)[2:]


def _up(points: Array, height: float) -> Array:
    return points + [0.0, 0.0, height]


def _quad(a: Array, b: Array, c: Array, d: Array) -> Array:
    return np.array([[a, b, c], [a, c, d]])


def _bridge(member: NetworkRoad, span: Span, ground: Ground) -> Iterator[Array]:
    left, right = _rims(member, span)
    across = left - right
    unit = across / np.linalg.norm(across, axis=1, keepdims=True)
    length = span.end - span.start
    count = max(0, round(length / PIERS) - 1)
    depth = max(DEEP[0], DEEP[1] * length / (count + 1))
    low_left, low_right = _up(left, -depth), _up(right, -depth)
    yield from (sheet(left, low_left), sheet(low_right, right), sheet(low_left, low_right))
    for rim, way in ((left, -1.0), (right, 1.0)):
        inner = rim + way * THICK * unit
        outside, inside = (rim, inner) if way < 0 else (inner, rim)  # left and right edge of the wall
        yield sheet(_up(inside, PARAPET), _up(outside, PARAPET))
        yield sheet(outside, _up(outside, PARAPET))[:, ::-1]
        yield sheet(inside, _up(inside, PARAPET))
        for at, end in ((0, 1), (-1, -1)):
            corners = inside[at], outside[at], _up(outside[at], PARAPET), _up(inside[at], PARAPET)
            yield _quad(*corners[::-end])
    middle, half = (left + right) / 2, np.linalg.norm(across, axis=1) / 2 * PIER[1]
    for n in range(1, count + 1):
        k = round(n * (len(left) - 1) / (count + 1))
        foot = float(ground.height(*middle[k, :2, None])[0]) - FOOTING
        top = middle[k, 2] - depth
        if top - foot < 2 * FOOTING:
            continue
        ahead = np.array([unit[k, 1], -unit[k, 0], 0.0]) * PIER[0] / 2
        side = unit[k] * half[k]
        ring = [middle[k] + a * ahead + b * side for a, b in ((1, -1), (1, 1), (-1, 1), (-1, -1), (1, -1))]
        flat = np.array(ring) * [1.0, 1.0, 0.0]
        yield sheet(flat + [0.0, 0.0, foot], flat + [0.0, 0.0, top])


def _tunnel(member: NetworkRoad, span: Span, ground: Ground) -> Iterator[Array]:
    left, right = _rims(member, span)
    high_left, high_right = _up(left, CLEAR), _up(right, CLEAR)
    yield from (sheet(left, high_left), sheet(high_right, right), sheet(high_left, high_right))
    for at, way in ((0, 1.0), (-1, -1.0)):
        a, b = (right[at], left[at]) if way > 0 else (left[at], right[at])  # right and left of who drives in
        out = (b - a) / np.linalg.norm(b - a)
        beside = [a - FACE[0] * out, b + FACE[0] * out]
        top = COVER + FACE[1]
        base = [_up(each, -FACE[1]) for each in beside]
        crown = [np.array([*each[:2], min(a[2], b[2]) + top]) for each in beside]
        roof = [_up(a, CLEAR), _up(b, CLEAR)]
        feet = [_up(a, -FACE[1]), _up(b, -FACE[1])]
        over = [np.array([*each[:2], crown[0][2]]) for each in (a, b)]
        yield _quad(crown[0], over[0], feet[0], base[0])
        yield _quad(over[1], crown[1], base[1], feet[1])
        yield _quad(over[0], over[1], roof[1], roof[0])
