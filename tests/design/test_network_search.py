"""Routes through junctions that the planner drafts: they are what was asked for, and they fit on the map.

The junctions are measured here on the built network, and by an outside referee on the exported file where it
is at hand.
"""

import json
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from outside_judge import networks_referee
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.check.measures import measure
from roadgpt.design import draft, draft_road
from roadgpt.design.designers.planner import Planner
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError, DesignError
from roadgpt.export import save
from roadgpt.network import Junction, NetworkDesign, Route, build_route, read_network_design
from roadgpt.road import Site, World

USUAL = World()
CASES: dict[str, dict[str, Any]] = {
    "// t_junction right //": {"sequence": [{"kind": "T", "take": "right"}]},
    "// t_junction straight ways=left+straight priority //": {
        "sequence": [
            {
                "kind": "T",
                "take": "straight",
                "exits": ["left", "straight"],
                "control": "priority",
                "other_control": "yield",
            }
        ]
    },
    "| len=80 // crossroads left lights //": {
        "sequence": [{"kind": "X", "take": "left", "after": 80, "control": "lights", "all_control": "lights"}]
    },
    "// crossroads straight skew //": {"sequence": [{"kind": "X", "take": "straight", "skew": True}]},
    "// y_junction left //": {"sequence": [{"kind": "Y", "take": "left"}]},
    "// star arms=5 sharp_left //": {
        "sequence": [{"kind": "star", "arms": 5, "take": "left", "deg": [80, 180]}]
    },
    "// star arms=6 //": {"sequence": [{"kind": "star", "arms": 6}]},
    "// roundabout exit=2 arms=4 //": {"sequence": [{"kind": "roundabout", "exit": 2, "arms": 4}]},
    "// roundabout straight //": {"sequence": [{"kind": "roundabout", "take": "straight"}]},
    "// roundabout mini arms=3 back //": {
        "sequence": [{"kind": "roundabout", "arms": 3, "exit": 3, "size": "mini", "take": "back"}]
    },
    "// roundabout large exit=3 //": {"sequence": [{"kind": "roundabout", "size": "large", "exit": 3}]},
    "// roundabout r=14 arms=4 //": {"sequence": [{"kind": "roundabout", "radius": 14, "arms": 4}]},
    "// roundabout arms=6 exit=4 //": {"sequence": [{"kind": "roundabout", "arms": 6, "exit": 4}]},
    "turn left // t_junction right stop // straight 60": {
        "sequence": [
            {"kind": "turn", "dir": "left"},
            {"kind": "T", "take": "right", "control": "stop"},
            {"kind": "straight", "len": [54, 70]},
        ]
    },
    "| turns=3 up // crossroads // | down": {
        "sequence": [{"kind": "X"}],
        "between": [{"turns": 3, "grade": "up"}, {"grade": "down"}],
    },
    "// t_junction left // // crossroads right // // roundabout exit=1 //": {
        "sequence": [
            {"kind": "T", "take": "left"},
            {"kind": "X", "take": "right"},
            {"kind": "roundabout", "exit": 1},
        ]
    },
    "| len=225..275 // t_junction straight // || len=500": {
        "sequence": [{"kind": "T", "take": "straight", "at": [200, 300]}],
        "length": 500,
    },
}
FIVE = "// t_junction // // crossroads // // roundabout // // y_junction // // t_junction //"


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    """The outside referee of networks."""
    return networks_referee()


def drafted(line: str, seed: int, world: World = USUAL) -> Route:
    """The route of a plan."""
    design = Planner().draft(read_plan(line), world, (), (), seed)
    assert isinstance(design, NetworkDesign)
    return build_route(design, world)


