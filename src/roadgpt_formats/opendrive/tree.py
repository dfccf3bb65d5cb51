"""Reads the roads of an OpenDRIVE file one after another, and is safe against malicious XML.

A file with a DOCTYPE is refused, so that no XML entities can be declared, fetched or expanded. Limits on file
size, number of elements, depth and tag length bound the time and memory that reading takes."""

import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
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
    "left", "center", "right", "lane", "width", "border", "roadMark", "material", "link", "predecessor",
    "successor", "objects", "object", "signals", "signal", "signalReference", "junction", "connection",
    "laneLink", "priority",
})  # fmt: skip
"""The elements that RoadGPT reads."""
TOPS = ("road", "junction")
SILENT = ("boundary", "controller", "outline", "outlines", "validity", "objectReference", "surface",
          "userData", "dataQuality", "sway", "explicit")  # fmt: skip
"""Elements that are neither read nor reported; those in them that ``COUNTED`` names are."""
COUNTED = {
    "bridge": "bridge",
    "tunnel": "tunnel",
    "railroad": "railway",
    "CRG": "surface",
    "include": "included file",
}
"""The nouns under which some elements are counted; ``IN_HEADER`` is reported if present."""
VALUES = frozenset({"a", "b", "c", "d", "inner", "outer"})  # an element says nothing if they are 0
OTHER_KINDS = {"osm": "Lanelet2 or OpenStreetMap", "net": "SUMO", "commonRoad": "CommonRoad"}
"""Whose XML files begin with these elements."""
IN_HEADER = ("geoReference", "offset")
NEWEST = "1.9"
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
TOLD = 3  # places that a remark lists


class MapRemarks:
    """Sentences about what was changed or left out, each with the places at which that happened. Those about
    a file ``of_one_road`` do not name the road."""

    def __init__(self, of_one_road: bool = False) -> None:
        self.of_one_road = of_one_road
        self._where = defaultdict[str, dict[str, None]](dict)

    def add(self, what: str, where: str, more: str = "") -> None:
        """Adds a sentence about one place, such as a road, and what more is to be said of this place."""
        named = ("" if self.of_one_road else where, more)
        self._where[what][": ".join(each for each in named if each)] = None

    def sentences(self) -> tuple[str, ...]:
        """Returns one sentence for each remark, with the first places and the number of all others."""
        return tuple(what + _listed([*filter(None, at)]) for what, at in self._where.items())


def _listed(places: Sequence[str]) -> str:
    more = f" and {len(places) - TOLD:,} more" if len(places) > TOLD else ""
    return f" ({', '.join(places[:TOLD])}{more})" if places else ""


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


Take = Callable[[Element, Counter[str]], None]
"""Takes a road or a junction, and the number of its elements that RoadGPT does not read, by their name."""


def read_tree(
    path: Path, take: Take, wants: Callable[[str, Mapping[str, str]], bool] = lambda tag, _: True
) -> tuple[list[str], frozenset[str]]:
    """Calls ``take`` with each road and junction of a file, in order, of which ``wants`` returns True for the
    name and the attributes. Returns the ids of all roads, and the elements of the header that RoadGPT does
    not read. Raises UsageError if the file cannot be read, is not OpenDRIVE, is too large, or has no road."""
    reader = _Reader(wants, take)
    _read(path, reader)
    if not reader.ids:
        raise UsageError("there is no road in it")
    return reader.ids, frozenset(() if OURS in reader.header else reader.header)


def count_roads(path: Path) -> int:
    """Returns the number of roads in a file; raises UsageError as ``read_tree`` does."""
    try:
        return len(read_tree(path, lambda node, passed: None, lambda tag, attributes: False)[0])
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


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
        why = f"it cannot be read: {error.strerror}"
        raise UsageError(f"{why}; give the path of an OpenDRIVE file") from error
    except (expat.ExpatError, UnicodeError, LookupError, ValueError) as error:
        raise UsageError(f"it is not well-formed XML ({error}); save it again as OpenDRIVE") from error


