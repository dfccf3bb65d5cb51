"""Formats numbers, shares, intervals and lists for reports."""

import math
from collections.abc import Iterable, Sequence
from itertools import count
from pathlib import PurePath

from roadgpt.plural import plural
from roadgpt.report.page.charts import Share
from roadgpt.report.page.model import Block, Details, Raw, TableCell, cell
from roadgpt.report.statistics import Interval, clopper_pearson, wilson

MOST_NAMED = 100  # lines of a list
SHARE_HEADS = ("of", "share", "Clopper-Pearson 95 %", "Wilson 95 %")
"""Table headings of the second to the fifth cell that ``share_cells`` returns."""


def p_value(p: float) -> str:
    """Returns a p-value as text: 'p = 0.010', 'p = 0.0004' or 'p < 0.0001'."""
    if p < 0.0001:
        return "p < 0.0001"
    return f"p = {p:.4f}" if p < 0.001 else f"p = {p:.3f}"


def as_sentence(text: str) -> str:
    """Returns text with a capital at its start and a full stop at its end."""
    return f"{text[:1].upper()}{text[1:]}."


def percent(share: float, digits: int = 1) -> str:
    """Returns a share (0 to 1) as text, such as '60.7 %'; a dash for NaN."""
    return "–" if math.isnan(share) else f"{100 * share:.{digits}f} %"


def driver_names(drivers: Iterable[str]) -> dict[str, str]:
    """Returns a name for each driver, with only as much of a file's path as tells the drivers apart."""
    parts = {driver: PurePath(driver).parts for driver in drivers}
    tails = ({driver: str(PurePath(*its[-n:])) for driver, its in parts.items()} for n in count(1))
    return next(tail for tail in tails if len({*tail.values()}) == len(parts))


def share_of(k: int, n: int) -> str:
    """Returns a count and its share as text, such as '182 of 300 (60.7 %)'."""
    return f"{k} of {n}" + (f" ({percent(k / n)})" if n else "")


def row(*values: Raw | TableCell) -> list[TableCell]:
    """Returns a table row. Each value is converted to a TableCell, unless it is one already."""
    return [value if isinstance(value, TableCell) else cell(value) for value in values]


def decimal(value: float | None, digits: int = 2, href: str = "") -> TableCell:
    """Returns a number as a table cell, with ``digits`` decimals; a dash for None, NaN and infinity."""
    if value is None or not math.isfinite(value):
        return cell(None)
    return cell(round(value, digits + 3), f"{value:z.{digits}f}".replace("-", "−"), href)


def share_cell(share: float, text: str = "") -> TableCell:
    """Returns a share (0 to 1) as a table cell: a number in CSV files; a text or a percentage on the page."""
    return cell(round(share, 6), text or percent(share))


def interval_cell(interval: Interval) -> TableCell:
    """Returns an interval of a proportion as a table cell: from 0 to 1 in CSV files, in % on the page."""
    low, high = interval
    return cell(f"{low:.4f} to {high:.4f}", f"{100 * low:.1f} to {100 * high:.1f} %")


def share_cells(k: int, n: int, href: str = "") -> list[TableCell]:
    """Returns k, n, k / n, Clopper and Pearson's interval, and Wilson's interval as table cells."""
    if not n:
        return [cell(k, href=href), *row(n, None, None, None)]
    exact, score = interval_cell(clopper_pearson(k, n)), interval_cell(wilson(k, n))
    return [cell(k, href=href), *row(n, share_cell(k / n), exact, score)]


def drawn_share(series: int, k: int, n: int, text: str = "") -> Share:
    """Returns a row of a forest plot: k / n with Wilson's interval, and a text, by default 'k of n'."""
    return Share(series, k / n, *wilson(k, n), text or f"{k} of {n}")


def folded(title: str, lines: Sequence[Block]) -> list[Block]:
    """Returns a collapsible block with a line for each of at most 100 roads, if there are any."""
    if not lines:
        return []
    more = [f"… and {len(lines) - MOST_NAMED} more."] if len(lines) > MOST_NAMED else []
    return [Details(f"{title} ({plural(len(lines), 'road')})", [*lines[:MOST_NAMED], *more])]
