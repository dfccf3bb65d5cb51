"""The simulator 'beamng' with the unmodified client against the fake: scene, drives, verdicts, faults."""

import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beamngpy.connection import Connection

from beamng.fake_beamng import FakeBeamNG, FakeFault, fake_home
from exported import HILLY
from roadgpt.campaign import CellBudget, Plan, begin, campaign
from roadgpt.drive import Camera, Command, Drive, View, simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.lane_position import MarkingMonitor
from roadgpt.errors import DriverError, SimulationError, UsageError
from roadgpt.road import CrossSection, Design, Limits, Road, Segment, Site, World, build
from roadgpt.run import Setup, prove
from roadgpt.verdict import judge
from roadgpt_beamng.session import leave_all, session_of
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_beamng.simulator import BeamngSimulator

OURS = Connection.PROTOCOL_VERSION
WORLD = World()
HILLS = build(HILLY)
SHORT = Road.through([[40, 100], [70, 100], [100, 100]])


def hairpin() -> Road:
    """A long straight into a bend of 15 m radius."""
    bend = Segment(distance=45, direction="left", turn_degrees=170, radius=15)
    straight = Segment(distance=90, direction="straight")
    return build(Design(starting_point=(20, 100, -10), theta=0, segments=(straight, bend, straight)))


class Spy:
    """Drives well, and keeps what it saw."""

    def __init__(self) -> None:
        self.inside = Reference()
        self.views: list[View] = []

    def start(self, road: Road, world: World, seed: int) -> None:
        self.inside.start(road, world, seed)

    def steer(self, view: View) -> Command:
        self.views.append(view)
        return self.inside.steer(view)


@pytest.fixture
def fake() -> Iterator[FakeBeamNG]:
    with FakeBeamNG(protocol=OURS) as server:
        yield server
        leave_all()
        assert server.unknown == []
        assert server.broken == []


def simulator(fake: FakeBeamNG, **settings: Any) -> BeamngSimulator:
    return BeamngSimulator(BeamngSettings(port=fake.port, **settings))


def test_beamngs_ai_drives_in_place_of_its_imitation(fake: FakeBeamNG) -> None:
    drive = simulator(fake, rate=20).simulate(HILLS, WORLD, BeamngLike(), 7)
    assert (drive.driver, drive.simulator, drive.ended) == ("beamng_ai", "beamng", "goal")
    assert judge(HILLS, drive, WORLD).kept
    kinds = {kind for _, kind in fake.transcript}
    assert {"SetAiWaypoint", "SetDriveInLane", "SetAiAggression", "SetAiSpeed", "FPSLimit"} <= kinds


@cache
def over_the_hills() -> Drive:
    with FakeBeamNG(protocol=OURS) as fake:
        drive = simulator(fake).simulate(HILLS, WORLD, Reference(), 7)
        leave_all()
    assert fake.unknown == fake.broken == []
    return drive


def test_the_drive_starts_at_rest_at_its_place_in_the_right_lane() -> None:
    drive = over_the_hills()
    assert drive["s"][0] == pytest.approx(2.5, abs=0.05)
    assert drive["t"][0] == pytest.approx(-2.0, abs=0.02)
    assert drive["speed"][0] < 0.05
    assert drive["time"][0] == 0.0
    assert drive["z"][0] - HILLS.at(2.5)[2] == pytest.approx(0.56, abs=0.02)
    assert drive["pitch"][0] == pytest.approx(math.atan(float(HILLS.grade(2.5))), abs=0.01)
    assert np.diff(drive["time"])[:-1] == pytest.approx(0.02)
    assert drive.car[:3] == pytest.approx((4.70, 1.86, -0.10), abs=1e-6)


def test_speeds_and_rates_are_those_of_the_positions() -> None:
    drive = over_the_hills()
    time = drive["time"]
    moved = np.hypot(np.gradient(drive["x"], time), np.gradient(drive["y"], time))
    level = np.hypot(drive["vx"], drive["vy"]) * np.cos(drive["pitch"])
    assert np.median(np.abs(moved - level)[5:-5]) < 0.05
    turned = np.gradient(np.unwrap(drive["heading"]), time)
    assert np.median(np.abs(turned - drive["yaw_rate"])) < 0.01
    s, t = HILLS.locate(drive["x"], drive["y"])
    assert drive["s"] == pytest.approx(s, abs=0.01)
    assert drive["t"] == pytest.approx(t, abs=0.01)


