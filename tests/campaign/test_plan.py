"""Plans: every combination is a cell; every mistake is a sentence with its key."""

import re
from pathlib import Path

import pytest

from campaign.test_store import BRIEFS
from roadgpt.brief.plan import read_plan as read_plan_of_road
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan, PlanTable, WorldTable, read_plan
from roadgpt.errors import PartError, UsageError
from rows import rows

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(("text", "sentence"), rows(__file__, "mistakes_in_plans"))
def test_a_mistake_is_told_with_its_key_and_what_to_do(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(text)
    with pytest.raises(UsageError, match=re.escape(sentence)) as told:
        read_plan(path)
    assert str(told.value).startswith(str(path))


def test_a_file_that_is_none_is_told(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot be read.*check the path"):
        read_plan(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="is not TOML"):
        read_plan(tmp_path / "bytes.toml")


def test_every_combination_is_a_cell_in_order(tmp_path: Path) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(
        "prompts = ['hairpin x2', 'a straight']\ndrivers = ['beamng_like', 'reference']\n"
        "seeds = [3, 4, 5]\ntests = 9\n[world]\nspeed_limit_kmh = 36\nfriction = 0.6\n[settings]\nsize = 3\n"
    )
    plan = read_plan(path).plan
    plan.check()
    cells = plan.cells(BRIEFS)
    told = [(cell.request.words, cell.request.setup.driver, cell.request.seed) for cell in cells]
    prompts, drivers = ("hairpin x2", "a straight"), ("beamng_like", "reference")
    assert told == [(words, driver, seed) for words in prompts for driver in drivers for seed in (3, 4, 5)]
    assert [cell.name for cell in cells] == [f"c{number:02d}" for number in range(1, 13)]
    assert cells[0].brief == BRIEFS["hairpin x2"]
    assert cells[-1].brief is None
    assert cells[0].request.world.limits.speed_limit == pytest.approx(10.0)
    assert cells[0].settings == {"size": 3}
    assert plan.budget == CellBudget(tests=9)


def test_the_plan_in_the_guide_is_one(tmp_path: Path) -> None:
    guide = (ROOT / "docs" / "how-to" / "run-campaigns.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```toml\n(.*?)^```", guide, re.MULTILINE | re.DOTALL)
    (tmp_path / "study.toml").write_text(block)
    plan = read_plan(tmp_path / "study.toml").plan
    plan.check()
    assert len(plan.cells({})) == 12
    keys = {
        key
        for row in re.findall(r"^\| (`[^|]+) \|", guide, re.MULTILINE)
        for key in re.findall(r"`(\[?\w+\]?)`", row)
    }
    known = {name if kind not in (dict, WorldTable) else f"[{name}]" for name, kind in kinds().items()}
    assert known <= keys


def kinds() -> dict[str, object]:
    return {
        name: WorldTable if name == "world" else dict if name in ("chat", "settings") else str
        for name in PlanTable.model_fields
    }


def test_names_of_many_cells_are_in_order_as_texts() -> None:
    names = [cell.name for cell in Plan(seeds=tuple(range(1234))).cells({})]
    assert names == sorted(names)
    assert len({*names}) == 1234


def test_a_goal_is_searched_for_by_the_usual_generator(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text("prompts = 'two hairpins'\ngoal = 'failures'\ntests = 9\n")
    assert read_plan(tmp_path / "plan.toml").plan.generators == ("quality_diversity",)
    (tmp_path / "plan.toml").write_text("prompts = 'two hairpins'\ntests = 9\n")
    assert read_plan(tmp_path / "plan.toml").plan.generators == ("words",)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"budget": CellBudget()}, "there is no limit"),
        ({"prompts": ("",)}, "needs a description"),
        ({"seeds": tuple(range(100_001))}, "more than 100,000; make several plans"),
    ],
)
def test_a_plan_that_cannot_be_is_told_before_anything_is_made(
    changes: dict[str, object], sentence: str
) -> None:
    plan = Plan(prompts=("two hairpins",), budget=CellBudget(tests=3)).model_copy(update=changes)
    with pytest.raises(UsageError, match=sentence):
        plan.check()


@pytest.mark.parametrize("shelf", ["designers", "simulators", "generators"])
def test_parts_that_are_not_installed_are_told(shelf: str) -> None:
    plan = Plan(prompts=("two hairpins",), budget=CellBudget(tests=3)).model_copy(update={shelf: ("nobody",)})
    with pytest.raises(PartError, match=f"no {shelf[:-1]} called 'nobody'"):
        plan.check()


@pytest.mark.parametrize(("given", "used"), [("", "2+2"), ("[world]\nlanes = '1+1'", "1+1")])
def test_words_set_the_lanes_unless_the_file_does(tmp_path: Path, given: str, used: str) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(f"prompts = ['two lanes each way']\ntests = 1\n{given}\n")
    brief = read_plan_of_road("turn | lanes=2 against=2")
    assert read_plan(path).plan.world.with_lanes_of(brief).section.lanes == used
