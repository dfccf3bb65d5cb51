"""Routes with several lanes, one-way roads and ramps that the planner drafts, measured by an outside referee.

The referee is used where it is at hand; it reads only the exported files.
"""

import numpy as np
import pytest

from roadgpt.brief import check, read
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.design.designers.planner import Planner
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError, DesignError, UsageError
from roadgpt.network import Route, build_route
from roadgpt.road import Design, Limits, Site, World
from roadgpt.road.design import narrow_part
from tables import rows

WIDE = World(site=Site(map_size=800))


def drafted(line: str, seed: int) -> Route:
    design = Planner().draft(read_plan(line), WIDE, (), (), seed)
    assert isinstance(design, Design)
    return build_route(design, WIDE)


@pytest.mark.parametrize(("width", "part"), [(3.0, 30.0), (4.0, 24.95), (3.5, 27.14)])
def test_the_narrow_part_of_a_taper_is_where_its_cubic_is_below_the_least_width(
    width: float, part: float
) -> None:
    (share,) = (
        root.real for root in np.roots([-2, 3, 0, -1.5 / width]) if 0 < root.real < 1 and not root.imag
    )
    assert narrow_part(60.0, width) == pytest.approx(60 * share)
    assert narrow_part(60.0, width) == pytest.approx(part, abs=0.01)


def test_a_road_behind_a_junction_has_the_lanes_of_the_road_before() -> None:
    def counts(line: str) -> list[tuple[tuple[int, int], bool]]:
        roads = drafted(line, 1).roads
        return [(member.profile.count, member.profile.is_divided) for _, member in roads]

    wide = ((2, 2), True)
    assert counts("| divided lanes=2 against=2 // crossroads straight lights //") == [wide, wide]
    assert counts("| lanes=2 against=1 // t_junction straight ways=left+straight //") == [((2, 1), False)] * 2
    assert counts("| oneway // crossroads straight //") == [((1, 0), False)] * 2
    assert counts("| lanes=2 oneway // crossroads straight // | oneway") == [((2, 0), False)] * 2
    assert counts("| lanes=2 against=2 // crossroads straight // | lanes=1 against=1")[1] == ((1, 1), False)
    assert counts("| lanes=2 against=2 // crossroads left //")[1] == ((2, 2), False)
    assert counts("| lanes=2 // crossroads left //")[1] == ((1, 1), False)
    assert counts("| oneway // crossroads left //")[1] == ((1, 1), False)
    line = "| oneway // crossroads straight // | centre=solid"
    assert counts(line)[1] == ((1, 1), False)
    assert inspect(drafted(line, 1), read_plan(line), WIDE) == ()


def test_roads_beyond_the_crossing_at_the_end_of_a_ramp_have_two_ways() -> None:
    for seed in range(2):
        route = drafted("| motorway // diverge ramp // t_junction left // roundabout exit=2 //", seed)
        counts = [member.profile.count for _, member in route.roads]
        assert counts == [(2, 0), (3, 0), (1, 0), (1, 1), (1, 1)]  # the second with the lane to the exit
        crossing = next(each for each in route.network.junctions if each.kind == "t_junction")
        ways = [route.network.road(arm.end.road).profile.count for arm in crossing.arms]
        assert sorted(ways) == [(1, 0), (1, 1), (1, 1)]
    route = drafted("crossroads left // merge ramp // | motorway", 1)
    assert [member.profile.count for _, member in route.roads][:2] == [(1, 1), (1, 0)]  # the ramp


def tightest(design: Design, last: int) -> float:
    """The smallest radius in metres of the roads before the place number ``last``."""
    bends = [each for each in design.segments[: design.junctions[last].after] if each.turn_degrees]
    return min((each.distance / np.radians(abs(each.turn_degrees)) for each in bends), default=np.inf)


@pytest.mark.parametrize("seed", range(3))
def test_a_motorway_stays_one_behind_a_change_of_lanes(seed: int) -> None:
    brief = read_plan("| motorway lanes=3 // lane_change right // | len=400 // diverge ramp")
    design = Planner().draft(brief, WIDE, (), (), seed)
    assert isinstance(design, Design)
    assert tightest(design, 1) > 500
    before_the_exit = design.segments[: design.junctions[1].after]
    assert max(abs(each.incline) for each in before_the_exit) <= 5


@pytest.mark.parametrize("take", ["left", "right"])
@pytest.mark.parametrize("behind", [1, 2])
@pytest.mark.parametrize("ways", ["", " ways=left+right"])
def test_a_wide_road_ends_at_a_t_junction_from_which_a_narrow_one_is_taken(
    take: str, behind: int, ways: str
) -> None:
    line = f"| lanes=3 against=3 // t_junction {take}{ways} // | lanes={behind} against={behind}"
    for seed in range(2):
        route = drafted(line, seed)
        assert inspect(route, read_plan(line), WIDE) == ()
        assert [member.profile.count for _, member in route.roads] == [(3, 3), (behind, behind)]


@pytest.mark.parametrize(
    ("line", "lanes"),
    [
        ("| lanes=2 divided // roundabout straight large", [(2, 2), (2, 2)]),
        ("| lanes=2 against=2 // roundabout straight // roundabout left", [(2, 2), (2, 2), (2, 2)]),
        ("| lanes=2 against=2 // roundabout exit=2 arms=4", [(2, 2), (2, 2)]),
        ("| lanes=2 // roundabout left", [(2, 1), (1, 1)]),
        ("| lanes=2 against=2 // roundabout straight lanes=2 // | lanes=1", [(2, 2), (1, 1)]),
        ("| lanes=2 against=2 // lane_change left // crossroads left", [(2, 2), (2, 2), (2, 2)]),
    ],
)
def test_lanes_go_on_over_a_roundabout_and_behind_a_change_of_lanes(
    line: str, lanes: list[tuple[int, int]]
) -> None:
    route = drafted(line, 1)
    assert [member.profile.count for _, member in route.roads] == lanes
    assert inspect(route, read_plan(line), WIDE) == ()


