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
``"left_hand": true``, traffic drives on the left.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool

from roadgpt.brief.junctions import Control, PlainKind
from roadgpt.errors import UsageError
from roadgpt.network.design import KERB, is_left_hand, read_part
from roadgpt.network.map_check import check_graph, check_route
from roadgpt.network.pose import mirrored_point
from roadgpt.road.design import Finite, FrozenFields, as_written
from roadgpt.road.road import FARTHEST

KEY = re.compile(r"node([1-9][0-9]{0,5})")
MOST_NODES = 400
MOST_ROADS = 800
MOST_PASSED = 1000
"""The largest number of nodes that a route may pass."""
BEND = 20.0  # m, radius of a bend whose design gives none

NodeKind = Literal[PlainKind, "bend", "end"]


class MapLanes(FrozenFields):
    """The lanes of all roads of a map: one in each direction."""

    width: Annotated[float, Field(ge=2, le=10, allow_inf_nan=False)] = 4.0
    """Width of every lane in metres."""


class MapNode(FrozenFields):
    """A junction, a bend or an end of a road."""

    at: tuple[Finite, Finite, Finite]
    """x, y and the height in metres of the point where the roads of a junction meet, where a road ends, or
    where the two straights at a bend would meet.
    """
    kind: NodeKind
    control: Control = "none"
    """The signs of a junction: "lights" for all its roads, "stop" or "yield" for its minor roads; see
    ``map_growing.signs_at``.
    """
    kerb: Annotated[float, Field(ge=1, le=100, allow_inf_nan=False)] = KERB
    """Radius in metres of the kerb between two neighbouring roads of a junction; not for roundabouts."""
    radius: Annotated[float, Field(ge=1, le=2000, allow_inf_nan=False)] | None = None
    """Radius in metres of the island of a roundabout, or of a bend; None for 16 m or 20 m, respectively."""

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

    def mirrored(self, middle: float = 0.0) -> "MapDesign":
        """Returns the map with left and right exchanged, and traffic on the other side.

        Args:
            middle: The y in metres of the mirror line, which is parallel to the x axis.
        """
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
        """The chains of roads that lead over bends from one junction or end of a road to the next.

        Each chain is given by the nodes along it, and is listed once, in one of its two directions.
        """
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


def has_nodes(data: Any) -> bool:
    """Returns whether parsed JSON is a design of a map: whether it has a field such as ``node1``."""
    return isinstance(data, Mapping) and any(KEY.fullmatch(str(key)) for key in data)


def read_map_design(data: Mapping[str, Any]) -> tuple[MapDesign, tuple[str, ...]]:
    """Reads a dictionary in RoadGPT's JSON format of maps; returns the design and an empty tuple of remarks.

    Raises:
        UsageError: A field is missing, misnamed, of the wrong type or out of range, or the roads or the route
            do not fit the nodes; see ``map_check``.
    """
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
    check_graph([node.kind for node in nodes], [node.at for node in nodes], made.roads)
    if made.route:
        check_route([node.kind for node in nodes], made.roads, made.route)
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
    """Returns the numbers of nodes in a list of two or more.

    Raises:
        UsageError: ``raw`` is not a list of 2 to ``most`` whole numbers.
    """
    is_list = isinstance(raw, (list, tuple)) and 2 <= len(raw) <= most
    if not is_list or any(isinstance(each, bool) or not isinstance(each, int) for each in raw):
        count = "two" if most == 2 else "two or more"
        raise UsageError(f"{what} is a list of {count} numbers of nodes, such as [1, 2]")
    return list(raw)