@pytest.mark.parametrize("line", CASES)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_route_is_what_was_asked_for(line: str, seed: int, referee: ModuleType, tmp_path: Path) -> None:
    route = drafted(line, seed)
    assert inspect(route, None, USUAL) == ()
    save(route, tmp_path, ["opendrive"], USUAL, "x")
    truth = {"junctions": len(CASES[line]["sequence"]), **CASES[line]}
    if any(item["kind"] in ("turn", "straight") for item in truth["sequence"]):
        truth["junctions"] = sum(item["kind"] not in ("turn", "straight") for item in truth["sequence"])
    way = json.loads((tmp_path / "x.route.json").read_text())
    holds, measured = referee.check(tmp_path / "x.xodr", way, truth)
    assert all(holds.values()), (holds, measured["breaks"], measured["junctions"])
    assert measured["faults"] == []


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


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("line", "low", "high"),
    [
        ("// t_junction left //", 40, 140),
        ("// t_junction right //", -140, -40),
        ("// crossroads straight //", -25, 25),
        ("// crossroads right //", -140, -40),
    ],
)
def test_the_route_turns_to_the_side_that_was_asked_for(
    line: str, low: float, high: float, seed: int
) -> None:
    route = drafted(line, seed)
    ((_, _, junction, *_),) = route.passages
    assert low <= turned(route, junction) <= high


def test_five_junctions_find_a_place_on_the_usual_map() -> None:
    for seed in range(3):
        route = drafted(FIVE, seed)
        assert [each.entered.kind for each in route.passages] == [
            "t_junction",
            "crossroads",
            "roundabout",
            "y_junction",
            "t_junction",
        ]
        (west, south), (east, north) = route.network.bounds()
        assert min(west, south) > 0
        assert max(east, north) < USUAL.site.map_size


def test_the_roads_of_a_route_meet_their_own_requirements() -> None:
    route = drafted("turn x2 left deg=60 // crossroads straight // straight 40..50 | down", 5)
    first, last = (route.network.road(route.legs[n].road).road for n in (0, -1))
    turns = measure(first.centreline()).turns
    assert [turn.side for turn in turns] == ["left", "left"]
    assert [turn.degrees for turn in turns] == pytest.approx([60, 60], abs=6)
    assert 40 <= last.length <= 60
    heights = last.at(np.array([0.0, last.length]))[:, 2]
    assert heights[1] < heights[0]


def test_the_same_seed_gives_the_same_route_and_another_seed_another() -> None:
    line = "// crossroads left // // roundabout exit=2 //"
    one, same, other = (Planner().draft(read_plan(line), USUAL, (), (), seed).to_json() for seed in (7, 7, 8))
    assert one == same
    assert one != other


def test_routes_of_one_plan_differ_in_their_junctions() -> None:
    designs = [Planner().draft(read_plan("// t_junction //"), USUAL, (), (), seed) for seed in range(12)]
    assert len({design.junctions[0].take for design in designs if isinstance(design, NetworkDesign)}) == 2
    ways = {
        tuple(round(arm.angle / 90) for arm in design.junctions[0].all_arms)
        for design in designs
        if isinstance(design, NetworkDesign)
    }
    assert ways == {(-1, 1), (0, 1), (-1, 0)}


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
    assert all(isinstance(design, NetworkDesign) for design in designs)
    arms = [arm for design in designs for each in design.junctions for arm in each.arms]  # type: ignore[union-attr]
    assert {len(each.arms) for design in designs for each in design.junctions} == {2}  # type: ignore[union-attr]
    assert {arm.one_way for arm in arms} == {None}


def test_a_design_from_a_plan_is_read_back_as_it_was_written() -> None:
    design = draft(read_plan("// crossroads left stop // // roundabout back //"), USUAL, seed=3)
    assert isinstance(design, NetworkDesign)
    again, remarks = read_network_design(json.loads(json.dumps(design.to_json())))
    assert again == design
    assert remarks == ()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("roundabout mini arms=5", "a mini roundabout is too small for 5 arms"),
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


def test_a_wide_road_and_a_narrow_one_keep_apart_by_their_own_widths() -> None:
    line = "| motorway lanes=4 len=300 // diverge ramp // junction right stop"
    world = world_for(read_plan(line), USUAL)
    assert inspect(drafted(line, 1, world), read_plan(line), world) == ()


def test_a_long_straight_road_to_a_junction_gets_a_map() -> None:
    brief = read_plan("| turns=0 len=600 // crossroads left")
    world = world_for(brief, USUAL)
    assert world.site.map_size * 2**0.5 > 600
    assert inspect(drafted("| turns=0 len=600 // crossroads left", 1, world), brief, world) == ()


