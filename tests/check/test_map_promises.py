"""What a map must show of its Brief: blocks, kinds of junctions, signs and distances."""

from typing import Any

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.measures import measured_map
from roadgpt.network import Route, build_route
from roadgpt.road import Site, World, read_design
from tables import rows

WORLD = World(site=Site(map_size=600))


def made(
    nodes: list[tuple[float, float, str]], roads: list[list[int]], route: list[int], **more: Any
) -> Route:
    data: dict[str, Any] = {
        f"node{n}": {"at": [x, y, 0], "kind": kind, **(more if kind not in ("end", "bend") else {})}
        for n, (x, y, kind) in enumerate(nodes, 1)
    }
    return build_route(read_design({**data, "roads": roads, "route": route})[0], WORLD)


def grid(**more: Any) -> Route:
    """Two by one blocks with sides of 80 m, and one road that leads out."""
    nodes = [(100 + 80 * i, 100 + 80 * j, "bend") for j in range(2) for i in range(3)]
    nodes[0], nodes[1], nodes[4] = (
        (100, 100, "t_junction"),
        (180, 100, "t_junction"),
        (180, 180, "t_junction"),
    )
    nodes.append((60, 100, "end"))
    roads = [[1, 2], [2, 3], [3, 6], [6, 5], [5, 4], [4, 1], [2, 5], [7, 1]]
    return made(nodes, roads, [7, 1, 2, 5], **more)


def village(*controls: str, **more: Any) -> Route:
    """Crossroads, joined to a fork; with signs of their own if two are given."""
    nodes = [(200.0, 200.0, "crossroads"), (290.0, 200.0, "y_junction"), (160.0, 200.0, "end")]
    nodes += [(200.0, 160.0, "end"), (200.0, 240.0, "end"), (310.0, 235.0, "end"), (310.0, 165.0, "end")]
    roads = [[1, 2], [3, 1], [4, 1], [5, 1], [2, 6], [2, 7]]
    if not controls:
        return made(nodes, roads, [3, 1, 2, 6], **more)
    data: dict[str, Any] = {
        f"node{n}": {"at": [x, y, 0], "kind": kind} for n, (x, y, kind) in enumerate(nodes, 1)
    }
    for n, control in enumerate(controls, 1):
        data[f"node{n}"]["control"] = control
    return build_route(read_design({**data, "roads": roads, "route": [3, 1, 2, 6]})[0], WORLD)


def told(asked: str, route: Route) -> list[str]:
    found = inspect(route, read_plan(asked), WORLD)
    return [finding.sentence for finding in found if finding.rule == "promises"]


def test_measures_of_a_grid_and_a_village() -> None:
    found = measured_map(grid().network)
    assert (found.blocks, found.ends, found.parts, len(found.nodes)) == (2, 1, 1, 3)
    assert [node.kinds for node in found.nodes] == [("t_junction",)] * 3
    assert sorted(found.distances) == pytest.approx([80, 80])
    found = measured_map(village().network)
    assert (found.blocks, found.ends, found.parts) == (0, 5, 1)
    assert [node.kinds for node in found.nodes] == [("crossroads",), ("y_junction",)]


@pytest.mark.parametrize(
    ("asked", "control"),
    rows(__file__, "a_grid_that_is_as_asked"),
)
def test_a_grid_that_is_as_asked(asked: str, control: str) -> None:
    assert told(asked, grid(control=control)) == []


@pytest.mark.parametrize(
    ("asked", "wanted"),
    rows(__file__, "a_grid_that_is_not_as_asked"),
)
def test_a_grid_that_is_not_as_asked(asked: str, wanted: str) -> None:
    assert wanted in told(asked, grid())


@pytest.mark.parametrize("asked", rows(__file__, "a_village_that_is_as_asked"))
def test_a_village_that_is_as_asked(asked: str) -> None:
    assert told(asked, village()) == []


@pytest.mark.parametrize(
    ("asked", "wanted"),
    rows(__file__, "signs_of_some_junctions_of_a_village"),
)
def test_signs_of_some_junctions_of_a_village(asked: str, wanted: list[str]) -> None:
    found = told(asked, village("lights", "none"))
    assert found[: len(wanted)] == wanted
    assert bool(found) == bool(wanted)


@pytest.mark.parametrize(("asked", "wanted"), rows(__file__, "a_village_that_is_not_as_asked"))
def test_a_village_that_is_not_as_asked(asked: str, wanted: str) -> None:
    assert wanted in told(asked, village())
