"""Reads whole maps from ASAM OpenDRIVE files, versions 1.1 to 1.8. Main function: ``read_map``.

roads       reads the roads with all their lanes
junctions   joins them: continuations, junctions with their signs and lights, roundabouts"""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.network.network import MOST_ROADS, Leg, Network
from roadgpt.network.opendrive.junctions import Joining
from roadgpt.network.opendrive.roads import FileRoad, Remarks, read_road
from roadgpt.road.opendrive.tree import read_map_tree
from roadgpt.road.world import FRICTIONS, SPEEDS

__all__ = ["ImportedMap", "read_map"]


@dataclass(frozen=True, eq=False)
class ImportedMap:
    """A network that was read from an OpenDRIVE file."""

    network: Network
    roads: Mapping[str, tuple[int, ...]]
    """The ids of the roads in the network, by the id of the road of the file that they are parts of."""
    remarks: tuple[str, ...]  # sentences about contents of the file that were changed, replaced or left out

    def world_values(self, legs: Sequence[Leg] = ()) -> tuple[dict[str, float], tuple[str, ...]]:
        """Returns the speed limit in m/s and the friction that hold for the longest part of a route, or of
        all lanes, as the fields of a World; and a sentence about each that differs on another part. What the
        file does not state, or states outside the limits of a World, is left out."""
        network, found, remarks = self.network, dict[str, float](), list[str]()
        lanes = legs or [
            Leg(each.id, lane)
            for each in network.roads
            for lane in (*each.profile.along_ids, *each.profile.against_ids)
        ]
        for name, (low, high) in (("speed_limit", SPEEDS), ("friction", FRICTIONS)):
            metres = defaultdict[float, float](float)
            for leg in lanes:
                value = getattr(network.road(leg.road).profile.lanes[leg.lane], name)
                if value is not None and low <= value <= high:
                    metres[value] += network.road(leg.road).road.length
            if metres:
                used = max(metres, key=lambda value: (metres[value], value))
                found[name] = used
            if len(metres) > 1:
                what, factor, unit = (
                    ("speed limit", 3.6, " km/h") if name == "speed_limit" else ("friction", 1.0, "")
                )
                said = [f"{value * factor:.4g}" for value in (min(metres), max(metres), used)]
                remarks.append(
                    f"its {what} is {said[0]} to {said[1]}{unit}; {said[2]}{unit} is used everywhere"
                )
        return found, tuple(remarks)


def read_map(path: Path | str) -> ImportedMap:
    """Returns all roads of an OpenDRIVE file that cars may use, and the junctions that join them.

    Roads and junctions keep their ids where these are numbers. A road whose lanes change on its way becomes
    several roads, of which the first one keeps the id; see ``ImportedMap.roads``.

    Raises UsageError if the file cannot be read or is too large, is not OpenDRIVE, or has no road that can be
    read; a road that cannot be read is left out, and the remarks say why."""
    path, remarks = Path(path), Remarks()
    roads, junctions, passed = list[FileRoad](), list[Element](), Counter[str]()

    def take(node: Element, skipped: Counter[str]) -> None:
        passed.update(skipped)
        if node.tag == "junction":
            junctions.append(node)
        else:
            try:
                road = read_road(node, remarks)
            except UsageError as error:
                said = str(error).partition(" at s = ")[0].partition(";")[0]
                remarks.add(f"left out: roads of which {said}", f"road {node.get('id', '?')[:40]}")
            else:
                roads.extend([] if road is None else [road])

    try:
        header = read_map_tree(path, take)
        if len({road.left_hand for road in roads}) > 1:
            raise UsageError("traffic drives on the left on some of its roads only; take them from two files")
        joining = Joining(roads, junctions, remarks)
        network = joining.network()
        if not network.plain_roads or len(network.roads) > MOST_ROADS:
            what = "no road" if not network.plain_roads else f"more than {MOST_ROADS:,} roads"
            why = [each for each in remarks.sentences() if each.startswith("left out: roads")]
            raise UsageError(f"it has {what} that can be read; {'; '.join(why)}")
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    left = [f"{count:,} {what}{'s' * (count > 1 and what[-1] != '>')}" for what, count in passed.items()]
    left += [f"<{name}> of the map" for name in sorted(header)]
    told = [f"left out: {', '.join(sorted(left))}"] if left else []
    return ImportedMap(network, joining.numbers(network), (*remarks.sentences(), *told))
