"""Analyses a survey: makes figures, tables and a report from the answers of people or of simulated raters."""

from pathlib import Path

from roadgpt import __version__
from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.report.page import Block, Page, Section, write
from roadgpt.run.atomic import write_whole
from roadgpt.study.survey import report_blocks
from roadgpt.study.survey.answers import Answers, answers_in, csv_of, synthetic
from roadgpt.study.survey.rating_charts import about_bars, rating_bars
from roadgpt.study.survey.store import ANSWERS, AnswerStore
from roadgpt.study.survey.survey import read_survey
from roadgpt.study.survey.tally import about_counts, tally

FIGURES = "figures"
TABLES = {"people": "answers.csv", "synthetic": "answers-synthetic.csv"}
MADE_UP = "SYNTHETIC: made-up raters. Nobody was asked; this tries out the analysis and contains no data."


def load_answers(
    folder: Path | str, number: int | None = None, seed: int = 0, agreement: float = 0.8
) -> Answers:
    """Returns the answers that people gave to a survey, or answers of simulated raters.

    If raters are simulated, the file with people's answers is not opened.

    Args:
        folder: the survey's folder.
        number: number of simulated raters; None: the answers of people are returned.
        seed: seed of the simulated raters.
        agreement: probability that a simulated rater gives the true answer, 0 to 1; see ``synthetic``.

    Raises:
        UsageError: there is no survey, or nobody has answered yet.
    """
    folder = Path(folder)
    survey = read_survey(folder)
    if number is not None:
        return synthetic(survey, number, seed, agreement)
    if not (folder / ANSWERS).is_file():
        raise UsageError(f"nobody has been invited yet; run: roadgpt study survey serve {folder} --raters 10")
    store = AnswerStore(folder / ANSWERS)
    try:
        answers = answers_in(store, survey)
    finally:
        store.close()
    if not answers.rows:
        raise UsageError(
            f"nobody has answered yet ({answers.agreed} of {answers.invited} agreed to take part); "
            "--synthetic 30 tries out the analysis with made-up raters"
        )
    return answers


def analyse(answers: Answers, out: Path | str, command: str = "") -> Path:
    """Writes ``report.html``, ``report.md``, the answers as CSV, ``tables/`` and ``figures/`` into a folder.

    Args:
        answers: the answers.
        out: the folder for the analysis, which is created if it does not exist.
        command: the command that repeats the analysis, as shown in the report; empty: none is shown.

    Returns:
        The path of the HTML page.

    Raises:
        UsageError: the folder contains an analysis of simulated raters and the answers are those of people,
            or the other way round.
        RoadGPTError: a file cannot be written.
    """
    out = Path(out)
    other = TABLES["people" if answers.source == "synthetic" else "synthetic"]
    if (out / other).exists():
        raise UsageError(
            f"{out} holds an analysis of {'people' if answers.source == 'synthetic' else 'made-up raters'}; "
            "the two are kept apart, so name another folder with --out"
        )
    with explained(RoadGPTError, f"cannot write into {out}", "name another folder with --out"):
        (out / FIGURES).mkdir(parents=True, exist_ok=True)
        write_whole(out / TABLES[answers.source], csv_of(answers.rows), is_private=True)
        page = page_of(answers, out / FIGURES, command)
    return write(page, out)


def page_of(answers: Answers, figures: Path, command: str = "") -> Page:
    """Returns the report as a page, and writes its figures into the folder ``figures``, which must exist."""
    is_synthetic = answers.source == "synthetic"
    match, alike = tally(answers, "alignment"), tally(answers, "similarity")
    counts = about_counts(answers)
    who: list[Block] = [report_blocks.raters(answers)]
    if counts:
        who += [about_bars(counts, figures, is_synthetic), report_blocks.about(counts)]
    sections = [Section("Who answered", who)]
    for title, found in (
        ("Do roads match their descriptions?", match),
        ("How similar are two roads?", alike),
    ):
        if found.units:
            drawn, table = rating_bars(found, figures, is_synthetic), report_blocks.ratings(found)
            sections.append(Section(title, [drawn, table, *report_blocks.differences(found)]))
    sections += [
        Section("Do raters agree?", [report_blocks.agreements([match, alike])]),
        Section("People and measurements", report_blocks.measurements([match, alike])),
        Section("Remarks", [report_blocks.remarks(answers)]),
    ]
    if is_synthetic:
        sections = [Section(each.title, [*map(report_blocks.marked, each.blocks)]) for each in sections]
    return Page(
        title=f"{'SYNTHETIC: ' if is_synthetic else ''}{answers.survey.title}",
        lead=MADE_UP if is_synthetic else "The answers of people.",
        summary=[*([MADE_UP] if is_synthetic else []), *report_blocks.summary(answers, match, alike)],
        sections=sections,
        card=_card(answers, command),
    )


def _card(answers: Answers, command: str) -> dict[str, str]:
    return {
        "asked by": answers.survey.asks,
        "answers of": "made-up raters" if answers.source == "synthetic" else "people",
        "tests": "Friedman with Conover's post-hoc test (Holm), Wilcoxon, Spearman; Krippendorff's alpha, "
        "ordinal; intervals of shares: Wilson, 95 %",
        "RoadGPT": __version__,
        **({"command": command} if command else {}),
    }
