"""A second reader of OpenDRIVE maps, which is slow and shares no code with RoadGPT's: lines are summed up in
steps of 2 cm, lanes are followed by the links of the file alone."""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

FINE = 0.02  # m
DRIVING = {"driving", "bidirectional", "slipLane", "entry", "exit", "onRamp", "offRamp", "connectingRamp"}


def read(path: Path | str) -> Element:
    """The root of a file, with tags without namespaces."""
    root = ElementTree.fromstring(Path(path).read_bytes().lstrip())
    for node in root.iter():
        node.tag = node.tag.rpartition("}")[2]
    return root


def number(node: Element, name: str) -> float:
    return float(node.get(name, "0"))


def line(road: Element) -> np.ndarray:
    """Rows (s, x, y, heading) along the reference line; each geometry begins where the file says."""
    found = []
    for node in sorted(road.findall("planView/geometry"), key=lambda each: number(each, "s")):
        s, x, y, heading, length = (number(node, name) for name in ("s", "x", "y", "hdg", "length"))
        u = np.linspace(0.0, length, max(2, math.ceil(length / FINE) + 1))
        shape = next(each for each in node if each.tag in ("line", "arc", "spiral", "poly3", "paramPoly3"))
        if shape.tag in ("line", "arc", "spiral"):
            k0 = number(shape, "curvStart") or number(shape, "curvature")
            k1 = number(shape, "curvEnd") if shape.tag == "spiral" else k0
            k0 = number(shape, "curvStart") if shape.tag == "spiral" else k0

            def angle(at: np.ndarray, k0: float = k0, k1: float = k1, length: float = length) -> np.ndarray:
                return at * (k0 + (k1 - k0) * at / (2 * max(length, 1e-12)))

            middle = (u[1:] + u[:-1]) / 2
            step = np.diff(u) / 6
            # Simpson's rule
            p, q = (
                np.r_[0.0, np.cumsum(step * (f(angle(u[:-1])) + 4 * f(angle(middle)) + f(angle(u[1:]))))]
                for f in (np.cos, np.sin)
            )
            turned = angle(u)
        else:
            p, q, turned = along_polynomial(shape, u, length)
        c, d = math.cos(heading), math.sin(heading)
        found.append(np.column_stack([s + u, x + c * p - d * q, y + d * p + c * q, heading + turned]))
    return np.concatenate(found)


def along_polynomial(
    shape: Element, u: np.ndarray, length: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Local x, y and heading at equal shares of a polynomial's own arc length, over ``length`` metres."""
    if shape.tag == "poly3":
        across = [number(shape, name) for name in "abcd"]
        along, end = [0.0, 1.0, 0.0, 0.0], length
    else:
        along, across = ([number(shape, f"{name}{axis}") for name in "abcd"] for axis in "UV")
        end = length if shape.get("pRange") == "arcLength" else 1.0
    p = np.linspace(0.0, end, 20 * len(u))
    x, y = np.polyval(along[::-1], p), np.polyval(across[::-1], p)
    walked = np.r_[0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y)))]
    whole = length if shape.tag == "poly3" else walked[-1]
    own = np.interp(u / length * whole, walked, p)
    dx, dy = (np.polyval(np.polyder(np.poly1d(each[::-1])), own) for each in (along, across))
    return np.polyval(along[::-1], own), np.polyval(across[::-1], own), np.unwrap(np.arctan2(dy, dx))


def cubic(nodes: list[Element], s: float, start: float, name: str) -> float:
    rows = sorted(((start + number(each, name), each) for each in nodes), key=lambda row: row[0])
    before = [row for row in rows if row[0] <= s + 1e-9] or rows[:1]
    if not before:
        return 0.0
    at, node = before[-1]
    u = max(s - at, 0.0)
    return sum(number(node, letter) * u**n for n, letter in enumerate("abcd"))


class LaneOfFile(NamedTuple):
    """A lane of one section of a road."""

    road: str
    section: int
    lane: int


class Movement(NamedTuple):
    """Where traffic leaves a lane and where it enters the next one, across a joint: x, y."""

    before: tuple[float, float]
    after: tuple[float, float]


