"""SUMO: nodes, edges, a trip and settings; the network itself where SUMO's netconvert is installed.

Source: SUMO user documentation, "PlainXML", "netconvert", "Definition of Vehicles".
"""

import os
import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.export.edges import line, stations
from roadgpt.export.ego import CAR, calm_speed
from roadgpt.export.markup import Element, Value, number
from roadgpt.export.poses import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

PATIENCE = 120.0  # s, for netconvert
PRECISION = 4  # decimals of a metre in a network
DECIMALS = 4


class Sumo:
    """SUMO's plain nodes and edges with heights, a trip, settings; .net.xml where netconvert is installed."""

    name = "sumo"
    suffix = ".nod.xml"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Write NAME.nod.xml, .edg.xml, .netccfg, .rou.xml, .sumocfg, and .net.xml if it can be made."""
        stem = path.name.removesuffix(self.suffix)
        shape = np.round(line(road, stations(road, world.lane_width), 0.0), DECIMALS) + 0.0
        files = {
            self.suffix: _nodes(shape),
            ".edg.xml": _edges(shape, world),
            ".netccfg": _conversion(stem),
            ".rou.xml": _trip(road, world),
            ".sumocfg": _settings(stem),
        }
        for suffix, document in files.items():
            path.with_name(stem + suffix).write_bytes(document.to_text().encode())
        program = netconvert()
        if program is not None:
            _convert(program, path.with_name(f"{stem}.netccfg"), path.with_name(f"{stem}.net.xml"))


def netconvert() -> str | None:
    """SUMO's converter: on the path, under SUMO_HOME or in the package eclipse-sumo; or None."""
    places = [Path(os.environ["SUMO_HOME"])] if os.environ.get("SUMO_HOME") else []
    package = find_spec("sumo")
    if package is not None:
        places += [Path(each) for each in package.submodule_search_locations or ()]
    found = shutil.which("netconvert")
    for place in places:
        found = found or shutil.which("netconvert", path=place / "bin")
    return found


def _nodes(shape: Array) -> Element:
    out = Element("nodes")
    for name, point in (("start", shape[0]), ("end", shape[-1])):
        out.add("node", {"id": name, **dict(zip("xyz", point.tolist(), strict=True)), "type": "dead_end"})
    return out


def _edges(shape: Array, world: World) -> Element:
    """One edge each way along the centre line; lanes lie to the right of it."""
    out = Element("edges")
    lanes: dict[str, Value] = {
        "numLanes": 1,
        "speed": round(world.speed_limit, 6),
        "width": world.lane_width,
        "friction": world.friction,
        "spreadType": "right",
    }
    ways = (("road", "start", "end", shape), ("back", "end", "start", shape[::-1]))
    for name, start, end, points in ways:
        told = " ".join(",".join(map(number, point)) for point in points.tolist())
        out.add("edge", {"id": name, "from": start, "to": end, **lanes, "shape": told})
    return out


def _trip(road: Road, world: World) -> Element:
    out = Element("routes")
    car = {"length": CAR.length, "width": CAR.width, "maxSpeed": round(calm_speed(road, world), 6)}
    out.add("vType", {"id": "saloon", "vClass": "passenger", **car, "sigma": 0, "speedDev": 0})
    ego = out.add(
        "vehicle", {"id": "ego", "type": "saloon", "depart": 0, "departPos": "base", "departSpeed": 0}
    )
    ego.add("route", {"edges": "road"})
    return out


def _conversion(stem: str) -> Element:
    """What netconvert is to do: ``netconvert -c NAME.netccfg``."""
    out = Element("configuration")
    files = out.add("input")
    files.add("node-files", {"value": f"{stem}.nod.xml"})
    files.add("edge-files", {"value": f"{stem}.edg.xml"})
    out.add("output").add("output-file", {"value": f"{stem}.net.xml"})
    out.add("formatting").add("precision", {"value": PRECISION})
    out.add("processing").add("offset.disable-normalization", {"value": "true"})
    out.add("junctions").add("no-turnarounds", {"value": "true"})
    return out


def _settings(stem: str) -> Element:
    out = Element("configuration")
    files = out.add("input")
    files.add("net-file", {"value": f"{stem}.net.xml"})
    files.add("route-files", {"value": f"{stem}.rou.xml"})
    return out


def _convert(program: str, settings: Path, network: Path) -> None:
    """Have the network made, and leave out the comment in which netconvert says when and where.

    Raises:
        ExportError: netconvert refuses or takes too long.
    """
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
        raise ExportError(f"SUMO's netconvert does not work ({error}); mend or uninstall SUMO") from error
    if done.returncode or not network.exists():
        said = [said for said in done.stderr.splitlines() if said.startswith("Error")] or ["it wrote no file"]
        raise ExportError(f"SUMO's netconvert refuses this road ({said[0]}); look at its map")
    text = network.read_text(encoding="utf-8")
    network.write_bytes(re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL).encode())
