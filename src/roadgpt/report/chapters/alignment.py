"""Makes the section on alignment: how many roads meet their descriptions, criterion by criterion."""

from collections.abc import Callable, Sequence

from roadgpt.check.truth import ASKED, CRITERIA
from roadgpt.report.chapters.roads import named_roads
from roadgpt.report.chapters.wording import drawn_share, folded, interval_cell, row, share_cell
from roadgpt.report.page.charts import forest
from roadgpt.report.page.model import Block, Figure, Section, Table, TableCell, cell
from roadgpt.report.road_record import RoadGroup, RoadRecord
from roadgpt.report.statistics import Interval, wilson

Parts = Sequence[RoadGroup]
OfPrompts = Callable[[Sequence[Sequence[bool]]], Interval]
"""Returns an interval for other prompts like these, of each of which it is told which roads are kept."""


def alignment(parts: Parts, designers: Sequence[str], of_prompts: OfPrompts | None = None) -> Section:
    """Returns the section on alignment: the percentage of roads that meet each criterion, in total and by
    prompt, and a list of roads that miss a requirement. Several prompts need ``of_prompts``."""
    some = [designer for designer in designers if any(part.roads for part in _of(parts, designer))]
    prompts = [part.truth for part in _of(parts, designers[0])]
    known = sum(truth is not None for truth in prompts)
    truth = (
        "The truth of every prompt was written down by people."
        if known == len(prompts)
        else "Nobody wrote down a truth, so roads are checked against what the reader read."
        if not known
        else f"For {known} of {len(prompts)} prompts people wrote down a truth; for the others it is what "
        "the reader read."
    )
    blocks: list[Block] = [
        "Each requirement is measured on the finished road alone: turns, straights and grades of its centre "
        f"line. {truth}"
    ]
    if some:
        blocks += [_by_criterion(parts, some), _pooled(parts, some, of_prompts)]
    blocks += [_by_prompt(_of(parts, designer), designer) for designer in some]
    broken = folded("Roads that break a requirement", named_roads(parts, _broken))
    return Section("Alignment with the words", [*blocks, *broken])


def _of(parts: Parts, designer: str) -> list[RoadGroup]:
    return [part for part in parts if part.designer == designer]


def _by_criterion(parts: Parts, designers: Sequence[str]) -> Figure:
    groups = []
    for criterion in CRITERIA:
        rows = []
        for series, designer in enumerate(designers):
            good = [kept for part in _of(parts, designer) for kept in part.kept(criterion)]
            if good:
                rows.append(drawn_share(series, sum(good), len(good)))
        if rows:
            groups.append((ASKED[criterion], rows))
    caption = "Roads that keep what was asked for, by criterion; lines are Wilson's 95 % intervals."
    return Figure("alignment", caption, forest(groups, list(designers), caption))


def _pooled(parts: Parts, designers: Sequence[str], of_prompts: OfPrompts | None) -> Table:
    rows: list[list[TableCell]] = []
    for designer in designers:
        for criterion in CRITERIA:
            asking = [kept for part in _of(parts, designer) if (kept := part.kept(criterion))]
            if not asking:
                continue
            good, every = sum(map(sum, asking)), sum(map(len, asking))
            by_prompt = None
            if of_prompts and 0 < good < every and len(asking) > 1:
                by_prompt = interval_cell(of_prompts(asking))
            shares = [share_cell(good / every), interval_cell(wilson(good, every)), by_prompt]
            rows.append(row(designer, ASKED[criterion], len(asking), good, every, *shares))
    heads = [
        "made by", "criterion", "prompts", "kept", "roads", "share", "Wilson 95 %", "by prompt 95 %",
    ]  # fmt: skip
    note = (
        "Roads of one prompt are alike, so Wilson's interval is for these prompts only; "
        "the last column, a bootstrap that resamples whole prompts, is for other prompts like them. It is "
        "undefined if all or none are kept."
    )
    return Table("alignment", "What was asked for and kept, by criterion", heads, rows, note)


def _by_prompt(parts: Parts, designer: str) -> Table:
    rows = []
    for part in parts:
        every = [part.kept(criterion) for criterion in CRITERIA]
        shares = [
            share_cell(sum(good) / len(good), f"{sum(good)} of {len(good)}") if good else None
            for good in every
        ]
        words = cell(part.words, href=part.overview if part.roads else "")
        rows.append(row(part.id, words, *shares, part.problem or ""))
    caption = f"{designer}: roads that keep the words, prompt by prompt"
    return Table(f"alignment-{designer}", caption, ["id", "prompt", *CRITERIA, "remark"], rows)


def _broken(road: RoadRecord) -> str:
    wrong = [criterion for criterion, good in road.kept.items() if not good]
    names = [ASKED[criterion] for criterion in wrong if criterion != "general"]
    return ", ".join(names or wrong)
