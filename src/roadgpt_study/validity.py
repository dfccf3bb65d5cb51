"""Compares the validity and the lane departures of roads between the descriptions of a study, and with the
counts of RoadGPT's thesis."""

from collections.abc import Sequence

from roadgpt.report.chapters import validity as chapter
from roadgpt.report.chapters.roads import named_roads
from roadgpt.report.chapters.validity import (
    KINDS,
    LEFT,
    Count,
    Kind,
    Parts,
    Passed,
    Source,
    outside_table,
    shares_forest,
    shares_table,
    source_of,
)
from roadgpt.report.chapters.wording import decimal, folded, p_value, row
from roadgpt.report.page.model import Block, Details, Section, Table, TableCell, cell
from roadgpt.report.road_record import RoadGroup
from roadgpt.report.statistics import LEVEL, ChiSquared, chi_squared
from roadgpt_study.statistics import exact, trend

NAME = "RoadGPT's thesis"
ROADS = 100  # of every prompt
LONG = "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn"
THESIS = {"a road": (88, 1), "an uphill road with 3 turns": (57, 2), LONG: (37, 5)}
"""For each prompt, in the order of the thesis' table 6.1: the number of valid roads among 100, and the number
of these valid roads on which the car left its lane."""
THESIS_VALID = Source(
    f"{NAME}, its own checks",
    tuple(Count(prompt, valid, ROADS) for prompt, (valid, _) in THESIS.items()),
    "thesis",
)
THESIS_LEFT = Source(
    NAME, tuple(Count(prompt, left, valid) for prompt, (valid, left) in THESIS.items()), "thesis"
)


def of_thesis(parts: Parts) -> list[RoadGroup]:
    """Returns the study parts with prompts for which the thesis gives results."""
    return [part for part in parts if part.words in THESIS]


def validity(parts: Parts, designers: Sequence[str], has_baseline: bool = False) -> Section:
    """Returns the section on validity by each rule set. With ``has_baseline``, only prompts of the thesis are
    counted, beside the thesis' numbers."""
    every = [
        source
        for designer in designers
        for kind in KINDS
        if (source := _counted(designer, parts, kind, has_baseline)).counts
    ]
    every += [THESIS_VALID] if has_baseline else []
    blocks: list[Block] = []
    if has_baseline:
        blocks += [_beside(source) for source in every if source.slug.endswith("-strict")]
    others: list[Block] = []
    for source in every:
        if len(source.counts) > 1:
            into = others if source.slug.endswith(("-sound", "-sbft")) else blocks
            into += chi_squared_blocks(source, "valid", "invalid", f"validity-{source.slug}")
    blocks += [Details("The same by the other rules", others)] if others else []
    return chapter.validity(parts, every, blocks)


def departures(
    parts: Parts, designers: Sequence[str], passed: Sequence[Passed], has_baseline: bool = False
) -> Section:
    """Returns the section on lane departures on valid roads, and on how far outside its lane the car was in
    tests that it ``passed``; ``has_baseline`` is as in ``validity``."""
    every = [
        source for designer in designers if (source := _counted(designer, parts, LEFT, has_baseline)).total
    ]
    blocks: list[Block] = [] if every else ["These roads were not driven."]
    every += [THESIS_LEFT] if has_baseline else []
    if every:
        aside = " (in the thesis: by its own checks)" if has_baseline else ""
        blocks += [
            f"Drives on which the car left its lane, on roads that are valid by the strict rules{aside}.",
            shares_forest("departures", "on which the car left its lane", every),
            shares_table("departures", "left", every),
        ]
    for source in every:
        if len(source.counts) > 1:
            blocks += chi_squared_blocks(source, "left", "kept", f"departures-{source.slug}")
    left = named_roads(parts, lambda road: road.result.description if road.has_left else "")
    return Section("Leaving the lane", [*blocks, *outside_table(passed), *folded("Drives that left", left)])


