"""Writes the signs and lights of junctions, with their stop lines, crosswalks and arrows.

Source: ASAM OpenDRIVE 1.8.1, signals; its catalogue of signals gives type 1000001 for traffic lights. Signs
are those of the German road traffic regulations (StVO): 205 give way, 206 stop, 306 priority road.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from roadgpt.export.exporters.opendrive.objects import arrow_object, crosswalk_object, line_object
from roadgpt.export.markup import XmlElement
from roadgpt.network import Arm, Network, NetworkRoad
from roadgpt.network.arrows import arrows
from roadgpt.network.markings import place_of_sign

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


class Signals:
    """The signs and lights of a network, and what is painted on its roads.

    The ids of signs and lights follow those of roads and junctions. A line has the id of its sign or light.
    After all of these come the ids of the crosswalks, then those of the arrows.
    """

    def __init__(self, network: Network) -> None:
        # the elements on each road, by the id of the road
        self._signals = defaultdict[int, list[XmlElement]](list)
        self._objects = defaultdict[int, list[XmlElement]](list)
        self._controllers: dict[int, XmlElement] = {}  # by the id of the junction
        arms = [(junction, arm) for junction in network.junctions for arm in junction.arms]
        controlled = [(junction, arm) for junction, arm in arms if arm.control != "none"]
        first = 1 + max([*(each.id for each in network.roads), *(each.id for each in network.junctions)])
        for number, (junction, arm) in enumerate(controlled, first):
            self._signals[arm.end.road].append(_signal(network.road(arm.end.road), arm, number))
            line = line_object(network, junction, arm, number)
            if line is not None:
                self._objects[line[0]].append(line[1])
            if arm.control == "lights":
                lights = XmlElement("controller", {"id": str(junction.id), "name": f"lights {junction.id}"})
                controller = self._controllers.setdefault(junction.id, lights)
                controller.add("control", {"signalId": str(number), "type": "0"})
        crossed = [arm.end for _, arm in arms if arm.crosswalk]
        for number, end in enumerate(crossed, first + len(controlled)):
            self._objects[end.road].append(crosswalk_object(network.road(end.road), end, number))
        for number, arrow in enumerate(arrows(network), first + len(controlled) + len(crossed)):
            self._objects[arrow.end.road].append(arrow_object(arrow, number))

    def on_road(self, road: int) -> Iterator[XmlElement]:
        """Yields the elements ``objects`` and ``signals`` of a road; an empty element is left out."""
        for name, elements in (("objects", self._objects), ("signals", self._signals)):
            if own := elements.get(road):
                yield XmlElement(name, children=own)

    def controllers(self) -> Iterable[XmlElement]:
        """Returns the controller of each junction with lights; a controller has the id of its junction."""
        return self._controllers.values()

    def of_junction(self, junction: int) -> Iterator[XmlElement]:
        """Yields the reference to the controller of a junction; nothing if the junction has no lights."""
        if junction in self._controllers:
            yield XmlElement("controller", {"id": str(junction), "type": "0", "sequence": 0})


def _signal(member: NetworkRoad, arm: Arm, number: int) -> XmlElement:
    """Returns the sign or light of an arm, which stands beside the road ``member``."""
    control, end = arm.control, arm.end
    at_end = end.contact == "end"
    s, t = place_of_sign(member, end.contact)
    height, width = SIZES[control]
    made = XmlElement(
        "signal",
        {
            "id": str(number),
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
