"""Scenes are what they say: who has priority drives on, nobody stands in another, and everybody is where the
scene puts it."""

import numpy as np
import pytest
from shapely import Polygon

from boxed import corners
from grids import diagonal
from roadgpt.errors import BriefError
from roadgpt.road.road import START
from roadgpt.run import Run, Setup, perform
from roadgpt.traffic import STEP, Traffic
from roadgpt.traffic.actor import SIZES
from roadgpt.traffic.rehearsal import rehearsed


@pytest.fixture(autouse=True)
def who_stands_is_soon_stuck(monkeypatch: pytest.MonkeyPatch) -> None:
    """After 20 s instead of 120; no car here has to wait as long."""
    monkeypatch.setattr("roadgpt.drive.drive_monitor.STUCK_AMONG_OTHERS", 20.0)


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


@pytest.mark.parametrize("who", ["bicycle junction right v=0 away=7", "car junction right v=0 away=12"])
def test_who_stands_at_a_junction_with_priority_goes_when_the_tested_car_waits_for_it(who: str) -> None:
    run = drive(f"crossroads straight none angle=90 && ego v=40; {who}: cross to=15")
    assert run.outcome == "PASS", run.description
    assert np.nanmax(tracks(run)[:, 0, 4]) == pytest.approx(15 / 3.6, abs=0.1)


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


@pytest.mark.parametrize(
    "scene",
    [
        "crossroads straight && car junction left: cross; car junction opposite: turn_across",
        "crossroads straight && van junction left v=30; motorcycle junction right v=50",
        "straight 300 | lanes=2 && ego v=10; truck lane left v=80; adult lane left v=3: keep",
    ],
)
def test_others_do_not_run_into_each_other_where_their_ways_cross(scene: str) -> None:
    others = rehearsal(scene)[0].tracks()
    for states in others.states:
        there = np.flatnonzero(~np.isnan(states[:, 0]))
        boxes = [Polygon(corners(states[n], others.actors[n].size)) for n in there]
        assert not any(one.intersects(other) for n, one in enumerate(boxes) for other in boxes[:n])


def rehearsal(plan: str, seed: int = 1) -> tuple[Traffic, Run]:
    """Returns the others of a scene as they drive with the test robot, and the road without a drive."""
    run = perform(plan, seed, setup=Setup(reader="plan", drives=False))
    assert run.road is not None
    traffic = rehearsed(run.road, run.world, run.seed)
    assert traffic is not None
    return traffic, run


@pytest.mark.parametrize(
    "plan",
    [
        "straight 60 && car ahead: brake",
        "turn x2 && car oncoming: drift before turn 1",
        "&& car lane left: keep 3, cut_in thw=1",
        "&& ego v=0; truck behind v=0",
        "straight 300 && ego v=0; car crossing left: cross",
        "straight 100 && adult crossing right",
        "straight 300 && ego v=30; child crossing left v=3: cross 10, stop",
        "turn right 60 r=60; straight 120 && car x2 parked left s=40: pull_out",
        "crossroads straight && ego v=120; child crossing right v=3 away=8: cross; car junction right: cross",
        "t_junction straight ways=right+straight && truck junction v=50: turn_in 20",
        "crossroads straight && car behind v=30: follow time=8",
        "straight 200 && ego v=30; car ahead; oncoming light",
        "straight 400 // diverge && car oncoming",
    ],
)
def test_what_is_told_happens_on_the_road_that_is_made_for_it(plan: str) -> None:
    traffic, _ = rehearsal(plan)
    assert traffic.missed == ()


