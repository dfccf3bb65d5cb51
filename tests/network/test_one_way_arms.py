"""One-way arms: whatever roads meet at a junction, it is built, or refused in one sentence."""

import math
from itertools import product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.changing import WORLD
from network.shared_laws import sentence_of
from roadgpt.check import inspect
from roadgpt.errors import UsageError
from roadgpt.network import NetworkRoad, Route, build_route
from roadgpt.road import read_design
from roadgpt.road.design import USUAL_ARMS

STRAIGHT = {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0}
ONE_WAY = {"forward": 1, "backward": 0}
settled = settings(max_examples=50, deadline=None)


def route_of(data: dict[str, Any]) -> Route:
    return build_route(read_design(data)[0], WORLD).on_ground()


def design_of(junction: dict[str, Any], lanes: dict[str, int], left_hand: bool) -> dict[str, Any]:
    """A junction between two straight roads, or at the end of the only one if the route turns back."""
    data = {
        "starting_point": [100, 100, 0],
        "theta": 0,
        "left_hand": left_hand,
        "lanes": lanes,
        "road_segment1": STRAIGHT,
        "junction1": {"after": 1, **junction},
    }
    goes_back = junction["kind"] == "roundabout" and junction["take"] == len(junction["arms"]) + 1
    return data if goes_back else {**data, "road_segment2": STRAIGHT}


def arm_at(route: Route, degrees: float) -> tuple[NetworkRoad, str]:
    """The road of the arm with this heading out of the junction, and its end there."""
    network = route.network
    outside = {each.id for each in network.roads_outside}
    arms = [arm for junction in network.junctions for arm in junction.arms if arm.end.road in outside]
    (found,) = [arm for arm in arms if math.cos(arm.direction - math.radians(degrees)) > 1 - 1e-9]
    return network.road(found.end.road), found.end.contact


def check_one_way(route: Route, arms: list[dict[str, Any]]) -> None:
    """A one-way arm has lanes in its own direction, one or more, and none against it."""
    for arm in arms:
        if "one_way" in arm:
            road, contact = arm_at(route, arm["angle"])
            assert contact == {"in": "end", "out": "start"}[arm["one_way"]]
            along, against = road.profile.count
            assert along >= 1
            assert against == 0


@pytest.mark.parametrize("left_hand", [False, True])
def test_a_one_way_arm_leads_in_from_straight_ahead_of_a_one_way_road(left_hand: bool) -> None:
    arms = [{"angle": 90}, {"angle": 0, "one_way": "in"}, {"angle": -90, "one_way": "in"}]
    route = route_of(design_of({"kind": "crossroads", "take": "left", "arms": arms}, ONE_WAY, left_hand))
    check_one_way(route, arms)
    ahead, _ = arm_at(route, 0)
    taken, _ = arm_at(route, 90)
    (junction,) = route.network.junctions
    ways = {(each.incoming.road, each.outgoing.road) for each in junction.connections}
    assert (ahead.id, taken.id) in ways
    assert inspect(route, None, WORLD) == ()


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("lanes", [ONE_WAY, {"forward": 1, "backward": 1}, {"forward": 3, "backward": 0}])
@pytest.mark.parametrize("ways", [*product(("in", "out", None), repeat=2)])
def test_each_side_of_a_crossroads_may_be_one_way(
    ways: tuple[str | None, str | None], lanes: dict[str, int], left_hand: bool
) -> None:
    given_ways = zip((0, 90), ways, strict=True)
    arms = [{"angle": -90}, *({"angle": a, **({"one_way": w} if w else {})} for a, w in given_ways)]
    route = route_of(design_of({"kind": "crossroads", "take": "right", "arms": arms}, lanes, left_hand))
    check_one_way(route, arms)


@given(st.data())
@settled
def test_nothing_ends_in_an_internal_error(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from([kind for kind, arms in USUAL_ARMS.items() if arms]))
    angles = USUAL_ARMS[kind]
    most = len(angles) + (kind == "roundabout")
    take = data.draw(st.integers(1, most))
    left_hand = data.draw(st.booleans())
    # exits are counted from the right or, with traffic on the left, from the left
    taken = len(angles) - take if left_hand else take - 1
    arms: list[dict[str, Any]] = [{"angle": angle} for angle in angles]
    for n, arm in enumerate(arms):
        way = data.draw(st.sampled_from([None, "in", "out"]))
        if way is not None and (n != taken or data.draw(st.integers(0, 9)) == 0):
            arm["one_way"] = way
    junction: dict[str, Any] = {"kind": kind, "take": take, "arms": arms}
    if kind == "roundabout":
        junction |= {"radius": 25, "ring_lanes": data.draw(st.integers(1, 2))}
    counts = st.fixed_dictionaries({"forward": st.integers(1, 4), "backward": st.integers(0, 4)})
    if take <= len(angles) and data.draw(st.booleans()):
        junction["lanes"] = data.draw(counts)
    made = design_of(junction, data.draw(counts), left_hand)
    try:
        route = route_of(made)
    except UsageError:
        sentence_of(route_of, made)
    else:
        check_one_way(route, arms)
        inspect(route, None, WORLD)
