"""Who has the wheel: what a scene tells the tested car happens, and the driver has its hands back behind it.

Everything is read from the columns of drives; distances and times come from the equations of uniformly
accelerated motion, not from the code."""

import re
from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity

from roadgpt.brief.plan import plan, read_plan
from roadgpt.drive import Command, Drive, simulate
from roadgpt.drive.drive import PEDALS, SCRIPT
from roadgpt.errors import BriefError, UsageError
from roadgpt.road import Road, World
from roadgpt.run import Run, Setup, judged, perform

FRONT = 2.25  # m, from the centre of gravity to the front of the car


def run_of(words: str, driver: str = "reference", **setup: object) -> Run:
    return perform(words, seed=3, setup=Setup(driver=driver, reader="plan", **setup))


def drive_of(words: str, driver: str = "reference") -> Drive:
    found = run_of(words, driver).drive
    assert found is not None
    return found


def at(drive: Drive, name: str, time: float) -> float:
    return float(np.interp(time, drive["time"], drive[name]))


def hands(drive: Drive) -> list[tuple[str, float, float]]:
    return [(each.by, round(each.start, 2), round(each.end, 2)) for each in drive.handovers]


@pytest.mark.parametrize("driver", ["reference", "lane_centring", "pure_pursuit", "robot"])
def test_it_brakes_as_told_and_the_driver_goes_on(driver: str) -> None:
    drive = drive_of("straight 300 && ego v=72: brake 4 to=36 time=3", driver)
    ((by, start, end),) = hands(drive)
    assert (by, start) == (PEDALS, 3.0)
    before, after = (at(drive, "speed", each) for each in (start, end))
    assert after == pytest.approx(10.0, abs=0.2)
    assert end - start == pytest.approx((before - 10.0) / 4.0, abs=0.25)  # t = (v0 - v1) / a
    assert at(drive, "s", end) - at(drive, "s", start) == pytest.approx((before**2 - 100.0) / 8.0, abs=2.0)
    assert at(drive, "speed", end + 6.0) > 15.0


def test_it_stops_before_the_line_waits_and_creeps() -> None:
    words = "straight 150 // crossroads straight priority // straight 100"
    drive = drive_of(f"{words} && ego v=50: stop before junction 1, wait 5, creep for=4")
    stands = drive["time"][drive["speed"] < 0.1]
    assert 4.5 < stands[-1] - stands[0] < 6.5
    road = run_of(words).road
    assert road is not None
    line = road.passages[0].line
    front = at(drive, "s", float(stands[0])) + FRONT
    assert line - 1.8 < front < line
    creeps = drive["time"] > stands[-1] + 1.5
    assert drive["speed"][creeps & (drive["time"] < stands[-1] + 4.0)].max() < 6.0 / 3.6
    (hand,) = hands(drive)
    assert hand[0] == PEDALS
    assert at(drive, "speed", hand[2] + 6.0) > 8.0


@pytest.mark.parametrize(
    ("scene", "ends"),
    [("", 4.0), (", speed 50 time=20", 8.0), (", stop s=80, wait 3", 12.0)],  # s of creeping, at least
)
def test_it_creeps_until_what_is_next_or_for_a_while(scene: str, ends: float) -> None:
    drive = drive_of(f"straight 300 && ego v=30: stop 3 s=50, wait 2, creep{scene}", "robot")
    stands = drive["time"][drive["speed"] < 0.1]
    first = stands[np.argmax(np.diff(stands, append=np.inf) > 0.1)]
    later = drive["time"] > first + 1.5
    assert drive["speed"][later & (drive["time"] < first + ends)].max() < 6.0 / 3.6


def test_it_waits_for_what_another_one_does() -> None:
    scene = (
        "ego v=50: stop 3 s=60, creep after truck 1 brake; truck oncoming gap=300 v=50: brake 4 to=20 time=14"
    )
    drive = drive_of(f"straight 400 && {scene}")
    stands = drive["time"][drive["speed"] < 0.1]
    assert stands[0] < 11.0
    assert (
        14.0 + 7.0 / 4.0 < stands[-1] < 14.0 + 12.0 / 4.0
    )  # from some 50 to 20 km/h with 4 m/s2, then it rolls