def _counted(designer: str, parts: Parts, kind: Kind, has_baseline: bool) -> Source:
    return source_of(designer, of_thesis(parts) if has_baseline else parts, kind)


def _beside(source: Source) -> str:
    table = [[each.hits, each.total - each.hits] for each in (source, THESIS_VALID)]
    return (
        f"{source.name}: {source.share} against {THESIS_VALID.share} of {NAME}; Fisher's exact test "
        f"{p_value(exact(table).p)}. The rules differ, and ours are stricter."
    )


def chi_squared_blocks(source: Source, hit: str, miss: str, name: str) -> list[Block]:
    """Returns a table and a paragraph with the test results. The table has the counts in the columns ``hit``
    and ``miss``, the expected counts, and the chi-squared terms."""
    found = chi_squared(_contingency(source))
    return [_table(source, found, hit, miss, name), _verdict(source, found, hit, miss)]


def _contingency(source: Source) -> list[list[int]]:
    """Returns the table ``(prompts, 2)``: roads with the property, and without it."""
    return [[count.hits, count.total - count.hits] for count in source.counts]


def _table(source: Source, found: ChiSquared, hit: str, miss: str, name: str) -> Table:
    heads = ["prompt", hit, miss, "total"]
    heads += [f"expected {each}" for each in (hit, miss)] + [f"(o − e)²/e {each}" for each in (hit, miss)]
    rows: list[Sequence[TableCell]] = []
    for count, expected, terms in zip(source.counts, found.expected, found.terms, strict=True):
        own = row(cell(count.hits, href=count.href), count.total - count.hits, count.total)
        rows.append(row(count.prompt, *own, *map(decimal, (*expected.tolist(), *terms.tolist()))))
    sums = [source.hits, source.total - source.hits, source.total]
    blank = cell(None, "")
    rows.append(row("total", *sums, blank, blank, cell(None, "χ² ="), decimal(found.statistic)))
    return Table(name, f"{source.name}: {hit} by prompt, and chi-squared term by term", heads, rows, "", True)


def _verdict(source: Source, found: ChiSquared, hit: str, miss: str) -> str:
    if not source.total:
        return f"{source.name}: no roads to count."
    if not found.freedom and 0 < source.hits < source.total:
        return f"{source.name}: only one prompt has roads to count, so there is nothing to compare it with."
    if not found.freedom:
        every = f"all roads are {hit if source.hits else miss}"
        return (
            f"{source.name}: {every}, so no prompt differs from another: chi-squared is 0 with no degrees of "
            "freedom, Cramér's V is 0, and the exact test gives p = 1. The "
            "intervals show what the true shares may be."
        )
    counted = exact(_contingency(source))
    how = f"drawn {counted.tables:,} times from a seed" if counted.is_drawn else "counted out"
    z, p_of_trend = trend([count.hits for count in source.counts], [count.total for count in source.counts])
    against = "exceeds" if found.statistic > found.critical else "does not exceed"
    sound = (
        "Cochran's rule on expected counts holds."
        if found.is_sound
        else f"Expected counts are small (least {found.expected[found.expected > 0].min():.2f}): Cochran's "
        "rule is broken, and the exact test decides."
    )
    p = found.p if found.is_sound else counted.p
    end = "the prompt makes a difference" if p < LEVEL else "no difference between prompts is shown"
    return (
        f"{source.name}: χ² = {found.statistic:.2f} with {found.freedom} degrees of freedom {against} the "
        f"critical value {found.critical:.2f} at the {100 * LEVEL:.0f} % level ({p_value(found.p)}); "
        f"Cramér's V = {found.cramers_v:.2f}. Exact test ({how}): {p_value(counted.p)}. "
        f"Trend in the order of the table (Cochran-Armitage): z = {z:.2f}, {p_value(p_of_trend)}. "
        f"{sound} So {end}."
    ).replace("z = -", "z = −")
