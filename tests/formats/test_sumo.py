"""SUMO's plain files; what netconvert and SUMO say of them stands in authorities/."""

import stat
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.errors import ExportError
from roadgpt.export import save
from roadgpt_formats import sumo

ALWAYS = {".nod.xml", ".edg.xml", ".netccfg", ".rou.xml", ".sumocfg"}


@pytest.fixture
def no_netconvert(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sumo, "netconvert", lambda: None)


def netconvert_that(monkeypatch: pytest.MonkeyPatch, folder: Path, script: str) -> None:
    """Put a program of this name on the path."""
    program = folder / "bin" / "netconvert"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(program.parent), prepend=":")


@pytest.mark.usefixtures("no_netconvert")
@pytest.mark.parametrize("name", ROADS)
def test_edges_run_both_ways_along_the_centre_line(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    written = save(road, tmp_path, ["sumo"], WORLD, "a.b")
    assert {path.name.removeprefix("a.b") for path in written} == ALWAYS
    nodes = {node.attrib["id"]: node.attrib for node in ET.parse(tmp_path / "a.b.nod.xml").getroot()}
    there, back = ET.parse(tmp_path / "a.b.edg.xml").getroot()
    for edge, ends in ((there, ("start", "end")), (back, ("end", "start"))):
        assert (edge.attrib["from"], edge.attrib["to"]) == ends
        points = np.array([[float(v) for v in point.split(",")] for point in edge.attrib["shape"].split()])
        for end, point in zip(ends, points[[0, -1]], strict=True):
            assert [float(nodes[end][axis]) for axis in "xyz"] == point.tolist()
        s, t = road.locate(points[:, 0], points[:, 1])
        assert np.abs(t).max() < 1e-3
        assert points[:, 2] == pytest.approx(road.at(s)[:, 2], abs=1e-3)
        assert edge.attrib["spreadType"] == "right"
        assert (float(edge.attrib["width"]), float(edge.attrib["friction"])) == (4.0, 0.6)
    settings = ET.parse(tmp_path / "a.b.sumocfg").getroot()
    named = {each.attrib["value"] for each in settings.iter() if "value" in each.attrib}
    assert named == {"a.b.net.xml", "a.b.rou.xml"}
    (route,) = ET.parse(tmp_path / "a.b.rou.xml").getroot().iter("route")
    after = [split.attrib["idAfter"] for split in there.iter("split")]
    assert route.attrib["edges"].split() == [there.attrib["id"], *after]


@pytest.mark.usefixtures("no_netconvert")
@pytest.mark.parametrize("name", ROADS)
def test_each_piece_has_the_speed_that_suits_its_bends(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    save(road, tmp_path, ["sumo"], WORLD, "a")
    there, back = ET.parse(tmp_path / "a.edg.xml").getroot()
    sideways = min(3.0, 0.5 * WORLD.site.friction * 9.81)
    for edge in (there, back):
        splits = list(edge.iter("split"))
        starts = np.array([0.0, *(float(split.attrib["pos"]) for split in splits)])
        limits = np.array([float(each.attrib["speed"]) for each in (edge, *splits)])
        assert (np.diff(starts) > 5).all()
        assert limits.max() <= WORLD.limits.speed_limit + 1e-5
        s = np.linspace(0.05, road.length - 0.05, 400)
        along = s if edge is there else road.length - s
        allowed = limits[np.searchsorted(starts, along, side="right") - 1]
        bend = np.abs(road.curvature(s))
        # where a piece ends, its end may lie some centimetres off
        assert np.quantile(allowed**2 * bend / sideways, 0.98) <= 1.01
        suits = np.minimum(WORLD.limits.speed_limit, np.sqrt(sideways / np.maximum(bend, 1e-9)))
        assert allowed.max() >= min(suits.max() - 5 / 3.6 - 1e-6, WORLD.limits.speed_limit) - 5 / 3.6


def test_the_network_is_kept_without_the_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    netconvert_that(monkeypatch, tmp_path, 'echo "<!-- generated today in $PWD -->\n<net/>" > road.net.xml')
    written = save(ROADS["arcs"], tmp_path / "out", ["sumo"], WORLD)
    assert {path.name.removeprefix("road") for path in written} == {*ALWAYS, ".net.xml"}
    assert (tmp_path / "out" / "road.net.xml").read_text() == "<net/>\n"


@pytest.mark.parametrize("script", ["echo 'Error: no such thing' >&2; exit 1", "exit 0"])
def test_what_netconvert_refuses_is_said_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str
) -> None:
    netconvert_that(monkeypatch, tmp_path, script)
    with pytest.raises(ExportError, match="netconvert refuses this road"):
        save(ROADS["arcs"], tmp_path / "out", ["sumo"], WORLD)
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.usefixtures("no_netconvert")
def test_netconvert_is_told_to_add_no_ways_back_at_the_ends(tmp_path: Path) -> None:
    """netconvert adds a turnaround to each dead end unless it is told not to."""
    save(next(iter(ROADS.values())), tmp_path, ["sumo"], WORLD, "a")
    root = ET.parse(tmp_path / "a.netccfg").getroot()
    (told,) = root.iter("no-turnarounds")
    assert told.attrib == {"value": "true"}
