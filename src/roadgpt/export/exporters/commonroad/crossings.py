"""Writes the junctions of a network for CommonRoad: intersections, with their signs, lights and stop lines.

Signs are those of Zamunda, CommonRoad's own country, which has the German ones: 205 give way, 206 stop, 306
priority road. Lights are green all the time, because there is no other traffic.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from math import degrees

from roadgpt.brief.junctions import Control, Way, side_of
from roadgpt.export.lanelets import Lanelet
from roadgpt.export.markup import XmlElement, number
from roadgpt.network import Arm, Junction, Network
from roadgpt.network.markings import place_of_sign

SIGNS: dict[Control, str] = {"yield": "205", "stop": "206", "priority": "306"}
LINES: dict[Control, str] = {"yield": "dashed", "stop": "solid", "lights": "solid"}
"""The line at the end of an arm with this sign or light."""
GREEN = 1000  # steps of the one phase of a light
ORDER: tuple[Way, ...] = ("right", "straight", "left")


def point_element(values: Sequence[float]) -> XmlElement:
    """Returns a point of a plan view, x and y in metres."""
    out = XmlElement("point")
    for name, value in zip("xy", values, strict=True):
        out.add(name, raw=number(value))
    return out


class Crossings:
    """The junctions of a network as CommonRoad has them."""

    def __init__(self, network: Network, lanelets: Sequence[Lanelet], first_free: int) -> None:
        """Gives ids to signs, lights and intersections, from ``first_free`` on."""
        self.network, self.lanelets = network, lanelets
        self.first_free = first_free
        self.arms = [
            (junction, arm, incoming)
            for junction in network.junctions
            for arm in junction.arms
            if (incoming := self._incoming(arm))
        ]

    def _incoming(self, arm: Arm) -> list[Lanelet]:
        """Returns the lanelets that lead into a junction on one of its arms."""
        ids = self.network.road(arm.end.road).ids_towards(arm.end.contact)
        own = [each for each in self.lanelets if each.road == arm.end.road and each.lane in ids]
        last = {each.lane: each for each in own}  # lanelets stand in the order in which they are driven
        return list(last.values())

    @cached_property
    def _signed(self) -> dict[int, tuple[int, Control]]:
        """The id and kind of the sign or light that holds for each lanelet with one."""
        signed = [(arm, incoming) for _, arm, incoming in self.arms if arm.control != "none"]
        return {
            lanelet.id: (self.first_free + n, arm.control)
            for n, (arm, incoming) in enumerate(signed)
            for lanelet in incoming
        }

    def line_of(self, lanelet: int) -> str | None:
        """Returns the marking of the line at which traffic on a lanelet stops or gives way; None for none."""
        return LINES.get(self._signed.get(lanelet, (0, "none"))[1])

    def references(self, lanelet: int) -> Iterator[XmlElement]:
        """Yields the reference of a lanelet to its sign or light; nothing if it has none."""
        if lanelet in self._signed:
            id_, control = self._signed[lanelet]
            yield XmlElement("trafficLightRef" if control == "lights" else "trafficSignRef", {"ref": id_})

    def elements(self) -> Iterator[XmlElement]:
        """Yields the signs, the lights and the intersections, in the order that the format asks for."""
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
        """Returns one way into a junction, with the lanelets on which one goes on."""
        out = XmlElement("incoming", {"id": id_})
        for lanelet in incoming:
            out.add("incomingLanelet", {"ref": lanelet.id})
        to: dict[Way, list[int]] = {side: [] for side in ORDER}
        sides = {
            each.road: self._side(each.road) for each in junction.connections if each.incoming == arm.end
        }
        by_id = {each.id: each for each in self.lanelets}
        for lanelet in incoming:
            for id_ in lanelet.after:
                to[sides[by_id[id_].road]].append(id_)
        for side in ORDER:
            for id_ in to[side]:
                out.add(f"successors{side.capitalize()}", {"ref": id_})
        return out

    def _side(self, connecting: int) -> Way:
        road = self.network.road(connecting).road
        return side_of(degrees(float(road.heading(road.length) - road.heading(0.0))))

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
        cycle.add("timeOffset", raw="0")
        out.extended(cycle, self._place(arm))
        out.add("direction", raw="all")
        out.add("active", raw="true")
        return out
