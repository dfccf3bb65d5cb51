"""Checks with contingency tables, as in the thesis, whether the share of roads with a property (such as valid
roads) depends on the description."""

from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.report.page import Block, Table, TableCell, cell
from roadgpt.study.chapters.wording import decimal, p_value, row
from roadgpt.study.statistics import LEVEL, ChiSquared, chi_squared, exact, trend


class Count(NamedTuple):
    """The number of roads of one prompt that have a property, such as being valid."""

    prompt: str
    hits: int
    """Number of roads with the property."""
    total: int
    """Number of all roads of the prompt, with and without the property."""
    href: str = ""
    """Address of the picture or table of these roads; empty for no link."""


class Source(NamedTuple):
    """The counts of one designer, or of the thesis, with one Count for each prompt."""

    name: str
    counts: tuple[Count, ...]
    slug: str
    """The name of the designer or of the thesis, as it is used in file names."""

    @property
    def hits(self) -> int:
        """Number of roads that have the property, summed over all prompts."""
        return sum(count.hits for count in self.counts)

    @property
    def total(self) -> int:
        """Number of all roads, summed over all prompts."""
        return sum(count.total for count in self.counts)

    def table(self) -> list[list[int]]:
        """Returns the contingency table ``(prompts, 2)``: the number of roads with the property, and the
        number without it."""
        return [[count.hits, count.total - count.hits] for count in self.counts]


def chi_squared_blocks(source: Source, hit: str, miss: str, name: str) -> list[Block]:
    """Returns the contingency table with expected counts and the chi-squared terms of its cells, and a
    paragraph with the test results.

    Args:
        source: the counts of one designer or of the thesis.
        hit: column heading for roads that have the property.
        miss: column heading for roads that do not have the property.
        name: name of the table's files.
    """
    found = chi_squared(source.table())
    return [_table(source, found, hit, miss, name), _verdict(source, found, hit, miss)]


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
    counted = exact(source.table())
    how = f"drawn {counted.tables:,} times from a seed" if counted.is_drawn else "counted out"
    slope = trend([count.hits for count in source.counts], [count.total for count in source.counts])
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
        f"Trend in the order of the table (Cochran-Armitage): z = {slope.z:.2f}, {p_value(slope.p)}. "
        f"{sound} So {end}."
    ).replace("z = -", "z = −")
