"""Formats numbers for reports."""

import math

from roadgpt.report.page import TableCell, cell
from roadgpt.study.statistics import Interval, clopper_pearson, wilson


def p_value(p: float) -> str:
    """Formats a p-value: 'p = 0.010', 'p < 1e-15'."""
    if p < 1e-15:
        return "p < 1e-15"
    return f"p = {p:.1e}" if p < 0.001 else f"p = {p:.3f}"


def percent(share: float, digits: int = 1) -> str:
    """Formats a share as '60.7 %'; NaN as a dash."""
    return "–" if math.isnan(share) else f"{100 * share:.{digits}f} %"


def between(interval: Interval) -> str:
    """Formats an interval of shares as '54.9 to 66.2 %'."""
    return f"{100 * interval.lo:.1f} to {100 * interval.hi:.1f} %"


def share_of(k: int, n: int) -> str:
    """Formats a count as '182 of 300 (60.7 %)'."""
    return f"{k} of {n}" + (f" ({percent(k / n)})" if n else "")


def decimal(value: float | None, digits: int = 2, href: str = "") -> TableCell:
    """Returns a table cell with a rounded number; None and NaN become a dash."""
    if value is None or not math.isfinite(value):
        return cell(None)
    return cell(round(value, digits + 3), f"{value:z.{digits}f}".replace("-", "−"), href)


def metres(value: float) -> str:
    """Formats metres as '0.18 m'; below 1 cm it says 'less than 1 cm'."""
    return f"{value:.2f} m" if value >= 0.01 else "less than 1 cm"


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
            f"Of the drives that kept their lane, {near[1]} came nearest to failing: {metres(near[0])}."
        )
    if far is not None and far[0] < 0:
        out.append(f"Farthest out went {far[1]}: {metres(-far[0])} beyond what is allowed.")
    return out


def share_cells(k: int, n: int, href: str = "") -> list[TableCell]:
    """Returns the cells k, n, share, Clopper and Pearson's interval, and Wilson's interval."""
    if not n:
        return [cell(k, href=href), cell(n), cell(None), cell(None), cell(None)]
    exact, score = clopper_pearson(k, n), wilson(k, n)
    return [
        cell(k, href=href),
        cell(n),
        cell(round(k / n, 6), percent(k / n)),
        interval_cell(exact),
        interval_cell(score),
    ]


def interval_cell(interval: Interval) -> TableCell:
    """Returns an interval as a cell: shares in CSV, percent on the page."""
    return cell(f"{interval.lo:.4f} to {interval.hi:.4f}", between(interval))


SHARE_HEADS = ("of", "share", "Clopper-Pearson 95 %", "Wilson 95 %")


def plural(n: int, word: str) -> str:
    """Formats a count with its noun: '1 road', '2 roads'."""
    return f"{n:,} {word}{'' if n == 1 else 's'}"
