"""The flow: what is done with objections, failures and seeds."""

from pathlib import Path

import pytest

from roadgpt.brief.model import Brief
from roadgpt.campaign import campaign
from roadgpt.errors import BriefError, DesignError, PartError, UsageError
from roadgpt.road import CrossSection, Limits, Road, World
from roadgpt.run import MOST_ROUNDS, Run, Setup, brief_of, perform, prove, read_run, seed_of
from run.doubles import TOO_STEEP, FreshDesigner, Learner, Stubborn, Unable, a_design, put_on_shelf

BRIEF = Brief(words="two straights and a turn")
NO_DRIVE = Setup(designer="double", drives=False)
STEERS_NOT = """
class Crashes:
    def steer(self, view):
        raise ZeroDivisionError("the driver fell asleep")
"""


def test_a_valid_draft_is_taken_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    designer = FreshDesigner()
    put_on_shelf(monkeypatch, double=designer)
    run = perform(BRIEF, 7, setup=NO_DRIVE, index=3, earlier=[a_design(1)])
    assert (run.outcome, run.is_valid, run.rounds, run.findings) == ("VALID", True, 1, ())
    assert run.validation_message == ""
    assert designer.calls == [((), 1, seed_of(7, 3))]
    assert run.seed == seed_of(7, 3)
    assert run.design == a_design(run.seed)
    assert run.road is not None
    assert run.length == pytest.approx(sum(s.distance for s in a_design(run.seed).segments))
    assert run.words == BRIEF.words
    assert run.drive is run.verdict is None


def test_objections_travel_back_as_sentences(monkeypatch: pytest.MonkeyPatch) -> None:
    designer = Learner()
    put_on_shelf(monkeypatch, double=designer)
    run = perform(BRIEF, setup=NO_DRIVE)
    assert (run.outcome, run.rounds) == ("VALID", 2)
    notes = designer.calls[1][0]
    assert notes
    assert all(isinstance(note, str) for note in notes)
    assert "15 %" in notes[0]
    assert designer.calls[0][2] != designer.calls[1][2]


def test_rounds_are_bounded_and_the_last_draft_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    designer = Stubborn()
    put_on_shelf(monkeypatch, double=designer)
    run = perform(BRIEF, setup=NO_DRIVE.model_copy(update={"drives": True}))
    assert len(designer.calls) == run.rounds == MOST_ROUNDS
    assert run.outcome == "INVALID"
    assert not run.is_valid
    assert run.description == run.validation_message == run.findings[0].sentence
    assert run.design is not None
    assert run.design.segments[-1] == TOO_STEEP
    assert run.drive is None


