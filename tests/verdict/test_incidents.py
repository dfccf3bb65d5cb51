"""What a car does wrong in junctions, on drives written by hand: every place is worked out on paper."""

import json
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from roadgpt.drive import COLUMNS, Box, Columns, Command, Drive, View, simulate
from roadgpt.drive.lane_position import LanePolygon
from roadgpt.network import Route, build_route
from roadgpt.road import CrossSection, Limits, Road, World, read_design
from roadgpt.verdict import Verdict, judge
from staged import shares_outside

WORLD = World(section=CrossSection(shoulder=2.0), limits=Limits(oob_tolerance=1.0))
BOX = Box(4.7, 1.86, ahead=-0.1)  # its front is 2.25 m ahead


def crossroads(take: str, control: str = "none") -> Route:
    """50 m along +x to crossroads with kerbs of 10 m."""
    straight = {"distance": 50, "direction": "straight", "incline": 0, "turn_degrees": 0}
    design = {
        "starting_point": [0, 0, 0],
        "theta": 0,
        "road_segment1": straight,
        "junction1": {
            "after": 1, "kind": "crossroads", "take": take, "control": control, "kerb": 10,
            "arms": [
                {"angle": angle, **({} if name == take else {"length": 40})}
                for name, angle in (("right", -90), ("straight", 0), ("left", 90))
            ],
        },
        "road_segment2": straight,
    }  # fmt: skip
    return build_route(read_design(design)[0], WORLD).on_ground()


def driven(
    route: Route, x: Any, y: Any, heading: Any = 0.0, speed: Any = 10.0, dt: float = 0.1, ended: str = "goal"
) -> Drive:
    """A car at these places; stations and shares are computed from the route."""
    x = np.atleast_1d(np.asarray(x, float))
    y, heading, speed = (np.broadcast_to(np.asarray(each, float), x.shape) for each in (y, heading, speed))
    columns = {name: np.zeros(len(x)) for name in COLUMNS}
    columns |= {"time": dt * np.arange(len(x)), "x": x, "y": y, "heading": heading, "speed": speed}
    table = np.arange(0, route.length, 0.01)
    points, headings = route.plan.at(table), route.heading(table)
    _, nearest = cKDTree(points[:, :2]).query(np.column_stack([x, y]))
    dx, dy = (np.column_stack([x, y]) - points[nearest, :2]).T
    columns["s"] = table[nearest]
    columns["t"] = dy * np.cos(headings[nearest]) - dx * np.sin(headings[nearest])
    made = Drive("by hand", "paper", 0, Columns(columns), ended, BOX)  # type: ignore[arg-type]
    columns["outside"] = shares_outside(made, LanePolygon.along(route, WORLD), columns["s"])
    return Drive("by hand", "paper", 0, Columns(columns), ended, BOX)  # type: ignore[arg-type]


def kinds(verdict: Verdict) -> list[str]:
    assert verdict.incidents is not None
    return [each.kind for each in verdict.incidents]


def test_a_car_on_its_route_does_nothing_wrong() -> None:
    route = crossroads("straight")
    verdict = judge(route, driven(route, np.arange(3, 120), -2.0), WORLD)
    assert verdict.kept
    assert verdict.incidents == ()
    assert verdict.counts == {}
    assert verdict.description.count(";") == 0


def test_straight_on_where_the_route_turns_left_is_a_wrong_turn() -> None:
    route = crossroads("left")
    verdict = judge(route, driven(route, np.arange(3, 100, 0.5), -2.0), WORLD)
    assert (verdict.outcome, verdict.cause) == ("FAIL", "wrong turn")
    assert verdict.counts == {"wrong turn": 1}
    (only,) = verdict.incidents or ()
    # The lane is 4 m wide, to the right of a left turn. Were it an arc of 14 m, its right edge of 18 m would
    # cross y = -2 at an angle a with 14 - 18 cos a = -2, at x = 50 + 18 sin a = 58.2; clothoids are later,
    # and the car, 4.7 m long, is nearly whole beside the lane half a length behind that.
    assert 58.2 < only.at_xy[0] < 66
    assert verdict.at_xy == only.at_xy
    assert verdict.at_s == only.at_s
    assert "took a wrong turn after" in verdict.description


