"""Studies: the same files for any number of processes, resumed, honest about designers that are silent."""

import csv
import html
import json
import os
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from fake_chat import FakeChat
from page_words import words_of
from roadgpt.brief.model import Brief
from roadgpt.chat import ChatError, ChatSettings
from roadgpt.cli import app
from roadgpt.design.designers import thesis as thesis_designer
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import DesignError, UsageError
from roadgpt.run import Setup
from roadgpt_study.execution import work
from roadgpt_study.plan import Prompt, StudyPlan, open_folder, read_plan, thesis_prompts
from roadgpt_study.study_report import keep_problems, write_study

GOLDEN = Path(__file__).parent / "golden"
CLOCK = (
    "seconds.json",
    "generation_stats.csv",
    "workers.log",
    "campaign.sqlite",
)  # what the clock and workers write
QUICK = Setup(reader="plan", drives=False)
ANY = "| turns=1.."  # a road of any kind


def content(folder: Path) -> dict[str, bytes]:
    """All files of a study but for what the clock wrote."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name not in CLOCK)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def small(*words: str, roads: int = 1, **more: object) -> StudyPlan:
    prompts = tuple(Prompt(id=str(number), prompt=prompt) for number, prompt in enumerate(words, 1))
    plan = StudyPlan(
        kind="alignment", prompts=prompts, designers=("planner",), roads=roads, seed=3, setup=QUICK
    )
    return plan.model_copy(update=more)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``roadgpt study thesis --roads 2``, not driven."""
    place = tmp_path_factory.mktemp("study")
    words = ["study", "thesis", "--roads", "2", "--no-drive", "--no-plot", "--workers", "1", "--out", "study"]
    here = Path.cwd()
    os.chdir(place)
    try:
        result = CliRunner().invoke(app, words)
    finally:
        os.chdir(here)
    assert result.exit_code == 0, result.output
    assert result.output.splitlines()[-1] == str(Path("study", "report.html"))
    return place / "study"


def test_the_golden_study(study: Path) -> None:
    """Tables of a small study; a change of them is a change of what users get."""
    names = {path.name for path in GOLDEN.iterdir()}
    assert names == {"alignment-planner.csv", "diversity.csv", "validity-shares.csv", "validity-thesis.csv"}
    for name in names:
        ours, theirs = (list(csv.reader((f / name).open())) for f in (study / "tables", GOLDEN))
        assert len(ours) == len(theirs)
        for row, other in zip(ours, theirs, strict=True):
            for cell, golden in zip(row, other, strict=True):
                try:
                    assert float(cell) == pytest.approx(float(golden), abs=2e-3)
                except ValueError:
                    assert cell == golden


def test_the_page_tells_what_the_tables_tell(study: Path) -> None:
    page, text = (study / "report.html").read_text(), words_of(study)
    for said in ("182 of 300 (60.7 %)", "55.35", "p < 0.0001", "z = −7.37", "These roads were not driven"):
        assert html.escape(said) in page
        assert said in text
    assert "6 of 6 (100.0 %)" in page
    assert (
        "roadgpt study thesis --roads 2 --seed 1 --driver beamng_like --oracle thesis --no-drive --out study"
        in page
    )
    assert re.search(r"weights [0-9a-f]{16}", page)
    for target in re.findall(r'<a href="([^"#]+)"', page):
        assert (study / target).is_file(), target


def test_processes_and_a_pause_change_nothing(tmp_path: Path) -> None:
    plan = small(ANY, "turn x2 left", roads=2)
    for name, workers in (("one", 1), ("two", 2)):
        open_folder(plan, tmp_path / name)
        heard: list[int] = []
        assert work(plan, tmp_path / name, workers, tell=heard.append) == []
        assert heard[-1] == 4
        write_study(tmp_path / name)
    assert content(tmp_path / "one") == content(tmp_path / "two")
    halted = tmp_path / "three"
    first = plan.model_copy(update={"roads": 1})
    open_folder(first, halted)
    work(first, halted)
    open_folder(plan, halted)
    work(plan, halted)
    write_study(halted)
    assert content(halted) == content(tmp_path / "one")


def test_another_study_is_left_alone(tmp_path: Path) -> None:
    plan = small(ANY)
    open_folder(plan, tmp_path)
    before = content(tmp_path)
    for other, says in (
        (small("turn x2"), "other prompts"),
        (plan.model_copy(update={"seed": 4}), "other seed"),
        (plan.model_copy(update={"designers": ("thesis",)}), "--designer planner"),
    ):
        with pytest.raises(UsageError, match=says):
            open_folder(other, tmp_path)
    more = plan.model_copy(update={"roads": 5})
    open_folder(more, tmp_path)
    with pytest.raises(UsageError, match="as many or more"):
        open_folder(plan, tmp_path)
    assert read_plan(tmp_path) == more
    assert before.keys() == content(tmp_path).keys()
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "mine.txt").write_text("mine")
    with pytest.raises(UsageError, match="holds no study"):
        open_folder(plan, tmp_path / "x")