def test_a_designer_that_gives_up_after_objections_leaves_its_last_draft(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class GivesUp(Stubborn):
        def draft(self, brief, world, notes, earlier, seed):  # type: ignore[no-untyped-def]
            if notes:
                raise DesignError("it cannot be less steep")
            return super().draft(brief, world, notes, earlier, seed)

    put_on_shelf(monkeypatch, double=GivesUp())
    run = perform(BRIEF, setup=NO_DRIVE)
    assert (run.outcome, run.rounds) == ("INVALID", 1)


def test_where_nothing_can_be_designed_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    put_on_shelf(monkeypatch, double=Unable())
    with pytest.raises(DesignError, match="ask for fewer"):
        perform(BRIEF, setup=NO_DRIVE)


def test_a_road_that_exists_is_driven_and_judged() -> None:
    run = prove(Road.through([[40, 100], [90, 100], [140, 100]]), seed=5)
    assert (run.outcome, run.seed, run.brief, run.design, run.rounds) == ("PASS", 5, None, None, 0)
    assert run.verdict is not None
    assert run.verdict.kept
    assert run.drive is not None
    assert run.drive.seed == 5
    assert run.description == run.verdict.description
    assert run.seconds.drive > 0
    assert {"roadgpt", "python", "numpy", "mujoco-core"} <= set(run.versions)


def test_a_design_that_exists_is_built_in_either_way() -> None:
    arcs = prove(a_design(), setup=Setup(drives=False))
    spline = prove(a_design(), setup=Setup(drives=False, geometry="spline"))
    assert arcs.road is not None
    assert spline.road is not None
    assert arcs.road.nodes is None
    assert spline.road.nodes is not None


def test_an_invalid_road_is_not_driven() -> None:
    run = prove(Road.through([[10, 10], [400, 10]]), world=World())
    assert run.outcome == "INVALID"
    assert run.drive is None
    assert "versions" not in run.description


def test_a_driver_that_fails_costs_one_error(tmp_path: Path) -> None:
    file = tmp_path / "sleepy.py"
    file.write_text(STEERS_NOT)
    run = prove(a_design(), setup=Setup(driver=f"{file}:Crashes"))
    assert (run.outcome, run.is_valid) == ("ERROR", True)
    assert "the driver fell asleep" in run.description
    assert "sleepy.py" in run.trace
    assert run.drive is run.verdict is None
    assert run.seconds.drive > 0


def test_a_simulator_that_crashes_costs_one_error_and_leaves_its_trace(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def crash(*args: object, **more: object) -> Run:
        raise FloatingPointError("the car exploded")

    monkeypatch.setattr("roadgpt.run.simulate", crash)
    run = prove(a_design())
    assert run.outcome == "ERROR"
    assert "the car exploded" in run.description
    assert "FloatingPointError" in run.trace


@pytest.mark.parametrize(
    "setup", [Setup(simulator="beam"), Setup(driver="nobody"), Setup(driver="none.py:X")]
)
def test_a_part_that_does_not_exist_is_the_user_s_error(setup: Setup) -> None:
    with pytest.raises((PartError, UsageError)):
        prove(a_design(), setup=setup)


def test_the_same_seed_gives_the_same_drive() -> None:
    one, other = (prove(a_design(4), seed=9) for _ in range(2))
    assert one.drive is not None
    assert other.drive is not None
    assert one.drive.to_bytes() == other.drive.to_bytes()
    assert one.verdict == other.verdict


MOODY = """
import json
from pathlib import Path

COUNT = Path(__file__).with_name("count")

class Moody:
    def __init__(self):
        COUNT.write_text(COUNT.read_text() + "x" if COUNT.exists() else "x")
        if len(COUNT.read_text()) == 4:
            json.loads("{")

    def start(self, road, world, seed):
        if len(COUNT.read_text()) == 5:
            json.loads("[")

    def steer(self, view):
        return (0.0, 0.2, 0.0)
"""


def test_a_driver_that_cannot_be_made_for_the_second_road_costs_that_road_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "moody.py"
    file.write_text(MOODY)
    put_on_shelf(monkeypatch, double=FreshDesigner())
    setup = Setup(designer="double", driver=f"{file}:Moody", keep_driving=True)
    # two are made before the first road: for the roll call, and for the record of what decides results
    runs = list(campaign(BRIEF, 4, 7, setup=setup, out=tmp_path / "c"))
    assert [run.outcome == "ERROR" for run in runs] == [False, True, True, False]
    assert "cannot be made" in runs[1].description
    assert "moody.py, line 15" in runs[2].description  # and no line of the library json
    for run in runs[1:3]:
        trace = (tmp_path / "c" / "runs" / f"{run.index:04d}" / "error.txt").read_text()
        assert "JSONDecodeError" in trace
        assert 'moody.py"' in trace
        assert read_run(tmp_path / "c" / "runs" / f"{run.index:04d}").trace == run.trace


ALWAYS_LEFT = """
from roadgpt.drive import Command


class Leaves:
    def steer(self, view):
        return Command(steer=0.5 if view.time > 2 else 0.0, throttle=0.4)
"""


def test_a_drive_that_goes_on_after_a_departure_tells_how_it_ended(tmp_path: Path) -> None:
    file = tmp_path / "leaves.py"
    file.write_text(ALWAYS_LEFT)
    setup = Setup(driver=f"{file}:Leaves", keep_driving=True)
    run = prove(
        Road.through([[40, 100], [90, 100], [140, 100]]),
        world=World(section=CrossSection(shoulder=0)),
        setup=setup,
    )
    assert run.verdict is not None
    assert run.drive is not None
    assert run.verdict.cause == "out of lane"
    assert run.drive.ended == "fell"
    assert run.description == f"{run.verdict.description}, then fell after {run.drive['s'][-1]:.0f} m"
    ended = prove(
        run.road,
        world=World(section=CrossSection(shoulder=0)),
        setup=setup.model_copy(update={"keep_driving": False}),
    )
    assert ended.description == ended.verdict.description  # type: ignore[union-attr]


def test_a_description_is_refused_where_the_world_forbids_it() -> None:
    assert brief_of("a straight road climbing at 12 percent").clauses
    with pytest.raises(BriefError, match="10"):
        brief_of("a straight road climbing at 12 percent", World(limits=Limits(max_grade=0.1)))
