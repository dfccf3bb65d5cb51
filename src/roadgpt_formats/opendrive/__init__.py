"""Reads ASAM OpenDRIVE files, versions 1.1 to 1.9: ``read_map`` whole maps, ``read_road`` one road of a file.

tree        reads the XML within limits and without entities; sorts the records of a road by station
line        computes the plan curve of a road: unchanged where possible, otherwise of clothoids
rounding    leads it past places where the elements of a line do not meet
roads       reads the roads with all their lanes
junctions   joins them: continuations, junctions with their signs and lights, roundabouts
one_road    takes one road of a file by itself, and selects its driven lane"""

import re
from collections import Counter
from pathlib import Path
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.network import ImportedMap
from roadgpt.network.network import MOST_ROADS
from roadgpt_formats.opendrive.junctions import Joining
from roadgpt_formats.opendrive.one_road import read_road
from roadgpt_formats.opendrive.roads import FileRoad, file_road, left_out, unread
from roadgpt_formats.opendrive.tree import MapRemarks, count_roads, read_tree

__all__ = ["count_roads", "read_map", "read_road"]


def read_map(path: Path) -> ImportedMap:
    """Returns a whole map; see ``roadgpt.network.read_map``."""
    remarks = MapRemarks()
    roads, junctions, passed, others = list[FileRoad](), list[Element](), Counter[str](), set[str]()

    def take(node: Element, skipped: Counter[str]) -> None:
        passed.update(skipped)
        if node.tag == "junction":
            junctions.append(node)
            return
        try:
            others.update(unread(node))
            road = file_road(node, remarks)
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
