"""Finds the outermost edge of the ways through a junction, between two neighbouring arms.

With traffic on the right, the way that turns right into the next arm usually runs along the kerb between the
two arms. If the arms end at different distances, this right turn may begin or end with a straight line. The
way to another arm may then bend earlier, and its edge is up to 12 cm farther out than that of the right turn.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from roadgpt.geometry import Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.network import Connection, Junction, Network

EARLIER = 0.1  # m by which a way must bend earlier than the way along the kerb
LEAST = 0.001  # m; a smaller distance between two edges is ignored
STEP = 0.1  # m, approximate distance between two points of an edge


class Stretch(NamedTuple):
    """A part of a way through a junction."""

    road: int
    """The id of the connecting road."""
    start: float | None
    """The station in metres at which the part begins; None for the start of the road."""
    end: float | None
    """The station in metres at which the part ends; None for the end of the road."""


def outermost(network: Network, junction: Junction, right: Connection) -> list[Stretch]:
    """Returns the parts of ways whose right edges together form the outermost edge between two arms.

    The parts are in driving order.

    Args:
        network: The network, with traffic on the right.
        junction: A junction of the network.
        right: The way from one of the two arms to the next arm counter-clockwise.
    """
    before = [c for c in junction.connections if c.incoming == right.incoming and c is not right]
    behind = [c for c in junction.connections if c.outgoing == right.outgoing and c is not right]
    first, last = _before(network, before, right, 1), _before(network, behind, right, -1)
    length = network.road(right.road).road.length
    if first is not None and last is not None and first[2] >= length - last[2]:
        return [Stretch(right.road, None, None)]
    found = [Stretch(right.road, first and first[2], last and length - last[2])]
    if first is not None:
        found.insert(0, Stretch(first[0], None, first[1]))
    if last is not None:
        found.append(Stretch(last[0], network.road(last[0]).road.length - last[1], None))
    return found


def _before(
    network: Network, ways: Sequence[Connection], right: Connection, sense: int
) -> tuple[int, float, float] | None:
    """Returns the way that leads farthest beyond the edge of the way ``right`` where both begin or end.

    Args:
        network: The network.
        ways: The ways to choose from.
        right: The way along the kerb.
        sense: 1 where the ways begin, -1 where they end.

    Returns:
        The id of the connecting road, and two distances in metres from the common end of both ways to the
        point at which their edges cross: along the found way and along ``right``. None if no way leads beyond
        the edge.
    """
    line = _straight(network, right, sense)[0] - EARLIER
    if line <= 0:
        return None
    found = []
    for way in ways:
        straight, bends_right = _straight(network, way, sense)
        if bends_right and straight < line and (crossing := _crossing(network, way, right, sense)):
            found.append((crossing[0], (way.road, *crossing[1:])))
    return max(found)[1] if found else None


def _straight(network: Network, way: Connection, sense: int) -> tuple[float, bool]:
    """Returns the length in metres of the straight line at an end of a way, and whether it bends right."""
    plan = network.road(way.road).road.plan
    assert isinstance(plan, PieceCurve)
    pieces: Sequence[Piece] = plan.pieces[::sense]
    lengths = [piece.length for piece in pieces]
    bend = next((n for n, piece in enumerate(pieces) if piece.k0 or piece.k1), len(pieces))
    is_right = bend < len(pieces) and min(pieces[bend].k0, pieces[bend].k1) < 0
    return sum(lengths[:bend]), is_right


def _crossing(
    network: Network, way: Connection, right: Connection, sense: int
) -> tuple[float, float, float] | None:
    """Returns how far a way leads beyond the edge of ``right``, and the distances to where the edges cross.

    All values are in metres. None is returned if the way leads less than ``LEAST`` beyond the edge, or if the
    edges do not cross.
    """
    s, x, y = _edge(network, way, sense)
    s2, x2, y2 = _edge(network, right, sense)
    beyond = np.interp(x, x2, y2) - y
    beyond[x > x2[-1]] = -1.0
    farthest = int(np.argmax(beyond))
    if beyond[farthest] < LEAST:
        return None
    back = farthest + int(np.argmax(beyond[farthest:] <= 0))
    if beyond[back] > 0:
        return None
    share = beyond[back - 1] / (beyond[back - 1] - beyond[back])
    at = x[back - 1] + share * (x[back] - x[back - 1])
    return float(beyond[farthest]), float(np.interp(at, x, s)), float(np.interp(at, x2, s2))


def _edge(network: Network, way: Connection, sense: int) -> tuple[Array, Array, Array]:
    """Returns points of the right edge of a way as far as it turns by less than a right angle.

    The result is three arrays ``(n,)`` in metres: the distance from the start of the way, and the coordinates
    ahead of this start and to its left. With ``sense`` -1, the way is mirrored and followed backwards, so
    that its end is the start.
    """
    road = network.road(way.road).road
    assert road.profile is not None
    distance = np.linspace(0.0, road.length, max(2, round(road.length / STEP)))
    s = distance if sense > 0 else road.length - distance
    dx, dy = (road.at(s, road.profile.edges(s).right)[:, :2] - road.plan.at(s[0])).T
    heading = float(road.heading(s[0]))
    along = sense * (dx * np.cos(heading) + dy * np.sin(heading))
    count = int(np.argmin(np.diff(along) > 0)) if np.any(np.diff(along) <= 0) else len(along)
    aside = dy * np.cos(heading) - dx * np.sin(heading)
    return distance[:count], along[:count], aside[:count]