class SlowMap:
    """The roads of a file, and how traffic goes from one lane to the next."""

    def __init__(self, path: Path | str) -> None:
        root = read(path)
        self.roads = {node.get("id", ""): node for node in root.findall("road")}
        self.junctions = root.findall("junction")
        self.lines = {name: line(node) for name, node in self.roads.items()}

    def sections(self, road: str) -> list[tuple[float, float, Element]]:
        nodes = sorted(self.roads[road].findall("lanes/laneSection"), key=lambda each: number(each, "s"))
        ends = [number(each, "s") for each in nodes[1:]] + [float(self.lines[road][-1, 0])]
        return [(number(each, "s"), end, each) for each, end in zip(nodes, ends, strict=True)]

    def lanes(self, road: str, section: int) -> dict[int, Element]:
        node = self.sections(road)[section][2]
        return {int(number(lane, "id")): lane for lane in node.iter("lane") if number(lane, "id")}

    def is_driven(self, at: LaneOfFile) -> bool:
        lane = self.lanes(at.road, at.section).get(at.lane)
        return lane is not None and lane.get("type") in DRIVING

    def leads_along(self, at: LaneOfFile) -> bool:
        return (at.lane < 0) != (self.roads[at.road].get("rule") == "LHT")

    def centre(self, at: LaneOfFile, at_end: bool) -> tuple[float, float]:
        """The middle of a lane at the start or the end of its section."""
        start, end, _ = self.sections(at.road)[at.section]
        s = end - 1e-6 if at_end else start
        lanes, sign = self.lanes(at.road, at.section), 1 if at.lane > 0 else -1
        t = cubic(self.roads[at.road].findall("lanes/laneOffset"), s, 0.0, "s")
        for n in range(1, abs(at.lane) + 1):
            width = cubic(lanes[sign * n].findall("width"), s, start, "sOffset") if sign * n in lanes else 0.0
            t += sign * width * (0.5 if n == abs(at.lane) else 1.0)
        rows = self.lines[at.road]
        _, x, y, heading = rows[min(int(np.searchsorted(rows[:, 0], s, side="right")), len(rows) - 1)]
        return x - t * math.sin(heading), y + t * math.cos(heading)

    def movements(self) -> Iterator[Movement]:
        """Every step of traffic from the end of one road onto another road that is outside junctions, or
        through a junction from the road before it to the road behind it."""
        for road, node in self.roads.items():
            if node.get("junction", "-1") not in ("-1", ""):
                continue
            for name, at_end in (("predecessor", False), ("successor", True)):
                link = node.find(f"link/{name}")
                if link is None or link.get("elementType", "road") != "road":
                    continue
                yield from self._onto(
                    road, at_end, link.get("elementId", ""), link.get("contactPoint", "start")
                )
        for junction in self.junctions:
            if junction.get("type", "default") == "default":
                for each in junction.findall("connection"):
                    yield from self._through(each)

    def _onto(self, road: str, at_end: bool, other: str, contact: str) -> Iterator[Movement]:
        if other not in self.roads or self.roads[other].get("junction", "-1") not in ("-1", ""):
            return
        last = len(self.sections(road)) - 1 if at_end else 0
        there = 0 if contact == "start" else len(self.sections(other)) - 1
        for lane, node in self.lanes(road, last).items():
            own = LaneOfFile(road, last, lane)
            for link in node.findall(f"link/{'successor' if at_end else 'predecessor'}"):
                next_lane = LaneOfFile(other, there, int(number(link, "id")))
                goes = self.leads_along(own) == at_end
                if goes and self.is_driven(own) and self.is_driven(next_lane):
                    yield Movement(self.centre(own, at_end), self.centre(next_lane, contact == "end"))

    def _through(self, connection: Element) -> Iterator[Movement]:
        road = connection.get("connectingRoad", "")
        if road not in self.roads:
            return
        at_start = connection.get("contactPoint", "start") == "start"
        before, after = (
            self.roads[road].find(f"link/{name}")
            for name in (("predecessor", "successor") if at_start else ("successor", "predecessor"))
        )
        if (
            before is None
            or after is None
            or {before.get("elementType"), after.get("elementType")} != {"road"}
        ):
            return
        ends = [(each.get("elementId", ""), each.get("contactPoint", "start")) for each in (before, after)]
        if any(
            name not in self.roads or self.roads[name].get("junction", "-1") not in ("-1", "")
            for name, _ in ends
        ):
            return
        count = len(self.sections(road))
        order = range(count) if at_start else range(count - 1, -1, -1)
        onward = "successor" if at_start else "predecessor"
        (first, first_at), (last, last_at) = ends
        for link in connection.findall("laneLink"):
            begin = 0 if first_at == "start" else len(self.sections(first)) - 1
            start = LaneOfFile(first, begin, int(number(link, "from")))
            lane: int | None = int(number(link, "to"))
            for n, section in enumerate(order):
                at = LaneOfFile(road, section, lane or 0)
                if lane is None or not self.is_driven(at) or self.leads_along(at) != at_start:
                    lane = None
                    break
                links = self.lanes(road, section)[lane].findall(f"link/{onward}")
                lane = int(number(links[0], "id")) if links else (lane if n < count - 1 else None)
            if lane is None:
                continue
            goal = LaneOfFile(last, 0 if last_at == "start" else len(self.sections(last)) - 1, lane)
            comes = self.is_driven(start) and self.leads_along(start) == (first_at == "end")
            goes = self.is_driven(goal) and self.leads_along(goal) == (last_at == "start")
            if comes and goes:
                yield Movement(self.centre(start, first_at == "end"), self.centre(goal, last_at == "end"))
