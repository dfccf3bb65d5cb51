"""Defines the Network: roads that are joined by junctions and roundabouts.

Ids of roads, junctions and lanes are those of OpenDRIVE. Lanes on the right of a road's reference line have
negative ids and are driven along the road; lanes on its left have positive ids and are driven against it.
With traffic on the left, lanes with positive ids are driven along the road. Every junction has its own
connecting roads, one for each way from one arm to another.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.junctions import Control, PlainKind
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.network.paved import (
    ISLAND,
    SLIVER,
    areas_of,
    covered_by,
    outline_of,
    paved_by,
    without_small_islands,
)
from roadgpt.network.polygon import Area
from roadgpt.network.pose import Point, mirrored_point
from roadgpt.road import Profile, Road
from roadgpt.road.profile import Lane

Contact = Literal["start", "end"]
Kind = Literal[PlainKind, "merge", "diverge"]


class RoadEnd(NamedTuple):
    """One end of a road."""

    road: int
    """The id of the road."""
    contact: Contact


class Leg(NamedTuple):
    """One road of a route."""

    road: int
    """The id of the road."""
    lane: int
    """The id of the lane that the route follows; ``Profile.leads_along`` says in which direction."""


@dataclass(frozen=True, eq=False)
class NetworkRoad:
    """A road of a network, or a connecting road of a junction."""

    id: int
    road: Road
    """The geometry; its ``profile`` is never None."""
    junction: int | None = None
    """The id of the junction, if this is a connecting road."""

    @property
    def profile(self) -> Profile:
        """The lanes of the road."""
        assert self.road.profile is not None
        return self.road.profile

    @property
    def shoulder(self) -> float:
        """The width of its wider shoulder in metres, at most."""
        return self.profile.reach - self.profile.paved_reach

    def ids_towards(self, contact: Contact) -> range:
        """Returns the ids of the driving lanes that lead towards one of its ends, from the centre line
        outwards.
        """
        return self.profile.along_ids if contact == "end" else self.profile.against_ids

    def lanes_towards(self, contact: Contact) -> tuple[Lane, ...]:
        """Returns the lanes that lead towards one of its ends and their shoulder, from the centre line
        outwards.
        """
        return self.profile.along if contact == "end" else self.profile.against

    def side_towards(self, contact: Contact) -> int:
        """Returns 1 if traffic towards this end is on the left of the reference line, -1 if on the right."""
        return self.profile.side if contact == "end" else -self.profile.side

    def begin_towards(self, contact: Contact, s: float) -> float:
        """Returns the offset in metres at station ``s`` at which the lanes towards an end begin."""
        offset, (left, right) = self.profile.offset, self.profile.begins
        line = float(self.profile.centre(s)) if isinstance(offset, CubicProfile) else offset
        return line + left if self.side_towards(contact) > 0 else line - right


class LaneLink(NamedTuple):
    """The ids of three lanes that continue each other through a junction."""

    incoming: int
    """The lane of the incoming road."""
    own: int
    """The lane of the connecting road."""
    outgoing: int
    """The lane of the outgoing road."""


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
    """Two roads that continue each other without a junction, because the number of lanes changes there."""

    before: RoadEnd
    after: RoadEnd
    lanes: tuple[tuple[int, int], ...]
    """Pairs of lane ids: lane of the road before, lane of the road after."""


@dataclass(frozen=True)
class Arm:
    """A road where it meets a junction."""

    end: RoadEnd
    direction: float
    """The heading in radians out of the junction."""
    control: Control = "none"
    """The sign or the light at which traffic into the junction has to stop or give way."""
    crosswalk: bool = False
    """Whether pedestrians cross the road there."""


@dataclass(frozen=True)
class Junction:
    """A place where roads meet, with a connecting road for each way through it.

    A roundabout has one junction for each of its arms; see ``Roundabout``.
    """

    id: int
    kind: Kind
    arms: tuple[Arm, ...]
    """The arms in counter-clockwise order."""
    connections: tuple[Connection, ...]
    node: Point
    """The point in metres at which the reference lines of the arms meet; the centre of a roundabout."""
    kerb: float
    """The radius in metres that was asked for where the kerbs of two neighbouring arms meet."""


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
    """Roads, the junctions that join them, and the roundabouts among these.

    Raises:
        ValueError: Two roads or two junctions have the same id, an arm or a connection names a road that does
            not exist, or traffic drives on the left on some roads only.
    """

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
            if unknown := named - set(self._by_id):
                raise ValueError(f"junction {junction.id} names road {min(unknown)}, which does not exist")
        if len({each.profile.left_hand for each in self.roads}) > 1:
            raise ValueError("traffic drives on the left on some roads only")
        for each in self.continuations:
            if unknown := {each.before.road, each.after.road} - set(self._by_id):
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
        """Returns the road with this id.

        Raises:
            KeyError: There is no such road.
        """
        return self._by_id[number]

    def junction(self, number: int) -> Junction:
        """Returns the junction with this id.

        Raises:
            KeyError: There is no such junction.
        """
        return self._junction_by_id[number]

    @property
    def left_hand(self) -> bool:
        """Whether traffic drives on the left."""
        return bool(self.roads) and self.roads[0].profile.left_hand

    @cached_property
    def mirrored(self) -> "Network":
        """The network with the sign of y changed, with traffic on the other side of its roads. Roads,
        junctions and roundabouts keep their ids and their order.
        """
        made = Network(
            tuple(replace(each, road=each.road.mirrored) for each in self.roads),
            tuple(map(_mirrored_junction, self.junctions)),
            tuple(replace(each, centre=mirrored_point(each.centre)) for each in self.roundabouts),
            tuple(
                replace(each, lanes=tuple((-one, -two) for one, two in each.lanes))
                for each in self.continuations
            ),
        )
        made.__dict__["mirrored"] = self
        return made

    @property
    def right_hand(self) -> "Network":
        """The network itself, or its mirror image if traffic drives on the left.

        What is defined for traffic on the right is computed there, once for both.
        """
        return self.mirrored if self.left_hand else self

    def leaves_by(self, leg: Leg) -> RoadEnd:
        """Returns the end of a road towards which a lane leads."""
        is_along = self.road(leg.road).profile.leads_along(leg.lane)
        return RoadEnd(leg.road, "end" if is_along else "start")

    def enters_by(self, leg: Leg) -> RoadEnd:
        """Returns the end of a road from which a lane leads."""
        is_along = self.road(leg.road).profile.leads_along(leg.lane)
        return RoadEnd(leg.road, "start" if is_along else "end")

    @cached_property
    def plain_roads(self) -> tuple[NetworkRoad, ...]:
        """The roads outside junctions, among them the pieces of rings."""
        return tuple(each for each in self.roads if each.junction is None)

    @cached_property
    def junction_at(self) -> dict[RoadEnd, int]:
        """The id of the junction at each end of a road that meets one."""
        return {arm.end: junction.id for junction in self.junctions for arm in junction.arms}

    @cached_property
    def crossed(self) -> frozenset[RoadEnd]:
        """The ends of roads with a crosswalk."""
        return frozenset(arm.end for each in self.junctions for arm in each.arms if arm.crosswalk)

    @cached_property
    def connection_of(self) -> dict[int, tuple[Junction, Connection]]:
        """For the id of each connecting road, its junction and its connection."""
        return {each.road: (junction, each) for junction in self.junctions for each in junction.connections}

    @cached_property
    def continued_at(self) -> dict[RoadEnd, Continuation]:
        """The continuation at each end of a road that another road continues without a junction."""
        return {end: each for each in self.continuations for end in (each.before, each.after)}

    @cached_property
    def roundabout_of(self) -> dict[int, Roundabout]:
        """The roundabout to which a junction or a road belongs, by the id of the junction or the road."""
        pairs = [
            (number, ring)
            for ring in self.roundabouts
            for number in (*ring.junctions, *ring.ring, *self._connecting(ring.junctions))
        ]
        return dict(pairs)

    def _connecting(self, junctions: Sequence[int]) -> list[int]:
        return [each.road for number in junctions for each in self.junction(number).connections]

    @cached_property
    def nodes(self) -> tuple[tuple[Kind, tuple[Junction, ...]], ...]:
        """The junctions as a driver counts them: each with its kind; those of one roundabout are one."""
        found: list[tuple[Kind, tuple[Junction, ...]]] = []
        for junction in self.junctions:
            ring = self.roundabout_of.get(junction.id)
            if ring is None:
                found.append((junction.kind, (junction,)))
            elif ring.junctions[0] == junction.id:
                found.append((junction.kind, tuple(map(self.junction, ring.junctions))))
        return tuple(found)

    @property
    def paved(self) -> Area:
        """The area of all lanes for driving, seen from above, without shoulders."""
        return self._paved[0]

    @property
    def paved_nodes(self) -> tuple[Area, ...]:
        """The paved area inside each of the ``nodes``."""
        return self._paved[1:]

    @cached_property
    def _paved(self) -> tuple[Area, ...]:
        """The paved area of all roads, and those inside each of the ``nodes``. Where roads cross, small holes
        between ways are paved; roundabouts have smaller islands."""
        areas = dict(zip(self._by_id, areas_of([each.road for each in self._by_id.values()]), strict=True))
        inside = [[each.id for each in self.inside(junctions)] for _, junctions in self.nodes]
        nodes = [covered_by([areas.pop(number) for number in numbers]) for numbers in inside]
        least = [SLIVER if kind == "roundabout" else ISLAND for kind, _ in self.nodes]
        return without_small_islands(covered_by([*nodes, *areas.values()]), nodes, least)

    def inside(self, junctions: tuple[Junction, ...]) -> list[NetworkRoad]:
        """Returns the connecting roads of some junctions and, for those of a roundabout, the pieces of its
        ring."""
        ring = self.roundabout_of.get(junctions[0].id)
        numbers = [each.road for junction in junctions for each in junction.connections]
        return [self.road(number) for number in (*numbers, *(ring.ring if ring else ()))]

    def outline(self, junction: int) -> Array:
        """Returns the outline ``(n, 2)`` in metres of the paved area inside a junction, counter-clockwise.

        Raises:
            KeyError: There is no such junction.
        """
        inside = [self.road(each.road).road for each in self.junction(junction).connections]
        return outline_of(paved_by(inside))

    def bounds(self) -> Array:
        """Returns the smallest and the largest x and y of the paved area, ``(2, 2)``, in metres."""
        return np.array(self.paved.bounds, float).reshape(2, 2)


def _mirrored_junction(junction: Junction) -> Junction:
    """Returns the mirror image of a junction; its first arm stays the first one."""
    arms = tuple(replace(arm, direction=0.0 - arm.direction) for arm in junction.arms)
    connections = tuple(
        replace(each, lanes=tuple(LaneLink(*(-lane for lane in lanes)) for lanes in each.lanes))
        for each in junction.connections
    )
    node = mirrored_point(junction.node)
    return replace(junction, arms=(*arms[:1], *arms[:0:-1]), connections=connections, node=node)