def test_the_same_road_is_driven_the_same_way_and_in_one_session(fake: FakeBeamNG) -> None:
    one, other = (simulator(fake, rate=20).simulate(SHORT, WORLD, Reference(), 7) for _ in range(2))
    assert one["x"] == pytest.approx(other["x"], abs=1e-6)
    assert [kind for _, kind in fake.transcript].count("GetSystemInfo") == 1
    assert fake.scenarios == {}  # cleared away
    assert fake.world is None


def test_too_fast_into_a_bend_is_out_of_the_lane_at_the_very_moment(fake: FakeBeamNG) -> None:
    road, times = hairpin(), []
    for rate in (20, 50):
        drive = simulator(fake, aggression=1.0, rate=rate).simulate(road, WORLD, BeamngLike(), 7)
        verdict = judge(road, drive, WORLD)
        assert (drive.ended, verdict.outcome, verdict.side) == ("out_of_lane", "FAIL", "right")
        assert drive["outside"][-1] == pytest.approx(WORLD.limits.oob_tolerance, abs=1e-3)
        times.append(drive.duration)
    # interpolated: 50 ms between samples cost no 50 ms of doubt
    assert max(times) - min(times) < 0.03


def test_a_lane_departure_ends_the_drive_at_the_very_moment(fake: FakeBeamNG) -> None:
    road, watched = hairpin(), World(limits=Limits(lane_departure=True))
    for keep_driving in (False, True):
        made = simulator(fake, aggression=1.0, rate=20)
        drive = made.simulate(road, watched, BeamngLike(), 7, keep_driving)
        beyond = MarkingMonitor.for_tyres(road, watched, drive.car).along(drive)
        first = int(np.argmax(beyond > 0))
        assert 0 < beyond[first] < 1e-3
        assert drive["outside"][first] < 0.2
        assert (drive.ended == "out_of_lane") == (first == len(drive) - 1) == (not keep_driving)
        verdict = judge(road, drive, watched)
        assert (verdict.outcome, verdict.at_time) == ("FAIL", drive["time"][first])


def test_a_car_that_leaves_a_floating_road_falls(fake: FakeBeamNG) -> None:
    class Away:
        def steer(self, view: View) -> Command:
            return Command(-0.2, 0.6)

    road = Road.through([[40, 100, 0], [90, 100, 0], [140, 100, 0]])
    drive = simulator(fake, rate=20).simulate(
        road, World(section=CrossSection(shoulder=0)), Away(), 7, keep_driving=True
    )
    assert drive.ended == "fell"
    assert drive["t"][-1] < -4.0


def test_who_does_not_move_is_stuck_and_an_ai_that_never_sets_off_is_an_error(fake: FakeBeamNG) -> None:
    class Asleep:
        def steer(self, view: View) -> Command:
            return Command(0.0, 0.0, 1.0)

    assert simulator(fake, rate=20).simulate(SHORT, WORLD, Asleep(), 7).ended == "stuck"
    with FakeBeamNG(protocol=OURS, is_blind=True) as blind:
        with pytest.raises(SimulationError, match=r"did not start to move.*doctor beamng"):
            simulator(blind).simulate(SHORT, WORLD, BeamngLike(), 7)
        leave_all()


@pytest.mark.parametrize(("sign", "told"), [(-1.0, 1.0), (1.0, -1.0)])
def test_a_driver_steers_to_its_left_whichever_way_the_input_turns(sign: float, told: float) -> None:
    spy = Spy()
    with FakeBeamNG(protocol=OURS, steer_sign=sign, told_sign=told) as fake:
        drive = simulator(fake, rate=25).simulate(HILLS, WORLD, spy, 7)
        gain = session_of(BeamngSettings(port=fake.port, rate=25)).gain
        leave_all()
    assert gain == pytest.approx(sign * 0.6, rel=0.05)
    assert drive.ended == "goal"
    assert np.abs(drive["t"] + 2.0).max() < 0.5
    bend = drive["steer"] - np.arctan(2.83 * drive["yaw_rate"] / np.maximum(drive["vx"], 1.0))
    assert np.abs(bend[drive["vx"] > 5]).max() < 0.05
    assert {view.dt for view in spy.views} == {0.04}
    assert all(view.image is None for view in spy.views)
    assert spy.views[10].steer == pytest.approx(drive["steer"][10])


