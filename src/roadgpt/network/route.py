"""Defines the Route: a way through a network. A Route is itself a Road.

The centre line of a Route consists of the reference lines of its roads, one after another. Everything that
can be done with a Road can be done with a Route: check, drive, judge and draw it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, groupby, pairwise
from typing import Any, ClassVar, Self

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.elevation import Cubic
from roadgpt.network.ground import shoulders_on_ground
from roadgpt.network.lane_along import LaneAlong, added, change_windows, cubics_at, lane_along
from roadgpt.network.network import Continuation, Leg, Network, NetworkRoad
from roadgpt.network.network_json import network_to_json
from roadgpt.network.passages import Passage, passages_of
from roadgpt.network.stretch import joined_grades, joined_plans
from roadgpt.road import Profile, Road
from roadgpt.road.moving import reversed_cubics, reversed_road
from roadgpt.road.profile import Lane, Marking, Width


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Route(Road):
    """A way through a network.

    Its profile has the lane that the route follows, and on each side of this lane a single lane that is as
    wide as all lanes of that side together. Inside junctions the profile has no oncoming lanes, and no
    shoulders until ``on_ground`` adds them.

    A network through which no route was asked for is a Route without legs; see ``has_no_route``. Nothing can
    drive such a Route. Its centre line is that of the network's first road outside junctions.
    """

    is_route: ClassVar[bool] = True
    network: Network
    legs: tuple[Leg, ...]

    @classmethod
    def along(cls, network: Network, legs: Sequence[Leg]) -> Self:
        """Returns the route that follows these legs through a network, in this order. ``legs`` may be empty.

        Raises:
            UsageError: The network has no road outside junctions, a road or a lane does not exist, two legs
                that follow each other are not joined, or the route begins or ends inside a junction.
        """
        legs = tuple(map(Leg._make, legs))
        for leg in legs:
            _check_leg(network, leg)
        for one, two in pairwise(legs):
            _check_joint(network, one, two)
        if network.left_hand:
            return cls.along(network.mirrored, _mirrored_legs(legs)).mirrored
        if not legs and not network.roads_outside:
            raise UsageError("the network has no road outside junctions; make the road again")
        followed = legs or (Leg(network.roads_outside[0].id, -1),)
        if any(network.road(followed[n].road).junction is not None for n in (0, -1)):
            raise UsageError("a route begins and ends on a road outside junctions")
        roads, lanes = _parts(network, followed)
        plan, heights = joined_plans(roads), joined_grades(roads)
        return cls(plan, heights, profile=_profile(roads, lanes), network=network, legs=legs)

    def __repr__(self) -> str:
        if not self.legs:
            return f"Route(none asked for, {len(self.network.roads_outside)} roads)"
        kinds = ", ".join(each.entered.kind.replace("_", "-") for each in self.passages)
        return f"Route({self.length:.1f} m, junctions: {kinds or 'none'})"

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """The stations in metres of the start of each leg and, as the last one, of the end of the route.

        A leg on the same road as the leg before begins in the middle of the lane change between them. Without
        legs, this is only the station 0.
        """
        found, start = [], 0.0
        for number, group in groupby(self.legs, key=lambda leg: leg.road):
            length = self.network.road(number).road.length
            windows = change_windows(length, len(list(group)) - 1)
            found += [start, *(start + (a + b) / 2 for a, b in windows)]
            start += length
        return (*found, start)

    @cached_property
    def roads(self) -> tuple[tuple[float, NetworkRoad], ...]:
        """The roads outside junctions and roundabouts, as pairs (station in metres of its start, road)."""
        own = zip(self.starts, self.legs, strict=False)
        firsts = [next(group) for _, group in groupby(own, key=lambda each: each[1].road)]
        members = [(start, self.network.road(leg.road)) for start, leg in firsts]
        return tuple(
            (start, member)
            for start, member in members
            if member.junction is None and member.id not in self.network.roundabout_of
        )

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The passages through junctions in driving order; a way through a roundabout is one passage."""
        return passages_of(self.network, self.legs, self.starts)

    @property
    def mirrored(self) -> Self:
        """The route with the sign of y changed, in the mirror image of its network."""
        return replace(super().mirrored, network=self.network.mirrored, legs=_mirrored_legs(self.legs))

    def on_ground(self) -> Self:
        """Returns the route with shoulders that reach to the edge of the ground.

        The ground is the paved area of the network, widened by the widest shoulder of its roads.
        """
        assert self.profile is not None
        left, right = shoulders_on_ground(self, self.network, self.passages, self.starts)
        profile = replace(
            self.profile,
            left=(*self.profile.left[:-1], Lane("shoulder", left)),
            right=(*self.profile.right[:-1], Lane("shoulder", right)),
        )
        return self.with_profile(profile)

    def to_json(self) -> dict[str, Any]:
        """Returns the route and its network as JSON data, for ``network.road_from_json``."""
        return {**self.to_route_json(), "network": network_to_json(self.network)}

    def to_route_json(self) -> dict[str, list[list[int]]]:
        """Returns the content of a route file: ``{"route": [[road, lane], ...]}`` in driving order; without a
        route, the list is empty.
        """
        return {"route": [list(leg) for leg in self.legs]}