def test_others_act_when_the_tested_car_does() -> None:
    car = "car behind gap=30 v=50: brake 6 with ego stop, speed 30 after ego stop"
    drive = drive_of(f"straight 400 && ego v=50: stop 4 time=5, wait 6; {car}")
    assert drive.others is not None
    speed = drive.others.states[:, 0, 4]
    slows = drive.others.time[np.argmax(speed < speed[40] - 0.1)]
    assert slows == pytest.approx(5.0, abs=0.25)
    rest = drive["time"][np.argmax(drive["speed"] < 0.1)]
    rolls = drive.others.time[(drive.others.time > slows + 1.0) & (np.gradient(speed) > 0.05)][0]
    assert rolls == pytest.approx(rest, abs=0.3)


def test_standing_it_starts_when_it_is_told() -> None:
    drive = drive_of("straight 300 && ego v=0: release time=7")
    assert drive["speed"][drive["time"] < 6.9].max() < 0.05
    assert at(drive, "speed", 9.0) > 2.0
    assert hands(drive) == [(PEDALS, 0.0, pytest.approx(7.0, abs=0.05))]


@pytest.mark.parametrize("driver", ["reference", "robot"])
@pytest.mark.parametrize("scene", ["ego v=0: wait 3", "ego parked right: wait 3, release"])
def test_who_stands_goes_on_up_to_the_limit_once_nothing_holds_it(driver: str, scene: str) -> None:
    drive = drive_of(f"straight 300 && {scene}", driver)
    assert drive.ended == "goal"
    assert 60.0 < 3.6 * drive["speed"].max() < 72.0


@pytest.mark.parametrize("driver", ["reference", "robot"])
def test_who_is_parked_pulls_out_or_it_has_not_happened(driver: str) -> None:
    assert drive_of("straight 150 && ego parked right: pull_out", driver).ended == "goal"
    blocked = run_of("straight 100 && ego parked right: pull_out; car parked right s=10", driver)
    assert blocked.outcome in ("FAIL", "INVALID", "NOT TESTED")


def test_a_corner_that_is_not_cut_is_no_pass() -> None:
    found = run_of("| lanes=2 && ego v=50: cut_corner; wet")
    assert found.outcome == "NOT TESTED"
    assert "cuts the corner: it was given up" in found.description


@pytest.mark.parametrize(("side", "sign"), [("left", 1), ("right", -1)])
def test_it_drifts_as_far_and_as_fast_as_told(side: str, sign: int) -> None:
    drive = drive_of(f"straight 300 && ego v=60: drift {side} shift=1.2 lat=0.5 time=4", "lane_centring")
    ((by, start, end),) = hands(drive)
    assert (by, start) == (SCRIPT, 4.0)
    aside = sign * (drive["t"] - at(drive, "t", start))
    assert sign * (at(drive, "t", end) - at(drive, "t", start)) == pytest.approx(1.2, abs=0.1)
    fastest = np.gradient(aside, drive["time"])[(drive["time"] > start) & (drive["time"] < end)].max()
    assert fastest == pytest.approx(0.5, abs=0.08)
    assert abs(sign * (at(drive, "t", end + 8.0) - at(drive, "t", start))) < 0.3  # the driver steers back


def test_swerving_leads_back() -> None:
    drive = drive_of("straight 300 && ego v=50: swerve shift=0.6 time=4", "robot")
    ((_, start, end),) = hands(drive)
    aside = drive["t"] - at(drive, "t", start)
    assert aside.max() == pytest.approx(0.6, abs=0.1)
    assert abs(at(drive, "t", end) - at(drive, "t", start)) < 0.1