def test_a_driver_that_asks_for_a_camera_sees(fake: FakeBeamNG) -> None:
    spy = Spy()
    spy.camera = Camera(width=32, height=16)  # type: ignore[attr-defined]
    simulator(fake).simulate(SHORT, WORLD, spy, 7)
    shades = [int(view.image[0, 0, 0]) for view in spy.views]
    assert {view.image.shape for view in spy.views} == {(16, 32, 3)}
    assert spy.views[0].image.dtype == np.uint8
    assert len(set(shades)) > 50  # a new image each time
    assert fake.cameras == {}
    spy.camera = "front"  # type: ignore[attr-defined]
    with pytest.raises(UsageError, match=r"roadgpt\.drive\.Camera"):
        simulator(fake).simulate(SHORT, WORLD, spy, 7)


def test_a_driver_that_fails_costs_its_drive_and_not_the_session(fake: FakeBeamNG) -> None:
    class RaisesError:
        def steer(self, view: View) -> Command:
            raise ValueError("no idea")

    with pytest.raises(DriverError, match="no idea"):
        simulator(fake, rate=20).simulate(SHORT, WORLD, RaisesError(), 7)
    assert simulator(fake, rate=20).simulate(SHORT, WORLD, Reference(), 7).ended == "goal"
    assert [kind for _, kind in fake.transcript].count("GetSystemInfo") == 1


# Others, also while a road is laid, are among the faults of the campaign of twenty roads.
@pytest.mark.parametrize(
    ("kind", "on", "nth"),
    [("drop", "SensorRequest", 40), ("error", "SensorRequest", 40), ("hang", "Step", 30)],
)
def test_a_fault_costs_one_more_try(tmp_path: Path, port: int, kind: str, on: str, nth: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS, faults=[FakeFault(kind, on, 1, nth)])
    made = BeamngSimulator(BeamngSettings(home=home, port=port, rate=20, poll_timeout=0.6, load_timeout=5))
    drive = made.simulate(SHORT, WORLD, BeamngLike(), 7)
    assert drive.ended == "goal"
    assert len((home / "started.jsonl").read_text().splitlines()) == 2
    assert len(drive) == pytest.approx(drive.duration * 20, abs=2)


def test_a_second_fault_is_an_error_of_this_road_and_the_next_is_driven(tmp_path: Path, port: int) -> None:
    faults = [FakeFault("die", "Step", 1, 9), FakeFault("hang", "SensorRequest", 2, 9)]
    home = fake_home(tmp_path / "home", protocol=OURS, faults=faults)
    made = BeamngSimulator(BeamngSettings(home=home, port=port, rate=20, poll_timeout=0.6))
    with pytest.raises(
        SimulationError, match=r"failed 2 times .* no answer within 0\.6 s while it was driving"
    ):
        made.simulate(SHORT, WORLD, BeamngLike(), 7)
    assert made.simulate(SHORT, WORLD, BeamngLike(), 7).ended == "goal"


def test_the_driver_of_the_guide_sees_and_drives(fake: FakeBeamNG) -> None:
    page = Path(__file__).parents[2] / "docs" / "how-to" / "use-beamng.md"
    (code,) = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    made: dict[str, Any] = {}
    exec(code, made)
    drive = simulator(fake, rate=20).simulate(SHORT, WORLD, made["Looks"](), 7)
    assert {*drive["throttle"][1:].tolist()} == {0.0, 0.2}  # the image of the fake grows lighter with time


def test_the_car_of_a_driver_of_ours_shifts_by_itself(fake: FakeBeamNG) -> None:
    """The fake's player has chosen to shift by hand, and a car that is reset goes back to that."""
    for road in (SHORT, HILLS):  # the first of them measures the steering, and resets the car after it
        assert simulator(fake, rate=20).simulate(road, WORLD, Reference(), 7).ended == "goal"


def test_a_friction_that_the_game_does_not_heed_is_refused_before_anything_is_driven(
    tmp_path: Path, fake: FakeBeamNG
) -> None:
    slippery, setup = World(site=Site(friction=0.5)), Setup(reader="plan", simulator="beamng")
    said = r"friction 0\.5 has no effect in this simulator.*give --friction 1, or drive in"
    with pytest.raises(UsageError, match=said):
        simulate(SHORT, slippery, "reference", 0, simulator(fake))
    with pytest.raises(UsageError, match=said):
        campaign("| turns=1..", 3, 0, slippery, setup, tmp_path / "runs")
    with pytest.raises(UsageError, match=said):
        prove(SHORT, 0, slippery, setup)
    plan = Plan(prompts=("a road",), world=slippery, simulators=("beamng",), budget=CellBudget(tests=3))
    with pytest.raises(UsageError, match=said):
        begin(plan, tmp_path / "campaign")
    assert not [*tmp_path.iterdir()]
    assert fake.transcript == []
    drive = simulate(SHORT, slippery, "reference", 0)  # ours heeds it
    assert drive.ended == "goal"