def _mirrored_legs(legs: Sequence[Leg]) -> tuple[Leg, ...]:
    return tuple(Leg(leg.road, -leg.lane) for leg in legs)


def _check_leg(network: Network, leg: Leg) -> None:
    try:
        profile = network.road(leg.road).profile
    except KeyError as error:
        raise UsageError(f"the route names road {leg.road}, which is not in the network") from error
    if leg.lane not in (*profile.along_ids, *profile.against_ids):
        raise UsageError(f"the route names lane {leg.lane} of road {leg.road}, which has no such lane")


def _check_joint(network: Network, one: Leg, two: Leg) -> None:
    """Raises UsageError unless the second leg follows the first one."""
    if one.road == two.road:
        is_joined = network.road(one.road).junction is None and abs(one.lane - two.lane) == 1
        if not is_joined or one.lane * two.lane < 0:
            raise UsageError(
                f"the route cannot change from lane {one.lane} to lane {two.lane} of road {one.road}; change "
                "to the next lane of the same direction"
            )
        return
    (_, left), (entered, _) = network.ends_of(one), network.ends_of(two)
    if (continued := network.continued_at.get(left)) is not None:
        is_joined = _continues(continued, one, two)
    elif (found := network.connection_of.get(two.road)) is not None:
        is_joined = found[1].incoming == left and (one.lane, two.lane) in [way[:2] for way in found[1].lanes]
    elif (found := network.connection_of.get(one.road)) is not None:
        is_joined = found[1].outgoing == entered and (one.lane, two.lane) in [
            way[1:] for way in found[1].lanes
        ]
    else:
        is_joined = False
    if not is_joined:
        raise UsageError(f"no way leads from road {one.road} to road {two.road}, as the route asks")


def _continues(found: Continuation, one: Leg, two: Leg) -> bool:
    if one.road == found.before.road:
        return two.road == found.after.road and (one.lane, two.lane) in found.lanes
    return two.road == found.before.road and (two.lane, one.lane) in found.lanes


def _directed(member: NetworkRoad, leg: Leg) -> Road:
    """Returns a road in the direction in which the route drives along it; traffic drives on the right."""
    profile, length = member.profile, member.road.length
    if profile.leads_along(leg.lane):
        return member.road

    def turned(width: Width) -> Width:
        return reversed_cubics(width, length) if isinstance(width, CubicProfile) else width

    left, right = (
        tuple(replace(lane, width=turned(lane.width)) for lane in side)
        for side in (profile.right, profile.left)
    )
    # the oncoming lanes become the lanes along the road, and the median moves to their left
    offset = added([(-1, turned(profile.offset)), (-1, profile.median)], length)
    driven = profile.against_ids.index(leg.lane)
    own = Profile(left, right, driven, profile.centre_marking, offset=offset, median=profile.median)
    return reversed_road(member.road).with_profile(own)


def _parts(network: Network, legs: Sequence[Leg]) -> tuple[list[Road], list[LaneAlong]]:
    """Returns the roads of a route in its direction, and the lane that the route follows on each; legs that
    follow each other on one road are one part.
    """
    roads, lanes = list[Road](), list[LaneAlong]()
    for number, group in groupby(legs, key=lambda leg: leg.road):
        own, member = list(group), network.road(number)
        profile = member.profile
        ids = profile.along_ids if profile.leads_along(own[0].lane) else profile.against_ids
        roads.append(_directed(member, own[0]))
        lanes.append(lane_along(roads[-1], [ids.index(leg.lane) for leg in own]))
    return roads, lanes


def _profile(roads: Sequence[Road], lanes: Sequence[LaneAlong]) -> Profile:
    """Returns the cross-section of a route: its own lane, one lane for all other lanes on each side, and the
    shoulders.
    """
    starts = [0.0, *accumulate(road.length for road in roads)]
    left_shoulder, left, offset, width, right, right_shoulder = (
        _joined_widths(column, roads, starts) for column in zip(*lanes, strict=True)
    )
    first = next(road.profile for road in roads if road.profile is not None)
    marking, edge = first.centre_marking, first.right[first.count[0] - 1].marking
    outer = () if right == 0 else (Lane("driving", right, edge),)
    own: Marking = "broken" if outer else edge
    return Profile(
        (Lane("driving", left, edge), Lane("shoulder", left_shoulder)),
        (Lane("driving", width, own), *outer, Lane("shoulder", right_shoulder)),
        0,
        marking,
        offset=offset,
    )


def _joined_widths(widths: Sequence[Width], roads: Sequence[Road], starts: Sequence[float]) -> Width:
    """Returns the widths of roads that follow each other as one function of the station along all of them."""
    if all(width == widths[0] and not isinstance(width, CubicProfile) for width in widths):
        return widths[0]
    rows: list[tuple[float, Cubic]] = []
    for width, road, start in zip(widths, roads, starts, strict=False):
        own = width.stations if isinstance(width, CubicProfile) else ()
        inside = [0.0, *(s for s in own if 0 < s < road.length - 1e-9)]
        rows += zip((start + s for s in inside), cubics_at(width, inside), strict=True)
    return CubicProfile.of_rows(rows)