def test_a_wrong_turn_lasts_until_the_car_is_back_on_its_route() -> None:
    route = crossroads("left")
    x = np.arange(3, 100, 0.5)
    # on the left half of the junction only roads of the other direction lead on
    over = np.where((x > 72) & (x < 75), 2.0, -2.0)
    assert judge(route, driven(route, x, over), WORLD).counts == {"wrong turn": 1}
    twice = np.concatenate([x, x])
    assert judge(route, driven(route, twice, -2.0), WORLD).counts == {"wrong turn": 2}


def test_cutting_a_corner_is_no_wrong_turn() -> None:
    route = crossroads("left")
    middle = np.arange(50.0, 75.0, 0.2)
    x, y = route.at(middle, 0.7)[:, :2].T  # 0.7 m on the wrong side of its lane's left edge
    verdict = judge(route, driven(route, x, y, route.heading(middle)), WORLD)
    assert "wrong turn" not in kinds(verdict)


def test_a_car_that_slides_wide_and_comes_back_has_taken_no_wrong_turn() -> None:
    route = crossroads("left")
    middle = np.arange(40.0, 80.0, 0.2)
    wide = np.where((middle > 55) & (middle < 65), -4.5, -2.0)  # 0.5 m beyond its lane
    x, y = route.at(middle, wide)[:, :2].T
    drive = driven(route, x, y, np.where(wide < -4, 0.3, route.heading(middle)))
    assert 0.5 < drive["outside"].max() < 0.9
    verdict = judge(route, drive, WORLD)
    assert verdict.kept
    assert "wrong turn" not in kinds(verdict)


def test_another_arm_may_be_wrong_in_either_direction() -> None:
    route = crossroads("straight")
    for heading in (math.pi / 2, -math.pi / 2):
        verdict = judge(route, driven(route, [20.0, 66.0, 66.0], [-2.0, 30.0, 31.0], heading), WORLD)
        assert verdict.counts["wrong turn"] == 1
        assert verdict.at_xy == (66.0, 30.0)


def test_a_car_that_faces_backwards_for_a_second_goes_the_wrong_way() -> None:
    route = crossroads("straight")
    for steps, expected in ((10, []), (11, ["wrong way"])):  # 0.9 s and 1.0 s
        heading = np.zeros(40)
        heading[20 : 20 + steps] = math.radians(91)
        verdict = judge(route, driven(route, np.linspace(3, 30, 40), -2.0, heading), WORLD)
        assert [kind for kind in kinds(verdict) if kind != "off road"] == expected
        assert verdict.cause == ("wrong way" if expected else None)
        if expected:
            assert verdict.at_time == pytest.approx(2.0)
    verdict = judge(route, driven(route, np.linspace(3, 30, 40), -2.0, math.radians(89)), WORLD)
    assert "wrong way" not in kinds(verdict)


def test_a_tyre_off_the_road_is_counted_and_fails_nothing() -> None:
    route = crossroads("straight")
    # outer edges of the tyres are 0.9025 m from the middle; the road ends 4 m to the right
    y = np.full(100, -3.0)
    y[20:25] = -3.13
    y[60:61] = -3.2
    verdict = judge(route, driven(route, np.linspace(3, 40, 100), y), WORLD)
    assert verdict.kept
    assert verdict.counts == {"off road": 2}
    assert [each.at_time for each in verdict.incidents or ()] == pytest.approx([2.0, 6.0])
    assert verdict.description.endswith("; a wheel off the road 2 times, first after 10 m")
    # inside the junction the whole mouth is paved: no kerb where the arms meet
    node = route.network.junctions[0].node[0]
    inside = judge(route, driven(route, [node + 2, node + 2], [-12.0, -9.0], math.pi / 2), WORLD)
    assert "off road" not in kinds(inside)


