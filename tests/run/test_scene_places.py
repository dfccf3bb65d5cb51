"""Roads have what the scenes on them need and their words leave open; what excludes each other is said."""

import numpy as np
import pytest
import shapely

from roadgpt.brief import read
from roadgpt.brief.scene_fit import fitted
from roadgpt.errors import BriefError
from roadgpt.network.line import driven_line
from roadgpt.road import World
from roadgpt.road.road import START
from roadgpt.run import Setup, perform
from roadgpt.traffic import begin
from roadgpt.traffic.actor import STEP
from roadgpt.traffic.following import GREEN, RED
from roadgpt.traffic.lights import lights_of
from roadgpt.traffic.rehearsal import rehearsed

SETUP = Setup(reader="plan", drives=False)


@pytest.mark.parametrize(
    "plan",
    [
        "crossroads right && car junction opposite: turn_across",
        "turn left | country && van oncoming in turn 1",
        "junction straight && car junction left v=50: cross",
        "t_junction straight && car junction right: cross",
        "crossroads && car junction right: cross",
        "crossroads priority others_stop && car junction right: run_sign",
        "straight 300 && car junction left: run_light",
        "straight 300 && car ramp: merge",
        "straight 300 && adult crosswalk left",
        "crossroads left && adult crosswalk left",
        "straight 300 && truck ahead: turn_off left",
        "straight 200 && car roundabout",
        "junction && van oncoming in turn 1",
        "| motorway && car oncoming",
        "| oneway && truck behind: overtake",
        "crossroads || left_hand && car junction left: cross",
        "junction left lights crosswalk && ego v=0; adult crosswalk: cross",
    ],
)
def test_a_road_has_what_its_scene_needs(plan: str) -> None:
    run = perform(read(plan, "plan", map_size=None), 1, World(), SETUP)
    assert run.outcome != "INVALID"
    assert run.road is not None
    # where somebody has no place, it raises SceneError
    assert begin(run.road, run.world, run.seed) is not None


@pytest.mark.parametrize(
    ("plan", "one", "other"),
    [
        ("crossroads right && car junction right: turn_in", "that turns in", "goes right"),
        (
            "t_junction ways=left+straight && car junction right: cross",
            "the right",
            "leads left and straight",
        ),
        ("t_junction straight && car junction left; car junction right", "from the right", "from the left"),
        ("y_junction left && car junction opposite: cross", "from the opposite side", "Y-junction"),
        ("crossroads straight stop && car junction left: run_light", "runs the red light", "stop signs"),
        ("crossroads straight lights && car junction left: run_sign", "does not give way", "traffic lights"),
        ("straight 200 && car ahead: brake after turn 1", "after turn 1", "there are 0"),
    ],
)
def test_what_excludes_each_other_is_said(plan: str, one: str, other: str) -> None:
    with pytest.raises(BriefError, match=f"{one}.*{other}"):
        read(plan, "plan", map_size=None)


def rehearsal(plan: str) -> tuple[float, float]:
    """How near the middles of the tested car, which never gives way, and of the first of the others come to
    each other, and how near the lines on which they move, in metres."""
    brief = read(plan, "plan", map_size=None)
    run = perform(brief, 1, World(), SETUP)
    assert run.road is not None
    traffic = rehearsed(run.road, run.world, run.seed)
    assert traffic is not None
    other = traffic.tracks().states[:, 0, :2]
    way, v = driven_line(run.road, run.world), run.world.first_speed
    s = min(START, run.road.length / 2) + v * STEP * np.arange(len(other))
    car = np.array([way.pose(way.from_road(each))[:2] for each in s])
    there = ~np.isnan(other[:, 0])
    lines = shapely.LineString(car), shapely.LineString(other[there])
    return float(np.hypot(*(car - other)[there].T).min()), float(shapely.distance(*lines))


@pytest.mark.parametrize(
    "plan",
    [
        "crossroads left lights && ego v=30; car junction opposite v=40: run_light",
        "crossroads straight stop all_way && ego v=40; car junction left v=40: run_sign",
        "crossroads straight none && ego v=30; car junction right v=30: run_sign",
        "crossroads right && ego v=20; car junction opposite v=20: run_sign, turn_in",
        "crossroads left && ego v=20; car junction right v=20: turn_in",
        "crossroads straight && ego v=40; car oncoming v=40: turn_off right",
        "crossroads && ego v=30; car junction right v=30: cross",
        "t_junction && ego v=30; car junction opposite v=20: turn_across",
        "t_junction left || left_hand && ego v=20; car junction right v=30: cross",
    ],
)
def test_where_the_action_says_so_the_two_come_into_each_others_path(plan: str) -> None:
    apart, lines = rehearsal(plan)
    assert lines < 0.5
    # Who turns in does so 1 s ahead: at 20 km/h 5.6 m from bumper to bumper, between cars of 4.7 m.
    assert apart < (10.8 if "turn_in" in plan else 8.0)


@pytest.mark.parametrize(
    "plan",
    [
        "crossroads straight && ego v=40; car junction opposite v=40: cross",
        "crossroads right && ego v=20; car junction right v=30: cross",
        "t_junction right yield && ego v=20; car junction right v=30",
    ],
)
def test_who_comes_from_an_arm_without_a_conflict_passes(plan: str) -> None:
    apart, lines = rehearsal(plan)
    assert lines > 2.0
    assert apart < 15.0


def test_who_runs_the_light_from_the_opposite_side_has_red_and_the_tested_car_green() -> None:
    brief = read("crossroads left lights && ego v=30; car junction opposite v=40: run_light", "plan")
    run = perform(brief, 1, World(), SETUP)
    assert run.road is not None
    (passage,) = run.road.passages
    lights = lights_of(run.road, run.world, run.seed)
    arrives = passage.start / run.world.first_speed
    shown = {end: lights.shown(end, arrives) for end in passage.arms}
    assert shown.pop(passage.arrival) == GREEN
    assert set(shown.values()) == {RED}


def test_words_at_a_junction_get_a_road_from_that_side() -> None:
    brief = read("At a junction we go straight on and a car comes from the left at 50 km/h.", map_size=None)
    (place,) = fitted(brief, brief.scene, 20.0).junctions
    assert (place.kind, place.take) == ("crossroads", "straight")


@pytest.mark.parametrize(("before", "whole"), [(100, 280), (200, 300)])
def test_the_length_of_a_route_with_a_lane_change_is_met(before: int, whole: int) -> None:
    brief = read(f"| lanes=2 len={before} // lane_change left || len={whole}", "plan", map_size=None)
    run = perform(brief, 1, World(), SETUP)
    assert run.road is not None
    assert run.road.length == pytest.approx(whole, rel=0.1)
    assert run.outcome != "INVALID"
