"""Writes the junctions of a network for CommonRoad: intersections, with their signs, lights and stop lines.

Signs are those of Zamunda, CommonRoad's fictional country, with their German numbers: 205 give way, 206 stop,
306 priority road. Lights are green all the time, because there is no other traffic.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from math import degrees

import numpy as np

from roadgpt.brief.junction_ranges import SIDE, side_of
from roadgpt.brief.junctions import Control, Way
from roadgpt.export.lanelets import Lanelet, leading_to
from roadgpt.export.markup import XmlElement, number
from roadgpt.network import Arm, Connection, Junction, Network
from roadgpt.network.markings import gives_way_to_ring, line_to_stop_at, place_of_sign

SIGNS: dict[Control, str] = {"yield": "205", "stop": "206", "priority": "306"}
LINES: dict[Control, str] = {"yield": "dashed", "stop": "solid", "lights": "solid"}
"""Type of the line at the end of an arm, by the sign or light of the arm."""
GREEN = 1000  # time steps; duration of the only phase of a light
ORDER: tuple[Way, ...] = ("right", "straight", "left")


def point_element(values: Sequence[float]) -> XmlElement:
    """Returns the element ``point`` with x and y in metres."""
    out = XmlElement("point")
    for name, value in zip("xy", values, strict=True):
        out.add(name, raw=number(value))
    return out


class Crossings:
    """Creates the CommonRoad elements of a network's junctions."""

    def __init__(self, network: Network, lanelets: Sequence[Lanelet], first_free: int) -> None:
        """Prepares the elements for all lanelets of a network; ``first_free`` is the first id for signs,
        lights and intersections."""
        self.network, self.first_free = network, first_free
        self.road_of = {each.id: each.road for each in lanelets}
        self.arms = [
            (junction, arm, incoming)
            for junction in network.junctions
            for arm in junction.arms
            if (incoming := leading_to(lanelets, network, arm.end))
        ]

    @cached_property
    def _signed(self) -> dict[int, tuple[int, Junction, Arm]]:
        """The id of the sign or light of each lanelet that has one, with its junction and its arm."""
        signed = [each for each in self.arms if each[1].control != "none"]
        return {
            lanelet.id: (self.first_free + n, junction, arm)
            for n, (junction, arm, incoming) in enumerate(signed)
            for lanelet in incoming
        }

    def line_of(self, lanelet: int) -> Iterator[XmlElement]:
        """Yields the element ``stopLine`` of a lanelet on which traffic stops or gives way; nothing for any
        other lanelet.

        Where traffic gives way to a roundabout, the element has no points, which means that the line is at
        the end of the lanelet.
        """
        if lanelet not in self._signed:
            return
        _, junction, arm = self._signed[lanelet]
        line = line_to_stop_at(self.network, junction, arm)
        if line is None:
            return
        out = XmlElement("stopLine")
        if not gives_way_to_ring(self.network, junction, arm):
            out.extended(*(point_element(each) for each in np.round(line[:, :2], 4).tolist()))
        out.add("lineMarking", raw=LINES[arm.control])
        yield out

    def references(self, lanelet: int) -> Iterator[XmlElement]:
        """Yields the element by which a lanelet refers to its sign or light; nothing if there is neither."""
        if lanelet in self._signed:
            id_, _, arm = self._signed[lanelet]
            name = "trafficLightRef" if arm.control == "lights" else "trafficSignRef"
            yield XmlElement(name, {"ref": id_})

    def elements(self) -> Iterator[XmlElement]:
        """Yields the signs, the lights and the intersections, in the order that the format requires."""
        placed = [(arm, self._signed[own[0].id][0]) for _, arm, own in self.arms if own[0].id in self._signed]
        yield from (self._sign(arm, id_) for arm, id_ in placed if arm.control != "lights")
        yield from (self._light(arm, id_) for arm, id_ in placed if arm.control == "lights")
        free = self.first_free + len(placed)
        for junction in self.network.junctions:
            own = [(arm, incoming) for each, arm, incoming in self.arms if each is junction]
            made = XmlElement("intersection", {"id": free})
            for n, (arm, incoming) in enumerate(own, 1):
                made.extended(self._way_in(junction, arm, incoming, free + n))
            yield made
            free += len(own) + 1

    def _way_in(self, junction: Junction, arm: Arm, incoming: Sequence[Lanelet], id_: int) -> XmlElement:
        """Returns the element ``incoming`` of an arm, with the lanelets that lead on to each side."""
        out = XmlElement("incoming", {"id": id_})
        for lanelet in incoming:
            out.add("incomingLanelet", {"ref": lanelet.id})
        to: dict[Way, list[int]] = {side: [] for side in ORDER}
        ways = [each for each in junction.connections if each.incoming == arm.end]
        sides = {each.road: self._side(junction, each) for each in ways}
        for lanelet in incoming:
            for id_ in lanelet.after:
                to[sides[self.road_of[id_]]].append(id_)
        for side in ORDER:
            for id_ in to[side]:
                out.add(f"successors{side.capitalize()}", {"ref": id_})
        return out

    def _side(self, junction: Junction, way: Connection) -> Way:
        """Returns the side to which a connection leads.

        A connection that stays on the ring of a roundabout leads straight on. At a diverge, a connection that
        turns by more than 1 degree leads to the side of this turn.
        """
        ring = self.network.roundabout_of.get(junction.id)
        if ring is not None and {way.incoming.road, way.outgoing.road} <= {*ring.ring}:
            return "straight"
        road = self.network.road(way.road).road
        turn = degrees(float(road.heading(road.length) - road.heading(0.0)))
        return side_of(turn * SIDE if junction.kind == "diverge" and abs(turn) > 1 else turn)

    def _place(self, arm: Arm) -> XmlElement:
        member = self.network.road(arm.end.road)
        s, t = place_of_sign(member, arm.end.contact)
        x, y = member.road.at(s, t)[:2].tolist()
        return XmlElement("position").extended(point_element((round(x, 4), round(y, 4))))

    def _sign(self, arm: Arm, id_: int) -> XmlElement:
        out = XmlElement("trafficSign", {"id": id_})
        out.add("trafficSignElement").add("trafficSignID", raw=SIGNS[arm.control])
        out.extended(self._place(arm)).add("virtual", raw="false")
        return out

    def _light(self, arm: Arm, id_: int) -> XmlElement:
        out = XmlElement("trafficLight", {"id": id_})
        cycle = XmlElement("cycle")
        phase = cycle.add("cycleElement")
        phase.add("duration", raw=str(GREEN))
        phase.add("color", raw="green")
        out.extended(cycle, self._place(arm))
        out.add("direction", raw="all")
        out.add("active", raw="true")
        return out
