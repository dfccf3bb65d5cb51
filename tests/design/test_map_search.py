"""Maps of roads that the planner drafts: an outside referee, where it is at hand, sees what was asked for."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from outside_judge import SHARED
from roadgpt.brief.feasible import check
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft, draft_road
from roadgpt.design.map_search import MapSearch
from roadgpt.design.room import world_for
from roadgpt.drive import simulate
from roadgpt.errors import BriefError, DesignError, UsageError
from roadgpt.export import save
from roadgpt.network import MapDesign, MapNode, Route, build_map, made_from
from roadgpt.road import CrossSection, Limits, Site, World
from roadgpt.verdict import judge

USUAL = World()
CASES: dict[str, dict[str, Any]] = {
    "map columns=3 rows=2": {"blocks": 6, "junctions": [8, 12]},
    "map columns=3 rows=2 len=100 lights": {"blocks": 6, "junctions": [8, 12]},
    "map columns=4 rows=3 stop": {"blocks": 12, "junctions": [16, 20]},
    "map columns=1 rows=1": {"blocks": 1, "junctions": [2, 4]},
    "map columns=5 rows=1 yield": {"blocks": 5},
    "map roundabout dead_ends=6": {"junctions": 1, "roundabouts": 1, "dead_ends": 6},
    "map roundabout dead_ends=3": {"junctions": 1, "roundabouts": 1, "dead_ends": 3},
    "map crossroads x3": {"junctions": 3, "kinds": {"X": 3}},
    "map crossroads x3; roundabout; t_junction x2": {
        "junctions": 6,
        "kinds": {"X": 3, "T": 2},
        "roundabouts": 1,
    },
    "map t_junction x2; y_junction; roundabout stop": {
        "junctions": 4,
        "kinds": {"T": 2, "Y": 1},
        "roundabouts": 1,
        "controls": {"stop": 4},
    },
    "map star; y_junction x2; crossroads yield": {
        "kinds": {"star": 1, "Y": 2, "X": 1},
        "controls": {"yield": 4},
    },
    "map roundabout x3; t_junction lights": {"roundabouts": 3, "controls": {"lights": 4}},
    "map junction x3": {"junctions": 3},
    "map junction x2 lights; roundabout; junction x2": {
        "junctions": 5,
        "roundabouts": 1,
        "controls": {"lights": 2},
    },
    "map crossroads x2 stop; crossroads; t_junction lights": {
        "kinds": {"X": 3, "T": 1},
        "controls": {"stop": 2, "lights": 2},
    },
    "map columns=2 rows=2; junction lights": {"blocks": 4, "controls": {"lights": 1}},
    "map columns=3 rows=2 stop; junction none; crossroads x2 lights": {
        "blocks": 6,
        "controls": {"lights": 2},
    },
    "map columns=2 rows=2 dead_ends=4; junction x..2 lights; t_junction x3 yield || left_hand": {
        "blocks": 4,
        "dead_ends": 4,
        "controls": {"lights": [0, 2], "yield": 3},
    },
    "map crossroads x3 || len=2000": {"junctions": 3, "kinds": {"X": 3}, "length": 2000},
    "map columns=3 rows=2 || len=1300..1500": {"blocks": 6, "length": [1300, 1500]},
    "map t_junction x2; roundabout || len=600 left_hand": {"roundabouts": 1, "length": 600},
    "map t_junction": {"junctions": 1, "kinds": {"T": 1}, "dead_ends": 3},
}


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    """The outside referee of networks."""
    path = SHARED / "referee_networks.py"
    if not path.exists():
        pytest.skip("the referee of networks is not at hand")
    sys.path.insert(0, str(SHARED))
    try:
        spec = importlib.util.spec_from_file_location("referee_networks", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(SHARED))
    return module


def drafted(line: str, seed: int, world: World = USUAL) -> MapDesign:
    """The map of a plan."""
    found = draft(read_plan(line), world, seed=seed)
    assert isinstance(found, MapDesign)
    return found


def route_of(line: str, seed: int, world: World = USUAL) -> Route:
    """The route through the map of a plan."""
    return build_map(drafted(line, seed, world), world)


@pytest.mark.parametrize("line", CASES)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_map_is_what_was_asked_for(line: str, seed: int, referee: ModuleType, tmp_path: Path) -> None:
    world = world_for(read_plan(line), USUAL)
    route = route_of(line, seed, world)
    assert inspect(route, read_plan(line), world) == ()
    save(route, tmp_path, ["opendrive"], world, "x")
    way = json.loads((tmp_path / "x.route.json").read_text())
    truth = {"map": {"connected": True, **CASES[line]}, "junctions": len(route.passages)}
    holds, measured = referee.check(tmp_path / "x.xodr", way, truth)
    assert all(holds.values()), (holds, measured["breaks"], measured["map"])
    assert measured["faults"] == []


def test_a_grid_of_three_by_two_blocks_fits_on_the_usual_map_and_longer_blocks_get_a_larger_one() -> None:
    assert world_for(read_plan("map columns=3 rows=2"), USUAL).site.map_size == 250
    larger = world_for(read_plan("map columns=3 rows=2 len=100"), USUAL)
    assert larger.site.map_size > 250
    assert inspect(route_of("map columns=3 rows=2 len=100", 3, larger), None, larger) == ()
    given = World(site=Site(map_size=120))
    assert world_for(read_plan("map columns=3 rows=2"), given).site.map_size == 120


@pytest.mark.parametrize("seed", range(10))
def test_roundabouts_have_three_arms_where_only_few_roads_may_end(seed: int) -> None:
    line = "map roundabout x4 blocks=1 dead_ends=4"
    design = drafted(line, seed, USUAL)
    ends = [node for node in design.nodes if node.kind == "end"]
    arms = [sum(number in road for road in design.roads) for number, _ in enumerate(design.nodes, 1)]
    assert len(ends) == 4
    assert [arms[n] for n, node in enumerate(design.nodes) if node.kind == "roundabout"] == [3, 3, 3, 3]


def test_what_finds_no_place_is_refused_with_what_to_do() -> None:
    small = World(site=Site(map_size=120))
    with pytest.raises(DesignError, match=r"no place on a map of 120 m; ask for fewer or shorter blocks, or"):
        drafted("map columns=3 rows=2", 1, small)
    search = MapSearch(read_plan("map crossroads x5"), small, np.random.default_rng(1))
    with pytest.raises(DesignError, match=r"no place on a map of 120 m; ask for fewer junctions, or give"):
        search.run(30)
    with pytest.raises(DesignError, match="give other numbers"):
        drafted("map columns=2 rows=2 len=20", 1)
    with pytest.raises(UsageError, match="leave out --lanes"):
        drafted("map columns=2 rows=1", 1, World(section=CrossSection(lanes="2+1")))


def test_signs_that_the_junctions_of_a_grid_cannot_have_are_refused() -> None:
    for line, why in (
        ("map columns=1 rows=1; junction x5 lights", "4 of the kind junction at most, not 5; ask for fewer"),
        ("map columns=2 rows=2 dead_ends=0; crossroads x2 lights", "1 of the kind crossroads at most, not 2"),
        ("map columns=2 rows=2; star lights", "no star junction; leave"),
        ("map columns=2 rows=2 stop; junction stop", "all junctions of the grid have stop signs"),
        (
            "map columns=2 rows=2 dead_ends=0; t_junction x3 lights; junction x3 stop",
            "has 5 junctions at most",
        ),
        ("map columns=2 rows=2; junction x2", "give a sign behind each kind"),
    ):
        with pytest.raises(BriefError, match=why):
            check(read_plan(line), map_size=None, min_radius=0.0)


def test_crossroads_with_signs_stand_within_a_grid() -> None:
    """In a grid of two by two blocks that is the one in the middle: four of its nine nodes lie beside it."""
    for seed in range(8):
        design = draft(read_plan("map columns=2 rows=2; crossroads lights"), World(), seed=seed)
        assert isinstance(design, MapDesign)
        (signed,) = [node for node in design.nodes if node.control == "lights"]
        places = np.array([node.at[:2] for node in design.nodes])
        low, high = places.min(axis=0), places.max(axis=0)
        assert (np.abs(np.array(signed.at[:2]) - (low + high) / 2) < 0.3 * (high - low)).all()


def test_the_check_measures_the_length_of_all_roads() -> None:
    world = world_for(read_plan("map crossroads x2 || len=800"), USUAL)
    route = route_of("map crossroads x2 || len=800", 3, world)
    found = [each.sentence for each in inspect(route, read_plan("map crossroads x2 || len=1000"), world)]
    assert len(found) == 1
    assert found[0].startswith("asked for 1000 m of roads in all, has ")
    assert 720 <= float(found[0].split()[-2]) <= 880


@pytest.mark.parametrize(
    ("line", "control", "number"),
    [
        ("map columns=2 rows=2; junction lights", "lights", 1),
        ("map columns=3 rows=2 stop; junction none", "none", 1),
    ],
)
def test_the_check_counts_the_signs_of_a_grid(line: str, control: str, number: int) -> None:
    """A design with one sign too many, and one with one too few, break the promise."""
    design, brief = drafted(line, 3), read_plan(line)
    assert sum(node.control == control for node in junctions_of(design)) == number
    other = next(node.control for node in junctions_of(design) if node.control != control)
    for old, new in ((control, other), (other, control)):
        first = next(
            n for n, node in enumerate(design.nodes) if node in junctions_of(design) and node.control == old
        )
        nodes = list(design.nodes)
        nodes[first] = nodes[first].model_copy(update={"control": new})
        route = build_map(design.model_copy(update={"nodes": tuple(nodes)}), USUAL)
        assert any("of the grid, has" in each.sentence for each in inspect(route, brief, USUAL))


def junctions_of(design: MapDesign) -> list[MapNode]:
    """The nodes of a design at which roads meet."""
    return [node for node in design.nodes if node.kind not in ("bend", "end")]


def test_where_maps_do_not_belong_they_are_refused() -> None:
    with pytest.raises(DesignError, match="single roads only"):
        draft_road(read_plan("map columns=2 rows=1"), USUAL)
    with pytest.raises(DesignError, match="without junctions"):
        draft(read_plan("map columns=2 rows=1"), USUAL, designer="thesis")


def test_the_same_seed_gives_the_same_map_and_another_seed_another() -> None:
    line = "map crossroads x2; roundabout"
    one, same, other = (json.dumps(drafted(line, seed).to_json()) for seed in (7, 7, 8))
    assert one == same
    assert one != other


def test_routes_are_long_enough_and_turn_to_both_sides_where_they_can() -> None:
    for seed in range(4):
        route = route_of("map columns=3 rows=2", seed)
        assert route.length > 100
        turns = [
            (float(route.heading(each.end) - route.heading(each.start)) + 4) % 6.283 - 4
            for each in route.passages
        ]
        assert max(turns) > 0.5
        assert min(turns) < -0.5


@pytest.mark.parametrize(
    "line",
    [
        "map columns=3 rows=2 route=left+straight+right",
        "map columns=1 rows=1 route=left+left",
        "map crossroads x3; t_junction route=right+left",
        "map columns=2 rows=2 route=straight",
    ],
)
def test_a_route_through_a_map_goes_where_it_was_asked_to(line: str) -> None:
    """The directions are measured on the centre line, 10 m before and behind each junction."""
    for seed in range(3):
        route = route_of(line, seed)
        assert inspect(route, read_plan(line), USUAL) == ()
        goes = [_way(route, each.start, each.end) for each in route.passages]
        assert goes == line.rpartition("=")[2].split("+")


def _way(route: Route, start: float, end: float) -> str:
    x, y = np.diff(route.at(np.array([start - 10, start, end, end + 10]))[:, :2], axis=0)[[0, 2]].T
    angle = np.degrees(np.arctan2(x[0] * y[1] - x[1] * y[0], x[0] * x[1] + y[0] * y[1]))
    return "straight" if abs(angle) < 40 else "left" if angle > 0 else "right"


def test_a_route_that_no_map_has_is_refused() -> None:
    with pytest.raises(DesignError, match="no route left, left, left, left leads through it"):
        drafted("map columns=1 rows=1 route=left+left+left+left", 1)


def test_limits_of_the_world_are_kept() -> None:
    world = World(limits=Limits(min_radius=25.0, max_grade=0.05))
    for line in ("map columns=2 rows=1", "map t_junction x3"):
        assert inspect(route_of(line, 2, world), read_plan(line), world) == ()


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("line", ["map columns=2 rows=2 stop", "map crossroads; roundabout; t_junction x2"])
def test_the_reference_driver_keeps_its_lane(line: str, seed: int) -> None:
    world = World(limits=Limits(speed_limit=50 / 3.6))
    road = made_from(drafted(line, seed, world), world)
    assert judge(road, simulate(road, world, "reference", seed), world).kept


@pytest.mark.parametrize(
    "line", ["map columns=2 rows=1", "crossroads // | up", "turn x2 | left_hand", "turn | divided"]
)
def test_searches_refuse_networks(line: str) -> None:
    from roadgpt.campaign.search import settings_of

    class Asked:
        """Stands for a cell of a campaign that asks for a network."""

        brief = read_plan(line)
        generator = "genetic"
        settings = ()

        class request:  # noqa: N801
            class setup:  # noqa: N801
                geometry = "arcs"

    with pytest.raises(
        UsageError, match="searches single roads without medians and with traffic on the right"
    ):
        settings_of(Asked)  # type: ignore[arg-type]
