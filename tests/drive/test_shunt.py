"""The tested car turns round, reverses, stands beside the road and errs where a scene tells it to.

Boxes are put together here from the columns of drives, and lanes from the lines of the road."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from roadgpt.brief.plan import plan, read_plan
from roadgpt.drive import Drive
from roadgpt.drive.drive import SCRIPT
from roadgpt.errors import BriefError
from roadgpt.run import Run, Setup, perform


def run_of(words: str, driver: str = "reference") -> Run:
    return perform(words, seed=3, setup=Setup(driver=driver, reader="plan"))


def driven(words: str, driver: str = "reference") -> tuple[Run, Drive]:
    run = run_of(words, driver)
    assert run.drive is not None
    return run, run.drive


def boxes(drive: Drive, every: int = 5) -> list[shapely.Polygon]:
    car, found = drive.car, []
    for x, y, heading in np.column_stack([drive[name] for name in ("x", "y", "heading")])[::every]:
        box = shapely.box(
            car.ahead - car.length / 2, -car.width / 2, car.ahead + car.length / 2, car.width / 2
        )
        turned = shapely.affinity.rotate(box, heading, origin=(0, 0), use_radians=True)
        found.append(shapely.affinity.translate(turned, x, y))
    return found


def lanes(run: Run) -> shapely.Polygon:
    assert run.road is not None
    edges = run.world.profile_of(run.road).edges(s := np.linspace(0.0, run.road.length, 400))
    sides = [run.road.at(s, each)[:, :2] for each in (edges.left, edges.right)]
    return shapely.Polygon(np.vstack([sides[0], sides[1][::-1]]))


@pytest.mark.parametrize("hand", ["", " left_hand"])
@pytest.mark.parametrize(("road", "reverses"), [("lanes=1 against=1", True), ("lanes=3 against=3", False)])
def test_it_turns_round_within_the_lanes(road: str, reverses: bool, hand: str) -> None:
    run, drive = driven(f"straight 140 | {road}{hand} && ego v=20: u_turn s=60", "robot")
    assert run.outcome == "PASS"
    assert drive.ended == "over"
    turned = float(drive["heading"][-1] - drive["heading"][0])
    assert abs(np.arctan2(np.sin(turned), np.cos(turned))) == pytest.approx(np.pi, abs=0.15)
    assert (drive["vx"].min() < -0.3) == reverses
    outside = [each.difference(lanes(run)).area for each in boxes(drive)]
    assert max(outside) < 0.05
    (hands,) = drive.handovers
    assert hands.by == SCRIPT
    back = drive["s"][-100] - drive["s"][-1]
    assert back > 2.0  # it drives the way that it came


def test_a_road_that_leads_one_way_only_is_none_to_turn_round_on() -> None:
    run = run_of("straight 100 | oneway && ego v=20: u_turn s=50")
    assert run.outcome == "INVALID"
    assert "no oncoming lane" in run.description


def test_it_reverses_for_as_long_as_it_is_told_and_goes_on() -> None:
    run, drive = driven("straight 160 && ego v=20: reverse 5 for=3 s=60")
    back = drive["time"][drive["vx"] < -0.1]
    assert 2.0 < back[-1] - back[0] < 3.2
    assert drive["vx"].min() == pytest.approx(-5 / 3.6, abs=0.2)
    assert run.outcome == "PASS"
    assert drive.ended == "goal"


@pytest.mark.parametrize(("side", "hand"), [("right", ""), ("left", ""), ("left", " left_hand")])
def test_it_is_parked_beside_the_lanes_and_pulls_out(side: str, hand: str) -> None:
    words = f"straight 160 |{hand} && ego parked {side}: wait 3, pull_out 30"
    run, drive = driven(words)
    first, *_, last = boxes(drive)
    assert not first.intersects(lanes(run))
    assert last.within(lanes(run))
    assert (drive["speed"][drive["time"] < 3.0] < 0.1).all()
    assert run.outcome == "PASS"
    assert "parked=" in plan(read_plan(words))


@pytest.mark.parametrize("driver", ["reference", "lane_centring", "robot"])
def test_who_stays_parked_is_parked_to_the_end(driver: str) -> None:
    run, drive = driven("straight 160 && ego parked right: wait 12; bus behind gap=20 v=40: keep", driver)
    assert (run.outcome, drive.ended) == ("PASS", "over")
    assert np.ptp(drive["s"]) < 0.2
    assert drive.others is not None
    assert (drive.others.states[0, 0, :2] != drive.others.states[-1, 0, :2]).any()


def test_released_its_driver_pulls_out_itself() -> None:
    run, drive = driven("straight 200 && ego parked right: wait 3, release; car behind gap=80 v=30")
    assert boxes(drive)[-1].within(lanes(run))
    assert {each.by for each in drive.handovers} == {"the script's pedals"}


def test_who_stands_has_room_behind_for_those_that_come() -> None:
    run, drive = driven("straight 200 && ego v=0: wait 8; truck x2 behind gap=40 v=20: stop", "robot")
    assert drive.others is not None
    assert run.road is not None
    start = run.road.at(0.0)[:2]
    away = np.linalg.norm(drive.others.states[0, :, :2] - start, axis=1)
    assert (away > 4.0).all()
    assert drive["s"][0] > 55.0


@pytest.mark.parametrize(("sign", "control"), [("run_light", "lights"), ("run_sign", "stop")])
def test_it_runs_a_light_or_a_sign_by_order(sign: str, control: str) -> None:
    told = "; lights red" if control == "lights" else ""
    run, drive = driven(f"straight 120 // crossroads straight {control} && ego v=40: {sign}{told}")
    assert run.road is not None
    assert run.verdict is not None
    line = run.road.passages[0].line
    crossed = float(np.interp(line - 2.25, drive["s"], drive["time"]))
    assert np.interp(crossed, drive["time"], drive["speed"]) > 9.0
    assert not run.verdict.incidents
    assert run.outcome == "PASS"
    stops = run_of(f"straight 120 // crossroads straight {control} && ego v=40{told}").drive
    assert stops is not None
    assert stops["speed"][stops["s"] < line].min() < 1.0


def test_emergency_brakes_stay_the_driver_s() -> None:
    from roadgpt.drive import Command, View, simulate

    class Panics:
        name = "panics"

        def steer(self, view: View) -> Command:
            return Command(0.0, 0.0, 1.0 if view.s > 60.0 else 0.3)

    words = "straight 120 // crossroads straight lights && ego v=40: run_light; lights red"
    run = run_of(f"{words}; car ahead v=0 s=70 t=-6", "robot")
    assert run.road is not None
    drive = simulate(run.road, run.world, Panics(), 3, keep_driving=True)
    assert drive["speed"][-1] < 0.1
    assert drive["s"][-1] < run.road.passages[0].line


def test_it_cuts_a_corner_to_its_inside() -> None:
    for side, sign in (("left", 1), ("right", -1)):
        words = f"straight 60; turn {side} r50 deg=80; straight 60 && ego v=30"
        _, cuts = driven(f"{words}: cut_corner shift=1.2", "robot")
        _, keeps = driven(words, "robot")
        s = np.linspace(80.0, 115.0, 20)
        moved = [np.interp(s, each["s"], each["t"]) for each in (cuts, keeps)]
        assert (sign * (moved[0] - moved[1])).max() == pytest.approx(1.2, abs=0.2)
        assert abs(cuts["t"][-1] - keeps["t"][-1]) < 0.1


@pytest.mark.parametrize("side", ["left", "right"])
def test_who_is_beside_backs_out_across_the_lane(side: str) -> None:
    run, drive = driven(f"straight 200 && ego v=40; van beside {side}: reverse")
    assert drive.others is not None
    x, y, _, heading, speed = drive.others.states[:, 0].T
    moves = np.flatnonzero(np.abs(speed[1:]) > 0.3)
    along = np.diff(x) * np.cos(heading[:-1]) + np.diff(y) * np.sin(heading[:-1])
    assert (along[moves] < 0.0).all()
    assert run.road is not None
    there = np.isfinite(x)
    t = [_offset(run, *each) for each in zip(x[there], y[there], strict=True)]
    sign = 1 if side == "left" else -1
    assert sign * t[0] > 4.0
    assert sign * t[-1] < 0.0
    assert run.outcome == "PASS"


def test_who_backs_out_stops_when_it_is_told() -> None:
    _, drive = driven("straight 200 && ego v=30; van beside left: reverse for=7", "robot")
    assert drive.others is not None
    speed = np.abs(drive.others.states[:, 0, 4])
    moves = np.flatnonzero(speed > 0.3) * 0.1
    assert moves[-1] - moves[0] == pytest.approx(7.0, abs=0.8)


def _offset(run: Run, x: float, y: float) -> float:
    assert run.road is not None
    s = np.linspace(0.0, run.road.length, 2000)
    line = shapely.LineString(run.road.at(s)[:, :2])
    place = shapely.Point(x, y)
    ahead = line.interpolate(line.project(place) + 0.5)
    here = line.interpolate(line.project(place))
    cross = (ahead.x - here.x) * (y - here.y) - (ahead.y - here.y) * (x - here.x)
    return float(np.copysign(line.distance(place), cross))


@pytest.mark.parametrize(
    "scene",
    [
        "ego parked right", "ego parked right: brake 3, pull_out", "ego parked right v=30: pull_out",
        "ego parked right t=1: pull_out", "ego: u_turn, keep", "ego v=30: pull_out",
        "ego parked right: pull_out s=40",
    ],
)  # fmt: skip
def test_what_cannot_follow_is_refused_in_a_sentence(scene: str) -> None:
    with pytest.raises(BriefError, match="the tested car"):
        read_plan(f"straight 200 && {scene}")
