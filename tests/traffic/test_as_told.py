"""Scenes are what they say: who has priority drives on, nobody stands in another, and everybody is where the
scene puts it."""

import numpy as np
import pytest

from roadgpt.run import Run, Setup, perform


def drive(plan: str, driver: str = "reference", seed: int = 1) -> Run:
    run = perform(plan, seed, setup=Setup(reader="plan", driver=driver))
    assert run.outcome != "ERROR", run.description
    return run


@pytest.mark.parametrize(
    "plan",
    [
        "t_junction right stop && car junction left: cross",
        "t_junction left stop && ego v=40; car junction right v=50: cross",
        "t_junction left yield && car junction left: cross",
        "crossroads straight && car junction right: turn_in",
        "crossroads left yield && car junction right: cross",
    ],
)
def test_who_has_priority_drives_on_and_the_tested_car_goes_after_it(plan: str) -> None:
    run = drive(plan)
    assert run.outcome == "PASS", run.description
    assert run.drive is not None
    assert run.drive.others is not None
    speed = run.drive.others.states[:, 0, 4]
    assert np.nanmin(speed) > 2.0  # it never stands, and so it has gone before the drive ends
    assert np.isnan(speed[-1]) or run.drive.others.states[-1, 0, 4] > 2.0


@pytest.mark.parametrize("speed", [0, 1])
def test_a_car_that_stands_or_crawls_at_first_comes_to_lights(speed: int) -> None:
    run = drive(f"crossroads straight lights && ego v={speed}; car junction left: run_light", "robot")
    assert run.verdict is not None


def test_a_route_begins_in_the_lane_from_which_its_words_change_lanes() -> None:
    ways = "| lanes=2 len=200 // lane_change left // | len=350 // lane_change right"
    run = drive(f"{ways} && ego v=80; truck lane right s=395 v=0")
    assert run.drive is not None
    assert run.drive["t"][0] == pytest.approx(-6.0, abs=0.1)  # of lanes of 4 m, the one at the kerb
    # the truck stands 4 m aside, where the path is not yet in its lane
    assert run.outcome == "PASS", run.description


def tracks(run: Run) -> np.ndarray:
    assert run.drive is not None, run.description
    assert run.drive.others is not None
    return run.drive.others.states


@pytest.mark.parametrize(
    "scene",
    [
        "car ahead; car ahead", "car behind: keep; truck behind: keep", "truck ahead v=0; car ahead v=0",
        "car oncoming; van oncoming", "adult crossing right; adult crossing right", "car ahead; car x2 ahead",
    ],
)  # fmt: skip
def test_nobody_stands_in_another_where_the_scene_leaves_the_place_open(scene: str) -> None:
    states = tracks(drive(f"straight 300 && ego v=50; {scene}", "robot"))[:, :, :2]
    apart = [
        np.hypot(*(a - b).T) for n, a in enumerate(states.swapaxes(0, 1)) for b in states.swapaxes(0, 1)[:n]
    ]
    crossing = "adult" in scene
    assert np.nanmin(apart) > (0.5 if crossing else 5.0)


def test_two_who_are_told_to_be_in_one_place_are_refused_by_name() -> None:
    run = drive("straight 300 && car ahead gap=30; truck ahead gap=31", "robot")
    assert run.outcome == "INVALID"
    assert "a truck ahead would be in a car ahead; give one of them another place" in run.description
    told = drive("straight 300 && car ahead gap=-3", "robot")
    assert "would be in the tested car at the start" in told.description


def test_who_is_ahead_or_behind_of_a_car_that_stands_is_not_in_it() -> None:
    for scene in ("car ahead v=0", "car behind v=0.1: keep"):
        run = drive(f"straight 100 && ego v=0; {scene}", "robot")
        assert run.drive is not None
        start = np.array([run.drive["x"][0], run.drive["y"][0]])
        assert np.hypot(*(tracks(run)[0, 0, :2] - start)) > (4.7 + 4.9) / 2 + 1.0


@pytest.mark.parametrize(("kind", "side", "away"), [("adult", "left", 12.0), ("car", "right", 6.0)])
def test_who_is_beside_the_road_is_as_far_away_as_the_scene_says(kind: str, side: str, away: float) -> None:
    run = drive(f"straight 250 | flat && ego v=50; {kind} beside {side} s=90 away={away}", "robot")
    assert run.drive is not None
    place = tracks(run)[0, 0, :2]
    apart = np.hypot(run.drive["x"] - place[0], run.drive["y"] - place[1]).min()
    assert apart == pytest.approx(away, abs=0.2)


def test_who_overtakes_is_out_of_the_lane_before_it_reaches_the_tested_car() -> None:
    run = drive("| lanes=2 len=600 && ego v=70; car behind gap=15 v=90: overtake", "robot")
    assert run.outcome == "PASS", run.description
    assert np.nanmax(tracks(run)[:, 0, 4]) > 80 / 3.6  # it does overtake


def test_a_wrong_way_driver_is_as_fast_as_told() -> None:
    run = drive("straight 400 | lanes=2 && ego v=60; car oncoming v=90: wrong_way", "reference")
    speed = tracks(run)[:, 0, 4]
    assert np.nanmin(speed) == pytest.approx(25.0, abs=0.5)
    assert np.nanmax(speed) == pytest.approx(25.0, abs=0.5)


@pytest.mark.parametrize("scene", ["car behind gap=30 v=15", "car ahead gap=3 v=0; car behind gap=10 v=60"])
def test_who_comes_from_behind_hits_the_rear_of_a_car_that_stands_and_stops_there(scene: str) -> None:
    run = drive(f"straight 100 && ego v=0 robot; {scene}: keep", "robot")
    assert run.verdict is not None
    contact = run.verdict.first_contact
    assert contact is not None
    assert (contact.face, contact.other_face) == ("rear", "front")
    assert run.drive is not None
    last, heading = tracks(run)[:, -1], run.drive["heading"][0]
    apart = (last[:, 0] - run.drive["x"][0]) * np.cos(heading) + (last[:, 1] - run.drive["y"][0]) * np.sin(
        heading
    )
    assert -4.9 < apart[-1] < -3.0  # as far as it came in the step of the contact
