"""Surveys are made of runs: what raters are shown, what they are not told, and what is refused."""

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.image import imread

from planned import planned
from roadgpt.brief import read
from roadgpt.errors import UsageError
from roadgpt.road import Design, Segment
from roadgpt.run import Run, Setup, perform, prove, write_run
from roadgpt_study.survey import build
from roadgpt_study.survey.command import command
from roadgpt_study.survey.plan import criteria_of, plan_from_runs, plan_text, read_plan
from roadgpt_study.survey.survey import Survey, read_survey

SETUP = Setup(drives=False)
NAMES = ("path", "view", "settings")
PROMPTS = {"an uphill road with 3 turns": "turn x3 | up", "a serpentine road": "serpentine"}


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two campaigns of two roads each, nobody drove."""
    folder = tmp_path_factory.mktemp("study")
    for number, (words, line) in enumerate(PROMPTS.items(), 1):
        campaign = folder / "planner" / f"{number:02d}"
        made = [perform(planned(line, words), 5, setup=SETUP, index=index) for index in (1, 2)]
        for run in made:
            assert run.is_valid
            write_run(run, campaign)
    return folder


@pytest.fixture(scope="module")
def made(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Survey]:
    out = tmp_path_factory.mktemp("made") / "survey"
    told: list[str] = []
    survey = build.make_survey(plan_from_runs(runs, "Jane", "jane@x.example", 1), Path(), out, told.append)
    assert len(told) == 4
    return out, survey


def test_a_survey_drawn_from_a_study_asks_what_its_descriptions_speak_of(
    made: tuple[Path, Survey], runs: Path
) -> None:
    out, survey = made
    assert read_survey(out) == survey
    assert [item.prompt for item in survey.of_part("alignment")] == list(PROMPTS)
    assert [item.criteria for item in survey.of_part("alignment")] == [("number of turns", "incline"), ()]
    assert [item.prompt for item in survey.of_part("similarity")] == list(PROMPTS)
    for item in survey.of_part("similarity"):
        assert item.roads[0] != item.roads[1]
        assert set(item.machine) == {
            "overall",
            "number of turns",
            "incline",
            "order of turns",
            "length of the road",
        }
    assert survey.items[0].machine == {"overall": 1.0, "number of turns": 1.0, "incline": 1.0}, (
        "the planner keeps its words"
    )
    assert plan_from_runs(runs, "Jane", "j", 1) == plan_from_runs(runs, "Jane", "j", 1)


def test_every_medium_is_there_and_nothing_else(made: tuple[Path, Survey]) -> None:
    out, survey = made
    assert {path.name for path in (out / "media").iterdir()} == set(survey.media)
    shapes = set()
    for name, medium in survey.media.items():
        data = (out / "media" / name).read_bytes()
        if medium.kind == "picture":
            picture = np.asarray(imread(io.BytesIO(data), format="png"))
            shapes.add(picture.shape)
            assert len(np.unique((picture[::3, ::3, :3] * 255).round() @ [65536, 256, 1])) > 20
        else:
            assert medium.kind == "view"
    assert len(shapes) == 1, "all plots are drawn alike"


def test_the_view_tells_raters_no_verdict_and_no_measures(made: tuple[Path, Survey]) -> None:
    out, survey = made
    for name, medium in survey.media.items():
        if medium.kind == "view":
            page = (out / "media" / name).read_text("utf-8")
            found = re.search(r'<script id="data" type="application/json">(.*?)</script>', page)
            assert found
            for scene in json.loads(found[1]):
                assert {scene[key] for key in ("outcome", "description", "about", "words")} == {""}
                assert scene["places"] == []
    raters_see = survey.model_dump_json(exclude={"items": {"__all__": {"machine", "roads"}}})
    assert "VALID" not in raters_see


def straight(length: float, start: tuple[float, float, float] = (10, 10, 0)) -> Run:
    segment = Segment(distance=length, direction="straight", incline=10)
    return prove(Design(starting_point=start, theta=45, segments=(segment,)), setup=Setup(drives=False))


@pytest.mark.parametrize(
    ("words", "criteria"),
    [
        ("a serpentine road", ()),
        ("an uphill road with 3 turns", ("turns", "incline")),
        ("a road going uphill for 3 turns and downhill for 2 turns", ("turns", "incline", "order")),
        (
            "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
            ("turns", "incline", "order"),
        ),
    ],
)  # fmt: skip
def test_criteria_are_those_that_the_thesis_asked_for(words: str, criteria: tuple[str, ...]) -> None:
    """Its figures 6.9, 6.12, 6.15 and 6.18."""
    assert criteria_of(read(words)) == criteria


def test_a_file_may_name_texts_criteria_and_questions_of_its_own(runs: Path, tmp_path: Path) -> None:
    run = next(runs.glob("planner/01/runs/0001"))
    (tmp_path / "S.toml").write_text(
        f"""title = "Own"\nasks = "Me"\ncontact = "me@x.example"\nattention_check = false\nviews = false