@pytest.mark.parametrize(
    ("stop", "speed", "missed"),
    [(46.0, 0.05, False), (46.0, 0.15, True), (40.0, 0.0, True), (47.2, 0.0, False), (47.5, 0.0, True)],
)
def test_a_stop_counts_within_four_metres_before_the_line(stop: float, speed: float, missed: bool) -> None:
    # The line is 0.5 m wide and ends at 50 m: the front, 2.25 m ahead, has to stand in 45.5 m ... 49.5 m.
    route = crossroads("straight", "stop")
    x = np.array([30.0, stop, 55.0, 60.0])
    verdict = judge(route, driven(route, x, -2.0, speed=[10.0, speed, 10.0, 10.0]), WORLD)
    assert kinds(verdict) == (["stop line"] if missed else [])
    assert verdict.cause == ("stop line" if missed else None)
    if missed:
        assert "did not stop at the stop sign" in verdict.description
        assert verdict.sbft_description == "Successful test"


def test_only_a_stop_sign_asks_for_a_stop() -> None:
    for control in ("none", "yield", "priority", "lights"):
        route = crossroads("straight", control)
        assert kinds(judge(route, driven(route, np.arange(3, 120), -2.0), WORLD)) == []


def test_out_of_lane_remains_the_cause_and_the_rest_is_counted() -> None:
    route = crossroads("left", "stop")
    strict = WORLD.changed(oob_tolerance=0.95)
    drive = driven(route, np.arange(3, 100, 0.5), -2.0, ended="fell")
    verdict = judge(route, drive, strict)
    assert verdict.cause == "out of lane"
    assert verdict.side == "right"
    assert verdict.counts == {"stop line": 1, "wrong turn": 1, "out of lane": 1}
    assert kinds(verdict)[0] == "stop line"  # in the order of time
    assert "; no stop at a stop sign once, after 48 m; on a wrong road once, after " in verdict.description
    assert "in all" not in verdict.description
    assert verdict.oob_counter == 1


def test_verdicts_of_routes_are_stored_and_those_of_roads_are_as_before() -> None:
    route = crossroads("left", "stop")
    verdict = judge(route, driven(route, np.arange(3, 100, 0.5), -2.0), WORLD)
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict
    road = Road.through([[0, 0], [50, 0], [100, 0]])
    x = np.arange(3.0, 90)
    zeros = {name: np.zeros(len(x)) for name in COLUMNS}
    along = Columns(zeros | {"x": x, "s": x, "t": np.full(len(x), -2.0), "y": np.full(len(x), -2.0)})
    plain = judge(road, Drive("by hand", "paper", 0, along, "goal", BOX), WORLD)
    assert plain.incidents is None
    assert list(plain.to_json()) == [
        "kept", "outcome", "cause", "description", "sbft_description", "max_oob", "margin", "oob_counter",
        "beyond", "at_s", "at_xy", "at_time", "side",
    ]  # fmt: skip
    assert Verdict.from_json(plain.to_json()) == plain


class RunsTheSign:
    """Drives the middle of a straight lane at 8 m/s and stops nowhere."""

    def steer(self, view: View) -> Command:
        return Command(0.1 * (-2.0 - view.t) - 0.5 * view.heading, 0.3 if view.speed < 8 else 0.0)


def test_a_driver_that_knows_no_signs_fails_for_that_alone() -> None:
    route = crossroads("straight", "stop")
    world = World()
    verdict = judge(route, simulate(route, world, RunsTheSign()), world)
    assert (verdict.outcome, verdict.cause) == ("FAIL", "stop line")
    assert verdict.margin > 1.99  # in the middle of a lane that is 4 m wide
    free = crossroads("straight", "none")
    assert judge(free, simulate(free, world, RunsTheSign()), world).kept
