"""Networks that the planner drafts: an outside referee, where it is at hand, sees what was asked for.

It reads only the exported files. Truths were written by hand from the words of the plans.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from outside_judge import networks_referee
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.export import save
from roadgpt.network import made_from
from roadgpt.road import Site, World
from tables import rows


def assert_refereed(line: str, world: World, truth: dict[str, Any], folder: Path) -> None:
    brief = read_plan(line)
    route = made_from(draft(brief, world, seed=1), world)
    assert inspect(route, brief, world) == ()
    save(route, folder, ["opendrive"], world, "x")
    way = json.loads((folder / "x.route.json").read_text())
    if "map" in truth:
        truth = {**truth, "junctions": len(route.passages)}
    holds, measured = networks_referee().check(folder / "x.xodr", way, truth)
    assert all(holds.values()), (holds, measured["breaks"], measured["junctions"])
    assert measured["faults"] == []


@pytest.mark.parametrize(("line", "map_size", "truth"), rows(__file__, "route"))
def test_a_route_is_what_was_asked_for(
    line: str, map_size: float, truth: dict[str, Any], tmp_path: Path
) -> None:
    junctions = sum(each["kind"] not in ("turn", "straight") for each in truth["sequence"])
    world = World(site=Site(map_size=map_size))
    assert_refereed(line, world, {"junctions": junctions, **truth}, tmp_path)


@pytest.mark.parametrize(("line", "truth"), rows(__file__, "map"))
def test_a_map_is_what_was_asked_for(line: str, truth: dict[str, Any], tmp_path: Path) -> None:
    world = world_for(read_plan(line), World())
    assert_refereed(line, world, {"map": {"connected": True, **truth}}, tmp_path)
