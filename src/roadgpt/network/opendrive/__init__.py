"""Reads ASAM OpenDRIVE files, versions 1.1 to 1.9. Main functions: ``read_map`` for whole maps, and
``read_opendrive`` for one road of a file.

tree        reads the XML within limits and without entities; sorts the records of a road by station
line        computes the plan curve of a road: unchanged where possible, otherwise of clothoids
roads       reads the roads with all their lanes
junctions   joins them: continuations, junctions with their signs and lights, roundabouts
one_road    takes one road of a file by itself, and selects its driven lane"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.network.network import MOST_ROADS, Leg, Network
from roadgpt.network.opendrive.junctions import Joining
from roadgpt.network.opendrive.one_road import ImportedRoad, read_opendrive
from roadgpt.network.opendrive.roads import FileRoad, left_out, read_road, unread, world_values
from roadgpt.network.opendrive.tree import MapRemarks, read_tree

__all__ = ["ImportedMap", "ImportedRoad", "read_map", "read_opendrive"]


@dataclass(frozen=True, eq=False)
class ImportedMap:
    """A network that was read from an OpenDRIVE file."""

    network: Network
    roads: Mapping[str, tuple[int, ...]]
    """The ids of the roads in the network, by the id of the road of the file that they are parts of."""
    remarks: tuple[str, ...]  # sentences about contents of the file that were changed, replaced or left out

    def world_values(self, legs: Sequence[Leg] = ()) -> tuple[dict[str, float], tuple[str, ...]]:
        """Returns the speed limit in m/s and the friction that hold for the longest part of a route, or of
        all lanes, as the fields of a World; and a sentence about each that differs on another part, or is
        limited. What the file does not state is left out; where some lane has no speed limit,
        ``limit_stated`` is False."""
        roads = {each.id: each for each in self.network.roads}
        ids = {number: each.profile.along_ids + each.profile.against_ids for number, each in roads.items()}
        legs = legs or [Leg(number, lane) for number, own in ids.items() for lane in own]
        lanes = ((roads[leg.road], leg.lane) for leg in legs)
        found, told = world_values([(each.road.length, each.profile.lanes[lane]) for each, lane in lanes])
        every = (roads[number].profile.lanes[lane] for number, own in ids.items() for lane in own)
        found |= {} if all(lane.speed_limit for lane in every) else {"limit_stated": False}
        return found, told


def read_map(path: Path | str) -> ImportedMap:
    """Returns all roads of an OpenDRIVE file that cars may use, and the junctions that join them.

    Roads and junctions keep their ids where these are numbers. A road whose lanes change on its way becomes
    several roads, of which the first one keeps the id; see ``ImportedMap.roads``.

    Raises UsageError if the file cannot be read or is too large, is not OpenDRIVE, or has no road that can be
    read; a road that cannot be read is left out, and the remarks say why."""
    path, remarks = Path(path), MapRemarks()
    roads, junctions, passed, others = list[FileRoad](), list[Element](), Counter[str](), set[str]()

    def take(node: Element, skipped: Counter[str]) -> None:
        passed.update(skipped)
        if node.tag == "junction":
            junctions.append(node)
            return
        try:
            others.update(unread(node))
            road = read_road(node, remarks)
        except UsageError as error:
            said = re.sub(r" at s = [-+.e\d]+", "", str(error)).partition(";")[0]
            remarks.add(f"left out: roads of which {said}", f"road {node.get('id', '?')[:40]}")
        else:
            roads.extend([] if road is None else [road])

    try:
        _, header = read_tree(path, take)
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
    told = left_out(passed, others, header)
    return ImportedMap(network, joining.numbers(network), (*remarks.sentences(), *told))