def test_a_designer_that_nobody_answers_is_said_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once; the other designer's roads are there, and the report says who is missing."""
    chat = FakeChat(ChatError("the server does not answer; start it"))
    monkeypatch.setattr(thesis_designer, "open_chat", lambda settings: chat)
    setup = QUICK.model_copy(update={"chat": ChatSettings(model="fake")})
    plan = small(ANY, "turn x2", designers=("thesis", "planner"), setup=setup)
    open_folder(plan, tmp_path)
    problems = work(plan, tmp_path)
    assert [problem.is_of_chat for problem in problems] == [True, True]
    assert len(chat.asked) == 1
    page = (write_study(tmp_path)).read_text()
    assert "planner: 2 of 2" in page
    assert "thesis was not run" in page


def test_a_description_that_no_road_can_keep_costs_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    draft = Planner.draft

    def drafted(self: Planner, brief: Brief, *rest: Any) -> Any:
        if brief.words == "turn x2":
            raise DesignError("no road keeps this")
        return draft(self, brief, *rest)

    monkeypatch.setattr(Planner, "draft", drafted)
    plan = small(ANY, "turn x2", "| up turns=1..", roads=4)
    open_folder(plan, tmp_path)
    (problem,) = work(plan, tmp_path)
    assert problem.sentence == "no road keeps this"
    assert not (tmp_path / problem.part).exists()
    made = [len(list((tmp_path / part.name).glob("test.*.json"))) for part in plan.parts()]
    assert made == [4, 0, 4]
    monkeypatch.undo()
    assert work(plan, tmp_path) == []
    assert len(list((tmp_path / problem.part).glob("test.*.json"))) == 4


def test_the_thesis_method_stands_beside_the_planner(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its answers are recorded ones here: one road that turns too sharply, and one that leaves the map."""
    segment = {"direction": "left", "distance": 30, "incline": 2, "turn_degrees": 70}
    sharp = {"starting_point": [100, 100, 0], "theta": 90, **{f"road_segment{n}": segment for n in (1, 2, 3)}}
    outside = {**sharp, "starting_point": [5, 5, 0], "theta": 200}
    chat = FakeChat(json.dumps(sharp), json.dumps(outside))
    monkeypatch.setattr(thesis_designer, "open_chat", lambda settings: chat)
    setup = Setup(drives=False, chat=ChatSettings(model="another"))
    plan = StudyPlan(
        kind="thesis",
        prompts=thesis_prompts()[:1],
        designers=("planner", "thesis"),
        roads=2,
        seed=5,
        setup=setup,
    )
    open_folder(plan, tmp_path)
    assert work(plan, tmp_path) == []
    write_study(tmp_path)
    rows = list(csv.DictReader((tmp_path / "tables" / "validity-shares.csv").open()))
    strict = {row["made by"]: row["valid"] for row in rows}
    assert strict["planner, strict rules"] == "2"
    assert strict["thesis, strict rules"] == "0"
    assert strict["RoadGPT's thesis, its own checks"] in ("182", "88")


def test_words_that_cannot_be_read_weigh_as_much_as_others(tmp_path: Path) -> None:
    plan = small(ANY, "turn x3 | turns=2", roads=3)
    open_folder(plan, tmp_path)
    keep_problems(tmp_path, work(plan, tmp_path))
    assert "3 of 6 (50.0 %) roads keep every word" in words_of(write_study(tmp_path).parent)


def test_alignment_by_the_command(tmp_path: Path) -> None:
    file = tmp_path / "prompts.jsonl"
    lines = [
        {"id": "u", "prompt": "u_turn", "truth": {"turns": 1}},
        {"id": "w", "prompt": "turn x2 left", "truth": {"left": 3}},
    ]
    file.write_text("\n".join(map(json.dumps, lines)))
    words = ["study", "alignment", str(file), "-n", "2", "--no-plot", "--workers", "1", "--reader", "plan"]
    result = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "s"), "-q"])
    assert result.exit_code == 0, result.output
    rows = list(csv.DictReader((tmp_path / "s" / "tables" / "alignment-planner.csv").open()))
    assert [(row["id"], float(row["general"])) for row in rows] == [("u", 1), ("w", 0)]
    assert "written down by people" in (tmp_path / "s" / "report.html").read_text()


def test_the_report_opens_with_what_a_manager_asks_and_statistics_come_after(tmp_path: Path) -> None:
    plan = small("a road", "two turns", "an uphill road", "a straight road", setup=Setup(drives=True))
    open_folder(plan, tmp_path)
    assert work(plan, tmp_path) == []
    page = write_study(tmp_path).read_text()
    first = page[: page.index("<h2>Alignment with the words</h2>")]
    assert "<h2>At a glance</h2>" in first
    assert first.count("<article>") == 3
    for sign in ("χ²", "interval", "Wilson", "p ="):
        assert sign not in first.partition("</style>")[2].replace("contain intervals", ""), sign
    rows = list(csv.DictReader((tmp_path / "tables" / "glance.csv").open()))
    assert [row["description"] for row in rows] == [prompt.prompt for prompt in plan.prompts]
    for part, row in zip(plan.parts(), rows, strict=True):
        runs = [json.loads(path.read_text()) for path in sorted((tmp_path / part.name).glob("test.*.json"))]
        left = [run for run in runs if run["test_outcome"] == "FAIL"]
        assert (int(row["roads"]), int(row["driven"])) == (len(runs), len(runs))
        assert int(row["left the lane"]) == len(left)
        assert int(row["valid"]) == sum(run["is_valid"] for run in runs)
