"""Reads the roads of an OpenDRIVE file one after another, and is safe against malicious XML.

A file with a DOCTYPE is refused, so that no XML entities can be declared, fetched or expanded. Limits on file
size, number of elements, depth and tag length bound the time and memory that reading takes."""

import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from xml.etree.ElementTree import Element
from xml.parsers import expat

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.elevation import Cubic
from roadgpt.reading import opened

NUMBER = re.compile(r"\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*")
LARGEST_NUMBER = 1e12  # of any number; beyond it, sums are no longer exact to a metre
LARGEST = 50_000_000  # bytes; the largest public maps have 20 MB
TOO_LARGE = f"it is larger than {LARGEST // 1_000_000} MB; cut out the roads that you need"
MOST_ELEMENTS = 500_000
MOST_KEPT = 60_000  # elements of one road
DEEPEST = 60
LONGEST_TAG = 1_000_000  # bytes
CHUNK = 65_536  # bytes
READ = frozenset({
    "type", "speed", "planView", "geometry", "line", "spiral", "arc", "poly3", "paramPoly3",
    "elevationProfile", "elevation", "lateralProfile", "superelevation", "lanes", "laneOffset", "laneSection",
    "left", "center", "right", "lane", "width", "border", "roadMark", "material",
})  # fmt: skip
"""The elements of a single road that RoadGPT reads."""
OF_MAPS = READ | {
    "link", "predecessor", "successor", "objects", "object", "signals", "signal", "signalReference",
    "junction", "connection", "laneLink", "priority",
}  # fmt: skip
"""The elements of a map that RoadGPT reads."""
TOPS = ("road", "junction")
OF_JUNCTIONS = ("boundary", "controller", "outline", "outlines", "validity")
"""Elements of a map that say nothing more than what is read, or where the edges of an object lie."""
SILENT = (
    *OF_JUNCTIONS,
    "objects",
    "signals",
    "surface",
    "link",
    "userData",
    "dataQuality",
    "sway",
    "explicit",
)
"""Elements of a road that are neither read nor reported; those in them that ``COUNTED`` names are."""
COUNTED = {
    "object": "object",
    "bridge": "bridge",
    "tunnel": "tunnel",
    "signal": "signal",
    "signalReference": "signal",
    "railroad": "railway",
    "CRG": "surface",
    "include": "included file",
}
"""The nouns under which some elements are counted; ``IN_HEADER`` is reported if present."""
VALUES = frozenset({"a", "b", "c", "d", "inner", "outer"})  # an element says nothing if they are 0
OTHER_KINDS = {"osm": "Lanelet2 or OpenStreetMap", "net": "SUMO", "commonRoad": "CommonRoad"}
"""Whose XML files begin with these elements."""
IN_HEADER = ("geoReference", "offset")
OURS = "RoadGPT"  # vendor of files that RoadGPT wrote: their georeference has no meaning
RAMPS = ("entry", "exit", "onRamp", "offRamp", "connectingRamp", "mwyEntry", "mwyExit")
DRIVING = ("driving", "bidirectional", "slipLane", *RAMPS)
OF_ROAD = ("type", "planView/geometry", "elevationProfile/elevation", "lateralProfile/superelevation",
           "lanes/laneOffset", "lanes/laneSection")  # fmt: skip
"""The records that RoadGPT reads; ``s`` is their station."""
OF_LANE = ("width", "border", "roadMark", "material", "speed")
"""The records of a lane that RoadGPT reads; ``sOffset`` is their distance from the start of its section."""
CUBICS = ("elevation", "superelevation", "laneOffset", "width", "border")
END = 1e-6  # m; a record this close to the end is at the end
MERGED = 0.1  # m; the length of a road may differ by this much from that of its line


def number(node: Element, name: str, missing: float | None = None) -> float:
    """Returns an attribute of an element as a finite number; ``missing`` if there is no such attribute. If
    ``missing`` is None, the attribute is required. Raises UsageError if a required attribute is missing, or
    if the attribute is not a number, not finite, or has an absolute value above 1e12."""
    text = node.get(name)
    if text is None:
        if missing is None:
            raise UsageError(f"a <{node.tag}> has no {name}; add it")
        return missing
    if not NUMBER.fullmatch(text) or len(text) > 400:
        raise UsageError(f"in a <{node.tag}>, {name} is '{text[:40]}', which is not a number; correct it")
    value = float(text)
    if not math.isfinite(value) or abs(value) > LARGEST_NUMBER:
        raise UsageError(f"in a <{node.tag}>, {name} is {text[:40]}, which is too large; correct it")
    return value


