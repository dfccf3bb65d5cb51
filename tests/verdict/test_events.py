"""The events of a test, against what the recorded motion alone says of when and where they happened."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.scene import Event
from roadgpt.cli.screen import row_of
from roadgpt.cli.summary import text_lines
from roadgpt.drive import Drive
from roadgpt.report.view import scene
from roadgpt.run import Run, Setup, perform
from roadgpt.run.folder import read_run, write_run_folder
from roadgpt.traffic.actor import SPEED, STEP
from roadgpt.verdict import Verdict, judge

OTHERS = (
    "straight 900 && ego v=50; car ahead v=50 gap=60: brake 3..6 to=20 time=9, brake 6 time=60; "
    "van lane left v=70 gap=-40: cut_in gap=15"
)
ROBOT = Setup(driver="robot", reader="plan")


def events_of(run: Run, who: str) -> list[Event]:
    assert run.verdict is not None
    return [each for each in run.verdict.events or () if each.who == who]


def driven(words: str, driver: str = "robot") -> Run:
    run = perform(words, seed=4, setup=replace_driver(driver))
    assert run.drive is not None, run.description
    return run


def replace_driver(driver: str) -> Setup:
    return ROBOT.model_copy(update={"driver": driver})


@pytest.fixture(scope="module")
def among() -> Run:
    return driven(OTHERS)


def track_of(run: Run, name: str) -> np.ndarray:
    assert run.drive is not None
    assert run.drive.others is not None
    number = [each.name for each in run.drive.others.actors].index(name)
    return run.drive.others.states[:, number]


def test_when_and_where_others_did_what_they_were_told(among: Run) -> None:
    brakes, again = events_of(among, "car 1")
    assert brakes.time is not None
    assert brakes.until is not None
    track = track_of(among, "car 1")
    slows = np.flatnonzero(np.diff(track[:, SPEED]) < -0.1)
    slows = slows[slows * STEP < 15.0]  # it also slows down for nobody else
    assert brakes.time == pytest.approx(slows[0] * STEP, abs=0.11)
    assert brakes.until == pytest.approx((slows[-1] + 1) * STEP, abs=0.11)
    assert among.road is not None
    s = among.road.locate(*track[round(brakes.time / STEP), :2])[0]
    assert brakes.s == pytest.approx(float(s), abs=0.5)
    rate = np.median(np.diff(track[slows[1:-1], SPEED]) / STEP)
    assert f"with {round(-rate, 1):g} m/s2" in brakes.what  # the number that was drawn from 3 to 6
    assert (again.time, again.why) == (None, "the drive ended before")


def test_a_cut_in_begins_and_ends_with_its_motion_sideways(among: Run) -> None:
    (cuts_in,) = events_of(among, "van 1")
    assert among.road is not None
    track = track_of(among, "van 1")
    t = among.road.locate(*track[:, :2].T)[1]
    moves = np.flatnonzero(np.abs(np.diff(t)) > 0.003)
    assert cuts_in.time == pytest.approx(moves[0] * STEP, abs=0.4)  # a cosine begins slowly
    assert cuts_in.until == pytest.approx((moves[-1] + 1) * STEP, abs=0.4)


def test_what_had_begun_and_not_ended_is_said(among: Run) -> None:
    assert among.drive is not None
    assert among.road is not None
    brakes, *rest = among.drive.history
    cut = replace(among.drive, history=(replace(brakes, until=None), *rest))
    verdict = judge(among.road, cut, among.world)
    said = {each.why for each in verdict.events or () if each.who == "car 1" and each.time is not None}
    assert said == {"not ended when the drive ended"}


def test_they_stand_in_order_and_what_never_happened_comes_last(among: Run) -> None:
    assert among.verdict is not None
    times = [each.time for each in among.verdict.events or ()]
    begun = [time for time in times if time is not None]
    assert begun == sorted(begun)
    assert times == [*begun, *[None] * (len(times) - len(begun))]


def test_the_tested_car_does_what_it_is_told_at_its_place() -> None:
    run = driven("straight 500 && ego v=50: brake 3 to=20 s=200, stop ttc=1")
    brakes, hand, never = events_of(run, "tested car")
    assert run.drive is not None
    first = int(np.argmax(run.drive["speed"] < run.drive["speed"][0] - 0.5))
    assert brakes.time == pytest.approx(run.drive["time"][first], abs=0.4)
    assert brakes.s == pytest.approx(200.0 - run.drive.car.length / 2, abs=3.0)
    assert (hand.what, hand.time) == ("driven by the script's pedals", brakes.time)
    assert never.time is None
    assert never.why == "what it waits for did not come"


def test_a_contact_is_one_of_them() -> None:
    run = driven("straight 300 && ego v=50; car ahead v=0 gap=100")
    (contact,) = events_of(run, "tested car")
    assert run.verdict is not None
    assert contact == Event(
        "tested car", "a contact with car 1", round(run.verdict.at_time, 3), round(run.verdict.at_s, 3)
    )  # type: ignore[arg-type]


def test_lights_are_seen_to_turn() -> None:
    words = "straight 150 // crossroads straight lights // straight 100 && ego v=50; lights {}"
    assert [each.time for each in events_of(driven(words.format("red")), "lights")] != [None]
    (turns,) = events_of(driven(words.format("red time=7..9")), "lights")
    assert turns.time is not None
    assert 7.0 <= turns.time <= 9.1
    (never,) = events_of(driven(words.format("green time=90")), "lights")
    assert (never.time, never.why) == (None, "the drive ended before")


def test_where_the_car_was_out_of_its_lane() -> None:
    run = driven("straight 400 && ego v=50: drift left lat=1.5 shift=5 s=100")
    (out,) = [each for each in events_of(run, "tested car") if each.what == "out of its lane"]
    assert run.drive is not None
    assert run.drive["outside"][int(np.searchsorted(run.drive["time"], out.time)) + 1] > 0.5
    assert run.drive["outside"][int(np.searchsorted(run.drive["time"], out.time)) - 2] < 0.5


def test_they_are_stored_shown_and_told(among: Run, tmp_path: Path) -> None:
    assert among.verdict is not None
    assert among.drive is not None
    folder = write_run_folder(among, tmp_path)
    read = read_run(folder)
    assert read.verdict == among.verdict
    assert read.drive is not None
    assert read.drive.history == among.drive.history
    told = json.loads((folder / "verdict.json").read_text())["events"]
    assert [(each["who"], each["time"]) for each in told] == [
        (each.who, each.time) for each in among.verdict.events or ()
    ]
    lines = [line for line in text_lines(folder) if ": brakes with" in line]
    assert ["never" in line for line in lines] == [False, True]
    assert (
        json.loads(row_of(among).to_json())["events"]
        == scene(among)["events"]
        == [vars(each) for each in among.verdict.events or ()]
    )


def test_older_drives_and_lonely_ones_have_none(among: Run) -> None:
    assert among.drive is not None
    assert among.road is not None
    old = replace(among.drive, history=())
    assert "history" not in str(old.to_bytes())
    verdict = judge(among.road, old, among.world)
    assert verdict.outcome == among.outcome
    alone = driven("turn left 60").verdict
    assert alone is not None
    assert alone.events is None
    assert "events" not in alone.to_json()
    assert Verdict.from_json(alone.to_json()) == alone


def test_drives_that_hold_broken_events_are_refused(among: Run, tmp_path: Path) -> None:
    assert among.drive is not None
    broken = replace(among.drive, history=(Event("car 1", 3),))  # type: ignore[arg-type]
    (tmp_path / "drive.npz").write_bytes(broken.to_bytes())
    with pytest.raises(Exception, match="is not a drive"):
        Drive.load(tmp_path / "drive.npz")
