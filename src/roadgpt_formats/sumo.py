"""Exports roads for SUMO: nodes, edges, a trip and settings, and the network if netconvert is installed.

Source: SUMO user documentation, "PlainXML", "netconvert", "Definition of Vehicles"."""

import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.export.ego import CAR, Poses
from roadgpt.export.markup import Value, XmlElement, number
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import line, stations
from roadgpt.road.profile import Width
from roadgpt_formats.ego import PULL, calm_speeds

PATIENCE = 120.0  # s, for netconvert
PRECISION = 4  # decimals of a metre in a network
DECIMALS = 4
SHORTEST = 12.0  # m, the shortest part with a speed limit of its own
LOOKS = 13  # places in such a part at which the curvature is sampled
ROUND = 5 / 3.6  # m/s: limits are multiples of 5 km/h, as on signs


class Sumo:
    """SUMO network in plain XML (nodes and edges, with heights), a trip and settings; also .net.xml if
    netconvert is installed.

    A lane in SUMO has a single width and a level cross-section: if the width of a lane varies, its mean is
    written, and superelevation is left out."""

    name = "sumo"
    suffix = ".nod.xml"
    for_junctions = "opendrive can, and netconvert reads it"
    lacks = ("superelevation", "changes of width", "the land around")

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes NAME.nod.xml, .edg.xml, .netccfg, .rou.xml and .sumocfg; also .net.xml if netconvert is
        installed."""
        stem = path.name.removesuffix(self.suffix)
        limits, ways = speed_zones(road, world), _ways(road, world.profile_of(road))
        converted: dict[str, dict[str, Value]] = {
            "input": {"node-files": f"{stem}.nod.xml", "edge-files": f"{stem}.edg.xml"},
            "output": {"output-file": f"{stem}.net.xml"},
            "formatting": {"precision": PRECISION},
            "processing": {"offset.disable-normalization": "true"},
            "junctions": {"no-turnarounds": "true"},
        }
        simulated = {"input": {"net-file": f"{stem}.net.xml", "route-files": f"{stem}.rou.xml"}}
        files = {
            self.suffix: _nodes(ways[0].shape),
            ".edg.xml": _edges(ways, world, limits),
            ".netccfg": _configuration(converted),
            ".rou.xml": _trip(limits, world.profile_of(road)),
            ".sumocfg": _configuration(simulated),
        }
        for suffix, document in files.items():
            path.with_name(stem + suffix).write_bytes(document.to_text().encode())
        program = netconvert()
        if program is not None:
            _convert(program, path.with_name(f"{stem}.netccfg"), path.with_name(f"{stem}.net.xml"))


def netconvert() -> str | None:
    """Returns the path of SUMO's netconvert; None if it is not installed.

    The function searches PATH, SUMO_HOME and the Python package eclipse-sumo."""
    places = [Path(os.environ["SUMO_HOME"])] if os.environ.get("SUMO_HOME") else []
    package = find_spec("sumo")
    if package is not None:
        places += [Path(each) for each in package.submodule_search_locations or ()]
    found = shutil.which("netconvert")
    for place in places:
        found = found or shutil.which("netconvert", path=place / "bin")
    return found


def _nodes(shape: Array) -> XmlElement:
    out = XmlElement("nodes")
    for name, (x, y, z) in (("start", shape[0].tolist()), ("end", shape[-1].tolist())):
        out.add("node", {"id": name, "x": x, "y": y, "z": z, "type": "dead_end"})
    return out


class SumoEdge(NamedTuple):
    """The lanes of one direction, which lie to the right of a line, from the inside out."""

    name: str
    start: str
    end: str
    shape: Array
    widths: list[float]  # m


def _ways(road: Road, profile: Profile) -> list[SumoEdge]:
    at, s = stations(road, profile.paved_reach), road.sample().s
    found, sides = [], (("road", profile.along_ids), ("back", profile.against_ids))
    for name, ids in sides:
        if ids:
            inner = profile.edges_of(ids[0], at)[name == "back"]
            shape = np.round(line(road, at, inner), DECIMALS) + 0.0
            widths = [_mean(profile.lanes[lane].width, s) for lane in ids]
            ends = ("start", "end") if name == "road" else ("end", "start")
            found.append(SumoEdge(name, *ends, shape if name == "road" else shape[::-1], widths))
    return found


class SpeedZone(NamedTuple):
    """A stretch of road with one speed limit; it ends where the next zone starts."""

    start: float  # station in metres where the zone starts
    speed: float  # speed limit in m/s


def speed_zones(road: Road, world: World) -> list[SpeedZone]:
    """Divides the road into consecutive zones. The speed limit of a zone is the lowest speed of a calm driver
    within the zone, rounded down to a multiple of 5 km/h, but at least 5 km/h.

    A zone is at least SHORTEST metres long; a shorter road is a single zone. Cars in SUMO brake in time for
    the speed limit of the next zone, so they drive bends at a suitable speed."""
    ends = np.linspace(0.0, road.length, max(1, int(road.length / SHORTEST)) + 1)
    out: list[SpeedZone] = []
    for a, b in pairwise(ends.tolist()):
        least = float(calm_speeds(road, world, np.linspace(a, b, LOOKS)).min())
        rounded = float(np.clip(np.floor(least / ROUND) * ROUND, ROUND, world.limits.speed_limit))
        if not out or rounded != out[-1].speed:
            out.append(SpeedZone(a, rounded))
    return out


def _edges(ways: Sequence[SumoEdge], world: World, limits: Sequence[SpeedZone]) -> XmlElement:
    along = float(np.hypot(*np.diff(ways[-1].shape[:, :2], axis=0).T).sum())
    ends = [*(limit.start for limit in limits[1:]), along]
    back = [SpeedZone(along - end, limit.speed) for end, limit in zip(ends, limits, strict=True)][::-1]
    out = XmlElement("edges")
    for (name, start, end, points, widths), pieces in zip(ways, (limits, back), strict=False):
        lanes: dict[str, Value] = {"numLanes": len(widths), "speed": round(pieces[0].speed, 6)}
        lanes |= {"width": widths[0], "friction": world.site.friction, "spreadType": "right"}
        told = " ".join(",".join(map(number, point)) for point in points.tolist())
        edge = out.add("edge", {"id": name, "from": start, "to": end, **lanes, "shape": told})
        if len({*widths}) > 1:
            for n, width in enumerate(reversed(widths)):  # SUMO counts from the right
                edge.add("lane", {"index": n, "width": width})
        for n, piece in enumerate(pieces[1:], 1):
            at: dict[str, Value] = {"pos": round(piece.start, DECIMALS), "speed": round(piece.speed, 6)}
            edge.add("split", {**at, "id": f"{name}_at_{n}", "idAfter": f"{name}_{n}"})
    return out


def _mean(width: Width, s: Array) -> float:
    if not isinstance(width, CubicProfile):
        return width
    return round(float(width.height(np.maximum(s, width.stations[0])).mean()), DECIMALS)


def _trip(limits: Sequence[SpeedZone], profile: Profile) -> XmlElement:
    out = XmlElement("routes")
    car = {"length": CAR.length, "width": CAR.width, "accel": PULL, "decel": PULL}
    out.add("vType", {"id": "saloon", "vClass": "passenger", **car, "sigma": 0, "speedDev": 0})
    lane = profile.along_ids[::-1].index(profile.driven_id)  # SUMO counts from the right
    begin: dict[str, Value] = {"depart": 0, "departPos": "base", "departSpeed": 0}
    place = {"departLane": lane} if lane else {}
    ego = out.add("vehicle", {"id": "ego", "type": "saloon", **place, **begin})
    ego.add("route", {"edges": " ".join(["road", *(f"road_{n}" for n in range(1, len(limits)))])})
    return out


def _configuration(sections: Mapping[str, Mapping[str, Value]]) -> XmlElement:
    out = XmlElement("configuration")
    for name, options in sections.items():
        section = out.add(name)
        for option, value in options.items():
            section.add(option, {"value": value})
    return out


def _convert(program: str, settings: Path, network: Path) -> None:
    """Runs netconvert, and removes the comment in which it states when and where it ran."""
    try:
        done = subprocess.run(  # noqa: S603 -- an installed program, and our own file by name
            [program, "-c", settings.name],
            cwd=settings.parent,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ExportError(f"SUMO's netconvert does not work ({error}); repair or uninstall SUMO") from error
    if done.returncode or not network.exists():
        said = [said for said in done.stderr.splitlines() if said.startswith("Error")] or ["it wrote no file"]
        raise ExportError(f"SUMO's netconvert refuses this road ({said[0]}); look at its map")
    text = network.read_text(encoding="utf-8")
    network.write_bytes(re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL).encode())
