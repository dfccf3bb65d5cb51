"""Failures looked into: reasons by hand, likeness by a slow loop, intervals by scipy, simplest by force."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from campaign.quick import features_of_road
from roadgpt.check import inspect
from roadgpt.cli.app import app
from roadgpt.drive import COLUMNS, Box, Columns, Command, Drive, View
from roadgpt.errors import DriverError, UsageError
from roadgpt.road import ORACLES, CrossSection, Design, Limits, Road, Segment, Site, World, build
from roadgpt.run import Request, Run, Setup, prove, write_run
from roadgpt.verdict import Verdict, judge
from roadgpt_search.faults import minimise as minimising
from roadgpt_search.faults import stability
from roadgpt_search.faults.failures import (
    BEND,
    GRADE,
    SHIFT,
    Surroundings,
    between,
    groups_of,
    lane_curvature,
    reason_of,
    surroundings,
    typical,
)
from roadgpt_search.faults.fault import WAYS
from roadgpt_search.faults.minimise import simplest
from roadgpt_search.faults.stability import (
    Disturbance,
    LateDriver,
    drive_disturbed,
    repeated,
)
from roadgpt_search.surrogate import NAMES

WORLD = World()
BOX = Box(4.7, 1.86)
SPEED = 17.0  # m/s


def design(*segments: Segment, start: tuple[float, float, float] = (60.0, 120.0, 0.0)) -> Design:
    return Design(starting_point=start, theta=0.0, segments=segments)


def straight(metres: float, incline: float = 0.0) -> Segment:
    return Segment(distance=metres, direction="straight", incline=incline)


def bend(degrees: float, radius: float, incline: float = 0.0) -> Segment:
    length = math.radians(abs(degrees)) * radius
    side = "left" if degrees > 0 else "right"
    return Segment(
        distance=length,
        direction=side,
        turn_degrees=degrees,
        radius=radius,
        transition=0.001,
        incline=incline,
    )


def driven(road: Road, until: float, t: float, speed: float = SPEED) -> Drive:
    """Along the lane at one speed; at the end the car stands outside, t metres to the left of the centre."""
    s = np.arange(2.5, until, speed * 0.02)
    columns = {name: np.zeros(len(s)) for name in COLUMNS}
    columns |= {"time": np.arange(len(s)) * 0.02, "s": s, "speed": np.full(len(s), speed)}
    columns["t"] = np.full(len(s), -2.0)
    columns["t"][-1] = t
    columns["outside"][-1] = 1.0
    place = road.at(s, columns["t"])
    columns |= {"x": place[:, 0], "y": place[:, 1], "z": place[:, 2], "heading": road.heading(s)}
    return Drive("nobody", "nothing", 0, Columns(columns), "out_of_lane", BOX)


def failed(road: Road, until: float, t: float, speed: float = SPEED) -> Run:
    drive = driven(road, until, t, speed)
    verdict = judge(road, drive, WORLD)
    assert not verdict.kept
    return Run(Request(), 7, 7, outcome="FAIL", description="", road=road, drive=drive, verdict=verdict)


def test_a_car_that_runs_wide_is_told_with_what_its_lane_asks_for() -> None:
    road = build(design(straight(60), bend(-80, 20)))
    reason = reason_of(failed(road, 72.0, t=1.5))
    assert (reason.way, reason.side) == ("wide", "right")
    assert reason.radius == pytest.approx(20, rel=0.01)
    # the middle of the right lane lies 2 m inside of a right bend
    assert reason.needed == pytest.approx(SPEED**2 / 18 / 9.81, rel=0.01)
    assert reason.entered == SPEED
    assert reason.sentence == (
        "entered a right bend of radius 20 m at 61 km/h and ran wide after 72 m; at that speed, the middle "
        f"of the lane needs a friction coefficient of {reason.needed:.2f}, and the road has "
        f"{World().site.friction:.2f}"
    )


def test_a_car_that_sets_off_in_a_bend_has_not_entered_it() -> None:
    reason = reason_of(failed(build(design(bend(-80, 20), straight(60))), 20.0, t=1.5, speed=1.0))
    assert reason.sentence.startswith(
        "set off in a right bend of radius 20 m and ran wide after 20 m; at the "
    )


@pytest.mark.parametrize(
    ("world", "middle"),
    [
        (World(section=CrossSection(lane_width=3.0)), -1.5),
        (World(section=CrossSection(lanes="2+1", lane_width=3.5)), -5.25),
        (World(section=CrossSection(lanes="3+2")), -10.0),
    ],
)
def test_the_bend_that_counts_is_that_of_the_driven_lane(world: World, middle: float) -> None:
    road = world.lay(build(design(straight(60), bend(-80, 40))))
    assert lane_curvature(road, world, np.array([80.0]))[0] == pytest.approx(-1 / (40 + middle), rel=1e-3)
    features = dict(zip(NAMES, features_of_road(road, world), strict=True))
    assert features["right_3"] * 0.06 == pytest.approx(1 / (40 + middle), rel=0.01)


def test_a_bank_to_the_inside_takes_its_share_of_what_a_bend_needs() -> None:
    plain = build(design(straight(60), bend(-80, 60)))
    for ratio, angle in ((0.05, math.atan(0.05)), (0.1, math.atan(0.1))):
        world = World(section=CrossSection(bank=ratio))
        road = world.lay(plain)
        drive = driven(road, 100.0, 1.5)
        run = Run(Request(world=world), 7, 7, outcome="FAIL", description="", road=road, drive=drive)
        reason = reason_of(replace(run, verdict=judge(road, drive, world)))
        pull = SPEED**2 / 58 / 9.81
        across, onto = pull * math.cos(angle) - math.sin(angle), math.cos(angle) + pull * math.sin(angle)
        # Where the bend begins, the road is not inclined yet.
        assert across / onto - 0.01 < reason.needed < pull * 1.01
        there = drive["s"] > 85
        rest = replace(drive, columns=Columns({name: drive[name][there] for name in COLUMNS}))
        late = reason_of(replace(run, drive=rest, verdict=judge(road, rest, world)))
        assert late.needed == pytest.approx(across / onto, rel=0.01)


def test_a_car_that_cuts_says_so_and_names_the_bend_before() -> None:
    road = build(design(straight(50), bend(-60, 25), bend(70, 16), start=(30.0, 120.0, 0.0)))
    reason = reason_of(failed(road, 50 + math.radians(60) * 25 + 6, t=3.0, speed=8.0))
    assert (reason.way, reason.side) == ("inside", "left")
    assert (
        "a left bend of radius 16 m at 29 km/h just after a right bend of radius 25 m and cut its inside"
        in reason.sentence
    )


def test_a_crest_takes_grip_and_is_named() -> None:
    level = build(design(straight(60), bend(-80, 30)))
    humped = build(design(straight(60, 9.0), bend(-80, 30, -9.0)))
    flat, crest = reason_of(failed(level, 66.0, t=1.5)), reason_of(failed(humped, 66.0, t=1.5))
    assert " on a crest " in crest.sentence
    assert "crest" not in flat.sentence
    assert crest.hill < 0
    assert crest.needed > flat.needed * 1.05


def test_a_straight_a_standstill_and_a_car_that_kept_its_lane() -> None:
    road = build(design(straight(120, -8.0), start=(60.0, 120.0, 12.0)))
    run = failed(road, 60.0, t=1.5)
    assert reason_of(run).sentence == "left a straight to the left at 61 km/h after 60 m downhill at 8 %"
    assert run.verdict is not None
    stuck = replace(run, verdict=replace(run.verdict, cause="stuck", side=None))
    assert reason_of(stuck).sentence == "came to a standstill after 60 m downhill at 8 %"
    kept = replace(run, verdict=replace(run.verdict, outcome="PASS", cause=None))
    with pytest.raises(UsageError, match="road 7 did not fail"):
        reason_of(kept)


profiles = st.lists(st.floats(-0.07, 0.07), min_size=77, max_size=77)


@given(profiles, profiles, st.integers(0, 50))
@settings(max_examples=15)
def test_distances_are_those_of_a_plain_loop(one: list[float], other: list[float], missing: int) -> None:
    a = Surroundings(np.array(one), np.array(other) / 2, "x")
    ends = np.array(other)
    ends[len(ends) - missing :] = np.nan
    b = Surroundings(ends, np.where(np.isnan(ends), np.nan, np.array(one) / 3), "x")
    best = math.inf
    for shift in range(-SHIFT, SHIFT + 1):
        total = {"bends": [], "grades": []}
        for i in range(len(one) - 2 * SHIFT):
            p, q = SHIFT + i + shift // 2, SHIFT + i + shift // 2 - shift
            for name, its in total.items():
                x, y = getattr(a, name)[p], getattr(b, name)[q]
                if not (math.isnan(x) and math.isnan(y)):
                    its.append(((0 if math.isnan(x) else x) - (0 if math.isnan(y) else y)) ** 2)
        squares = np.mean(total["bends"]) / BEND**2 + np.mean(total["grades"]) / GRADE**2
        best = min(best, math.sqrt(squares))
    apart = between([a, b], [a, b, replace(b, kind="y")])
    assert apart[0, 1] == pytest.approx(best, abs=1e-9)
    assert apart[1, 0] == pytest.approx(best, abs=1e-9)
    assert apart[0, 2] == math.inf


def test_the_same_bend_reached_otherwise_is_one_fault_and_its_mirror_image_another() -> None:
    def around(*segments: Segment, at: float, kind: str = "out of lane right") -> Surroundings:
        return surroundings(build(design(*segments)), WORLD, at, kind)

    plain = around(straight(50), bend(-90, 16), straight(40), at=60.0)
    later = around(straight(90), bend(-88, 16.5), straight(30), at=103.0)
    mirrored = around(straight(50), bend(90, 16), straight(40), at=60.0)
    gentle = around(straight(50), bend(-60, 40), straight(40), at=60.0)
    steep = around(straight(50, 8.0), bend(-90, 16, 8.0), straight(40, 8.0), at=60.0)
    left = replace(plain, kind="out of lane left")
    assert groups_of([plain, mirrored, later, gentle, steep, left, plain]) == [0, 1, 0, 2, 3, 4, 0]
    assert groups_of([]) == []
    assert groups_of([plain]) == [0]


class Notes:
    """Writes down what it is shown."""

    name = "notes"

    def __init__(self) -> None:
        self.times: list[float] = []

    def start(self, road: Road, world: World, seed: int) -> None:
        self.believes = world.site.friction

    def steer(self, view: View) -> Command:
        self.times.append(view.time)
        return Command(0.0)


def test_a_late_driver_sees_what_was_and_does_not_know_of_the_grip() -> None:
    notes = Notes()
    late = LateDriver(notes, 0.06, WORLD)
    road = build(design(straight(60)))
    late.start(road, WORLD.changed(friction=0.5), 1)
    numbers = dict.fromkeys(View._fields, 0.0) | {"road": road, "world": WORLD, "dt": 0.02, "image": None}
    for step in range(6):
        late.steer(View(**{**numbers, "time": step * 0.02}))  # type: ignore[arg-type]
    assert notes.times == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.02, 0.04])
    assert notes.believes == 1.0


# Two hairpins' worth of bend at the least radius: beamng_like cuts its inside.
WET = design(straight(60), bend(120, 16.0))


@pytest.fixture(scope="module")
def slid() -> Run:
    world = World(site=Site(friction=0.5), limits=Limits(**ORACLES["thesis"]))
    run = prove(WET, 3, world, Setup(driver="beamng_like"))
    assert run.outcome == "FAIL"
    return run


def test_disturbed_drives_start_and_slip_as_they_are_told(slid: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[Drive, World]] = []

    def judged(road: Road, drive: Drive, world: World) -> Verdict:
        seen.append((drive, world))
        return judge(road, drive, world)

    monkeypatch.setattr("roadgpt_search.faults.stability.judge", judged)
    drive_disturbed(slid, Disturbance(0.9, 0.25, 0.0))
    ((drive, world),) = seen
    assert drive["t"][0] == pytest.approx(-1.75, abs=0.02)
    assert world.site.friction == pytest.approx(0.45)


def test_the_same_failure_is_repeated_alike(slid: Run) -> None:
    first, again = repeated(slid, 3), repeated(slid, 3)
    assert first == again
    assert len({each.at_s for each in first.drives}) == 3


def test_a_driver_that_breaks_down_has_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(run: Run, disturbance: Disturbance) -> Verdict:
        raise DriverError("it cannot see so late")

    monkeypatch.setattr(stability, "drive_disturbed", breaks)
    found = repeated(failed(build(design(straight(60), bend(-80, 20))), 72.0, t=1.5), 3)
    assert (found.failed, found.is_stable) == (3, True)
    assert all(drive.margin is None for drive in found.drives)


def _proved_by(
    fails: object, monkeypatch: pytest.MonkeyPatch, goes_left: object = lambda road: False
) -> list[Design]:
    """Instead of driving: a road fails where ``fails`` says so, to the left where ``goes_left`` does."""
    asked: list[Design] = []

    def proved(blueprint: Design, seed: int, world: World, setup: object, index: int) -> Run:
        asked.append(blueprint)
        bad = fails(blueprint)  # type: ignore[operator]
        verdict = Verdict(
            "FAIL" if bad else "PASS", "out of lane" if bad else None, "", "", 1.0, -0.1, 1,
            at_s=10.0 if bad else None, side=("left" if goes_left(blueprint) else "right") if bad else None,  # type: ignore[operator]
        )  # fmt: skip
        return Run(
            Request(),
            index,
            seed,
            outcome=verdict.outcome,
            design=blueprint,
            road=build(blueprint),
            verdict=verdict,
        )

    monkeypatch.setattr(minimising, "prove", proved)
    return asked


LONG = design(
    straight(40, 4.0), bend(-50, 22.0), straight(31, -3.0), bend(47, 19.0), straight(24),
    bend(-41, 17.0, 2.0), straight(33), start=(30.0, 150.0, 3.0),
)  # fmt: skip


def test_the_simplest_road_has_what_fails_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(road: Design) -> bool:
        tight = [s for s in road.segments if s.direction == "left" and s.radius and s.radius < 20]
        return bool(tight) and tight[0].turn_degrees > 33 and sum(s.distance for s in road.segments) > 40

    asked = _proved_by(fails, monkeypatch)
    failing = minimising.prove(LONG, 1, WORLD, None, 5)  # type: ignore[arg-type]
    found = simplest(failing)
    assert found.is_minimal
    left = found.run.design
    assert left is not None
    assert fails(left)
    assert [s.direction for s in left.segments if s.turn_degrees] == ["left"]
    assert all(s.incline == 0 for s in left.segments)
    for index in range(len(left.segments)):
        rest = left.segments[:index] + left.segments[index + 1 :]
        assert not rest or not fails(left.model_copy(update={"segments": rest}))
    assert found.drives <= len(asked)
    assert len(set(asked)) == len(asked), "nothing is driven twice"


def test_the_simplest_road_fails_to_the_same_side(monkeypatch: pytest.MonkeyPatch) -> None:
    def goes_left(road: Design) -> bool:
        return not any(segment.direction == "right" for segment in road.segments)

    _proved_by(lambda road: True, monkeypatch, goes_left)
    found = simplest(minimising.prove(LONG, 1, WORLD, None, 5))  # type: ignore[arg-type]
    assert found.run.verdict is not None
    assert found.run.verdict.side == "right"
    assert found.run.design is not None
    assert len(found.run.design.segments) <= 2


def test_only_roads_that_the_rules_allow_are_driven(monkeypatch: pytest.MonkeyPatch) -> None:
    """A radius of 14.6 m would be rounded to 10 m, which is too tight."""
    asked = _proved_by(lambda road: any(s.radius and s.radius < 20 for s in road.segments), monkeypatch)
    tight = design(straight(40), bend(-90, 14.6), straight(30))
    found = simplest(minimising.prove(tight, 1, WORLD, None, 5))  # type: ignore[arg-type]
    assert len(asked) > 5
    assert all(not inspect(build(one), None, WORLD) for one in asked[1:])  # the first is the failure itself
    assert found.run.design is not None
    assert all((segment.radius or 99) > 14 for segment in found.run.design.segments)


def test_a_search_that_runs_out_of_drives_gives_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    _proved_by(lambda road: any(s.direction == "left" for s in road.segments), monkeypatch)
    failing = minimising.prove(LONG, 1, WORLD, None, 5)  # type: ignore[arg-type]
    found = simplest(failing, most=3)
    assert found.drives <= 3
    assert not found.is_minimal
    assert found.run.outcome == "FAIL"
    assert "given up" in found.sentence


profiles_of_many = st.lists(st.sampled_from([-0.06, -0.03, 0.0, 0.03, 0.06]), min_size=1, max_size=40)


@given(profiles_of_many, st.integers(1, 12))
@settings(max_examples=15)
def test_many_failures_fall_into_the_same_faults_as_few(bends: list[float], most: int) -> None:
    """Steady bends so far apart that they are alike or not, whoever is compared with whom."""
    many = [Surroundings(np.full(77, bend), np.zeros(77), "x") for bend in bends]
    numbers: dict[float, int] = {}
    assert groups_of(many, most=most) == [numbers.setdefault(bend, len(numbers)) for bend in bends]


@given(st.lists(st.floats(-0.005, 0.005), min_size=1, max_size=12))
@settings(max_examples=15)
def test_the_most_typical_failure_is_nearest_to_all_others(bends: list[float]) -> None:
    """Of steady bends the distance is the difference of curvature, so it is the one nearest to the mean."""
    members = [Surroundings(np.full(77, bend), np.zeros(77), "x") for bend in bends]
    order = typical(members)
    assert sorted(order) == [*range(len(bends))]
    squares = [sum((one - other) ** 2 for other in bends) / BEND**2 for one in bends]
    assert squares[order[0]] == pytest.approx(min(squares), abs=1e-8)


def test_the_command_looks_into_failures_once(
    slid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_run(replace(slid, index=1), tmp_path)
    write_run(prove(design(straight(60)), 1, index=2), tmp_path)
    words = ["faults", str(tmp_path), "--repeat", "2"]
    first = CliRunner().invoke(app, [*words, "--no-plot"], standalone_mode=False)
    assert first.exception is None
    bend = f"a left bend of radius {reason_of(slid).radius:.0f} m"
    assert f"\n1 distinct fault in 1 failure: the car {WAYS[reason_of(slid).way]} {bend}\n" in first.output
    assert not (tmp_path / "faults" / "0001.png").exists()
    with monkeypatch.context() as patch:
        patch.setattr("roadgpt_search.faults.fault_log.repeated", lambda *_: pytest.fail("driven again"))
        assert CliRunner().invoke(app, [*words, "-q"], standalone_mode=False).output == ""
    png = (tmp_path / "faults" / "0001.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    table = (tmp_path / "faults" / "faults.csv").read_text(encoding="utf-8")
    assert len(table.splitlines()) == 2
    monkeypatch.setattr("roadgpt_search.faults.fault_log.repeated", lambda *_: pytest.fail("driven again"))
    CliRunner().invoke(app, ["faults", str(tmp_path), "--repeat", "2"], standalone_mode=False)
    assert (tmp_path / "faults" / "faults.csv").read_text(encoding="utf-8") == table
    assert folder.is_dir()
    nothing = CliRunner().invoke(app, ["faults", str(tmp_path / "nothing")], standalone_mode=False)
    assert isinstance(nothing.exception, UsageError)