def test_what_the_script_steers_is_no_departure_but_what_follows_is() -> None:
    words = "straight 300 && ego v=50: drift left shift=3.5 lat=1 time=4"
    kept = run_of(words)
    assert kept.outcome == "PASS"
    assert kept.drive is not None
    assert kept.drive["outside"].max() > 0.9
    assert kept.drive.max_outside < 0.1

    class StaysThere:
        def steer(self, view: object) -> Command:
            return Command(0.0, 0.1, 0.0)

    assert kept.road is not None
    drive = simulate(kept.road, kept.world, StaysThere(), kept.seed)
    found = judged(replace(kept, drive=drive))
    (hand,) = hands(drive)
    assert (found.outcome, found.verdict and found.verdict.cause) == ("FAIL", "out of lane")
    assert drive["time"][-1] == pytest.approx(hand[2] + 2.0, abs=0.1)


class Brakes:
    """Brakes fully in a second of its drive, and else holds its speed as well as it can."""

    def __init__(self, since: float) -> None:
        self.since = since

    def steer(self, view: object) -> Command:
        time = view.time  # type: ignore[attr-defined]
        return Command(0.0, 0.0, 1.0) if self.since <= time < self.since + 1.0 else Command(0.0, 0.15, 0.0)


def straight(words: str) -> tuple[Road, World]:
    run = run_of(words)
    assert run.road is not None
    return run.road, run.world


def test_the_stronger_brake_counts() -> None:
    road, world = straight("straight 300 && ego v=70: brake 2 to=20 time=4")
    drive = simulate(road, world, Brakes(5.0), 3)
    slows = -np.gradient(drive["speed"], drive["time"])
    by_script, by_driver = (slows[np.searchsorted(drive["time"], each)] for each in (4.8, 5.6))
    assert by_script == pytest.approx(2.0, abs=0.4)
    assert by_driver > 6.0
    assert drive.unheeded is not None
    heard = ~np.isnan(drive.unheeded[:, 0])
    during = (drive["time"][:-1] >= 4.0 - 1e-6) & (drive["time"][:-1] < drive.handovers[-1].end - 1e-6)
    assert (heard == during).all()
    assert drive.unheeded[np.searchsorted(drive["time"], 5.5), 2] == 1.0


def test_a_driver_that_brakes_hard_ends_the_script() -> None:
    road, world = straight("straight 500 && ego v=70: drift left shift=1.5 lat=0.3 time=4, keep 1 time=12")
    before = simulate(road, world, Brakes(3.5), 3)
    assert [each.by for each in before.handovers] == [PEDALS]
    assert "gave up before the tested car drifts" in before.limited[0]
    during = simulate(road, world, Brakes(6.0), 3)
    ((by, start, end),) = hands(during)
    assert (by, start) == (SCRIPT, 4.0)
    aside = during["t"] - at(during, "t", 4.0)
    assert aside.max() < 1.2
    assert abs(at(during, "t", end) - at(during, "t", 4.0)) < 0.2
    assert "gave up while the tested car drifts" in during.limited[0]


def test_the_brake_after_a_contact_is_no_refusal_of_the_script() -> None:
    words = "straight 400 && ego v=50: brake 2 to=20 time=4, brake 3 time=8; car behind v=50 gap=12"
    found = run_of(words, "lane_centring")
    assert found.drive is not None
    assert found.drive.ended == "collision"
    assert found.drive.duration > 8.5
    assert "gave up" not in found.description


def test_overtaking_that_ends_in_a_crash_has_happened() -> None:
    others = "truck ahead gap=40 v=30; car oncoming v=60 gap=160"
    found = run_of(f"straight 600 | lanes=1 against=1 && ego v=60: overtake truck 1; {others}", "robot")
    assert found.verdict is not None
    assert found.verdict.cause == "collision"
    (event,) = [each for each in found.verdict.events or () if each.what.startswith("overtakes")]
    assert event.time is not None
    assert "never happened" not in found.description


