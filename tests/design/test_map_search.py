"""Maps of roads that the planner drafts: an outside referee, where it is at hand, sees what was asked for."""

import json
from itertools import product

import numpy as np
import pytest

from roadgpt.brief.feasible import check
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.design.network_search import MapSearch
from roadgpt.drive import simulate
from roadgpt.errors import BriefError, DesignError, UsageError
from roadgpt.network import Route, build_route, made_from
from roadgpt.road import CrossSection, Design, Limits, Site, World
from roadgpt.road.design import MapNode
from roadgpt.verdict import judge

USUAL = World()


def drafted(line: str, seed: int, world: World = USUAL) -> Design:
    """The map of a plan."""
    found = draft(read_plan(line), world, seed=seed)
    assert isinstance(found, Design)
    return found


def route_of(line: str, seed: int, world: World = USUAL) -> Route:
    """The route through the map of a plan."""
    return build_route(drafted(line, seed, world), world)


@pytest.mark.parametrize("seed", range(4))
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
    for line in (
        "map columns=1 rows=1; junction x5 lights",
        "map columns=2 rows=2 dead_ends=0; crossroads x2 lights",
        "map columns=2 rows=2; star lights",
        "map columns=2 rows=2 stop; junction stop",
        "map columns=2 rows=2 dead_ends=0; t_junction x3 lights; junction x3 stop",
    ):
        with pytest.raises(BriefError, match="no map can be built as"):
            check(read_plan(line), map_size=None, min_radius=0.0)
    with pytest.raises(BriefError, match="give a sign behind each kind"):
        check(read_plan("map columns=2 rows=2; junction x2"), map_size=None, min_radius=0.0)


def test_crossroads_with_signs_stand_within_a_grid() -> None:
    """In a grid of two by two blocks that is the one in the middle: four of its nine nodes lie beside it."""
    for seed in range(8):
        design = draft(read_plan("map columns=2 rows=2; crossroads lights"), World(), seed=seed)
        assert isinstance(design, Design)
        (signed,) = [node for node in design.nodes if node.control == "lights"]
        places = np.array([node.at[:2] for node in design.nodes])
        low, high = places.min(axis=0), places.max(axis=0)
        assert (np.abs(np.array(signed.at[:2]) - (low + high) / 2) < 0.3 * (high - low)).all()


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
        route = build_route(design.model_copy(update={"nodes": tuple(nodes)}), USUAL)
        assert any("of the grid, has" in each.sentence for each in inspect(route, brief, USUAL))


def junctions_of(design: Design) -> list[MapNode]:
    """The nodes of a design at which roads meet."""
    return [node for node in design.nodes if node.kind not in ("bend", "end")]


def test_the_same_seed_gives_the_same_map_and_another_seed_another() -> None:
    line = "map crossroads x2; roundabout"
    one, same, other = (json.dumps(drafted(line, seed).to_json()) for seed in (7, 7, 8))
    assert one == same
    assert one != other


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
    for seed in range(2):
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


@pytest.mark.parametrize(
    ("line", "seed"), [("map columns=2 rows=2 stop", 0), ("map crossroads; roundabout; t_junction x2", 1)]
)
def test_the_reference_driver_keeps_its_lane(line: str, seed: int) -> None:
    world = World(limits=Limits(speed_limit=50 / 3.6))
    road = made_from(drafted(line, seed, world), world)
    assert judge(road, simulate(road, world, "reference", seed), world).kept


@pytest.mark.parametrize(("kind", "arms"), [("t_junction", 3), ("crossroads", 4)])
def test_a_village_has_the_blocks_and_dead_ends_that_eulers_formula_allows(kind: str, arms: int) -> None:
    """A connected map of roads has one more road than junctions for each block: with ``ends`` arms of
    n junctions left open, (arms n - ends) / 2 roads join the others. A road never leads back to its own
    junction."""
    for n, blocks, ends in product((1, 2, 3), (*range(6), None), (*range(7), None)):
        free = [each for each in range(arms * n + 1) if not (arms * n - each) % 2]
        found = {((arms * n - each) // 2 - n + 1, each) for each in free}
        can = {(block, end) for block, end in found if block >= 0 and (n > 1 or block == 0)}
        is_possible = any(blocks in (None, block) and ends in (None, end) for block, end in can)
        wishes = (
            f"blocks={blocks}" if blocks is not None else "",
            f"dead_ends={ends}" if ends is not None else "",
        )
        line = " ".join(filter(None, (f"map {kind} x{n}", *wishes)))
        if is_possible:
            check(read_plan(line), map_size=None)
        else:
            with pytest.raises(BriefError, match="no map can be built as"):
                check(read_plan(line), map_size=None)
