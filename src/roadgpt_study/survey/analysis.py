"""Analyses a survey: makes figures, tables and a report from the answers of people or of simulated raters."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from math import isfinite
from pathlib import Path

import numpy as np

from roadgpt import __version__
from roadgpt.errors import RoadGPTError, UsageError, command_line, explained
from roadgpt.report.chapters.wording import row
from roadgpt.report.page import unformulated, write
from roadgpt.report.page.model import Block, Details, Figure, Page, Section, Table, TableCell, cell
from roadgpt.report.statistics import LEVEL, friedman, wilcoxon, wilson
from roadgpt.run.atomic import csv_text, write_whole
from roadgpt_study.statistics import conover, spearman
from roadgpt_study.survey.answers import (
    AnswerRow,
    Answers,
    RatingTally,
    Unit,
    about_counts,
    alpha_of,
    answers_of_raters,
    score_matrix,
    synthetic,
    tally,
)
from roadgpt_study.survey.rating_charts import about_bars, rating_bars
from roadgpt_study.survey.store import ANSWERS, AnswerStore
from roadgpt_study.survey.survey import REMARKS, read_survey

FIGURES = "figures"
TABLES = {"people": "answers.csv", "synthetic": "answers-synthetic.csv"}
NAMES = {"alignment": "road and description", "similarity": "two roads"}
TESTS = (
    "Friedman with Conover's post-hoc test (Holm), Wilcoxon, Spearman; Krippendorff's alpha, ordinal; "
    "intervals of shares: Wilson, 95 %"
)
FAVOURABLE = 4  # lowest score that is in favour of the road, or of the two roads being similar
MADE_UP = "SYNTHETIC: made-up raters. Nobody was asked; this tries out the analysis and contains no data."


def load_answers(
    folder: Path | str, number: int | None = None, seed: int = 0, agreement: float = 0.8
) -> Answers:
    """Returns the answers that people gave to a survey, or those of a ``number`` of simulated raters."""
    folder = Path(folder)
    survey = read_survey(folder)
    if number is not None:
        return synthetic(survey, number, seed, agreement)
    if not (folder / ANSWERS).is_file():
        invite = command_line("study", "survey", "serve", folder, "--raters", 10)
        raise UsageError(f"nobody has been invited yet; invite some: {invite}")
    with closing(AnswerStore(folder / ANSWERS)) as store:
        raters = store.raters()
        given = {rater.digest: store.answers_of(rater) for rater in raters if rater.state == "agreed"}
    withdrawn = sum(rater.state == "withdrawn" for rater in raters)
    answers = answers_of_raters(survey, given, "people", len(raters), withdrawn)
    if not answers.rows:
        raise UsageError(
            f"nobody has answered yet ({answers.agreed} of {answers.invited} agreed to take part); "
            "--synthetic 30 tries out the analysis with made-up raters"
        )
    return answers


def analyse(answers: Answers, out: Path | str, command: str = "") -> Path:
    """Writes ``report.html``, the answers as CSV, ``tables/`` and ``figures/`` into a folder, which holds
    either answers of people or of simulated raters; returns the path of the HTML page."""
    out = Path(out)
    other = TABLES["people" if answers.source == "synthetic" else "synthetic"]
    if (out / other).exists():
        raise UsageError(
            f"{out} holds an analysis of {'people' if answers.source == 'synthetic' else 'made-up raters'}; "
            "the two are kept apart, so name another folder with --out"
        )
    with explained(RoadGPTError, f"cannot write into {out}", "name another folder with --out"):
        (out / FIGURES).mkdir(parents=True, exist_ok=True)
        rows = ([unformulated(value) for value in row] for row in answers.rows)
        write_whole(out / TABLES[answers.source], csv_text(AnswerRow._fields, rows), is_private=True)
        page = page_of(answers, out / FIGURES, command)
    return write(page, out)


def page_of(answers: Answers, figures: Path, command: str = "") -> Page:
    """Returns the report as a page, and writes its figures into the folder ``figures``, which must exist."""
    is_synthetic = answers.source == "synthetic"
    match, alike = tally(answers, "alignment"), tally(answers, "similarity")
    counts = about_counts(answers)
    who: list[Block] = [_raters(answers)]
    if counts:
        said = [row(text, answer, count) for text, each in counts for answer, count in each if count]
        table = Table("about", "Who answered", ("question", "answer", "raters"), said)
        who += [about_bars(counts, figures, is_synthetic), Details("The same as a table", [table])]
    sections = [Section("Who answered", who)]
    titles = (("Do roads match their descriptions?", match), ("How similar are two roads?", alike))
    for title, found in titles:
        if found.units:
            drawn, table = rating_bars(found, figures, is_synthetic), _ratings(found)
            sections.append(Section(title, [drawn, table, *_differences(found)]))
    sections += [
        Section("Do raters agree?", [_agreements([match, alike])]),
        Section("People and measurements", _measurements([match, alike])),
        Section("Remarks", [_remarks(answers)]),
    ]
    if is_synthetic:
        sections = [Section(each.title, [*map(_marked, each.blocks)]) for each in sections]
    return Page(
        title=f"{'SYNTHETIC: ' if is_synthetic else ''}{answers.survey.title}",
        lead=MADE_UP if is_synthetic else "The answers of people.",
        summary=[*([MADE_UP] if is_synthetic else []), *_summary(answers, match, alike)],
        sections=sections,
        card={
            "asked by": answers.survey.asks,
            "answers of": "made-up raters" if is_synthetic else "people",
            "tests": TESTS,
            "RoadGPT": __version__,
            **({"command": command} if command else {}),
        },
    )


def _marked(block: Block) -> Block:
    """Returns a copy of a block in which tables and figures, but not text, are marked as synthetic."""
    if isinstance(block, Details):
        return replace(block, blocks=[*map(_marked, block.blocks)])
    if not isinstance(block, Table | Figure):
        return block
    name = f"synthetic-{block.name}" if isinstance(block, Table) else block.name
    return replace(block, name=name, caption=f"SYNTHETIC (made-up raters): {block.caption}")


def _summary(answers: Answers, match: RatingTally, alike: RatingTally) -> list[str]:
    lines = [
        f"The answers of {len(answers.analysed)} raters are analysed; {answers.finished} of them rated "
        f"everything. {len(answers.failed)} failed the attention check and are left out."
    ]
    ratings = ((match, "that roads match their descriptions"), (alike, "that two roads are similar"))
    for found, says in ratings:
        scores = [score for unit in found.overall for score in unit.given]
        if scores:
            share, alpha = sum(score >= FAVOURABLE for score in scores) / len(scores), alpha_of(found.overall)
            agreed = f"; Krippendorff's alpha is {_number(alpha)}" if isfinite(alpha) else ""
            lines.append(
                f"Overall, {share:.0%} of {len(scores)} ratings say {says} (one of the two highest answers)"
                f"{agreed}."
            )
    return lines


def _raters(answers: Answers) -> Table:
    numbers = {
        "links given or taken": answers.invited,
        "agreed to take part": answers.agreed,
        "withdrew; their answers are deleted": answers.withdrawn,
        "failed the attention check; left out below": len(answers.failed),
        "left the attention check out; analysed": len(answers.unchecked),
        "analysed": len(answers.analysed),
        "of these, rated everything": answers.finished,
    }
    return Table("raters", "Raters", ("", "number"), [row(*each) for each in numbers.items()])


def _ratings(found: RatingTally) -> Table:
    answers = found.units[0].question.answers
    firsts = {unit.item.id: unit.question.id for unit in reversed(found.units)}
    rows = [_rating(unit, firsts[unit.item.id] == unit.question.id) for unit in found.units]
    heads = [
        "item", "description", "criterion", "n", *"12345", "median", "quartiles", "4 or 5", "95 %",
    ]  # fmt: skip
    scale = "; ".join(f"{number}: {answer}" for number, answer in enumerate(answers, 1))
    return Table(f"{found.part}-ratings", f"Ratings: {NAMES[found.part]}", heads, rows, scale)


def _rating(unit: Unit, is_first: bool) -> list[TableCell]:
    """Returns a row; the description is shown once for each item."""
    item = [cell(text, text if is_first else "") for text in (unit.item.id, unit.item.prompt)]
    counts = row(*item, unit.criterion, unit.number, *unit.counts)
    if not unit.number:
        return [*counts, *row(None, None, None, None)]
    low, middle, high = np.quantile(unit.given, [0.25, 0.5, 0.75]).tolist()
    count = int((unit.given >= FAVOURABLE).sum())
    share, (lo, hi) = count / unit.number, wilson(count, unit.number)
    favourable = (cell(round(share, 4), f"{share:.0%}"), f"{lo:.0%} to {hi:.0%}")
    return [*counts, *row(_rounded(middle, 1), f"{low:g} to {high:g}", *favourable)]


def _differences(found: RatingTally) -> list[Block]:
    """Returns whether the overall ratings differ between items: by Wilcoxon's test of two items, or
    Friedman's test of more and then Conover's test for each pair."""
    units = found.overall
    if len(units) < 2 or not found.raters:
        return ["One item alone cannot be compared with others."]
    scores = score_matrix(units)
    if len(units) == 2:
        paired = wilcoxon(scores[:, 0], scores[:, 1])
        return [
            f"The two{_verdict(paired.p)} in general: Wilcoxon's signed-rank test of "
            f"{paired.pairs} raters, p {_p(paired.p)}, rank-biserial correlation {paired.effect:.2f}."
        ]
    test = friedman(scores)
    if test.people < 2:
        return ["Fewer than two raters rated all of them, so they cannot be compared."]
    line = (
        f"The items{_verdict(test.p)} in general: Friedman's test of the {test.people} raters who "
        f"rated all, chi-squared({test.freedom}) = {test.statistic:.2f}, p {_p(test.p)}, "
        f"Kendall's W = {test.kendalls_w:.2f}."
    )
    if test.p >= LEVEL:  # pairs are compared only where the items differ at all (Conover 1999, 5.8)
        return [f"{line} So pairs of them are not compared."]
    names, rows = [unit.item.id for unit in units], list[list[TableCell]]()
    for name, own in zip(names, conover(scores).tolist(), strict=True):
        cells = [cell(p, _p(p).removeprefix("= ")) for p in own[: len(rows)]]
        rows.append(row(name, *cells, *[""] * (len(names) - len(cells))))
    caption = "p of every pair after Friedman's test (Conover, corrected by Holm)"
    return [line, Table(f"{found.part}-pairs", caption, ("", *names), rows)]


def _agreements(tallies: Sequence[RatingTally]) -> Table:
    rows = []
    for found in tallies:
        groups = [(criterion, found.of(criterion)) for criterion in found.criteria]
        for name, units in [*groups, *([("all ratings", found.units)] if found.units else [])]:
            number = sum(unit.number for unit in units)
            rows.append(row(NAMES[found.part], name, len(units), number, _rounded(alpha_of(units))))
    return Table(
        "agreement",
        "Agreement between raters: Krippendorff's alpha (ordinal)",
        ("part", "criterion", "items", "ratings", "alpha"),
        rows,
        "1: all raters agree; 0: as by chance; below 0: less than by chance. A dash: one item only, or "
        "all ratings are the same, so alpha is undefined. Krippendorff asks for 0.8, and 0.667 for "
        "tentative conclusions.",
    )


def _measurements(tallies: Sequence[RatingTally]) -> list[Block]:
    blocks: list[Block] = []
    heads = ("item", "description", "criterion", "people, mean of 1 to 5", "machine, 0 to 1")
    for found in tallies:
        units = [unit for unit in found.units if unit.measured is not None and unit.number]
        if not units:
            continue
        people = [float(unit.given.mean()) for unit in units]
        machine = [float(unit.measured or 0.0) for unit in units]
        correlation = spearman(people, machine)
        rows = [
            row(u.item.id, u.item.prompt, u.criterion, cell(one, f"{one:.2f}"), cell(two, f"{two:.2f}"))
            for u, one, two in zip(units, people, machine, strict=True)
        ]
        line = "the scores of people or the measured scores are all equal, or too few for a correlation."
        if isfinite(correlation.rho):
            line = (
                f"Spearman's rho is {correlation.rho:.2f} over {correlation.pairs} questions, each with "
                f"people's mean (p {_p(correlation.p)}, as if questions were independent; those "
                "about one road are not)."
            )
        name = NAMES[found.part]
        table = Table(f"{found.part}-machine", f"People and measurements: {name}", heads, rows)
        blocks += [f"{name.capitalize()}: {line}", table]
    return blocks or ["None of the criteria that people rated was measured."]


def _remarks(answers: Answers) -> Block:
    rows = [
        row(each.item or "at the end", each.prompt, each.answer)
        for each in sorted(answers.used, key=lambda each: (each.item, each.rater))
        if each.question.endswith(f".{REMARKS}")
    ]
    if not rows:
        return "There are no remarks."
    return Table("remarks", f"{len(rows)} remarks", ("item", "description", "remark"), rows)


def _verdict(p: float) -> str:
    return " differ" if p < LEVEL else " do not differ significantly"


def _rounded(value: float, digits: int = 2) -> TableCell:
    return cell(round(value, 4) if isfinite(value) else None, _number(value, digits))


def _number(value: float, digits: int = 2) -> str:
    return f"{value:z.{digits}f}" if isfinite(value) else "–"


def _p(value: float) -> str:
    return "< 0.001" if value < 0.001 else f"= {value:.3f}"