def test_who_reverses_past_where_it_pulled_out_stays_in_its_lane() -> None:
    scene = "ego parked right s=60: pull_out, keep for=1, reverse for=25 to=8"
    found = run_of(f"straight 400 && {scene}", "lane_centring")
    assert found.drive is not None
    assert found.verdict is not None
    assert found.outcome == "PASS", found.description
    assert not [each for each in found.verdict.events or () if each.what == "out of its lane"]
    drive, back = found.drive, found.drive.handovers[-1].end
    assert at(drive, "s", back) < 50.0
    later, parked = drive["time"] > back, at(drive, "t", 1.0)
    assert np.ptp(drive["t"][later]) < 1.5  # it does not go back to where it was parked
    assert abs(drive["t"][later] - parked).min() > 2.0


def test_who_drove_is_said_and_what_never_happened() -> None:
    found = run_of("straight 300 && ego v=50: brake 3 to=20 s=60")
    assert found.drive is not None
    assert found.drive.shares[PEDALS] == pytest.approx(0.1, abs=0.05)
    assert "handed over to the script's pedals" in found.description
    car = "car ahead gap=80 v=60: brake 3 ttc=0.1"
    late = run_of(f"straight 500 && ego v=50: brake 3 to=20 after car 1 brake; {car}")
    assert late.outcome == "INVALID"
    assert "tested car brakes" in late.description
    avoided = run_of("straight 400 && ego v=50: drift left gap=8; car ahead gap=30 v=30")
    assert avoided.outcome == "NOT TESTED"
    slow = run_of("straight 400 && ego v=30: brake 9 to=10 time=12; ice")
    assert "the tested car brakes with 0." in slow.description
    assert "not 9.0" in slow.description


def test_who_waits_for_what_never_comes_is_no_failure_of_the_driver() -> None:
    scene = "ego v=50: stop 3 time=4, creep after car 1 brake; car ahead gap=90 v=60: brake 3 ttc=0.1"
    found = run_of(f"straight 500 && {scene}")
    assert found.outcome == "INVALID"
    assert "the tested car creeps: what it waits for did not come" in found.description
    slow = run_of("straight 400 && ego v=50: pass car 1 s=60; car ahead gap=40 v=50", "robot")
    assert slow.outcome == "INVALID"
    assert "the tested car passes car 1: it had left the road before" in slow.description


def test_lanes_are_changed_before_the_junction_that_is_named() -> None:
    words = "| lanes=2 len=250 // crossroads straight priority // | lanes=2 len=150"
    run = run_of(f"{words} && ego v=50 lane=1: change_lane left before junction 1")
    assert run.road is not None
    assert run.drive is not None
    (hand,) = hands(run.drive)
    begins = run.road.passages[0].start
    assert begins - 15.0 < at(run.drive, "s", hand[2]) + FRONT < begins + 1.0


def test_who_cannot_go_around_is_stuck_in_the_end() -> None:
    scene = "ego v=40: overtake car 1; car ahead gap=100 v=0; barrier ahead gap=97 t=4"
    drive = drive_of(f"straight 400 && {scene}")
    assert drive.ended == "stuck"
    assert drive.duration < 160.0


def test_standing_by_order_is_not_being_stuck() -> None:
    drive = drive_of("straight 300 && ego v=50: stop 3 s=60, wait 25")
    assert drive.ended == "goal"
    assert np.ptp(drive["time"][drive["speed"] < 0.1]) > 24.0


def test_a_drive_with_a_script_is_the_same_again_and_in_its_file(tmp_path: object) -> None:
    words = "straight 300 && ego v=50: brake 2..5 to=10..30 time=2..6, drift right shift=0.2..0.8"
    one, two = drive_of(words), drive_of(words)
    assert one.to_bytes() == two.to_bytes()
    path = tmp_path / "drive.npz"  # type: ignore[operator]
    path.write_bytes(one.to_bytes())
    again = Drive.load(path)
    assert np.array_equal(again.unheeded, one.unheeded, equal_nan=True)  # type: ignore[arg-type]
    assert again.handovers == one.handovers


