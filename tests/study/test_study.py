"""Studies: the same files for any number of processes, resumed, honest about designers that are silent."""

import csv
import json
import os
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from fake_chat import FakeChat
from roadgpt.brief.model import Brief
from roadgpt.chat import ChatError, ChatSettings
from roadgpt.cli import app
from roadgpt.design.designers import thesis as thesis_designer
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import DesignError, UsageError
from roadgpt.run import Setup
from roadgpt.run.atomic import alone_in
from roadgpt.study.chapters.validity import Count, Source, chi_squared_blocks
from roadgpt.study.execution import work
from roadgpt.study.plan import Prompt, StudyPlan, open_folder, read_plan, thesis_prompts
from roadgpt.study.study_report import keep_problems, write_run_report, write_study
from roadgpt.study.truth import Truth

GOLDEN = Path(__file__).parent / "golden"
CLOCK = ("seconds.json", "generation_stats.csv", "workers.log")  # what the clock and workers write
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
    page, text = (study / "report.html").read_text(), (study / "report.md").read_text()
    for said in ("182 of 300 (60.7 %)", "55.35", "p = 9.6e-13", "z = −7.37", "These roads were not driven"):
        assert said in page
        assert said in text
    assert "6 of 6 (100.0 %)" in page
    assert (
        "roadgpt study thesis --roads 2 --seed 1 --driver beamng_like --oracle thesis --no-drive --out study"
        in page
    )
    assert re.search(r"weights [0-9a-f]{16}", page)
    for target in re.findall(r'<a href="([^"#]+)"', page):
        assert (study / target).is_file(), target


def test_the_report_is_written_again_from_the_folder_alone(study: Path) -> None:
    before = (study / "report.html").read_bytes()
    (study / "report.html").unlink()
    result = CliRunner().invoke(app, ["report", str(study)])
    assert result.exit_code == 0, result.output
    assert (study / "report.html").read_bytes() == before


def test_pictures_of_a_study_are_of_the_format_that_is_asked_for(tmp_path: Path) -> None:
    (tmp_path / "p.jsonl").write_text('{"id": "1", "prompt": "straight | turns=0 len=40"}\n')
    words = [
        "study",
        "alignment",
        str(tmp_path / "p.jsonl"),
        "-n",
        "1",
        "--reader",
        "plan",
        "--workers",
        "1",
    ]
    result = CliRunner().invoke(app, [*words, "--format", "svg", "--out", str(tmp_path / "s")])
    assert result.exit_code == 0, result.output
    assert not list(tmp_path.rglob("*.png"))
    targets = re.findall(r'<a href="([^"#]+)"', (tmp_path / "s" / "report.html").read_text())
    assert {Path(target).name for target in targets} >= {"overview.svg", "birds_eye.svg"}
    assert all((tmp_path / "s" / target).is_file() for target in targets)


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


def test_one_process_works_in_a_study(tmp_path: Path) -> None:
    plan = small(ANY)
    open_folder(plan, tmp_path)
    (part,) = plan.parts()
    for folder in (tmp_path, tmp_path / part.name):
        with alone_in(folder), pytest.raises(UsageError, match="another process is at work"):
            work(plan, tmp_path)
    assert work(plan, tmp_path) == []


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


def test_a_designer_that_asks_a_model_joins_a_study_in_which_none_was_asked(tmp_path: Path) -> None:
    """The second command of the guide 'Evaluate roads', in the folder of the first one."""
    plan = small(ANY)
    open_folder(plan, tmp_path)
    asking = QUICK.model_copy(update={"chat": ChatSettings(model="one")})
    both = plan.model_copy(update={"designers": ("planner", "thesis"), "setup": asking})
    open_folder(both, tmp_path)
    assert read_plan(tmp_path) == both
    another = asking.model_copy(update={"chat": ChatSettings(model="two")})
    with pytest.raises(UsageError, match="another study"):
        open_folder(both.model_copy(update={"setup": another}), tmp_path)


def test_a_plan_survives_its_file(tmp_path: Path) -> None:
    truth = Truth.model_validate(
        {"sequence": [{"kind": "turn", "dir": "left", "deg": [80, None]}], "hilly": 2}
    )
    plan = small(ANY).model_copy(update={"prompts": (Prompt(id="1", prompt="x", truth=truth),)})
    open_folder(plan, tmp_path)
    assert read_plan(tmp_path) == plan
    (tmp_path / "study.json").write_text("{")
    with pytest.raises(UsageError, match="cannot be read"):
        read_plan(tmp_path)


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