def cubics(nodes: Iterable[Element], station: str, start: float = 0.0) -> CubicProfile | None:
    """Returns the cubic polynomials that the elements define by a, b, c and d; None if there are no elements.

    The station of a cubic is its attribute named ``station``, plus ``start`` metres; stations ascend. Each
    cubic applies from its station to that of the next cubic. Before the first station, the value is that at
    the first station."""
    kept: dict[float, Cubic] = {}
    for node in nodes:
        a, b, c, d = (number(node, name, None if name == "a" else 0.0) for name in "abcd")
        kept[start + number(node, station, 0.0)] = (a, b, c, d)
    if not kept:
        return None
    stations = list(kept)
    if stations[0] > start:
        first = kept[stations[0]][0]
        kept = {start: (first, 0.0, 0.0, 0.0), **kept}
    return CubicProfile(tuple(kept), tuple(kept.values()))


@dataclass(frozen=True)
class Choice:
    """The road that was selected from a file, and information about the other contents of the file."""

    road: Element
    others: tuple[str, ...]  # ids of all roads in the file
    passed: Mapping[str, int]
    """Number of skipped elements of the road for each type of element, such as objects and signals."""
    header: frozenset[str]
    """Names of the header elements (``geoReference``, ``offset``) that the file contains and that are
    skipped."""


def read_tree(path: Path, wanted: str | None) -> Choice:
    """Returns the road with the id ``wanted``, and information about the other contents of the file. If
    ``wanted`` is None, roads with a driving lane are preferred, then roads outside junctions, then longer
    roads. Raises UsageError if the file cannot be read, is not OpenDRIVE, is too large, or has no such road.
    """
    choice = _Selection(wanted)
    reader = _Reader(READ, choice.wants, choice.compare)
    _read(path, reader)
    return choice.made(reader)


def count_roads(path: Path) -> int:
    """Returns the number of roads in a file; raises UsageError as ``read_tree`` does."""
    reader = _Reader(frozenset(), lambda tag, attributes: False, lambda node, passed: None)
    _read(path, reader)
    return len(reader.ids)


def read_map_tree(path: Path, take: Callable[[Element, Counter[str]], None]) -> "frozenset[str]":
    """Calls ``take`` with each road, junction and group of junctions of a file, in order, and with the number
    of its elements that RoadGPT does not read, by their name. Returns the names of such elements of the
    header. Raises UsageError as ``read_tree`` does."""
    reader = _Reader(OF_MAPS, lambda tag, attributes: tag in TOPS, take)
    _read(path, reader)
    if not reader.ids:
        raise UsageError("there is no road in it")
    return frozenset(() if OURS in reader.header else reader.header)


def _read(path: Path, reader: "_Reader") -> None:
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = reader.start, reader.end
    parser.StartDoctypeDeclHandler = _refuse_doctype
    try:
        with opened(path, LARGEST, "a map; cut out the roads that you need", "it") as file:
            fed = 0
            while chunk := file.read(CHUNK):
                fed += len(chunk)
                if fed > LARGEST:  # it grows
                    raise UsageError(TOO_LARGE)
                parser.Parse(chunk, False)
                if fed - max(parser.CurrentByteIndex, 0) > LONGEST_TAG:
                    raise UsageError("one tag is longer than a megabyte; that is not an OpenDRIVE file")
            parser.Parse(b"", True)
    except OSError as error:
        raise UsageError(
            f"it cannot be read: {error.strerror}; give the path of an OpenDRIVE file"
        ) from error
    except (expat.ExpatError, UnicodeError, LookupError, ValueError) as error:
        raise UsageError(f"it is not well-formed XML ({error}); save it again as OpenDRIVE") from error


def _refuse_doctype(name: str, system: str | None, public: str | None, internal: int) -> None:
    raise UsageError("it has a DOCTYPE, which OpenDRIVE has no use for; remove it")