def nearest(drive: Drive) -> float:
    """The least distance between the boxes of the car and of somebody else."""
    assert drive.others is not None
    found = np.inf
    for step in range(0, len(drive), 5):
        own = shapely.Polygon(drive.corners(step))
        states = drive.others.at(float(drive["time"][step]))
        for actor, (x, y, _, heading, _) in zip(drive.others.actors, states.tolist(), strict=True):
            if np.isnan(x):
                continue
            box = shapely.box(*(np.array(actor.size[:2]) @ np.array([[-0.5, 0, 0.5, 0], [0, -0.5, 0, 0.5]])))
            there = shapely.affinity.translate(shapely.affinity.rotate(box, heading, (0, 0), True), x, y)
            found = min(found, own.distance(there))
    return found


@pytest.mark.parametrize("driver", ["reference", "lane_centring", "robot"])
def test_it_changes_lanes_and_the_driver_keeps_to_the_new_one(driver: str) -> None:
    scene = "ego v=60 lane=1: change_lane left time=3, change_lane right time=14"
    run = run_of(f"straight 500 | lanes=2 && {scene}", driver)
    drive = run.drive
    assert drive is not None
    assert run.road is not None
    width = float(run.world.profile_of(run.road).width(0.0))
    start = at(drive, "t", 0.0)
    assert at(drive, "t", 12.0) - start == pytest.approx(width, abs=0.2)
    assert at(drive, "t", 24.0) - start == pytest.approx(0.0, abs=0.2)
    assert [each.by for each in drive.handovers] == [SCRIPT] * 2
    assert run.outcome == "PASS"
    assert drive.max_outside < 0.05


@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
@pytest.mark.parametrize(
    ("scene", "clear"),
    [
        ("ego v=50: pass car 1; car ahead gap=120 v=0", 1.0),
        ("ego v=50: pass bicycle 1; bicycle ahead gap=60 v=15 t=-1", 1.5),
        ("ego v=60: overtake; truck ahead gap=60 v=30", 1.0),
    ],
)
def test_it_goes_around_somebody_and_back(scene: str, clear: float, driver: str) -> None:
    run = run_of(f"straight 600 && {scene}", driver)
    drive = run.drive
    assert drive is not None
    assert drive.others is not None
    assert run.outcome == "PASS"
    assert (
        nearest(drive) == pytest.approx(clear, abs=0.15) if "overtake" not in scene else nearest(drive) > 1.0
    )
    last = drive.others.at(drive.duration)[0]
    ahead = (drive.middles[-1, :2] - last[:2]) @ np.array([np.cos(last[3]), np.sin(last[3])])
    assert ahead > 10.0
    assert at(drive, "t", drive.duration - 2.0) == pytest.approx(at(drive, "t", 0.0), abs=0.2)


@pytest.mark.parametrize("first", ["cones 1", "barrier 1"])
def test_those_that_stand_in_one_row_are_passed_together(first: str) -> None:
    words = f"straight 400 && ego v=30: overtake {first}; cones x6 ahead gap=90; barrier ahead gap=112"
    run = run_of(words)
    assert run.drive is not None
    assert run.outcome == "PASS"
    assert nearest(run.drive) > 1.0
    assert len(run.drive.moves) == 2  # out once, and back once


def test_who_is_made_to_drive_on_the_wrong_side_is_to_blame_there() -> None:
    scene = "ego v=50: pass truck 1 left; truck ahead v=20 gap=50; car oncoming"
    wrong = run_of(f"straight 400 && {scene}", "robot").verdict
    assert wrong is not None
    assert wrong.first_contact is not None
    assert wrong.first_contact.face == "front"
    assert wrong.at_fault == "ego"
    assert wrong.law is not None
    assert not wrong.law.other
    changed = "ego v=60 lane=1: change_lane left time=3; car lane left gap=120 v=30"
    right = run_of(f"straight 600 | lanes=2 && {changed}", "robot").verdict
    assert right is not None
    assert right.law is not None
    assert [*right.law.ego] == ["distance"]


