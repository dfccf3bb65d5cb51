"""Reads one road from an OpenDRIVE file, skips the rest of the file, and is safe against malicious XML.

A file with a DOCTYPE is refused, so that no XML entities can be declared, fetched or expanded. Limits on file
size, number of elements, depth and tag length bound the time and memory that reading takes.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element
from xml.parsers import expat

from roadgpt.errors import UsageError
from roadgpt.reading import opened
from roadgpt.road.opendrive.numbers import NUMBER

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
"""The elements of a road that RoadGPT reads."""
SILENT = ("objects", "signals", "surface", "link", "userData", "dataQuality", "sway", "explicit")
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


@dataclass(frozen=True)
class Choice:
    """The road that was selected from a file, and information about the other contents of the file."""

    road: Element
    others: tuple[str, ...]
    """Ids of all roads in the file."""
    passed: Mapping[str, int]
    """Number of skipped elements of the road for each type of element, such as objects and signals."""
    header: frozenset[str]
    """Names of the header elements (``geoReference``, ``offset``) that the file contains and that are
    skipped.
    """


def read_tree(path: Path, wanted: str | None) -> Choice:
    """Returns the road with the id ``wanted``, and information about the other contents of the file. If
    ``wanted`` is None, roads with a driving lane are preferred, then roads outside junctions, then longer
    roads. Raises UsageError if the file cannot be read, is not OpenDRIVE, is too large, or has no such road.
    """
    reader = _RoadSelector(wanted)
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
    return reader.choice()


def _refuse_doctype(name: str, system: str | None, public: str | None, internal: int) -> None:
    raise UsageError("it has a DOCTYPE, which OpenDRIVE has no use for; remove it")


class _RoadSelector:
    """Counts what is skipped, and keeps the selected road."""

    def __init__(self, wanted: str | None) -> None:
        self.wanted = wanted
        self.ids: list[str] = []
        self.best: tuple[tuple[bool, bool, float], Element, Counter[str]] | None = None
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
        if self.hidden or (self.stack and tag not in READ and self.stack[-1].tag != "geometry"):
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
        elif self.depth == 2 and tag == "road":
            self.ids.append(attributes.get("id", ""))
            if self.wanted is None or attributes.get("id") == self.wanted:
                self.stack.append(Element(tag, attributes))
                self.kept = 0
                self.passed = Counter()
        elif tag in IN_HEADER and not self.ids:
            self.header.add(tag)
        elif tag == "header" and attributes.get("vendor") == OURS:
            self.header.add(OURS)

    def end(self, tag: str) -> None:
        """Handles the end tag of an XML element. A complete road is compared with the best one so far."""
        self.depth -= 1
        if self.hidden:
            self.hidden -= 1
        elif self.stack:
            node = self.stack.pop()
            if not self.stack:
                self._compare(node)

    def _compare(self, road: Element) -> None:
        is_driven = any(lane.get("type") in DRIVING for lane in road.findall("lanes/laneSection/*/lane"))
        is_free = road.get("junction", "-1") == "-1"
        length = road.get("length", "0")
        rank = (is_driven, is_free, float(length) if NUMBER.fullmatch(length) else 0.0)
        if self.best is None or rank > self.best[0]:
            self.best = (rank, road, self.passed)

    def choice(self) -> Choice:
        """Returns the selected road, after the whole file has been parsed."""
        if self.best is None:
            if not self.ids:
                raise UsageError("there is no road in it")
            told = ", ".join(self.ids[:12]) + (", ..." if len(self.ids) > 12 else "")
            raise UsageError(f"there is no road {self.wanted} in it; there are: {told}")
        _, road, passed = self.best
        header = set() if OURS in self.header else self.header
        return Choice(road, tuple(self.ids), passed, frozenset(header))
