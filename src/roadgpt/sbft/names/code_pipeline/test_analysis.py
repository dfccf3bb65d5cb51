"""Features of tests."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from roadgpt.run.features import direction_coverage as _coverage
from roadgpt.run.features import features_of
from roadgpt.run.features import max_curvature as _curvature


def compute_all_features(the_test: Any, execution_data: Sequence[Any] | None) -> dict[str, float]:
    """MAX_CURV and DIR_COV of the road; STD_SA, MEAN_LP and MAX_LP of the drive, where there is one."""
    return features_of([node[:2] for node in the_test.interpolated_points], execution_data or ())


def max_curvature(the_test: Any, w: int = 5) -> float:
    """1/m, of interpolated points i, i+2, i+4: the competition's own window."""
    return _curvature(_plan(the_test))


def direction_coverage(the_test: Any, n_bins: int = 25) -> float:
    """Share of the edges of bins of directions, always 25 bins."""
    return _coverage(_plan(the_test))


def sd_steering(execution_data: Sequence[Any]) -> float:
    """Degrees at the steering wheel."""
    return float(np.std([record.steering for record in execution_data]))


def mean_lateral_position(execution_data: Sequence[Any]) -> float:
    """Metres."""
    return float(np.mean([record.oob_distance for record in execution_data]))


def max_lateral_position(execution_data: Sequence[Any]) -> float:
    """Metres."""
    return float(np.max([record.oob_distance for record in execution_data]))


def _plan(the_test: Any) -> Any:
    return np.asarray([node[:2] for node in getattr(the_test, "interpolated_points", the_test)], float)
