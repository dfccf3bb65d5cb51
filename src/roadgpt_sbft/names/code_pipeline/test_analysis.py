"""Computes features of tests. Each function returns the name of a feature and its value, as the
competition's functions do.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from statistics import fmean, pstdev
from typing import Any, Dict, Sequence, Tuple

THE_NORTH = [0, 1]
FEWEST_RECORDS = 3  # with fewer, a drive has no features

Feature = Tuple[str, float]


def compute_all_features(the_test: Any, execution_data: Sequence[Any]) -> Dict[str, float]:
    """Returns the features MAX_CURV and DIR_COV of the road and, if the drive has three or more records, the
    features STD_SA, MEAN_LP and MAX_LP of the drive."""
    found = [max_curvature(the_test), direction_coverage(the_test)]
    if len(execution_data or ()) >= FEWEST_RECORDS:
        found += [
            feature(execution_data) for feature in (sd_steering, mean_lateral_position, max_lateral_position)
        ]
    return dict(found)


def max_curvature(the_test: Any, w: int = 5) -> Feature:
    """Returns "MAX_CURV" and the largest curvature in 1/m, of circles through nodes i, i + 2 and i + 4."""
    from code_pipeline.validation import smallest_circle

    return "MAX_CURV", 1 / smallest_circle(_nodes(the_test), w)


def direction_coverage(the_test: Any, n_bins: int = 25) -> Feature:
    """Returns "DIR_COV" and the direction coverage: how many bins of directions (angles to north, 0 to 180
    degrees) occur on the road, divided by the number of bin edges, as in the competition."""
    edges = [360.0 / n_bins * i for i in range(n_bins + 1)]
    nodes = _nodes(the_test)
    covered = set()
    for one, after in zip(nodes, nodes[1:]):
        x, y = after[0] - one[0], after[1] - one[1]
        way = math.sqrt(x * x + y * y)
        # coinciding nodes have no direction; the competition's library counts that beyond the last edge
        cosine = max(-1.0, min(1.0, y / way)) if way else math.nan
        covered.add(bisect_right(edges, math.degrees(math.acos(cosine))) if way else len(edges))
    return "DIR_COV", len(covered) / len(edges)


def get_thetas(xs: Any, ys: Any, skip: int = 1) -> Any:
    """Returns the directions between successive points of the arrays xs and ys, in radians from the
    x-axis."""
    del skip  # the competition's function ignores it, too
    import numpy

    return numpy.arctan2(ys[1:] - ys[:-1], xs[1:] - xs[:-1])


def direction_coverage_klk(the_test: Any, n_bins: int = 36) -> Feature:
    """Returns the same as ``direction_coverage`` for angles to the x-axis, from -180 to 180 degrees."""
    edges = [-math.pi + 2 * math.pi / (n_bins - 1) * i for i in range(n_bins - 1)] + [math.pi]
    nodes = _nodes(the_test)
    ways = [(after[0] - one[0], after[1] - one[1]) for one, after in zip(nodes, nodes[1:])]
    covered = {bisect_right(edges, math.atan2(y, x)) for x, y in ways}
    return "DIR_COV", len(covered) / len(edges)


def sd_steering(execution_data: Sequence[Any]) -> Feature:
    """Returns "STD_SA" and the standard deviation of the steering wheel's angle, in degrees."""
    return "STD_SA", pstdev(float(record.steering) for record in execution_data)


def mean_lateral_position(execution_data: Sequence[Any]) -> Feature:
    """Returns "MEAN_LP" and the mean of ``oob_distance`` over all records, in metres."""
    return "MEAN_LP", fmean(float(record.oob_distance) for record in execution_data)


def max_lateral_position(execution_data: Sequence[Any]) -> Feature:
    """Returns "MAX_LP" and the maximum of ``oob_distance`` over all records, in metres."""
    return "MAX_LP", max(record.oob_distance for record in execution_data)


def _nodes(the_test: Any) -> Sequence[Sequence[float]]:
    nodes: Sequence[Sequence[float]] = getattr(the_test, "interpolated_points", the_test)
    return nodes