def test_where_there_is_no_room_the_test_is_refused() -> None:
    passes = run_of("straight 400 | lanes=1 against=0 && ego v=50: pass car 1; car ahead gap=120 v=0")
    assert passes.outcome == "INVALID"
    assert re.search(r"passes car 1 at 1\d\d m, where \d\.\d m of road are missing", passes.description)
    beside = run_of("straight 400 | lanes=1 against=0 && ego v=50: overtake; truck ahead gap=60 v=30")
    assert "no oncoming lane" in beside.description


def test_it_pulls_over_and_out_again() -> None:
    run = run_of("straight 500 && ego v=50: pull_over 6 time=4, pull_out")
    drive = run.drive
    assert drive is not None
    assert run.road is not None
    rim = float(run.world.profile_of(run.road).rims(0.0).right)
    stands = drive["speed"] < 0.1
    assert np.ptp(drive["time"][stands]) == pytest.approx(6.0, abs=1.0)
    assert drive["t"][stands].max() - 0.9 - rim == pytest.approx(0.2, abs=0.15)
    assert at(drive, "t", drive.duration) == pytest.approx(at(drive, "t", 0.0), abs=0.2)
    assert run.outcome == "PASS"


def test_it_starts_and_keeps_aside_until_it_pulls_out() -> None:
    keeps = run_of("straight 300 && ego v=50 t=-0.5", "lane_centring")
    pulls = run_of("straight 300 && ego v=0 t=-1: pull_out time=5", "lane_centring")
    assert keeps.outcome == pulls.outcome == "PASS"
    assert keeps.road is not None
    assert keeps.drive is not None
    assert pulls.drive is not None
    middle = float(keeps.world.profile_of(keeps.road).middle(0.0))
    assert keeps.drive["t"] - middle == pytest.approx(-0.5, abs=0.1)
    assert at(pulls.drive, "t", 4.9) - middle == pytest.approx(-1.0, abs=0.05)
    assert at(pulls.drive, "t", pulls.drive.duration) - middle == pytest.approx(0.0, abs=0.1)


def test_it_overtakes_as_fast_as_it_is_told() -> None:
    drive = drive_of("straight 700 && ego v=50: overtake to=45; truck ahead gap=30 v=25", "robot")
    (hand,) = hands(drive)
    assert drive["speed"][(drive["time"] > hand[1] + 3.0) & (drive["time"] < hand[2])] == pytest.approx(
        12.5, abs=0.4
    )


def test_who_meets_somebody_on_the_way_out_goes_back_behind_whom_it_overtakes() -> None:
    scene = "ego v=60: overtake; truck ahead v=30 gap=60; car oncoming gap=280 v=60"
    run = run_of(f"straight 700 && {scene}")
    assert run.drive is not None
    assert "gave up while the tested car overtakes truck 1" in run.description
    assert run.outcome in ("INVALID", "NOT TESTED")
    assert nearest(run.drive) > 0.2
    assert at(run.drive, "t", run.drive.duration) == pytest.approx(at(run.drive, "t", 0.0), abs=0.2)


@pytest.mark.parametrize("seconds", [3, 6])
def test_lanes_are_changed_in_the_time_that_is_told(seconds: int) -> None:
    drive = drive_of(f"straight 500 | lanes=2 && ego v=50 lane=1: change_lane left for={seconds} time=4")
    (hand,) = hands(drive)
    assert hand[2] - hand[1] == pytest.approx(seconds, abs=0.2)


def test_roads_get_the_lanes_that_changes_need() -> None:
    run = run_of("straight 400 && ego v=50: change_lane left time=3")
    assert run.outcome == "PASS"
    assert run.road is not None
    assert len(run.world.profile_of(run.road).along_ids) == 2


