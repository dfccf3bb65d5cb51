"""Defines the Network: roads that are joined by junctions and roundabouts.

Ids of roads, junctions and lanes are those of OpenDRIVE. Lanes on the left of a road's reference line have
positive ids, lanes on the right negative ids. If traffic drives on the right, lanes with negative ids are
driven along the road, and lanes with positive ids against it; if traffic drives on the left, it is the other
way round. Every junction has its own connecting roads, one for each way from one arm to another.

A road file with a route has two more fields: ``route``, a list of [road, lane], and ``network``."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast

from pydantic import TypeAdapter

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array, Point
from roadgpt.language.names import Control, PlainKind
from roadgpt.reading import strictly
from roadgpt.road import Profile, Road
from roadgpt.road.design import mirrored_point
from roadgpt.road.profile import width_at

if TYPE_CHECKING:
    from roadgpt.network.paved import Area

Contact = Literal["start", "end"]
OTHER_CONTACT: dict[Contact, Contact] = {"start": "end", "end": "start"}
Kind = Literal[PlainKind, "junction", "merge", "diverge"]
MOST_ROADS = 20_000
T_GAP = (145.0, 215.0)  # degrees, the largest gap between the arms of a T-junction
T_OTHERS = 55.0  # degrees, least other gap
Y_GAP = (85.0, 155.0)  # degrees, every gap between the arms of a fork
ALIKE = 0.01  # m, by which shoulders of the same width may differ
CROSSED = 35.0  # degrees, that opposite arms of crossroads may be off one line


def kinds_of(gaps: Sequence[float]) -> tuple[PlainKind, ...]:
    """Returns the kinds of junction that fit the angles between neighbouring arms, degrees; may be empty."""
    found: list[PlainKind] = []
    least, *_, most = sorted(gaps)
    if len(gaps) == 3:
        if least >= T_OTHERS and T_GAP[0] <= most <= T_GAP[1]:
            found.append("t_junction")
        if least >= Y_GAP[0] and most <= Y_GAP[1]:
            found.append("y_junction")
    elif len(gaps) == 4:
        if all(abs(gaps[n] + gaps[n + 1] - 180) <= CROSSED for n in range(2)):
            found.append("crossroads")
    elif len(gaps) > 4:
        found.append("star")
    return tuple(found)


class RoadEnd(NamedTuple):
    """One end of a road."""

    road: int  # the id of the road
    contact: Contact


class Leg(NamedTuple):
    """One road of a route, and the lane that the route follows there."""

    road: int  # the id of the road
    lane: int  # the id of the lane; ``Profile.leads_along`` says in which direction it is driven


@dataclass(frozen=True, eq=False)
class NetworkRoad:
    """A road of a network, or a connecting road of a junction."""

    id: int
    road: Road  # the geometry; its ``profile`` is never None
    junction: int | None = None
    """The id of the junction to which a connecting road belongs; None for other roads."""

    @property
    def profile(self) -> Profile:
        """The cross-section of the road."""
        assert self.road.profile is not None
        return self.road.profile

    @property
    def shoulder(self) -> float:
        """The ``reach`` of the road's profile less its ``paved_reach``, in metres: the width of the shoulders
        if both sides of the road are alike."""
        return self.profile.reach - self.profile.paved_reach

    def ids_towards(self, contact: Contact) -> tuple[int, ...]:
        """Returns the ids of the driving lanes that lead towards an end, from the centre line outwards."""
        return self.profile.along_ids if contact == "end" else self.profile.against_ids

    def side_towards(self, contact: Contact) -> int:
        """Returns the side on which traffic drives towards an end: 1 left of the reference line, -1 right."""
        return self.profile.side if contact == "end" else -self.profile.side

    def begin_towards(self, contact: Contact, s: float) -> float:
        """Returns the offset in metres, at station ``s``, of the inner edge of the lanes towards an end."""
        profile, ids, side = self.profile, self.ids_towards(contact), self.side_towards(contact)
        inside = (profile.left if side > 0 else profile.right)[: abs(ids[0]) - 1] if ids else ()
        return width_at(profile.offset, s) + side * sum(width_at(lane.width, s) for lane in inside)


class LaneLink(NamedTuple):
    """The ids of three lanes that lead one after another through a junction."""

    incoming: int  # the lane of the incoming road
    own: int  # the lane of the connecting road
    outgoing: int  # the lane of the outgoing road


@dataclass(frozen=True)
class Connection:
    """One way through a junction, along a connecting road from its start to its end."""

    road: int
    """The id of the connecting road."""
    incoming: RoadEnd
    outgoing: RoadEnd
    lanes: tuple[LaneLink, ...]


@dataclass(frozen=True)
class Continuation:
    """Two roads joined without a junction, where the number of lanes or the lane of the route changes, or
    people cross."""

    before: RoadEnd
    after: RoadEnd
    lanes: tuple[tuple[int, int], ...]
    """Pairs of lane ids that continue each other: of the road ``before``, and of the road ``after``."""
    crosswalk: bool = False  # whether there is a crosswalk at the end ``before``


@dataclass(frozen=True)
class Arm:
    """The end of a road at a junction."""

    end: RoadEnd
    direction: float  # the heading in radians out of the junction
    control: Control = "none"  # the sign or the light that traffic into the junction meets
    crosswalk: bool = False  # whether pedestrians cross the road there
    line: float | None = None  # m from the end of the road to its stop line, where a map says so


@dataclass(frozen=True)
class Junction:
    """A place where roads meet, with a connecting road for each way through it. A roundabout has one junction
    for each of its arms; see ``Roundabout``."""

    id: int
    kind: Kind
    arms: tuple[Arm, ...]
    """The arms in counter-clockwise order."""
    connections: tuple[Connection, ...]
    node: Point
    """The point in metres at which the reference lines of the arms meet; the centre of a roundabout."""
    kerb: float
    """The requested radius in metres of the kerbs between neighbouring arms; 0 for a merge or a diverge."""


@dataclass(frozen=True)
class Roundabout:
    """The junctions of one roundabout and the roads of its ring, both in driving order."""

    junctions: tuple[int, ...]
    ring: tuple[int, ...]
    centre: Point
    radius: float
    """The radius of the central island in metres."""
    width: float
    """The width of the circulatory roadway in metres."""


@dataclass(frozen=True, eq=False)
class Network:
    """Roads, the junctions that join them, and the roundabouts that consist of some of the junctions."""

    roads: tuple[NetworkRoad, ...]
    junctions: tuple[Junction, ...] = ()
    roundabouts: tuple[Roundabout, ...] = ()
    continuations: tuple[Continuation, ...] = ()

    def __post_init__(self) -> None:
        if len(self._by_id) < len(self.roads) or len(self._junction_by_id) < len(self.junctions):
            raise ValueError("two roads or two junctions of a network have the same id")
        for junction in self.junctions:
            named = {arm.end.road for arm in junction.arms}
            for connection in junction.connections:
                named |= {connection.road, connection.incoming.road, connection.outgoing.road}
            if unknown := named - self._by_id.keys():
                raise ValueError(f"junction {junction.id} names road {min(unknown)}, which does not exist")
        if len({each.profile.left_hand for each in self.roads}) > 1:
            raise ValueError("traffic drives on the left on some roads only")
        for each in self.continuations:
            if unknown := {each.before.road, each.after.road} - self._by_id.keys():
                raise ValueError(f"a continuation names road {min(unknown)}, which does not exist")

    def __repr__(self) -> str:
        metres = sum(each.road.length for each in self.roads if each.junction is None)
        kinds = ", ".join(kind.replace("_", "-") for kind, _ in self.nodes)
        return f"Network({len(self.plain_roads)} roads, {metres:.0f} m, junctions: {kinds or 'none'})"

    @cached_property
    def _by_id(self) -> dict[int, NetworkRoad]:
        return {each.id: each for each in self.roads}

    @cached_property
    def _junction_by_id(self) -> dict[int, Junction]:
        return {each.id: each for each in self.junctions}

    def road(self, number: int) -> NetworkRoad:
        """Returns the road with this id; raises KeyError if there is none."""
        return self._by_id[number]

    def junction(self, number: int) -> Junction:
        """Returns the junction with this id; raises KeyError if there is none."""
        return self._junction_by_id[number]

    @property
    def left_hand(self) -> bool:
        """Whether traffic drives on the left."""
        return bool(self.roads) and self.roads[0].profile.left_hand

    @cached_property
    def mirrored(self) -> "Network":
        """The network with the sign of y changed and traffic on the other side. Ids and order stay."""
        joints = [(each, tuple((-one, -two) for one, two in each.lanes)) for each in self.continuations]
        made = Network(
            tuple(replace(each, road=each.road.mirrored) for each in self.roads),
            tuple(map(_mirrored_junction, self.junctions)),
            tuple(replace(each, centre=mirrored_point(each.centre)) for each in self.roundabouts),
            tuple(replace(each, lanes=lanes) for each, lanes in joints),
        )
        made.__dict__["mirrored"] = self
        return made

    @property
    def right_hand(self) -> "Network":
        """The network or, if traffic drives on the left, its mirror image, so that computations with it need
        not handle traffic on the left."""
        return self.mirrored if self.left_hand else self

    def lanes_into(self, end: RoadEnd) -> tuple[int, ...]:
        """Returns the ids of the driving lanes that lead towards an end of a road, from mid-road outwards."""
        return self.road(end.road).ids_towards(end.contact)

    def lanes_out_of(self, end: RoadEnd) -> tuple[int, ...]:
        """Returns the ids of the driving lanes that lead away from an end of a road."""
        return self.road(end.road).ids_towards(OTHER_CONTACT[end.contact])

    @cached_property
    def plain_roads(self) -> tuple[NetworkRoad, ...]:
        """The roads that are not connecting roads; the pieces of rings are among them."""
        return tuple(each for each in self.roads if each.junction is None)

    @property
    def roads_outside(self) -> tuple[NetworkRoad, ...]:
        """The roads outside junctions and roundabouts."""
        return tuple(each for each in self.plain_roads if each.id not in self.roundabout_of)

    @cached_property
    def junction_at(self) -> dict[RoadEnd, int]:
        """Maps each end of a road at a junction to the id of the junction."""
        return {arm.end: junction.id for junction in self.junctions for arm in junction.arms}

    @cached_property
    def crossed(self) -> frozenset[RoadEnd]:
        """The ends of roads at which there is a crosswalk."""
        at_arms = (arm.end for each in self.junctions for arm in each.arms if arm.crosswalk)
        return frozenset((*at_arms, *(each.before for each in self.continuations if each.crosswalk)))

    @cached_property
    def connection_of(self) -> dict[int, tuple[Junction, Connection]]:
        """Maps the id of each connecting road to its junction and its connection."""
        return {each.road: (junction, each) for junction in self.junctions for each in junction.connections}

    @cached_property
    def continued_at(self) -> dict[RoadEnd, Continuation]:
        """Maps each end of a road that is part of a continuation to the continuation."""
        return {end: each for each in self.continuations for end in (each.before, each.after)}

    @cached_property
    def following(self) -> dict[Leg, list[Leg]]:
        """Maps each lane that goes on to the lanes that continue it, in the direction of its traffic."""
        found: dict[Leg, list[Leg]] = {}
        for _, way in self.connection_of.values():
            for incoming, own, outgoing in way.lanes:
                found.setdefault(Leg(way.incoming.road, incoming), []).append(Leg(way.road, own))
                found.setdefault(Leg(way.road, own), []).append(Leg(way.outgoing.road, outgoing))
        for each in self.continuations:
            towards = self.lanes_into(each.before)
            for before, after in each.lanes:
                pair = Leg(each.before.road, before), Leg(each.after.road, after)
                one, two = pair if before in towards else pair[::-1]
                found.setdefault(one, []).append(two)
        return found

    @cached_property
    def roundabout_of(self) -> dict[int, Roundabout]:
        """Maps the id of each junction, connecting road and ring road of a roundabout to the roundabout."""
        found: dict[int, Roundabout] = {}
        for ring in self.roundabouts:
            ways = (each.road for number in ring.junctions for each in self.junction(number).connections)
            found |= dict.fromkeys((*ring.junctions, *ring.ring, *ways), ring)
        return found

    @cached_property
    def nodes(self) -> tuple[tuple[Kind, tuple[Junction, ...]], ...]:
        """The junctions as a driver counts them, each with its kind; those of a roundabout count as one."""
        found: list[tuple[Kind, tuple[Junction, ...]]] = []
        for junction in self.junctions:
            ring = self.roundabout_of.get(junction.id)
            if ring is None:
                found.append((junction.kind, (junction,)))
            elif ring.junctions[0] == junction.id:
                found.append((junction.kind, tuple(map(self.junction, ring.junctions))))
        return tuple(found)

    @property
    def paved(self) -> "Area":
        """The area of all driving lanes, seen from above, without shoulders; small holes are filled."""
        return self._paved[0]

    @property
    def paved_nodes(self) -> "tuple[Area, ...]":
        """The paved area inside each of the ``nodes``, in their order."""
        return self._paved[1:]

    @cached_property
    def _paved(self) -> "tuple[Area, ...]":
        """The paved area of all roads, and the area inside each of the ``nodes``. Holes below ``ISLAND`` are
        paved, at roundabouts those below ``SLIVER``."""
        from roadgpt.network.paved import ISLAND, SLIVER, areas_of, covered_by, without_small_islands

        areas = dict(zip(self._by_id, areas_of([each.road for each in self._by_id.values()]), strict=True))
        inside = [[each.id for each in self.inside(junctions)] for _, junctions in self.nodes]
        nodes = [covered_by([areas.pop(number) for number in numbers]) for numbers in inside]
        least = [SLIVER if kind == "roundabout" else ISLAND for kind, _ in self.nodes]
        return without_small_islands(covered_by([*nodes, *areas.values()]), nodes, least)

    @cached_property
    def shoulder(self) -> float:
        """The usual width in metres of the shoulders, 0 for none: the median of the roads outside junctions
        that have any. On maps of other tools, single roads have strips of 40 m beside them."""
        found = sorted(each.shoulder for each in self.roads_outside if each.shoulder > 0)
        usual = found[len(found) // 2] if found else 0.0
        return max((each for each in found if each <= usual + ALIKE), default=0.0)

    def inside(self, junctions: tuple[Junction, ...]) -> list[NetworkRoad]:
        """Returns the connecting roads of the junctions in one of the ``nodes``, with the pieces of the ring
        if it is a roundabout."""
        ring = self.roundabout_of.get(junctions[0].id)
        numbers = [each.road for junction in junctions for each in junction.connections]
        return [self.road(number) for number in (*numbers, *(ring.ring if ring else ()))]

    def outline(self, junction: int) -> Array:
        """Returns the outline ``(n, 2)`` in metres of the paved area inside a junction, counter-clockwise."""
        from roadgpt.network.paved import outline_of, paved_by

        inside = [self.road(each.road).road for each in self.junction(junction).connections]
        return outline_of(paved_by(inside))

    def moved(self, x: float, y: float, z: float) -> "Network":
        """Returns the network shifted by these distances in metres along each axis. Ids and order stay."""

        def to(point: Point) -> Point:
            return point[0] + x, point[1] + y, point[2] + z

        return replace(
            self,
            roads=tuple(replace(each, road=each.road.moved(x, y, z)) for each in self.roads),
            junctions=tuple(replace(each, node=to(each.node)) for each in self.junctions),
            roundabouts=tuple(replace(each, centre=to(each.centre)) for each in self.roundabouts),
        )


def _mirrored_junction(junction: Junction) -> Junction:
    arms = tuple(replace(arm, direction=0.0 - arm.direction) for arm in junction.arms)
    connections = tuple(
        replace(each, lanes=tuple(LaneLink(*(-lane for lane in lanes)) for lanes in each.lanes))
        for each in junction.connections
    )
    node = mirrored_point(junction.node)
    return replace(junction, arms=(*arms[:1], *arms[:0:-1]), connections=connections, node=node)


_Parts = tuple[tuple[Junction, ...], tuple[Roundabout, ...], tuple[Continuation, ...]]
_NAMES = ("junctions", "roundabouts", "continuations")


def network_to_json(network: Network) -> dict[str, Any]:
    """Returns a network as JSON data for ``network_from_json``."""
    roads = [{"id": each.id, "junction": each.junction, **each.road.to_json()} for each in network.roads]
    parts = (network.junctions, network.roundabouts, network.continuations)
    plain = TypeAdapter(_Parts).dump_python(parts, mode="json", exclude_none=True)
    return {"roads": roads, **dict(zip(_NAMES, plain, strict=True))}


def network_from_json(data: Any) -> Network:
    """Restores a network from JSON data as returned by ``network_to_json``. Raises UsageError if a field is
    missing or of the wrong type, a road cannot be read or has no lanes, or the parts do not make a Network.
    """
    try:
        rows = data["roads"]
        if not isinstance(rows, list) or len(rows) > MOST_ROADS:
            raise ValueError(f"roads are a list of at most {MOST_ROADS:,}")
        roads = tuple(_road(row) for row in rows)
        junctions, rings = data["junctions"], data["roundabouts"]
        parts = [_with_lane_links(junctions), rings, data.get("continuations", [])]
        return Network(roads, *strictly(cast(type[_Parts], _Parts), parts))
    except KeyError as error:
        raise UsageError(f"the network cannot be read: {error} is missing; make the road again") from error
    except (TypeError, ValueError) as error:
        first = str(error).splitlines()[0][:200]
        raise UsageError(f"the network cannot be read ({first}); make the road again") from error


def _with_lane_links(junctions: Any) -> Any:
    """Adds the outgoing lane to lane links of older files, which have pairs. Their roads have one lane in
    each direction, so the missing id is 1 or -1."""
    found = copy.deepcopy(junctions)
    for junction in found:
        for each in junction["connections"]:
            after = -1 if each["outgoing"][1] == "start" else 1
            each["lanes"] = [[*lanes, after] if len(lanes) == 2 else lanes for lanes in each["lanes"]]
    return found


def _road(row: Mapping[str, Any]) -> NetworkRoad:
    number, junction = strictly(tuple[int, int | None], [row.get("id"), row.get("junction")])
    road = Road.from_json(row, in_network=True)
    if road.profile is None:
        raise ValueError(f"road {number} has no lanes")
    return NetworkRoad(number, road, junction)


def legs_from_json(data: Any) -> tuple[Leg, ...]:
    """Restores the legs of a route from a list of [road, lane]. Raises UsageError if it is something else."""
    try:
        return strictly(tuple[Leg, ...], data)
    except (TypeError, ValueError) as error:
        raise UsageError("a route is a list of [road, lane], two whole numbers each") from error
