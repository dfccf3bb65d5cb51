"""The lane in which the tested car starts: counted on the finished road, and refused where it cannot be."""

import pytest

from roadgpt.brief import read, remarks
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError, UsageError
from roadgpt.network import build_route, refuse_other_lane
from roadgpt.network.road_or_route import legs_of, network_of
from roadgpt.road import World, build


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize(("lane", "outside"), [("1", 0), ("2", 1), ("3", 2), ("-1", 2), ("-2", 1), ("-3", 0)])
@pytest.mark.parametrize("road", ["straight | lanes=3 against=1{}", "| lanes=3 // crossroads straight{}"])
def test_lanes_are_counted_from_the_kerb(road: str, lane: str, outside: int, left_hand: bool) -> None:
    side = (" || left_hand" if "//" in road else " left_hand") if left_hand else ""
    brief = read(f"{road.format(side)} && ego lane={lane}", "plan")
    world = world_for(brief, World())
    asked = draft(brief, world, (), (), 0)
    drawn = world.lay(build(asked) if asked.is_plain else build_route(asked, world))
    (first, *_), network = legs_of(drawn, world), network_of(drawn, world)
    profile = network.road(first.road).profile
    own = sum(profile.edges_of(first.lane, 1.0)) / 2
    driven = [number for number, lane in profile.lanes.items() if lane.kind == "driving"]
    middles = [sum(profile.edges_of(number, 1.0)) / 2 for number in driven]
    same = [each for each in middles if (each > 0) == (own > 0)]
    assert len(same) == 3
    assert len([each for each in same if abs(each) > abs(own) + 0.5]) == outside


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("straight | lanes=2 && ego lane=3", "lane=3 needs more lanes; write lanes=3"),
        ("straight | lanes=2 && ego lane=1; car lane right", "no lane beside the tested car's lane=1"),
        ("straight | lanes=2 && ego lane=-1; car lane left", "no lane beside the tested car's lane=-1"),
        ("straight | lanes=2 left_hand && ego lane=1; car lane left", "no lane beside"),
        ("straight && ego lane=0", "lanes count from 1 to 4 from the kerb"),
        ("straight && ego lane=9", "there is no lane 9; write for example lane=1"),
        ("straight && forest x0", "one forest or more, not 0"),
        ("straight && ego lane=right", "lane=right is no lane"),
    ],
)
def test_a_lane_that_cannot_be_is_refused(line: str, said: str) -> None:
    with pytest.raises(BriefError, match=said):
        world_for(read(line, "plan"), World())


def test_what_is_not_built_of_the_landscape_is_said() -> None:
    brief = read("straight && lake along left; town through; bridge x2 len=40", "plan")
    (said,) = (each for each in remarks(brief, 250.0) if "not built" in each)
    assert said == "not built: a town to go through; the road is made without it"
    without = read("straight && lake along left; bridge x2 len=40", "plan")
    assert not any("not built" in each for each in remarks(without, 250.0))


def test_a_road_that_is_there_is_driven_in_the_lane_that_is_said_or_not_at_all() -> None:
    world = World().changed(lanes="3+0")
    road = world.lay(build(draft(read("straight len=100", "plan"), world, (), (), 0)))
    for lane, is_its in (("1", True), ("-3", True), ("2", False), ("-1", False), ("4", False)):
        there = world.changed(scene=f"ego lane={lane} v=30")
        if is_its:
            refuse_other_lane(road, there)
        else:
            with pytest.raises(UsageError, match=r"starts in lane 1 of 3 from the kerb; write lane=1"):
                refuse_other_lane(road, there)