def test_ramps_find_a_place_close_to_changes_of_lanes() -> None:
    line = "merge ramp len=220 // | len=300 // lane_change right // | len=300 // lane_change left // "
    line += "diverge ramp"
    world = world_for(read_plan(line), USUAL)
    assert inspect(drafted(line, 1, world), read_plan(line), world) == ()


def test_wide_roads_find_a_place_around_a_roundabout() -> None:
    line = "| lanes=2 divided // roundabout exit=2 // | lanes=2 divided // roundabout exit=1"
    for seed in range(2):
        assert inspect(drafted(line, seed), read_plan(line), USUAL) == ()


def test_what_finds_no_place_is_refused_with_what_to_do() -> None:
    small = World(site=Site(map_size=90))
    brief = read_plan("// roundabout large // // roundabout large // // roundabout large //")
    search = NetworkSearch(brief, small, np.random.default_rng(1))
    with pytest.raises(DesignError, match=r"3 junctions .* found no place on a map of 90 m; .*--map-size"):
        search.run(100)


def test_the_most_frequent_reason_is_named_without_a_place() -> None:
    brief = read_plan("| lanes=2 against=2 // roundabout exit=3 arms=5 r=9")
    with pytest.raises(
        DesignError, match=r"accepted: at the roundabout: the mouths of two arms overlap; turn"
    ):
        NetworkSearch(brief, USUAL, np.random.default_rng(1)).run(100)


def test_too_short_a_route_is_refused_by_its_length() -> None:
    brief = read_plan(
        "| divided lanes=2 // crossroads straight // | turns=0 // crossroads straight || len=60"
    )
    with pytest.raises(DesignError, match=r"the length .* leaves too little .*; ask for a longer route$"):
        NetworkSearch(brief, USUAL, np.random.default_rng(1)).run(60)


def test_a_larger_map_holds_what_a_small_one_does_not() -> None:
    line = "// roundabout large // // roundabout large // // roundabout large //"
    route = drafted(line, 1, World(site=Site(map_size=600)))
    assert len(route.network.roundabouts) == 3


def test_single_roads_only_are_drafted_where_junctions_do_not_belong() -> None:
    with pytest.raises(DesignError, match="single roads only"):
        draft_road(read_plan("// t_junction //"), USUAL)
    assert draft_road(Brief(), USUAL, seed=1).segments
    with pytest.raises(DesignError, match="without junctions"):
        draft(read_plan("// t_junction //"), USUAL, designer="thesis")


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


def test_a_road_between_junctions_climbs_as_many_metres_as_asked() -> None:
    for seed in range(3):
        route = drafted("t_junction left // | up climb=5 // t_junction right", seed)
        road = route.network.road(route.legs[2].road).road
        assert np.diff(road.at(np.array([0.0, road.length]))[:, 2]) == pytest.approx(5, abs=1)


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
    for seed in range(3):
        route = drafted(line, seed)
        assert inspect(route, read_plan(line), USUAL) == ()


@pytest.mark.parametrize("junctions", [1, 2, 3, 9, 10, 13, 16])
@pytest.mark.parametrize("lanes", ["", " lanes=4"])
def test_however_many_junctions_a_route_has_no_road_is_asked_for_an_empty_range(
    junctions: int, lanes: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The more junctions, the more haste a draft has; it is a share, and ranges are drawn with it."""
    hastes: list[float] = []
    monkeypatch.setattr(NetworkSearch, "_draft", lambda self, haste: hastes.append(haste))
    brief = read_plan(" // crossroads straight // ".join(["|" + lanes] * (junctions + 1)))
    assert len(brief.junctions) == junctions
    search = NetworkSearch(brief, USUAL, np.random.default_rng(1))
    with pytest.raises(DesignError):
        search.run(30)
    assert hastes == sorted(hastes)
    assert hastes[0] == pytest.approx(min(max(junctions - 2, 0) / 8, 1.0))
    assert 0 <= hastes[0] <= hastes[-1] <= 1
    for haste in (hastes[0], hastes[-1]):
        for _ in range(20):
            asked = search._open(haste, search._shortest(0, haste))
            for amount in (asked.length, asked.degrees, asked.turns):
                assert amount is None or amount.lo <= amount.hi
            assert asked.length is not None
            assert 20 < asked.length.lo < asked.length.hi < 180