@pytest.mark.parametrize(
    ("line", "side"),
    [
        ("| lanes=1 // lane_gain // | lanes=2 // lane_change left", "left"),
        ("| lanes=1 // lane_gain // | lanes=2 // lane_change right", "right"),
        ("| lanes=1 // lane_gain side=right // | lanes=2 // lane_change left", "right"),
        ("| lanes=2 // lane_change right // lane_drop // | lanes=1", "left"),
        ("| lanes=2 // lane_change left // lane_drop // | lanes=1", "right"),
        ("| lanes=2 // lane_drop // | lanes=1", "right"),
    ],
)
def test_a_lane_begins_or_ends_where_the_lane_change_beside_it_says(line: str, side: str) -> None:
    design = draft(read_plan(line), WIDE, seed=2)
    assert isinstance(design, Design)
    places = [place for place in design.junctions if place.kind in ("lane_gain", "lane_drop")]
    assert [getattr(place, "side", None) for place in places] == [side]


def test_a_motorway_with_a_median_has_tighter_turns_where_the_map_is_small() -> None:
    brief, small = read_plan("turn left | motorway lanes=2 against=2 divided"), World()
    design = Planner().draft(brief, small, (), (), 1)
    assert isinstance(design, Design)
    route, large = build_route(design, small), World(site=Site(map_size=3000))
    assert inspect(route, brief, small) == ()
    assert any("turn 1 has a radius" in finding.sentence for finding in inspect(route, brief, large))


@pytest.mark.parametrize(
    ("line", "first", "apart"), rows(__file__, "two_lane_changes_are_as_far_apart_as_asked")
)
def test_two_lane_changes_are_as_far_apart_as_asked(
    line: str, first: float | None, apart: list[float]
) -> None:
    brief = read_plan(line)
    world = world_for(brief, World())
    route = build_route(draft(brief, world, seed=3), world)
    assert inspect(route, brief, world) == ()
    s = np.arange(0, route.length, 0.05)
    lane = route.profile.middle(s) / world.section.lane_width  # it moves by 1 in each change
    moved = np.cumsum(np.abs(np.diff(lane)))
    assert moved[-1] == pytest.approx(len(apart) + 1, abs=0.01)
    places = s[np.searchsorted(moved, np.arange(len(apart) + 1) + 0.5)]
    assert np.diff(places) == pytest.approx(apart, abs=2)
    assert first is None or places[0] == pytest.approx(first, rel=0.06)


@pytest.mark.parametrize("line", [line for (line,) in rows(__file__, "routes_past_ramps_are_as_asked")])
def test_routes_past_ramps_are_as_asked(line: str) -> None:
    brief = read_plan(line)
    world = World(limits=Limits(speed_limit=100 / 3.6), site=Site(map_size=1350))
    assert inspect(build_route(draft(brief, world, seed=1), world), brief, world) == ()


@pytest.mark.parametrize(("line", "said"), rows(__file__, "what_has_no_room_is_told"))
def test_what_has_no_room_is_told(line: str, said: str) -> None:
    with pytest.raises((BriefError, DesignError), match=f"^{said}$"):
        draft(read(line, "plan", 800), WIDE, seed=1)


def test_a_road_with_an_exit_has_sweeping_bends_unless_others_are_asked_for() -> None:
    def radius(line: str, seed: int) -> float:
        design = Planner().draft(read_plan(line), WIDE, (), (), seed)
        assert isinstance(design, Design)
        return tightest(design, 0)

    free = [radius("| len=400 lanes=2 // diverge ramp", seed) for seed in range(12)]
    assert any(np.isfinite(free))
    assert min(free) >= 40
    assert max(radius("turn sharp // diverge ramp", seed) for seed in range(4)) < 40


@pytest.mark.parametrize(
    ("line", "said"),
    rows(__file__, "what_cannot_be_built_yet_is_named"),
)
def test_what_cannot_be_built_yet_is_named(line: str, said: str) -> None:
    with pytest.raises(DesignError, match=f"^{said}$"):
        draft(read_plan(line), WIDE, seed=1)


@pytest.mark.parametrize(
    ("line", "most", "more"),
    [
        ("| lanes=4 against=4 // crossroads straight // | lanes=1 against=1", "2 lanes", 3),
        ("| lanes=3 // t_junction straight // | lanes=1", "1 lane", 2),
        ("| lanes=1 against=1 // t_junction straight // | lanes=1 against=3", "1 lane", 2),
    ],
)
def test_lanes_that_would_lead_nowhere_are_refused_at_once(line: str, most: str, more: int) -> None:
    with pytest.raises(DesignError, match=f"can differ by {most} in .*, and not by {more}; .*lane_drop"):
        NetworkSearch(read_plan(line), WIDE, np.random.default_rng(1))


def checked_draft(line: str) -> None:
    brief = read_plan(line)
    check(brief)
    draft(brief, WIDE, seed=1)


@pytest.mark.parametrize(
    ("line", "word"),
    rows(__file__, "lanes_that_contradict_each_other_are_refused_in_one_sentence"),
)
def test_lanes_that_contradict_each_other_are_refused_in_one_sentence(line: str, word: str) -> None:
    with pytest.raises((UsageError, DesignError), match=word) as error:
        checked_draft(line)
    assert "\n" not in str(error.value)
