"""Defines the MapDesign: the design of a map of roads and, if it has one, of a route through the map.

In JSON, the map is a graph: the nodes are junctions, bends and ends of roads, and roads join the nodes.

    "lanes": {"width": 3.5},
    "node1": {"at": [20, 80, 0], "kind": "end"},
    "node2": {"at": [80, 80, 0], "kind": "t_junction", "control": "stop", "kerb": 8},
    "node3": {"at": [150, 80, 1], "kind": "bend", "radius": 20}, ...
    "roads": [[1, 2], [2, 3], ...],
    "route": [1, 2, 4]

``at`` is x, y and the height in metres. Each pair in ``roads`` is a straight between two nodes; at a bend, a
curve leads from one straight to the next, so that several straights and bends may join two junctions.
``route`` lists the nodes that the tested car passes, in driving order; it may be left out. With
``"left_hand": true``, traffic drives on the left."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Field, StrictBool

from roadgpt.brief.junctions import Control, PlainKind
from roadgpt.errors import UsageError
from roadgpt.network.design import ASTERN, COUNTS, KERB, NetworkDesign, is_left_hand, read_part
from roadgpt.network.pose import mirrored_point
from roadgpt.plural import plural
from roadgpt.road import Design, Road
from roadgpt.road.design import Finite, FrozenFields, as_written
from roadgpt.road.road import FARTHEST

KEY = re.compile(r"node([1-9][0-9]{0,5})")
MOST_NODES = 400
MOST_ROADS = 800
MOST_PASSED = 1000
"""The largest number of nodes that a route may pass."""
BEND = 20.0  # m, radius of a bend whose design gives none
NEAREST = 1.0  # m, least distance between two nodes that a road joins
STEEPEST_BEND = 150.0  # degrees, largest angle by which a road may turn at a bend

ROADS: dict[str, tuple[int, int]] = {
    "end": (1, 1),
    "bend": (2, 2),
    **{kind: (least + 1, most + 1) for kind, (least, most) in COUNTS.items()},
}
"""The smallest and the largest number of roads at a node of each kind."""

NodeKind = Literal[PlainKind, "bend", "end"]


class MapLanes(FrozenFields):
    """The lanes of all roads of a map: one in each direction."""

    width: Annotated[float, Field(ge=2, le=10, allow_inf_nan=False)] = 4.0
    """Width of every lane in metres."""


class MapNode(FrozenFields):
    """A junction, a bend or an end of a road."""

    at: tuple[Finite, Finite, Finite]
    """x, y and the height in metres of the point where the roads of a junction meet, where a road ends, or
    where the two straights at a bend would meet."""
    kind: NodeKind
    control: Control = "none"
    """The signs of a junction: "lights" for all its roads, "stop" or "yield" for its minor roads; see
    ``growing.signs_at``."""
    kerb: Annotated[float, Field(ge=1, le=100, allow_inf_nan=False)] = KERB
    """Radius in metres of the kerb between two neighbouring roads of a junction; not for roundabouts."""
    radius: Annotated[float, Field(ge=1, le=2000, allow_inf_nan=False)] | None = None
    """Radius in metres of the island of a roundabout (None for 16 m), or of a bend (None for 20 m)."""

    @property
    def is_junction(self) -> bool:
        """Whether the node is a junction or a roundabout."""
        return self.kind not in ("bend", "end")


class MapDesign(FrozenFields):
    """Nodes, the roads between them, and a route along nodes, or none. Nodes are numbered from 1."""

    nodes: Annotated[tuple[MapNode, ...], Field(min_length=2, max_length=MOST_NODES)]
    roads: Annotated[tuple[tuple[int, int], ...], Field(min_length=1, max_length=MOST_ROADS)]
    """The two nodes that each road joins."""
    route: Annotated[tuple[int, ...], Field(max_length=MOST_PASSED)] = ()
    """Two or more nodes in driving order; empty for a map without a route."""
    lanes: MapLanes | None = None
    """The lanes of all roads; None for the lane width of the World."""
    left_hand: StrictBool = False
    """Whether traffic drives on the left."""

    def __repr__(self) -> str:
        kinds = [node.kind.replace("_", "-") for node in self.nodes if node.is_junction]
        count = {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
        said = ", ".join(f"{number} {kind}" for kind, number in count.items())
        return f"MapDesign({len(self.roads)} roads, junctions: {said or 'none'})"

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Returns a copy with some fields changed; what was computed from the fields is computed anew."""
        fresh = super().model_copy(update=update, deep=deep)
        for computed in vars(fresh).keys() - type(self).model_fields.keys():
            del vars(fresh)[computed]
        return fresh

    def mirrored(self, middle: float = 0.0) -> "MapDesign":
        """Returns the map mirrored about the line y = ``middle`` metres, with traffic on the other side."""
        nodes = tuple(node.model_copy(update={"at": mirrored_point(node.at, middle)}) for node in self.nodes)
        return self.model_copy(update={"nodes": nodes, "left_hand": not self.left_hand})

    def node(self, number: int) -> MapNode:
        """Returns a node by its number, which counts from 1."""
        return self.nodes[number - 1]

    def direction(self, one: int, other: int) -> float:
        """Returns the heading in radians from one node to another."""
        (x, y, _), (to_x, to_y, _) = self.node(one).at, self.node(other).at
        return math.atan2(to_y - y, to_x - x)

    @cached_property
    def neighbours(self) -> dict[int, tuple[int, ...]]:
        """For each node, the nodes at the other ends of its roads, counter-clockwise by direction."""
        found: dict[int, list[int]] = {number: [] for number in range(1, len(self.nodes) + 1)}
        for one, other in self.roads:
            found[one].append(other)
            found[other].append(one)
        return {n: tuple(sorted(ends, key=lambda end: self.direction(n, end))) for n, ends in found.items()}

    @cached_property
    def chains(self) -> tuple[tuple[int, ...], ...]:
        """The chains of roads that lead over bends from one junction or end of a road to the next. Each is
        given by the nodes along it, and is listed once, in one of its two directions."""
        found: dict[tuple[int, ...], None] = {}
        for start, ends in self.neighbours.items():
            if self.node(start).kind == "bend":
                continue
            for end in ends:
                nodes = [start, end]
                while self.node(nodes[-1]).kind == "bend":
                    before, here = nodes[-2:]
                    nodes.append(next(each for each in self.neighbours[here] if each != before))
                if tuple(reversed(nodes)) not in found:
                    found[tuple(nodes)] = None
        return tuple(found)

    @property
    def driven(self) -> Iterator[tuple[int, ...]]:
        """The route, cut at its junctions: for each part, the nodes along this part."""
        first = 0
        for n in range(1, len(self.route)):
            if self.node(self.route[n]).kind != "bend":
                yield self.route[first : n + 1]
                first = n

    def to_json(self) -> dict[str, Any]:
        """Returns the design as a dictionary in RoadGPT's JSON format."""
        out: dict[str, Any] = {}
        if self.left_hand:
            out["left_hand"] = True
        if self.lanes is not None:
            out["lanes"] = self.lanes.model_dump()
        for number, node in enumerate(self.nodes, 1):
            fields = node.model_dump(exclude_none=True, exclude_defaults=True)
            written = {key: as_written(value) for key, value in fields.items()}
            out[f"node{number}"] = {**written, "at": [as_written(each) for each in node.at]}
        out["roads"] = [list(pair) for pair in self.roads]
        if self.route:
            out["route"] = list(self.route)
        return out


