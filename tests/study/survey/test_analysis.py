"""The analysis: made-up raters whose agreement is known, and the same numbers reached in other ways."""

import csv
import math
import re
import statistics
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import pytest
from matplotlib.figure import Figure as Drawing
from scipy import stats

from page_words import words_of
from roadgpt.errors import UsageError
from roadgpt.report.canvas import Format, save_all
from roadgpt_study.survey import rating_charts
from roadgpt_study.survey.analysis import analyse, load_answers
from roadgpt_study.survey.answers import alpha_of, answers_of_raters, synthetic, tally
from roadgpt_study.survey.store import ANSWERS, AnswerStore, code_of
from roadgpt_study.survey.survey import CHECK, MATCHES, Survey
from survey_made import EVIL, folder_of, survey


def table(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / "tables" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def asked() -> Survey:
    made = survey(roads=5, pairs=2)
    items = [
        item.model_copy(
            update={"machine": {"overall": number / 7, "incline": 1.0}, "prompt": f"road {number}"}
        )
        for number, item in enumerate(made.items)
    ]
    return made.model_copy(update={"items": tuple(items)})


@pytest.fixture(scope="module")
def made_up(asked: Survey, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("analysis")
    return analysed(asked, out)


def analysed(asked: Survey, out: Path) -> Path:
    """Every chart as SVG, and the first one as PDF and PNG as well: each PDF takes a second."""

    def save_first(figure: Drawing, path: Path, formats: Sequence[Format]) -> list[Path]:
        return [] if [*path.parent.glob("*.pdf")] else save_all(figure, path, formats)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rating_charts, "save_all", save_first)
        return analyse(synthetic(asked, 25, 4, 0.7, failing=0.2), out, "roadgpt study survey analyse").parent


@pytest.fixture
def svg_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Charts are not written as PDF and PNG as well, which takes most of the time of an analysis."""
    monkeypatch.setattr(rating_charts, "save_all", lambda *_: [])


@pytest.mark.parametrize(("said", "low", "high"), [(1.0, 1.0, 1.0), (0.9, 0.6, 0.99), (0.0, -0.05, 0.05)])
def test_known_agreement_comes_out_as_such(said: float, low: float, high: float) -> None:
    answers = synthetic(survey(roads=6, pairs=6), 80, 3, said, failing=0)
    for part in ("alignment", "similarity"):
        found = tally(answers, part)
        assert low <= alpha_of(found.units) <= high


def test_two_raters_who_never_agree_have_a_negative_alpha(asked: Survey) -> None:
    overall = [f"a{n}.overall" for n in range(1, 6)]
    given = {
        "a" * 64: {id_: MATCHES[0 if n % 2 else 4] for n, id_ in enumerate(overall)},
        "b" * 64: {id_: MATCHES[4 if n % 2 else 0] for n, id_ in enumerate(overall)},
    }
    found = tally(answers_of_raters(asked, given, "people", 2), "alignment")
    assert math.isnan(alpha_of(found.overall[:1])), "one road alone tells nothing of agreement"
    # 5 units, each with one 1 and one 5: observed 1, by chance 50/90
    assert alpha_of(found.overall) == pytest.approx(1 - 1 / (50 / 90))


def test_the_same_seed_gives_the_same_bytes_and_another_one_others(
    asked: Survey, made_up: Path, tmp_path: Path
) -> None:
    again = analysed(asked, tmp_path)
    files = sorted(path.relative_to(made_up) for path in made_up.rglob("*.*"))
    assert len(files) > 20
    assert {".svg", ".pdf", ".png"} <= {path.suffix for path in files}
    for path in files:
        assert (made_up / path).read_bytes() == (again / path).read_bytes(), path
    assert synthetic(asked, 6, 1).rows == synthetic(asked, 6, 1).rows != synthetic(asked, 6, 2).rows


def test_made_up_raters_are_marked_wherever_they_are_seen(made_up: Path) -> None:
    assert not (made_up / "answers.csv").exists()
    assert {row["source"] for row in rows(made_up / "answers-synthetic.csv")} == {"synthetic"}
    page = (made_up / "report.html").read_text("utf-8")
    assert page.count("<svg") == 3
    assert "<h1>SYNTHETIC" in page
    for caption in re.findall(r"<caption>(.*?)</caption>|<figcaption>(.*?)</figcaption>", page):
        assert "SYNTHETIC" in "".join(caption)
    for path in (made_up / "tables").iterdir():
        assert path.name.startswith("synthetic-")
        assert path.suffix != ".tex" or "SYNTHETIC" in path.read_text("utf-8")


@pytest.mark.usefixtures("svg_alone")
def test_people_are_not_called_made_up(asked: Survey, tmp_path: Path) -> None:
    given = {f"{n:x}" * 64: {"a1.overall": MATCHES[n % 5], "check": MATCHES[CHECK]} for n in range(4)}
    analyse(answers_of_raters(asked, given, "people", 9, 2), tmp_path)
    for path in tmp_path.rglob("*"):
        if path.suffix in {".html", ".csv", ".tex", ".svg"}:
            assert "synthetic" not in path.read_text("utf-8").lower().replace("synthetic 30", ""), path
    numbers = {row[""]: int(row["number"]) for row in table(tmp_path, "raters")}
    assert list(numbers.values()) == [9, 4, 2, 0, 0, 4, 0]


def test_the_two_kinds_are_never_in_one_folder(asked: Survey, tmp_path: Path) -> None:
    people = answers_of_raters(asked, {"0" * 64: {"a1.overall": MATCHES[0]}}, "people", 1)
    for name, file in (("people", "answers.csv"), ("made-up", "answers-synthetic.csv")):
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_text("as an analysis left it")
    with pytest.raises(UsageError, match="kept apart"):
        analyse(synthetic(asked, 3), tmp_path / "people")
    with pytest.raises(UsageError, match="kept apart"):
        analyse(people, tmp_path / "made-up")


def test_numbers_of_the_tables_are_those_of_the_rows(made_up: Path, asked: Survey) -> None:
    every = rows(made_up / "answers-synthetic.csv")
    failed = {row["rater"] for row in every if row["question"] == "check" and row["answer"] != MATCHES[CHECK]}
    assert 0 < len(failed) < 12
    numbers = {row[""]: int(row["number"]) for row in table(made_up, "synthetic-raters")}
    assert numbers["failed the attention check; left out below"] == len(failed)
    assert numbers["analysed"] == 25 - len(failed)
    scores = defaultdict[tuple[str, str], dict[str, int]](dict)
    for row in every:
        if row["score"] and row["rater"] not in failed:
            scores[row["item"], row["criterion"]][row["rater"]] = int(row["score"])
    told = table(made_up, "synthetic-alignment-ratings") + table(made_up, "synthetic-similarity-ratings")
    assert len(told) == len(scores) == 12
    for row in told:
        given = list(scores[row["item"], row["criterion"]].values())
        assert [int(row[str(score)]) for score in range(1, 6)] == [
            given.count(score) for score in range(1, 6)
        ]
        assert float(row["median"]) == statistics.median(given)
        assert float(row["4 or 5"]) == pytest.approx(sum(g >= 4 for g in given) / len(given), abs=1e-4)
    raters = sorted(scores["a1", "overall"])
    columns = [[scores[f"a{n}", "overall"][rater] for rater in raters] for n in range(1, 6)]
    expected = stats.friedmanchisquare(*columns)
    line = f"chi-squared(4) = {expected.statistic:.2f}"
    assert line in words_of(made_up)
    people = [statistics.mean(column) for column in columns]
    machine = [
        float(row["machine, 0 to 1"])
        for row in table(made_up, "synthetic-alignment-machine")
        if row["criterion"] == "overall"
    ]
    assert machine == pytest.approx([n / 7 for n in range(5)])
    told_people = [
        float(row["people, mean of 1 to 5"])
        for row in table(made_up, "synthetic-alignment-machine")
        if row["criterion"] == "overall"
    ]
    assert told_people == pytest.approx(people)


@pytest.mark.usefixtures("svg_alone")
def test_hostile_remarks_are_words_in_every_form(asked: Survey, tmp_path: Path) -> None:
    formula = "=cmd|' /C calc'!A0"
    given = {
        "1" * 64: {"a1.remarks": EVIL, "check": MATCHES[CHECK]},
        "2" * 64: {"a2.remarks": formula, "check": MATCHES[CHECK]},
    }
    analyse(answers_of_raters(asked, given, "people", 2), tmp_path)
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "<script" not in page
    assert "<img" not in page
    assert "alert(1)" in page
    assert [row["answer"] for row in rows(tmp_path / "answers.csv") if row["item"] == "a2"] == ["'" + formula]
    assert [row["remark"] for row in table(tmp_path, "remarks")] == [EVIL, "'" + formula]


def test_a_survey_that_nobody_answered_is_told(tmp_path: Path) -> None:
    folder = folder_of(survey(), tmp_path / "s")
    with pytest.raises(UsageError, match="nobody has been invited yet"):
        load_answers(folder)
    assert load_answers(folder, 5).source == "synthetic"
    assert not (folder / ANSWERS).exists(), "made-up raters never come near the answers"
    store = AnswerStore(folder / ANSWERS)
    rater = store.rater_of(store.add_rater())
    assert rater is not None
    with pytest.raises(UsageError, match="nobody has answered yet"):
        load_answers(folder)
    store.agree(rater)
    store.save(rater, {"a1.overall": MATCHES[4]})
    answers = load_answers(folder)
    store.close()
    assert [(row.source, row.score, row.attention) for row in answers.rows] == [("people", 5, "not answered")]
    assert answers.unchecked == {code_of(rater.digest)}
    with pytest.raises(UsageError, match="made-up raters are"):
        synthetic(survey(), 0)