@pytest.mark.parametrize(
    ("seconds", "who"), diagonal([1, 2, 4, 8], ["adult crossing right v=5", "bicycle crossing left v=15"])
)
def test_a_crossing_begins_at_its_time_to_collision(seconds: int, who: str) -> None:
    """From beside the lanes, however little time that leaves; farther away where it leaves more."""
    traffic, run = rehearsal(f"straight 300 && ego v=36; {who}: cross ttc={seconds}")
    track = traffic.tracks().states[:, 0]
    begins = int(np.flatnonzero(np.hypot(*(track[:, :2] - track[0, :2]).T) > 1e-3)[0]) - 1
    assert run.road is not None
    own, aside = (float(each) for each in run.road.locate(*track[0, :2]))
    front = min(START, run.road.length / 2) + 10.0 * begins * STEP + SIZES["car"].length / 2
    assert own - front == pytest.approx(10.0 * seconds, abs=2.0)  # to the middle of the path, within a box
    assert abs(aside) > 4.0  # the lanes are 4 m wide


def test_who_comes_along_another_road_is_as_far_away_as_the_scene_says_and_crosses_in_time() -> None:
    traffic, run = rehearsal("crossroads straight && car junction left v=30 away=20")
    track, road = traffic.tracks().states[:, 0], run.road
    assert road is not None
    t = np.array([float(road.locate(*each)[1]) for each in track[:, :2]])
    middle = float(run.world.profile_of(road).middle(0.0))
    assert t[0] - middle == pytest.approx(20.0, abs=0.5)
    assert t[-1] < middle - 5.0
    assert [*traffic.happened] == ["car 1 crosses"]


def test_who_is_in_another_lane_stays_there_where_the_route_changes_lanes() -> None:
    ways = "| lanes=2 len=60 // lane_change left // | len=250"
    traffic, run = rehearsal(f"{ways} && ego v=50; truck lane left v=50 lead=40; car oncoming gap=120 v=20")
    road = run.road
    assert road is not None
    for n, states in enumerate(traffic.tracks().states.swapaxes(0, 1)):
        there = states[~np.isnan(states[:, 0])]
        t = [float(road.locate(*each)[1]) for each in there[:, :2]]
        assert np.ptp(t) < 0.1, n
        course = np.arctan2(*np.diff(there[:, :2], axis=0).T[::-1])
        assert np.abs(np.angle(np.exp(1j * (course - there[1:, 3])))).max() < 0.05, n


def test_who_stands_is_in_a_lane_where_the_route_changes_lanes() -> None:
    """On a straight road with lanes 4 m wide they stand along two lines."""
    cones = "; ".join(f"cones ahead s={s}" for s in range(110, 260, 10))
    traffic, _ = rehearsal(f"| lanes=2 len=60 // lane_change left // | len=250 && ego v=30; {cones}")
    places = traffic.at(0.0)[:, :2]
    east, north = (places[1] - places[0]) / np.hypot(*(places[1] - places[0]))
    across = (places - places[0]) @ (-north, east)
    is_first = across < across.mean()
    assert np.ptp(across[is_first]) < 0.1
    assert np.ptp(across[~is_first]) < 0.1
    assert across[~is_first].mean() - across[is_first].mean() == pytest.approx(4.0, abs=0.1)


def test_a_speed_that_a_bend_does_not_give_is_said() -> None:
    traffic, _ = rehearsal("straight 60; turn left 90 r=20; straight 60 && ego v=20; car ahead gap=30 v=90")
    assert "car 1 is slower than 90 km/h where it comes to a bend" in traffic.limited


@pytest.mark.parametrize(
    ("plan", "said"),
    [
        ("straight 200 && truck oncoming gap=60 v=0: overtake time=3", "stands, so it never overtakes"),
        ("crossroads straight && car junction left away=190", "begins less than 190 m from the tested car's"),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(plan: str, said: str) -> None:
    assert said in perform(plan, 1, setup=Setup(reader="plan", driver="robot")).description


def test_the_roads_of_a_map_have_one_lane_in_each_direction() -> None:
    with pytest.raises(BriefError, match="needs two lanes in its direction; the roads of a map have one"):
        perform("map columns=2 rows=2 && car ahead: change_lane", 1, setup=Setup(reader="plan", drives=False))