def _refuse_doctype(name: str, system: str | None, public: str | None, internal: int) -> None:
    raise UsageError("it has a DOCTYPE, which OpenDRIVE has no use for; remove it")


class _Reader:
    """Builds the elements below the root that are wanted, one at a time, and counts what is skipped."""

    def __init__(self, wants: Callable[[str, Mapping[str, str]], bool], take: Take) -> None:
        self.wants, self.take = wants, take
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
        is_temporary = self.stack and _is_temporary(attributes)
        if (
            self.hidden
            or is_temporary
            or (self.stack and tag not in READ and self.stack[-1].tag != "geometry")
        ):
            self.hidden += 1
            values = [attributes[name].strip("+-0.e") for name in VALUES & attributes.keys()]
            is_told = self.hidden == 1 and tag not in SILENT and (any(values) or not values)
            if is_temporary and self.hidden == 1:
                self.passed[f"temporary <{tag[:30]}>"] += 1
            elif tag in COUNTED or is_told:
                self.passed[COUNTED.get(tag, f"<{tag[:30]}>")] += 1
        elif self.stack:
            node = Element(tag, attributes)
            self.kept += 1
            if self.kept > MOST_KEPT:
                most = f"more than {MOST_KEPT:,} elements"
                raise UsageError(f"one of its roads has {most}; cut out what you need")
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
        elif tag == "header":
            if (version := attributes.get("revMajor", "1").strip()) > NEWEST[:1]:
                version = f"{version[:9]}.{attributes.get('revMinor', '0')[:9]}"
                raise UsageError(
                    f"it is OpenDRIVE {version}; only 1.1 to {NEWEST} are read, so save it as such"
                )
            self.header |= {OURS} if attributes.get("vendor") == OURS else set()

    def end(self, tag: str) -> None:
        """Handles the end tag of an XML element. A complete element is passed on."""
        self.depth -= 1
        if self.hidden:
            self.hidden -= 1
        elif self.stack:
            node = self.stack.pop()
            if not self.stack:
                self.take(node, self.passed)


def _is_temporary(attributes: Mapping[str, str]) -> bool:
    """Returns whether an element is of the temporary layer of roadworks, which OpenDRIVE 1.9 lays over the
    permanent one, or a temporary sign or object."""
    layers = (value for name, value in attributes.items() if name.lower().endswith("layer"))
    return "temporary" in layers or attributes.get("temporary") == "true"


def in_order(road: Element, remarks: MapRemarks, where: str) -> None:
    """Sorts the records of a road in place, and removes those that begin beyond its end. Adds a remark for
    each kind of record that was not in order, had several at one station, begins late, or begins beyond the
    end, and for a wrong length. Raises UsageError if a station is not a number."""
    line = road.findall("planView/geometry")
    end = max((number(each, "s") + abs(number(each, "length")) for each in line), default=0.0)

    def tell(what: str, more: str) -> None:
        remarks.add(what, where, more)

    for path in OF_ROAD if line else ():
        _sort(road, path, "s", (0.0, end), "", tell)
    sections = road.findall("lanes/laneSection")
    starts = [number(section, "s") for section in sections]
    for section, part in zip(sections, pairwise([*starts, end]), strict=True):
        for lane in section.findall("*/lane"):
            for tag in OF_LANE:
                _sort(lane, tag, "sOffset", part, f" of lane {lane.get('id', '?')[:10]}", tell)
    if abs((said := number(road, "length", end)) - end) > MERGED:
        tell("its length is not that of its line, which is taken", f"{said:g} m, not {end:g} m")


def _sort(
    holder: Element,
    path: str,
    station: str,
    part: tuple[float, float],
    of: str,
    tell: Callable[[str, str], None],
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
        for s in stations:
            tell(what, f"at s = {s:g} m{of}")
    parents = holder.findall(above or ".")
    for parent in reversed(parents):
        parent[:] = [node for node in parent if node.tag != tag]
        parent.extend(node for _, node in kept if parent is parents[0])