def test_recorded_answers_stand_beside_the_planner(tmp_path: Path) -> None:
    """Those that lie in examples/: no server, no key."""
    file = tmp_path / "prompts.jsonl"
    file.write_text('{"prompt": "a road", "truth": {"turns": [1, null]}}')
    replay = Path(__file__).resolve().parents[2] / "examples" / "chat-replay"
    words = ["study", "alignment", str(file), "-n", "1", "--seed", "1", "--no-plot"]
    words += ["--designer", "planner", "--designer", "thesis", "--max-completion", "400"]
    words += ["--replay", str(replay), "--workers", "1", "--out", str(tmp_path / "s"), "-q"]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    text = (tmp_path / "s" / "report.md").read_text()
    assert "planner: 1 of 1" in text
    assert "thesis: 0 of 1" in text


def test_words_that_cannot_be_read_count_as_not_kept(tmp_path: Path) -> None:
    plan = small(ANY, "turn x3 | turns=2")
    open_folder(plan, tmp_path)
    (problem,) = work(plan, tmp_path)
    assert problem.part.endswith("02-turn-x3-turns-2")
    keep_problems(tmp_path, [problem])
    text = write_study(tmp_path).with_name("report.md").read_text()
    assert "1 of 2 (50.0 %) roads keep every word" in text
    assert problem.sentence in text


def test_one_prompt_with_roads_is_not_compared_with_none() -> None:
    half = Source("ours", (Count("a", 3, 5), Count("b", 0, 0)), "ours")
    said = chi_squared_blocks(half, "left", "kept", "departures")[1]
    assert "only one prompt" in str(said)
    assert "all roads" not in str(said)
    full = Source("ours", (Count("a", 5, 5), Count("b", 4, 4)), "ours")
    assert "all roads are valid" in str(chi_squared_blocks(full, "valid", "invalid", "validity")[1])


def test_words_that_cannot_be_read_weigh_as_much_as_others(tmp_path: Path) -> None:
    plan = small(ANY, "turn x3 | turns=2", roads=3)
    open_folder(plan, tmp_path)
    keep_problems(tmp_path, work(plan, tmp_path))
    assert "3 of 6 (50.0 %) roads keep every word" in write_study(tmp_path).with_name("report.md").read_text()


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


def test_a_campaign_of_run_has_a_report_too(tmp_path: Path) -> None:
    place = tmp_path / "runs"
    words = ["run", "turn x2 left", "-n", "2", "--seed", "4", "--no-plot", "--reader", "plan", "-q"]
    assert CliRunner().invoke(app, [*words, "--out", str(place)]).exit_code == 0
    result = CliRunner().invoke(app, ["report", str(place)])
    assert result.exit_code == 0, result.output
    page = (place / "report.html").read_text()
    assert "turn x2 left" in page
    assert "roadgpt run &#x27;turn x2 left&#x27; -n 2 --seed 4 --reader plan" in page
    for target in re.findall(r'<a href="([^"#]+)"', page):
        assert (place / target).is_file(), target


def test_a_report_names_the_lanes_and_banks_of_its_roads(tmp_path: Path) -> None:
    words = ["run", "turn x2 left", "-n", "1", "--seed", "4", "--no-plot", "--reader", "plan", "-q"]
    for bank, said in (("auto", "bank auto"), ("5", "bank 5 %")):
        place = tmp_path / bank
        lanes = ["--lanes", "2+1", "--lane-width", "3.5", "--bank", bank, "--out", str(place)]
        assert CliRunner().invoke(app, [*words, *lanes]).exit_code == 0
        assert CliRunner().invoke(app, ["report", str(place)]).exit_code == 0
        text = (place / "report.md").read_text()
        for each in ("lanes 2+1", "lane width 3.5 m", said):
            assert each in text


def test_folders_that_hold_nothing(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert result.exit_code == 2
    assert f"there is no campaign in {tmp_path}, and there are no runs" in result.stderr
    with pytest.raises(UsageError):
        write_run_report(tmp_path)


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