WORDS = [
    "| len=300 && ego v=50: brake decel=3 to=20 s=60",
    "| len=300 && ego: stop before junction 1, wait for=5, creep after car 1 cross; car crossing left: cross",
    "| len=300 && ego v=0 left: release time=4, drift lat=0.3 shift=0.4 left, swerve",
    "| len=300 && ego: stop; car behind: stop with ego stop, speed after ego stop",
    "| len=300 && ego: overtake truck 1 gap=20, pass car 2 left; truck ahead; car ahead; car parked right",
]


@pytest.mark.parametrize("words", WORDS)
def test_plans_with_a_script_read_back(words: str) -> None:
    brief = read_plan(words)
    assert read_plan(plan(brief)) == brief


REFUSED = {
    "ego: cut_in": "cannot be told to 'cut_in'; it can keep, brake",
    "ego: brake 3 after car 1 brake": "needs another car that does 'brake'",
    "ego v=0: brake s=60": "stands until it brakes at 60 metres from the start, and so never comes there",
    "ego: pull_out": "pulls out, and is in its lane",
    "ego: pull_over, pass": "pulls over without end",
    "ego: wait, creep": "waits without end",
    "car ahead: release": "a car has no 'release'",
    "ego: pass car 2; car ahead": "there is no 'car 2' to pass",
    "ego: brake; car behind: stop with ego stop": "needs a tested car that is told to 'stop'",
    "ego: brake car 1; car ahead": "there is no 'car 1' to brake",
    "ego: creep for=6 s=100, brake 3 s=50": "before that it creeps .*; change their order",
    "ego v=50: brake 6 to=80": "is no faster than that; write speed 80",
    "ego: run_light; lights green": "runs a red light, and lights are green",
    "ego: brake 3; run_sign": r"no 'run_sign'; its parts, divided by ; \(actions of one by commas\)",
    "ego: stop before crosswalk": "no word 'before' .* a place is for example before junction 1",
    "roadworks close": "no word 'close' for a site; there are closed",
    "truck behind: overtake car 1; car ahead": "only the tested car can overtake 'car 1'",
}


@pytest.mark.parametrize("scene", REFUSED)
def test_what_cannot_be_told_is_refused_in_a_sentence(scene: str) -> None:
    with pytest.raises(BriefError, match=REFUSED[scene]):
        read_plan(f"| len=300 && {scene}")


def test_a_simulator_that_heeds_no_script_refuses() -> None:
    class Simple:
        moves_others = True

    road, world = straight("straight 300 && ego v=50: brake 3 to=20 s=60")
    with pytest.raises(UsageError, match="cannot make the tested car do what its scene tells"):
        simulate(road, world, "reference", simulator=Simple())  # type: ignore[arg-type]


@pytest.mark.parametrize("own", ["v=40: wait", "v=40: pull_over right", "parked right: wait"])
def test_who_waits_at_last_stands_until_somebody_has_come_past(own: str) -> None:
    drive = drive_of(f"straight 300 | lanes=2 oneway && ego {own}; car lane left gap=-120 v=40", "robot")
    assert drive.ended == "over"
    assert drive.others is not None
    car, end = (
        drive.others.at(drive.duration)[0],
        np.array([drive[name][-1] for name in ("x", "y", "heading")]),
    )
    assert np.isnan(car[0]) or np.cos(end[2]) * (car[0] - end[0]) + np.sin(end[2]) * (car[1] - end[1]) > 4.7
    assert at(drive, "speed", drive.duration) < 0.1


def test_who_waits_at_last_stands_until_it_is_hit_as_told() -> None:
    run = run_of("straight 300 && ego v=30: stop s=90, wait; truck behind v=8 hits=rear", "robot")
    assert run.drive is not None
    assert run.drive.ended == "collision"
    assert at(run.drive, "speed", run.drive.duration) < 0.5
    assert "its rear met the front of truck 1" in run.description


def test_who_waits_alone_ends_its_drive() -> None:
    drive = drive_of("straight 300 && ego v=36: stop 2 s=90, wait", "reference")
    assert drive.ended == "over"
    stands = drive["time"][drive["speed"] < 0.1]
    assert 3.5 < stands[-1] - stands[0] < 6.0
