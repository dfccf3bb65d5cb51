"""Turn lanes on the road of arrival: where they lead, how long they are, and what stays as it was."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.random_designs import random_turn_lanes_design
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import UsageError
from roadgpt.network import Network, Route, build_route
from roadgpt.network.route import Passage
from roadgpt.road import Limits, Site, World, read_design
from roadgpt.run import perform
from roadgpt.run.model import Setup

WORLD = World(site=Site(map_size=500), limits=Limits(speed_limit=50 / 3.6))


def built(data: dict[str, Any]) -> Route:
    return build_route(read_design(data)[0], WORLD)


def without_turn_lanes(data: dict[str, Any]) -> dict[str, Any]:
    made = copy.deepcopy(data)
    for key, place in made.items():
        if key.startswith("junction"):
            del place["turn_lanes"], place["turn_length"]
    return made


def side_of_way(network: Network, road: int) -> str:
    """The side to which a way through a junction turns, from the sum of many small changes of direction."""
    line = network.road(road).road.centreline(0.5)[:, :2]
    steps = np.diff(line, axis=0)
    turned = math.degrees(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))[-1] - math.atan2(*steps[0, ::-1]))
    return "left" if turned > 25 else "right" if turned < -25 else "straight"


def led(network: Network, passage: Passage) -> list[set[str]]:
    """For each lane of the road of arrival, from left to right, the sides to which it leads."""
    lanes = network.lanes_into(passage.arrival)
    ways = [each for each in passage.entered.connections if each.incoming == passage.arrival]
    found = [
        {side_of_way(network, each.road) for each in ways if lane in [link.incoming for link in each.lanes]}
        for lane in lanes
    ]
    return found[::-1] if network.left_hand else found


def other_ways(passage: Passage) -> set[tuple[int, int, int, int]]:
    """The lanes that ways from other arms join, with the places of their arms around the junction."""
    place = {end: number for number, end in enumerate(passage.arms)}
    return {
        (place[each.incoming], link.incoming, place[each.outgoing], link.outgoing)
        for each in passage.entered.connections
        for link in each.lanes
        if each.incoming != passage.arrival and each.outgoing != passage.arrival
    }


@given(st.integers(0, 10_000), st.booleans())
@settings(max_examples=25, deadline=None)
def test_turn_lanes_lead_to_their_side_alone_and_change_no_other_lane(seed: int, left_hand: bool) -> None:
    data = random_turn_lanes_design(seed) | {"left_hand": left_hand}
    route, plain = built(data), built(without_turn_lanes(data))
    network, places = route.network, [data[key] for key in sorted(data) if key.startswith("junction")]
    for place, passage, usual in zip(places, route.passages, plain.passages, strict=True):
        sides, lanes, before = place["turn_lanes"], led(network, passage), led(plain.network, usual)
        assert len(lanes) == len(before) + len(sides)
        for side, end in (("left", 0), ("right", -1)):
            if side in sides:
                assert lanes[end] == {side}
                assert sum(side in each for each in lanes) == 1
        assert set().union(*lanes) == set().union(*before)
        assert other_ways(passage) == other_ways(usual)
        _check_shape(route, place, passage)


def _check_shape(route: Route, place: dict[str, Any], passage: Passage) -> None:
    """Each turn lane begins with no width, grows over eight times its width, and then stays; the route is in
    it where it turns to its side, and in no turn lane elsewhere."""
    member = route.network.road(passage.arrival.road)
    if not place["turn_lanes"]:
        assert passage.arrival not in route.network.continued_at
        return
    inner, *_, outer = lanes = route.network.lanes_into(passage.arrival)
    full, s = (
        member.profile.lanes[passage_lane(route, passage)].width,
        np.linspace(0, member.road.length, 300),
    )
    width = full if isinstance(full, float) else float(full.height(member.road.length))
    assert member.road.length == pytest.approx(place["turn_length"] + 8 * width)
    at_centre = "right" if route.network.left_hand else "left"
    for side in place["turn_lanes"]:
        left, right = member.profile.edges_of(inner if side == at_centre else outer, s)
        assert abs(left - right)[0] == pytest.approx(0.0, abs=1e-9)
        assert abs(left - right)[s >= 8 * width] == pytest.approx(width)
    angle = sorted((arm["angle"] for arm in place["arms"]), reverse=route.network.left_hand)[
        place["take"] - 1
    ]
    taken = "left" if angle > 25 else "right" if angle < -25 else "straight"
    turning = [inner if side == at_centre else outer for side in place["turn_lanes"]]
    assert (passage_lane(route, passage) in turning) == (taken in place["turn_lanes"])
    assert len([leg for leg in route.legs if leg.road == member.id]) == 1 + (taken in place["turn_lanes"])
    assert len(lanes) > len(turning)


def passage_lane(route: Route, passage: Passage) -> int:
    """The lane in which the route comes to a junction."""
    return [leg.lane for leg in route.legs if leg.road == passage.arrival.road][-1]


@pytest.mark.parametrize(("left_hand", "sides"), [(False, ["left"]), (False, ["right"]), (True, ["right"])])
def test_the_lanes_that_lead_on_stay_where_they_are(left_hand: bool, sides: list[str]) -> None:
    data: dict[str, Any] = {
        "starting_point": [20, 100, 0],
        "theta": 30,
        "left_hand": left_hand,
        "lanes": {"forward": 2, "backward": 2, "width": 3.5, "divided": True},
        "road_segment1": {"distance": 60, "direction": "left", "incline": 3, "turn_degrees": 40},
        "road_segment2": {"distance": 70, "direction": "right", "incline": -2, "turn_degrees": -50},
        "junction1": {"after": 2, "kind": "crossroads", "take": "straight"},
        "road_segment3": {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0},
    }
    usual = built(data)
    data["junction1"] |= {"turn_lanes": sides}
    route = built(data)
    s = np.linspace(0.0, 129.9, 200)
    left, right = (each.profile.lane(s) for each in (route, usual))
    for own, other in zip(left, right, strict=True):
        assert route.at(s, own) == pytest.approx(usual.at(s, other), abs=1e-6)


PLANS = (
    "straight 120 // crossroads left lights turn_lane=left",
    "turn left // t_junction right turn_lane=right turn_len=50 // crossroads straight turn_lane=left+right",
    "| lanes=2 against=2 // crossroads left stop turn_lane=left // | up || left_hand",
    "lane_gain // crossroads right turn_lane=right crosswalk // roundabout exit=2",
)


@pytest.mark.parametrize("plan", PLANS)
def test_a_plan_with_turn_lanes_is_built_and_driven(plan: str) -> None:
    run = perform(plan, 1, WORLD, Setup(reader="plan", driver="reference"))
    assert run.findings == ()
    assert run.outcome == "PASS"


def test_a_missing_or_a_short_turn_lane_is_told() -> None:
    brief = read_plan("t_junction left ways=left+straight turn_lane=left turn_len=60")
    world = world_for(brief, WORLD)
    design = draft(brief, world, seed=1)

    def told(**change: Any) -> list[str]:
        (place,) = design.junctions
        other = design.model_copy(update={"junctions": (place.model_copy(update=change),)})
        return [each.sentence for each in inspect(build_route(other, world), brief, world)]

    assert told() == []
    (short,) = told(turn_length=30.0)
    assert "asked for a left-turn lane of" in short
    (missing,) = told(turn_lanes=())
    assert "asked for a lane that leads to the left only, has none" in missing


@pytest.mark.parametrize(
    "change",
    [
        {"turn_lanes": ["right"]},
        {"turn_lanes": ["left", "left"]},
        {"turn_lanes": ["left"], "turn_length": 400},
    ],
)
def test_designs_whose_turn_lanes_cannot_be_are_refused(change: dict[str, Any]) -> None:
    data = random_turn_lanes_design(1)
    arms = [{"angle": 0}, {"angle": 90}]
    data["junction1"] = {"after": 2, "kind": "t_junction", "take": "left", "arms": arms, **change}
    with pytest.raises(UsageError, match="turn") as error:
        built(data)
    assert "\n" not in str(error.value)
