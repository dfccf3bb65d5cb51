"""Angles, one-way arms, tapers and dead ends that a plan requires: drafted, built and measured from outside.

The OpenDRIVE file is read here by a few lines of its own.
"""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.export import save
from roadgpt.network import build_route
from roadgpt.road import Site, World

WIDE = World(site=Site(map_size=600))
MAPS = {
    "map columns=2 rows=2 dead_ends=0": (4, 0),
    "map columns=3 rows=1 dead_ends=3 lights": (3, 3),
    "map columns=1 rows=1 dead_ends=1": (1, 1),
    "map t_junction x4 dead_ends=0": (3, 0),
    "map t_junction x3 dead_ends=5": (0, 5),
    "map crossroads x2; t_junction x2 dead_ends=2": (3, 2),
    "map roundabout; t_junction dead_ends=1": (None, 1),
    "map t_junction x4 blocks=0": (0, 6),
    "map t_junction x2 blocks=2": (2, 0),
    "map t_junction x2 blocks=1 dead_ends=2": (1, 2),
    "map crossroads x3 blocks=0 lights": (0, 8),
    "map crossroads; y_junction x2 blocks=2 || left_hand": (2, 2),
}


def exported(line: str, seed: int, folder: Path) -> Any:
    """The root of the OpenDRIVE file of a draft that meets its plan."""
    brief = read_plan(line)
    design = draft(brief, WIDE, seed=seed)
    route = build_route(design, WIDE)
    assert inspect(route, brief, WIDE) == ()
    save(route, folder, ["opendrive"], WIDE, "x")
    return etree.parse(folder / "x.xodr").getroot()


def headings(root: Any) -> list[float]:
    """Of each road at the only junction: its heading away from it in degrees."""
    found = []
    for road in root.iter("road"):
        for tag, is_end in (("predecessor", False), ("successor", True)):
            link = road.find(f"link/{tag}")
            if road.get("junction") != "-1" or link is None or link.get("elementType") != "junction":
                continue
            geometry = road.findall("planView/geometry")[-1 if is_end else 0]
            heading = float(geometry.get("hdg")) + (math.pi if is_end else 0.0)
            arc = geometry.find("arc")
            assert geometry.find("spiral") is None
            if is_end and arc is not None:
                heading += float(arc.get("curvature")) * float(geometry.get("length"))
            found.append(math.degrees(heading) % 360)
    return sorted(found)


@pytest.mark.parametrize("degrees", [42, 65, 80, 110, 138])
def test_two_roads_cross_at_the_angle_that_was_asked_for(degrees: int, tmp_path: Path) -> None:
    found = headings(exported(f"crossroads left deg={degrees}", 3, tmp_path))
    gaps = [b - a for a, b in pairwise([*found, found[0] + 360])]
    assert min(gaps) == pytest.approx(min(degrees, 180 - degrees), abs=5.5)


@pytest.mark.parametrize("line", MAPS)
def test_a_map_has_as_many_dead_ends_as_were_asked_for(line: str, tmp_path: Path) -> None:
    blocks, dead_ends = MAPS[line]
    root = exported(line, 1, tmp_path)
    own = [road for road in root.iter("road") if road.get("junction") == "-1"]
    met = [[road.find(f"link/{tag}") is not None for tag in ("predecessor", "successor")] for road in own]
    assert sum(each.count(False) for each in met) == dead_ends
    if blocks is not None:  # areas of a connected plane graph, by Euler's formula
        vertices = len(root.findall("junction")) + dead_ends
        assert len(own) - vertices + 1 == blocks


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("line", ["columns=1 rows=1 dead_ends=..1", "columns=1..2 rows=1 dead_ends=0"])
def test_a_grid_without_junctions_is_drawn_anew(line: str, seed: int, tmp_path: Path) -> None:
    assert exported(f"map {line}", seed, tmp_path).find("junction") is not None