AnyDesign = Design | NetworkDesign | MapDesign
"""A design of a road, of a route through junctions, or of a map with one route."""
Blueprint = AnyDesign | Road
"""Anything from which ``made_from`` makes a road."""


def has_nodes(data: Any) -> bool:
    """Returns whether parsed JSON is a design of a map: whether it has a field such as ``node1``."""
    return isinstance(data, Mapping) and any(KEY.fullmatch(str(key)) for key in data)


def read_map_design(data: Mapping[str, Any]) -> tuple[MapDesign, tuple[str, ...]]:
    """Reads a dictionary in RoadGPT's JSON format of maps; returns the design and an empty tuple of remarks.
    Raises UsageError if a field is missing, misnamed, of the wrong type or out of range, or the roads or the
    route do not fit the nodes."""
    numbered = {int(found[1]): raw for key, raw in data.items() if (found := KEY.fullmatch(str(key)))}
    for key in data:
        if not KEY.fullmatch(str(key)) and key not in ("lanes", "left_hand", "roads", "route"):
            raise UsageError(
                f"the map has a field '{str(key)[:40]}' that is unknown; the fields are lanes, left_hand, "
                "node1, node2, ..., roads and route"
            )
    if sorted(numbered) != [*range(1, len(numbered) + 1)] or not 2 <= len(numbered) <= MOST_NODES:
        raise UsageError(f"the nodes of a map are numbered node1, node2 and so on, 2 to {MOST_NODES} of them")
    nodes = [_node(number, numbered[number]) for number in sorted(numbered)]
    roads = tuple((pair[0], pair[1]) for pair in _pairs(data.get("roads")))
    lanes, route = data.get("lanes"), data.get("route")
    made = MapDesign(
        nodes=tuple(nodes),
        roads=roads,
        route=() if route in (None, [], ()) else tuple(_numbers(route, "the route", MOST_PASSED)),
        lanes=None if lanes is None else read_part(MapLanes, "the lanes of the map", lanes, "width"),
        left_hand=is_left_hand(data),
    )
    ends = _checked_ends(made)
    for number, others in ends.items():
        _check_node(made, number, others)
    _check_connected(made, ends)
    if made.route:
        _check_route(made)
    return made, ()


