"""Formats numbers, intervals and lists for reports."""

import math
from collections.abc import Sequence

from roadgpt.report.page import Block, Details, TableCell, cell
from roadgpt.report.page.forest import Share
from roadgpt.report.page.model import Raw
from roadgpt.study.statistics import Interval, clopper_pearson, wilson

MOST_NAMED = 100  # lines of a list
SHARE_HEADS = ("of", "share", "Clopper-Pearson 95 %", "Wilson 95 %")
"""Headings of the cells of ``share_cells``, after the first."""


def p_value(p: float) -> str:
    """Formats a p-value: 'p = 0.010', 'p < 1e-15'."""
    if p < 1e-15:
        return "p < 1e-15"
    return f"p = {p:.1e}" if p < 0.001 else f"p = {p:.3f}"


def percent(share: float, digits: int = 1) -> str:
    """Formats a share as '60.7 %'; NaN as a dash."""
    return "–" if math.isnan(share) else f"{100 * share:.{digits}f} %"


def share_of(k: int, n: int) -> str:
    """Formats a count as '182 of 300 (60.7 %)'."""
    return f"{k} of {n}" + (f" ({percent(k / n)})" if n else "")


def plural(n: int, word: str) -> str:
    """Formats a count with its noun: '1 road', '2 roads'."""
    return f"{n:,} {word}{'' if n == 1 else 's'}"


def row(*values: Raw | TableCell) -> list[TableCell]:
    """Returns a row of a table; values that are no cells yet become cells."""
    return [value if isinstance(value, TableCell) else cell(value) for value in values]


def decimal(value: float | None, digits: int = 2, href: str = "") -> TableCell:
    """Returns a table cell with a rounded number; None and NaN become a dash."""
    if value is None or not math.isfinite(value):
        return cell(None)
    return cell(round(value, digits + 3), f"{value:z.{digits}f}".replace("-", "−"), href)


def share_cell(share: float, text: str = "") -> TableCell:
    """Returns a share as a cell: a number from 0 to 1 in CSV; on the page the text, or percent."""
    return cell(round(share, 6), text or percent(share))


def interval_cell(interval: Interval) -> TableCell:
    """Returns an interval of shares as a cell: from 0 to 1 in CSV, percent on the page."""
    low, high = interval
    return cell(f"{low:.4f} to {high:.4f}", f"{100 * low:.1f} to {100 * high:.1f} %")


def share_cells(k: int, n: int, href: str = "") -> list[TableCell]:
    """Returns the cells k, n, share, Clopper and Pearson's interval, and Wilson's interval."""
    if not n:
        return [cell(k, href=href), *row(n, None, None, None)]
    exact, score = interval_cell(clopper_pearson(k, n)), interval_cell(wilson(k, n))
    return [cell(k, href=href), *row(n, share_cell(k / n), exact, score)]


def drawn_share(series: int, k: int, n: int, text: str = "") -> Share:
    """Returns the share k of n as a row of a forest plot: with Wilson's interval and 'k of n' beside it."""
    return Share(series, k / n, *wilson(k, n), text or f"{k} of {n}")


def folded(title: str, lines: Sequence[Block]) -> list[Block]:
    """Returns the first 100 lines about roads, folded under a title with their number; empty if none."""
    if not lines:
        return []
    more = [f"… and {len(lines) - MOST_NAMED} more."] if len(lines) > MOST_NAMED else []
    return [Details(f"{title} ({plural(len(lines), 'road')})", [*lines[:MOST_NAMED], *more])]


def near_and_far(near: tuple[float, str] | None, far: tuple[float, str] | None) -> list[str]:
    """Returns sentences on the drive that came nearest to failing and on the one that went farthest out.

    Args:
        near: least margin of the drives that kept their lane, in metres, and the drive's name; None if there
            is none.
        far: least margin of the drives that left it and drove on, and the drive's name; None if there is none
            or if drives end where the car leaves its lane.
    """
    out = []
    if near is not None:
        out.append(
            f"Of the drives that kept their lane, {near[1]} came nearest to failing: {_metres(near[0])}."
        )
    if far is not None and far[0] < 0:
        out.append(f"Farthest out went {far[1]}: {_metres(-far[0])} beyond what is allowed.")
    return out


def _metres(value: float) -> str:
    return f"{value:.2f} m" if value >= 0.01 else "less than 1 cm"
