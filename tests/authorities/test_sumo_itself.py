"""SUMO's netconvert makes a network of our files, and SUMO drives a car along it."""

import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD, program
from roadgpt.export import save


@pytest.fixture
def sumo(monkeypatch: pytest.MonkeyPatch) -> str:
    """The simulator; its converter is put on the path."""
    found = program("sumo", "venv-sumo")
    program("netconvert", "venv-sumo")
    monkeypatch.setenv("PATH", str(Path(found).parent), prepend=os.pathsep)
    return found


@pytest.mark.parametrize("name", [name for name in ROADS if name != "short"])
def test_sumo_drives_our_road_from_start_to_end(sumo: str, tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        save(road, folder, ["sumo"], WORLD)
    one, two = ((folder / "road.net.xml").read_bytes() for folder in folders)
    assert one == two
    edges = {edge.attrib["id"]: edge for edge in ET.fromstring(one).iter("edge")}
    for id_, offset in (("road", -2.0), ("back", 2.0)):
        (lane,) = edges[id_].findall("lane")
        points = np.array([[float(v) for v in point.split(",")] for point in lane.attrib["shape"].split()])
        s, t = road.locate(points[:, 0], points[:, 1])
        inside = (s > 0.5) & (s < road.length - 0.5)
        assert np.abs(t[inside] - offset).max() < 0.02
        heights = points[:, 2] if points.shape[1] == 3 else np.zeros(len(s))  # SUMO leaves out zeros
        assert np.abs(heights[inside] - road.at(s[inside])[:, 2]).max() < 0.01
        assert float(lane.attrib["speed"]) == pytest.approx(WORLD.limits.speed_limit, abs=0.01)
        assert float(lane.attrib["width"]) == 4.0
    trip = tmp_path / "trip.xml"
    settings = folders[0] / "road.sumocfg"
    drive = [
        sumo, "-c", str(settings), "--tripinfo-output", str(trip), "--no-step-log", "true", "--end", "900",
    ]  # fmt: skip
    done = subprocess.run(drive, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Error" not in done.stderr + done.stdout
    (info,) = ET.parse(trip).getroot().findall("tripinfo")
    assert float(info.attrib["routeLength"]) == pytest.approx(road.length, rel=0.05)