def _node(number: int, raw: Any) -> MapNode:
    what, at = f"node {number}", raw.get("at", ...) if isinstance(raw, Mapping) else ...
    if at is not ... and (not isinstance(at, (list, tuple)) or len(at) != 3):
        raise UsageError(f"{what} cannot be read: at: give x, y and the height, as in [20, 80, 0]")
    node = read_part(MapNode, what, raw, "at and kind")
    if max(map(abs, node.at)) > FARTHEST:
        raise UsageError(f"{what} is beyond {FARTHEST:,.0f}; give smaller numbers")
    return node


def _pairs(raw: Any) -> list[Sequence[int]]:
    if not isinstance(raw, (list, tuple)) or not 1 <= len(raw) <= MOST_ROADS:
        raise UsageError(f"roads are a list of 1 to {MOST_ROADS} pairs of nodes, such as [[1, 2], [2, 3]]")
    return [_numbers(pair, f"road {number}", 2) for number, pair in enumerate(raw, 1)]


def _numbers(raw: Any, what: str, most: int) -> Sequence[int]:
    is_list = isinstance(raw, (list, tuple)) and 2 <= len(raw) <= most
    if not is_list or any(isinstance(each, bool) or not isinstance(each, int) for each in raw):
        count = "two" if most == 2 else "two or more"
        raise UsageError(f"{what} is a list of {count} numbers of nodes, such as [1, 2]")
    return list(raw)


def _checked_ends(design: MapDesign) -> dict[int, list[int]]:
    """Returns for each node the nodes at the other ends of its roads. Raises UsageError unless every road
    joins two existing nodes that are at least ``NEAREST`` metres apart, and no two roads join the same nodes.
    """
    ends: dict[int, list[int]] = {number: [] for number in range(1, len(design.nodes) + 1)}
    for number, (one, other) in enumerate(design.roads, 1):
        for each in (one, other):
            if each not in ends:
                raise UsageError(
                    f"road {number} names node {each}, and there are nodes 1 to {len(design.nodes)}"
                )
        if one == other:
            raise UsageError(f"road {number} joins node {one} to itself; give two different nodes")
        if other in ends[one]:
            raise UsageError(
                f"two roads join nodes {one} and {other}; leave one out, or lead it over another node"
            )
        if math.dist(design.node(one).at[:2], design.node(other).at[:2]) < NEAREST:
            raise UsageError(
                f"nodes {one} and {other} are less than {NEAREST:g} m apart; move them apart or make them one"
            )
        ends[one].append(other)
        ends[other].append(one)
    return ends


def _check_node(design: MapDesign, number: int, others: Sequence[int]) -> None:
    kind = design.node(number).kind
    fewest, most = ROADS[kind]
    if not fewest <= len(others) <= most:
        wanted = plural(most, "road") if fewest == most else f"{fewest} to {most} roads"
        here = plural(len(others), "road")
        name = f"{'an' if kind == 'end' else 'a'} {kind}"
        raise UsageError(
            f"node {number} is {name}, which has {wanted}, and here it has {here}; change its kind or the "
            "roads"
        )
    if len(others) < 2:
        return
    out = sorted((math.degrees(design.direction(number, n)), n) for n in others)
    least = 180 - STEEPEST_BEND if kind == "bend" else ASTERN
    for (a, one), (b, other) in pairwise([*out, (out[0][0] + 360, out[0][1])]):
        if b - a < least - 1e-9:
            raise UsageError(
                f"the roads from node {number} to nodes {one} and {other} are {b - a:.0f} degrees apart, and "
                f"{least:g} are needed; move one of these nodes"
            )


def _check_connected(design: MapDesign, ends: Mapping[int, Sequence[int]]) -> None:
    if all(node.kind == "bend" for node in design.nodes):
        raise UsageError("all nodes are bends, so that no road begins or ends; add an end or a junction")
    seen, waiting = {1}, [1]
    while waiting:
        new = [n for n in ends[waiting.pop()] if n not in seen]
        seen.update(new)
        waiting += new
    lost = next((number for number in ends if number not in seen), None)
    if lost is not None:
        raise UsageError(f"no roads lead from node 1 to node {lost}; join them or leave node {lost} out")


def _check_route(design: MapDesign) -> None:
    route, joined = design.route, {frozenset(pair) for pair in design.roads}
    for one, other in pairwise(route):
        if frozenset((one, other)) not in joined:
            raise UsageError(f"the route goes from node {one} to node {other}, and no road joins them")
    for number in (route[0], route[-1]):
        if design.node(number).kind == "bend":
            raise UsageError(f"the route begins or ends at node {number}, a bend; take a junction or an end")
    for before, here, after in zip(route, route[1:], route[2:], strict=False):
        if before == after and design.node(here).kind != "roundabout":
            raise UsageError(
                f"the route turns back at node {here}, and one can only at a roundabout; leave out the rest"
            )
