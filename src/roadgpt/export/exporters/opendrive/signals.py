"""Writes the signs and lights of junctions, with their stop lines, crosswalks and arrows.

Source: ASAM OpenDRIVE 1.8.1, signals; its catalogue of signals gives type 1000001 for traffic lights. Signs
are those of the German road traffic regulations (StVO): 205 give way, 206 stop, 306 priority road.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from roadgpt.export.exporters.opendrive.arrows import arrow_object
from roadgpt.export.exporters.opendrive.stop_lines import line_object
from roadgpt.export.markup import XmlElement
from roadgpt.network import Arm, Network, RoadEnd
from roadgpt.network.arrows import PaintedArrow, arrows
from roadgpt.network.markings import place_of_sign
from roadgpt.network.passages import CROSSWALK

TYPES = {"stop": "206", "yield": "205", "priority": "306", "lights": "1000001"}
NAMES = {
    "stop": "stop sign",
    "yield": "give way sign",
    "priority": "priority road sign",
    "lights": "traffic light",
}
SIZES = {"stop": (0.9, 0.9), "yield": (0.9, 0.9), "priority": (0.6, 0.6), "lights": (0.9, 0.3)}
"""Height and width in metres of each sign and of a light."""
HEIGHTS = {"stop": 2.0, "yield": 2.0, "priority": 2.0, "lights": 2.1}
"""Height in metres of the lower edge of each sign and of a light above the road."""


@dataclass(frozen=True)
class _Signal:
    """The sign or light of one arm."""

    id: int
    junction: int
    arm: Arm


@dataclass(frozen=True)
class Signals:
    """The signs and lights of a network, each with its id."""

    network: Network
    them: tuple[_Signal, ...]
    first_free: int
    """The first id after the ids of all signals."""
    arrows: tuple[PaintedArrow, ...]
    """The arrows before all junctions."""

    @classmethod
    def of(cls, network: Network) -> "Signals":
        """Returns the signals of a network. Their ids follow the ids of its roads and junctions."""
        arms = [
            (junction.id, arm)
            for junction in network.junctions
            for arm in junction.arms
            if arm.control != "none"
        ]
        first = 1 + max([*(each.id for each in network.roads), *(each.id for each in network.junctions)])
        them = tuple(_Signal(first + n, junction, arm) for n, (junction, arm) in enumerate(arms))
        return cls(network, them, first + len(arms), arrows(network))

    def on_road(self, road: int) -> Iterator[XmlElement]:
        """Yields the elements ``objects`` and ``signals`` of a road; an empty element is left out."""
        if objects := self._objects.get(road):
            yield XmlElement("objects", children=objects)
        if own := self._of_road.get(road):
            yield XmlElement("signals").extended(*map(self._element, own))

    @cached_property
    def _of_road(self) -> dict[int, list[_Signal]]:
        """The signals of each road that has any, by the id of the road."""
        found: dict[int, list[_Signal]] = {}
        for signal in self.them:
            found.setdefault(signal.arm.end.road, []).append(signal)
        return found

    @cached_property
    def _objects(self) -> dict[int, list[XmlElement]]:
        """What is painted on each road, by the id of the road: lines at signals, crosswalks, arrows.

        A line has the id of its signal. Crosswalks and then arrows have the ids from ``first_free`` on.
        """
        found: dict[int, list[XmlElement]] = {}
        for signal in self.them:
            junction = self.network.junction(signal.junction)
            line = line_object(self.network, junction, signal.arm, signal.id)
            if line is not None:
                found.setdefault(line[0], []).append(line[1])
        arms = [arm for junction in self.network.junctions for arm in junction.arms]
        crossed = [arm.end for arm in arms if arm.crosswalk]
        for number, end in enumerate(crossed, self.first_free):
            found.setdefault(end.road, []).append(self._crosswalk(end, number))
        for number, arrow in enumerate(self.arrows, self.first_free + len(crossed)):
            found.setdefault(arrow.end.road, []).append(arrow_object(arrow, number))
        return found

    def controllers(self) -> Iterator[XmlElement]:
        """Yields the controller of each junction with lights; a controller has the id of its junction."""
        for junction in self._lit:
            controller = XmlElement("controller", {"id": str(junction), "name": f"lights {junction}"})
            for signal in self.them:
                if signal.junction == junction and signal.arm.control == "lights":
                    controller.add("control", {"signalId": str(signal.id), "type": "0"})
            yield controller

    def of_junction(self, junction: int) -> Iterator[XmlElement]:
        """Yields the reference to the controller of a junction; nothing if the junction has no lights."""
        if junction in self._lit:
            yield XmlElement("controller", {"id": str(junction), "type": "0", "sequence": 0})

    @cached_property
    def _lit(self) -> list[int]:
        """The junctions that have lights."""
        return list(dict.fromkeys(s.junction for s in self.them if s.arm.control == "lights"))

    def _element(self, signal: _Signal) -> XmlElement:
        control, end = signal.arm.control, signal.arm.end
        member = self.network.road(end.road)
        at_end = end.contact == "end"
        s, t = place_of_sign(member, end.contact)
        height, width = SIZES[control]
        made = XmlElement(
            "signal",
            {
                "id": str(signal.id),
                "name": NAMES[control],
                "s": s,
                "t": t,
                "zOffset": HEIGHTS[control],
                "height": height,
                "width": width,
                "dynamic": "yes" if control == "lights" else "no",
                "orientation": "+" if at_end else "-",
                "country": "OpenDRIVE" if control == "lights" else "DE",
                "type": TYPES[control],
                "subtype": "-1",
                "value": "-1",
            },
        )
        lanes = member.ids_towards(end.contact)
        made.add("validity", {"fromLane": min(lanes), "toLane": max(lanes)})
        return made

    def _crosswalk(self, end: RoadEnd, number: int) -> XmlElement:
        """Returns the crosswalk at the end of a road, with the id ``number``."""
        member = self.network.road(end.road)
        away = min(CROSSWALK[0] + CROSSWALK[1] / 2, member.road.length)
        s = member.road.length - away if end.contact == "end" else away
        left, right = (float(t) for t in member.profile.edges(s))
        made = XmlElement(
            "object",
            {
                "id": str(number),
                "name": "crosswalk",
                "type": "crosswalk",
                "s": s,
                "t": (left + right) / 2,
                "zOffset": 0.0,
                "hdg": 0.0,
                "orientation": "none",
                "length": CROSSWALK[1],
                "width": left - right,
                "height": 0.01,
                "dynamic": "no",
            },
        )
        # length and width say the same; CommonRoad's converter reads only the corners
        u, v = CROSSWALK[1] / 2, (left - right) / 2
        outline = made.add("outlines").add("outline", {"id": 0, "closed": "true", "outer": "true"})
        for corner in ((-u, -v), (-u, v), (u, v), (u, -v)):
            outline.add("cornerLocal", {"u": corner[0], "v": corner[1], "z": 0.0, "height": 0.01})
        return made
