"""Features of tests; each by itself comes with its name, as the competition's functions give it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from roadgpt.run.features import direction_coverage as _coverage
from roadgpt.run.features import features_of
from roadgpt.run.features import max_curvature as _curvature


def compute_all_features(the_test: Any, execution_data: Sequence[Any] | None) -> dict[str, float]:
    """MAX_CURV and DIR_COV of the road; STD_SA, MEAN_LP and MAX_LP of the drive, where there is one."""
    return features_of([node[:2] for node in the_test.interpolated_points], execution_data or ())


def max_curvature(the_test: Any, w: int = 5) -> tuple[str, float]:
    """1/m, of interpolated points i, i+2, i+4: the competition's own window."""
    return "MAX_CURV", _curvature(_plan(the_test))


def direction_coverage(the_test: Any, n_bins: int = 25) -> tuple[str, float]:
    """Share of the edges of bins of directions, as angles to north from 0 to 180 degrees."""
    return "DIR_COV", _coverage(_plan(the_test), n_bins)


def direction_coverage_klk(the_test: Any, n_bins: int = 36) -> tuple[str, float]:
    """The same of the whole circle, from -180 to 180 degrees to the x-axis."""
    step = np.diff(_plan(the_test), axis=0)
    edges = np.linspace(-np.pi, np.pi, n_bins)
    covered = np.unique(np.digitize(np.arctan2(step[:, 1], step[:, 0]), edges))
    return "DIR_COV", len(covered) / len(edges)


def sd_steering(execution_data: Sequence[Any]) -> tuple[str, float]:
    """Degrees at the steering wheel."""
    return "STD_SA", float(np.std([record.steering for record in execution_data]))


def mean_lateral_position(execution_data: Sequence[Any]) -> tuple[str, float]:
    """Metres."""
    return "MEAN_LP", float(np.mean([record.oob_distance for record in execution_data]))


def max_lateral_position(execution_data: Sequence[Any]) -> tuple[str, float]:
    """Metres."""
    return "MAX_LP", float(np.max([record.oob_distance for record in execution_data]))


def _plan(the_test: Any) -> Any:
    return np.asarray([node[:2] for node in getattr(the_test, "interpolated_points", the_test)], float)
