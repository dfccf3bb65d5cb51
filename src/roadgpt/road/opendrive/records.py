"""Puts the records of an OpenDRIVE road in the order of their stations, before anything else reads them.

A record, such as an ``elevation`` or a lane's ``width``, holds from its station to that of the next record of
its kind. The standard asks for ascending stations. What a file does otherwise is told in sentences.
"""

from collections import defaultdict
from itertools import pairwise
from xml.etree.ElementTree import Element

from roadgpt.road.opendrive.numbers import number

OF_ROAD = ("type", "planView/geometry", "elevationProfile/elevation", "lateralProfile/superelevation",
           "lanes/laneOffset", "lanes/laneSection")  # fmt: skip
"""The records that RoadGPT reads; ``s`` is their station."""
OF_LANE = ("width", "border", "roadMark", "material", "speed")
"""The records of a lane that RoadGPT reads; ``sOffset`` is their distance from the start of its section."""
CUBICS = ("elevation", "superelevation", "laneOffset", "width", "border")
END = 1e-6  # m; a record this close to the end is at the end
MERGED = 0.1  # m; the length of a road may differ by this much from that of its line


def in_order(road: Element) -> list[str]:
    """Sorts the records of a road in place, and removes those that begin beyond its end.

    Returns a sentence for each kind of record that was not in order, had several at one station, begins late,
    or begins beyond the end, and for a wrong length. Raises UsageError if a station is not a number.
    """
    line = road.findall("planView/geometry")
    end = max((number(each, "s") + abs(number(each, "length")) for each in line), default=0.0)
    told = defaultdict[str, list[str]](list)
    for path in OF_ROAD if line else ():
        _sort(road, path, "s", (0.0, end), "", told)
    sections = road.findall("lanes/laneSection")
    starts = [number(section, "s") for section in sections]
    for section, part in zip(sections, pairwise([*starts, end]), strict=True):
        for lane in section.findall("*/lane"):
            for tag in OF_LANE:
                _sort(lane, tag, "sOffset", part, f" of lane {lane.get('id', '?')[:10]}", told)
    if abs((said := number(road, "length", end)) - end) > MERGED:
        told[f"its length is said to be {said:g} m, and that of its line is taken"] = [f"{end:g} m"]
    firsts = (f"{len(at)} times, first at {at[0]}" if len(at) > 1 else f"at {at[0]}" for at in told.values())
    return [f"{what} ({where})" for what, where in zip(told, firsts, strict=True)]


def _sort(
    holder: Element, path: str, station: str, part: tuple[float, float], of: str, told: dict[str, list[str]]
) -> None:
    """Sorts the records of one list. ``part`` is the part of the road that they are for, in metres."""
    (start, end), (above, _, tag) = part, path.rpartition("/")
    found = [(start + number(node, station, 0.0), node) for node in holder.findall(path)]
    ordered = sorted(found, key=lambda each: each[0])
    kept = [each for each in ordered if each[0] <= end + END] or ordered[: tag in CUBICS]
    back = [then for (s, _), (then, _) in pairwise(found) if then < s]
    twice = [s for (s, _), (then, _) in pairwise(kept) if s == then and tag != "geometry"]
    late = [s for s, _ in kept[:1] if tag in CUBICS and s > start + END]
    beyond = [s for s, _ in ordered[len(kept) :]]
    for what, stations in (
        (f"its <{tag}> records are not in the order of their {station}, and are sorted", back),
        (f"several <{tag}> begin at one place, and the last one is taken", twice),
        (f"its first <{tag}> begins late, and its value there is taken for what comes before", late),
        (f"a <{tag}> begins beyond the end of what it is for, and has no effect", beyond),
    ):
        if stations:
            told[what] += [f"s = {s:g} m{of}" for s in stations]
    parents = holder.findall(above or ".")
    for parent in reversed(parents):
        parent[:] = [node for node in parent if node.tag != tag]
        parent.extend(node for _, node in kept if parent is parents[0])