class _Reader:
    """Builds the elements below the root that are wanted, one at a time, and counts what is skipped."""

    def __init__(
        self,
        known: frozenset[str],
        wants: Callable[[str, Mapping[str, str]], bool],
        take: Callable[[Element, Counter[str]], None],
    ) -> None:
        self.known, self.wants, self.take = known, wants, take
        self.ids: list[str] = []
        self.header: set[str] = set()
        self.passed: Counter[str] = Counter()
        self.elements = self.kept = self.depth = self.hidden = 0
        self.stack: list[Element] = []

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Handles the start tag of an XML element."""
        self.elements += 1
        self.depth += 1
        if self.elements > MOST_ELEMENTS or self.depth > DEEPEST:
            what = f"more than {MOST_ELEMENTS:,} elements" if self.depth <= DEEPEST else "elements too deep"
            raise UsageError(f"it has {what}; cut out the roads that you need")
        tag = tag.rpartition(":")[2]
        if self.depth == 1 and tag != "OpenDRIVE":
            kind = f", but a file of {OTHER_KINDS[tag]}" if tag in OTHER_KINDS else ""
            raise UsageError(f"it is XML but not OpenDRIVE{kind}: it begins with <{tag[:40]}>")
        if self.hidden or (self.stack and tag not in self.known and self.stack[-1].tag != "geometry"):
            self.hidden += 1
            values = [attributes[name].strip("+-0.e") for name in VALUES & attributes.keys()]
            is_told = self.hidden == 1 and tag not in SILENT and (any(values) or not values)
            if tag in COUNTED or is_told:
                self.passed[COUNTED.get(tag, f"<{tag[:30]}>")] += 1
        elif self.stack:
            node = Element(tag, attributes)
            self.kept += 1
            if self.kept > MOST_KEPT:
                raise UsageError(
                    f"one of its roads has more than {MOST_KEPT:,} elements; cut out what you need"
                )
            self.stack[-1].append(node)
            self.stack.append(node)
        elif self.depth == 2 and tag in TOPS:
            if tag == "road":
                self.ids.append(attributes.get("id", ""))
            if self.wants(tag, attributes):
                self.stack.append(Element(tag, attributes))
                self.kept = 0
                self.passed = Counter()
        elif tag in IN_HEADER and not self.ids:
            self.header.add(tag)
        elif tag == "header" and attributes.get("vendor") == OURS:
            self.header.add(OURS)

    def end(self, tag: str) -> None:
        """Handles the end tag of an XML element. A complete element is passed on."""
        self.depth -= 1
        if self.hidden:
            self.hidden -= 1
        elif self.stack:
            node = self.stack.pop()
            if not self.stack:
                self.take(node, self.passed)


class _Selection:
    """The best of the roads, or the one that is wanted."""

    def __init__(self, wanted: str | None) -> None:
        self.wanted = wanted
        self.best: tuple[tuple[bool, bool, float], Element, Counter[str]] | None = None

    def wants(self, tag: str, attributes: Mapping[str, str]) -> bool:
        """Returns whether an element is a road that may be selected."""
        return tag == "road" and self.wanted in (None, attributes.get("id"))

    def compare(self, road: Element, passed: Counter[str]) -> None:
        """Compares a complete road with the best one so far."""
        is_driven = any(lane.get("type") in DRIVING for lane in road.findall("lanes/laneSection/*/lane"))
        is_free = road.get("junction", "-1") == "-1"
        length = road.get("length", "0")
        rank = (is_driven, is_free, float(length) if NUMBER.fullmatch(length) else 0.0)
        if self.best is None or rank > self.best[0]:
            self.best = (rank, road, passed)

    def made(self, read: _Reader) -> Choice:
        """Returns the selected road, after the whole file has been parsed."""
        if self.best is None:
            if not read.ids:
                raise UsageError("there is no road in it")
            told = ", ".join(read.ids[:12]) + (", ..." if len(read.ids) > 12 else "")
            raise UsageError(f"there is no road {self.wanted} in it; there are: {told}")
        _, road, passed = self.best
        header = set() if OURS in read.header else read.header
        return Choice(road, tuple(read.ids), passed, frozenset(header))


def in_order(road: Element) -> list[str]:
    """Sorts the records of a road in place, and removes those that begin beyond its end. Returns a sentence
    for each kind of record that was not in order, had several at one station, begins late, or begins beyond
    the end, and for a wrong length. Raises UsageError if a station is not a number."""
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
