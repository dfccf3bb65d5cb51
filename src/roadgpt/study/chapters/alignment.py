"""Makes the section on alignment: whether roads keep the words, criterion by criterion."""

from collections.abc import Sequence

from roadgpt.report.page import Block, Details, Figure, Section, Table, TableCell, cell, linked
from roadgpt.report.page.forest import Share, forest
from roadgpt.study.chapters.wording import interval_cell, percent, plural
from roadgpt.study.criteria import ASKED, CRITERIA, Criterion
from roadgpt.study.road_record import StudyPartRecord
from roadgpt.study.statistics import Estimate, bootstrap, wilson

MOST_NAMED = 100


def kept(part: StudyPartRecord, criterion: Criterion) -> list[bool]:
    """Returns for each road whether it keeps a criterion; empty if the description does not ask for it.

    A missing road keeps nothing: a prompt without any road counts with as many roads as were asked for.
    """
    found = [road.kept[criterion] for road in part.roads if criterion in road.kept]
    return found if part.roads or criterion != "general" else [False] * part.wanted


def pooled(parts: Sequence[StudyPartRecord], designer: str, criterion: Criterion) -> Estimate:
    """Returns the share of roads that keep a criterion, with a bootstrap interval that resamples prompts."""
    groups = [kept(part, criterion) for part in parts if part.part.designer == designer]
    return bootstrap([[float(good) for good in group] for group in groups])


def alignment(parts: Sequence[StudyPartRecord], designers: Sequence[str]) -> Section:
    """Returns the section: shares by criterion and by prompt, and the roads that break a requirement."""
    some = [designer for designer in designers if any(p.roads for p in parts if p.part.designer == designer)]
    known = sum(part.part.prompt.truth is not None for part in parts if part.part.designer == designers[0])
    prompts = sum(part.part.designer == designers[0] for part in parts)
    truth = (
        "The truth of every prompt was written down by people."
        if known == prompts
        else "Nobody wrote down a truth, so roads are checked against what the reader read."
        if not known
        else f"For {known} of {prompts} prompts people wrote down a truth; for the others it is what the "
        "reader read."
    )
    blocks: list[Block] = [
        "Each requirement is measured on the finished road alone: turns, straights and grades of its centre "
        f"line. {truth}"
    ]
    if some:
        blocks += [_by_criterion(parts, some), _pooled(parts, some)]
    blocks += [_by_prompt(parts, designer) for designer in some]
    return Section("Alignment with the words", [*blocks, *_broken(parts)])


def _by_criterion(parts: Sequence[StudyPartRecord], designers: Sequence[str]) -> Figure:
    groups = []
    for criterion in CRITERIA:
        rows = []
        for series, designer in enumerate(designers):
            good = [g for part in parts if part.part.designer == designer for g in kept(part, criterion)]
            if good:
                share = sum(good) / len(good)
                text = f"{sum(good)} of {len(good)}"
                rows.append(Share(series, share, *wilson(sum(good), len(good)), text))
        if rows:
            groups.append((ASKED[criterion], rows))
    caption = "Roads that keep what was asked for, by criterion; lines are Wilson's 95 % intervals."
    return Figure("alignment", caption, forest(groups, list(designers), caption))


def _pooled(parts: Sequence[StudyPartRecord], designers: Sequence[str]) -> Table:
    rows: list[list[TableCell]] = []
    for designer in designers:
        for criterion in CRITERIA:
            asking = [p for p in parts if p.part.designer == designer and kept(p, criterion)]
            if not asking:
                continue
            good = [g for part in asking for g in kept(part, criterion)]
            found = pooled(parts, designer, criterion)
            rows.append(
                [
                    cell(designer),
                    cell(ASKED[criterion]),
                    cell(len(asking)),
                    cell(sum(good)),
                    cell(len(good)),
                    cell(round(found.value, 6), percent(found.value)),
                    interval_cell(wilson(sum(good), len(good))),
                    interval_cell(found.interval) if 0 < found.value < 1 and len(asking) > 1 else cell(None),
                ]
            )
    heads = [
        "made by", "criterion", "prompts", "kept", "roads", "share", "Wilson 95 %", "by prompt 95 %",
    ]  # fmt: skip
    note = (
        "Roads of one prompt are alike, so Wilson's interval is for these prompts only; "
        "the last column, a bootstrap that resamples whole prompts, is for other prompts like them. It is "
        "undefined if all or none are kept."
    )
    return Table("alignment", "What was asked for and kept, by criterion", heads, rows, note)


def _by_prompt(parts: Sequence[StudyPartRecord], designer: str) -> Table:
    rows = []
    for part in parts:
        if part.part.designer != designer:
            continue
        row = [
            cell(part.part.prompt.id),
            cell(part.part.prompt.prompt, href=part.overview if part.roads else ""),
        ]
        for criterion in CRITERIA:
            good = kept(part, criterion)
            row.append(
                cell(round(sum(good) / len(good), 6), f"{sum(good)} of {len(good)}") if good else cell(None)
            )
        rows.append([*row, cell(part.problem or "")])
    return Table(
        f"alignment-{designer}",
        f"{designer}: roads that keep the words, prompt by prompt",
        ["id", "prompt", *(criterion for criterion in CRITERIA), "remark"],
        rows,
    )


def _broken(parts: Sequence[StudyPartRecord]) -> list[Block]:
    lines: list[Block] = []
    for part in parts:
        for road in part.roads:
            wrong = [ASKED[criterion] for criterion, good in road.kept.items() if not good]
            if wrong:
                where = linked(f"{part.part.name}, road {road.index}", part.href(road))
                lines.append(
                    [where, f": {', '.join(name for name in wrong if 'general' not in name) or 'general'}"]
                )
    if not lines:
        return []
    title = f"Roads that break a requirement ({plural(len(lines), 'road')})"
    more: list[Block] = [f"… and {len(lines) - MOST_NAMED} more."] if len(lines) > MOST_NAMED else []
    return [Details(title, lines[:MOST_NAMED] + more)]
