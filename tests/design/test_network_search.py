"""Routes through junctions that the planner drafts: they are what was asked for, and they fit on the map.

The junctions are measured here on the built network, and by an outside referee on the exported file where it
is at hand.
"""

import math

import numpy as np
import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.designers.planner import Planner
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError, DesignError
from roadgpt.network import Junction, Route, build_route
from roadgpt.road import Design, Site, World

USUAL = World()


def drafted(line: str, seed: int, world: World = USUAL) -> Route:
    """The route of a plan."""
    design = Planner().draft(read_plan(line), world, (), (), seed)
    assert isinstance(design, Design)
    return build_route(design, world)


def turned(route: Route, junction: Junction) -> float:
    """How far the route turns in a junction, in degrees, by the directions of its roads 15 m away from it."""
    at = next(each.start for each in route.passages if each.entered.node == junction.node)
    after = next(s for s in route.starts if s > at and _is_outside(route, s))
    points = route.at(np.array([at - 15, at, after, after + 15]))[:, :2]
    before, behind = points[1] - points[0], points[3] - points[2]
    angle = math.atan2(
        before[0] * behind[1] - before[1] * behind[0], before[0] * behind[0] + before[1] * behind[1]
    )
    return math.degrees(angle)


def _is_outside(route: Route, s: float) -> bool:
    index = route.starts.index(s)
    return index < len(route.legs) and route.network.road(route.legs[index].road).junction is None


def test_the_roads_of_a_route_meet_their_own_requirements() -> None:
    route = drafted("turn x2 left deg=60 // crossroads straight // straight 40..50 | down", 5)
    first, last = (route.network.road(route.legs[n].road).road for n in (0, -1))
    turns = measure(first.centreline()).turns
    assert [turn.side for turn in turns] == ["left", "left"]
    assert [turn.degrees for turn in turns] == pytest.approx([60, 60], abs=6)
    assert 40 <= last.length <= 60
    heights = last.at(np.array([0.0, last.length]))[:, 2]
    assert heights[1] < heights[0]


def test_a_junction_of_any_kind_is_of_none_that_the_plan_counts() -> None:
    """ "Five junctions, two of them forks": there is no third fork."""
    brief = read_plan("y_junction // y_junction // junction // junction")
    designs = [Planner().draft(brief, USUAL, (), (), seed) for seed in range(12)]
    kinds = [[each.kind for each in design.junctions] for design in designs if hasattr(design, "junctions")]
    assert all(each[:2] == ["y_junction", "y_junction"] for each in kinds)
    assert {"t_junction", "crossroads"} <= {kind for each in kinds for kind in each[2:]}
    assert "y_junction" not in {kind for each in kinds for kind in each[2:]}


def test_a_street_beside_the_road_makes_no_crossroads() -> None:
    """It would have a one-way street on the other side, of which the words say nothing."""
    brief = read_plan("junction straight ways=right+straight // junction right ways=right+straight")
    designs = [Planner().draft(brief, USUAL, (), (), seed) for seed in range(8)]
    assert all(isinstance(design, Design) for design in designs)
    arms = [arm for design in designs for each in design.junctions for arm in each.arms]  # type: ignore[union-attr]
    assert {len(each.arms) for design in designs for each in design.junctions} == {2}  # type: ignore[union-attr]
    assert {arm.one_way for arm in arms} == {None}


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("roundabout mini arms=5", "no roundabout can be built as"),
        ("star arms=9", "a star junction has 5 to 6 arms, not 9"),
        ("t_junction left straight", "take"),
    ],
)
def test_what_no_junction_can_be_is_refused_before_anything_is_drawn(line: str, said: str) -> None:
    with pytest.raises(BriefError, match=said):
        draft(read_plan(line), USUAL, seed=1)


@pytest.mark.parametrize(
    "line",
    [
        "| len=120 // t_junction right // | down || len=850",
        "turn x2 // crossroads right // turn left || len=500",
        "| motorway lanes=3 against=3 // merge main len=180 // diverge ramp len=120 || len=1500",
        "merge ramp len=200 // | motorway lanes=2 // diverge main // | motorway // diverge ramp || len=1600",
    ],
)
def test_roads_without_a_length_of_their_own_make_up_the_length_of_the_whole(line: str) -> None:
    brief = read_plan(line)
    world = world_for(brief, USUAL)
    route = drafted(line, 3, world)
    assert brief.length is not None
    assert brief.length.lo is not None
    assert route.length == pytest.approx(brief.length.lo, rel=0.1)
    assert inspect(route, brief, world) == ()


def test_what_finds_no_place_is_refused_with_what_to_do() -> None:
    small = World(site=Site(map_size=90))
    brief = read_plan("// roundabout large // // roundabout large // // roundabout large //")
    search = NetworkSearch(brief, small, np.random.default_rng(1))
    with pytest.raises(DesignError, match=r"3 junctions .* found no place on a map of 90 m; .*--map-size"):
        search.run(100)


@pytest.mark.parametrize(
    ("line", "index", "asked"),
    [
        ("crossroads // | down pct=6 // crossroads", 2, -6),
        ("| up pct=8 // t_junction left // | flat", 0, 8),
        ("t_junction left // turn x2 | up pct=4 // t_junction right", 2, 4),
        ("t_junction left // straight len=60 down pct=9 // t_junction right", 2, -9),
    ],
)
def test_a_road_between_junctions_is_as_steep_as_asked_where_it_is_not_level_for_them(
    line: str, index: int, asked: float
) -> None:
    for seed in range(3):
        route = drafted(line, seed)
        road = route.network.road(route.legs[index].road).road
        s = np.arange(0.0, road.length - 10, 0.5)
        windows = 100 * (road.at(s + 10)[:, 2] - road.at(s)[:, 2]) / 10
        assert math.copysign(np.abs(windows).max(), asked) == pytest.approx(asked, abs=0.8)
        assert (windows * asked >= -1e-9).all()
        assert road.grade(np.array([road.length])) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    "line",
    [
        "star straight arms=5",
        "roundabout arms=5 exit=2",
        "junction // junction // junction || len=..450",
        "| divided lanes=2 // crossroads straight // | turns=0 // crossroads straight || len=220",
        "| lanes=2 against=2 // crossroads straight // | len=120 // roundabout exit=2 arms=4",
    ],
)
def test_what_can_be_drawn_is_drawn(line: str) -> None:
    for seed in range(2):
        route = drafted(line, seed)
        assert inspect(route, read_plan(line), USUAL) == ()
