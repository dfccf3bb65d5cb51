"""Goals reach those who know them; a search that finds nothing says so."""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.status import CellStatus
from roadgpt.cli import app

PLAN = Plan(prompts=("hairpin x2",), reader="plan", budget=CellBudget(tests=3))


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.mark.parametrize(
    ("generator", "goal"), [("words", "failures"), ("random", "hardest"), ("genetic", "coverage")]
)
def test_a_goal_that_nobody_searches_for_is_refused(tmp_path: Path, generator: str, goal: str) -> None:
    words = ["hairpin x2", "-n", 3, "--reader", "plan", "--goal", goal, "--generator", generator]
    said = roadgpt("campaign", *words, "--out", tmp_path / "c")
    assert said.exit_code == 2
    sentence = f"the generator '{generator}' does not search for '{goal}'; leave out the goal"
    assert sentence in " ".join(said.output.split())
    assert not (tmp_path / "c").exists()


def test_others_may_stand_beside_a_search_to_be_compared_with() -> None:
    plan = PLAN.model_copy(update={"goal": "failures", "generators": ("quality_diversity", "random")})
    plan.check()
    assert [(cell.generator, cell.goal) for cell in plan.cells({})] == [
        ("quality_diversity", "failures"),
        ("random", None),
    ]


def status(goal: str | None, **outcomes: int) -> CellStatus:
    return CellStatus("c01", "a road", "d", "g", 1, 100, outcomes, None, 0, 0, None, None, goal, None)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("outcomes", "sentence"),
    [
        ({"PASS": 2, "FAIL": 95}, "c01: of 97 driven roads the car kept its lane on 2, so there is hardly a"),
        ({"FAIL": 40}, "of 40 driven roads the car kept its lane on none"),
        ({"PASS": 99, "FAIL": 1}, "of 100 driven roads the car failed on 1, so"),
        ({"ERROR": 3}, "c01: no road was driven"),
    ],
)
def test_a_boundary_with_one_side_is_told(outcomes: dict[str, int], sentence: str) -> None:
    said = status("boundary", **outcomes).remark
    assert sentence in said
    assert ("easier" in said) == (outcomes.get("PASS", 0) < outcomes.get("FAIL", 0))
    assert not status("failures", **outcomes).remark


@pytest.mark.parametrize("outcomes", [{}, {"PASS": 5, "FAIL": 95}, {"PASS": 50, "FAIL": 50, "ERROR": 900}])
def test_a_boundary_with_two_sides_needs_no_remark(outcomes: dict[str, int]) -> None:
    assert not status("boundary", **outcomes).remark