[[about]]\ntext = "Do you like roads?"\nanswers = ["yes", "no"]
[[alignment]]\nrun = "{run.as_posix()}"\nprompt = "something <else>"\ncriteria = ["turns", "beauty"]\n"""
    )
    plan = read_plan(tmp_path / "S.toml")
    survey = build.make_survey(plan, tmp_path, tmp_path / "out")
    assert [page.part for page in survey.pages] == ["about", "alignment", "end"]
    assert survey.about[0].answers == ("yes", "no")
    assert survey.items[0].criteria == ("number of turns", "beauty")
    assert survey.items[0].machine == {}, "the road was not made from these words"
    (tmp_path / "again.toml").write_text(plan_text(plan))
    again = read_plan(tmp_path / "again.toml")
    assert again.model_copy(update={"purpose": ""}) == plan


def test_the_file_in_the_guide_is_one(tmp_path: Path) -> None:
    guide = (Path(__file__).parents[3] / "docs" / "how-to" / "ask-people.md").read_text("utf-8")
    (text,) = re.findall(r"^```toml\n(.*?)^```", guide, re.M | re.S)
    (tmp_path / "S.toml").write_text(text)
    plan = read_plan(tmp_path / "S.toml")
    assert (len(plan.alignment), len(plan.similarity)) == (1, 1)
    assert plan.alignment[0].criteria == ("turns", "incline")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("title = ", "is not valid TOML"),
        ('asks = "x"\ncontact = "y"', "names no road"),
        ('contact = "y"\n[[alignment]]\nrun = "x"', "asks: field required"),
        ('asks = "x"\ncontact = "y"\ncolour = "red"\n[[alignment]]\nrun = "x"', "colour: extra inputs"),
        ('asks = "x"\ncontact = "y"\n[[similarity]]\nruns = ["x"]', r"similarity\.1\.runs"),
        ('asks = "x"\ncontact = "y"\n[[alignment]]\nrun = "nowhere"', "there is no run in"),
    ],
)
def test_what_a_file_says_wrongly_is_told_in_a_sentence(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "S.toml").write_text(text)
    with pytest.raises(UsageError, match=says):
        build.make_survey(read_plan(tmp_path / "S.toml"), tmp_path, tmp_path / "out")
    with pytest.raises(UsageError, match="cannot be read"):
        read_plan(tmp_path / "nothing.toml")


def test_a_survey_to_which_people_were_invited_is_never_replaced(
    made: tuple[Path, Survey], runs: Path, tmp_path: Path
) -> None:
    plan = plan_from_runs(runs, "Jane", "j")
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "answers.sqlite").write_bytes(b"answers")
    with pytest.raises(UsageError, match="people were invited"):
        build.make_survey(plan, Path(), tmp_path / "a")
    assert (tmp_path / "a" / "answers.sqlite").read_bytes() == b"answers"
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "thesis.docx").write_bytes(b"years of work")
    with pytest.raises(UsageError, match="contains other files"):
        build.make_survey(plan, Path(), tmp_path / "b")


def test_films_are_made_once_and_where_none_can_be_that_is_said(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    driven = replace(
        prove(
            Design(
                starting_point=(60, 60, 0),
                theta=0,
                segments=(Segment(distance=60, direction="straight", incline=0),),
            ),
            7,
        ),
        index=1,
    )
    campaign = tmp_path / "campaign"
    write_run(driven, campaign)
    where = (campaign / "runs" / "0001").as_posix()
    words = f'asks = "x"\ncontact = "y"\n[[alignment]]\nrun = "{where}"\nprompt = "a road"'
    (tmp_path / "S.toml").write_text(words)
    made: list[Path] = []

    def record(runs: list[Run], path: Path, view: str) -> None:
        made.append(path)
        path.write_bytes(view.encode())

    monkeypatch.setattr(build, "can_film", lambda: True)
    monkeypatch.setattr(build, "make_film", record)
    plan = read_plan(tmp_path / "S.toml")
    survey = build.make_survey(plan, tmp_path, tmp_path / "out")
    assert [medium.kind for medium in survey.items[0].media] == ["picture", "picture", "film", "film", "view"]
    assert survey.lacks == ""
    build.make_survey(plan, tmp_path, tmp_path / "out")
    assert [path.read_bytes() for path in made] == [b"chase", b"bonnet"], "what is there is not made again"
    monkeypatch.setattr(build, "can_film", lambda: False)
    without = build.make_survey(plan, tmp_path, tmp_path / "out")
    assert "there are no films" in without.lacks
    assert not list((tmp_path / "out" / "media").glob("*.mp4"))


def test_the_commands_make_and_analyse_a_survey(runs: Path, tmp_path: Path) -> None:
    out, runner = str(tmp_path / "s"), CliRunner()
    alone = runner.invoke(command, ["new", "--out", out])
    assert isinstance(alone.exception, UsageError)
    assert "SURVEY.toml" in str(alone.exception)
    nobody = runner.invoke(command, ["new", "--from", str(runs), "--out", out])
    assert "say who asks" in str(nobody.exception)
    done = runner.invoke(
        command,
        ["new", "--from", str(runs), "--out", out, "--asks", "J", "--contact", "j@x.example", "--pairs", "0"],
    )
    assert done.exit_code == 0, done.output
    assert read_plan(tmp_path / "s" / "SURVEY.toml").asks == "J"
    assert read_plan(tmp_path / "s" / "SURVEY.toml").films
    pages = re.findall(r"^page (\d) of (\d)(, about \d+ s left)?: ", done.output, flags=re.MULTILINE)
    assert [(number, total, bool(left)) for number, total, left in pages] == [
        ("1", "2", False), ("2", "2", True)
    ]  # fmt: skip
    tried = runner.invoke(command, ["analyse", out, "--synthetic", "5", "--seed", "2"])
    assert tried.output.strip().endswith("analysis-synthetic/report.html")
    charts = [{path.stem for path in (tmp_path / "s").rglob(f"*.{name}")} for name in ("svg", "pdf")]
    assert charts[0] == charts[1] != set()
    assert "nobody has been invited" in str(runner.invoke(command, ["analyse", out]).exception)
