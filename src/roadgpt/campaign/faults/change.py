"""Finds the smallest change that turns a road on which the car passed into one on which it fails.

Delta debugging first finds a set of changed fields from which none can be left out (see ``minimise``).
Bisection then finds the smallest fraction of that change that still makes the car fail.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from roadgpt.brief.model import Brief
from roadgpt.campaign.faults.minimise import MOST_DRIVES, Trial
from roadgpt.errors import UsageError
from roadgpt.road import Design, Segment
from roadgpt.run import Run

FINEST = 1 / 64  # of the change
TOLD = {
    "distance": ("length", " m"),
    "turn_degrees": ("turn", " degrees"),
    "radius": ("radius", " m"),
    "transition": ("clothoid", " m"),
    "incline": ("grade", " %"),
    "vertical_radius": ("vertical radius", " m"),
}
"""The name and the unit of a field of a segment in texts."""


@dataclass(frozen=True)
class Difference:
    """One changed field of one segment: its value on the road that passed and on the road that failed."""

    segment: int
    """Index of the segment, from 0."""
    field: str
    kept: Any
    failing: Any

    @property
    def sentence(self) -> str:
        """The difference as text for users."""
        name, unit = TOLD.get(self.field, (self.field, ""))
        before, after = (_value_text(value, unit) for value in (self.kept, self.failing))
        return f"segment {self.segment + 1}: {name} {before} -> {after}"


def _value_text(value: Any, unit: str) -> str:
    if value is None:
        return "as it comes"
    return f"{value:.4g}{unit}" if isinstance(value, float) else str(value)


@dataclass(frozen=True)
class SmallestChange:
    """The smallest change found, and the Run of the failing road that results from this change."""

    run: Run
    differences: tuple[Difference, ...]
    drives: int
    """Number of drives that the search took."""


def smallest_change(
    kept: Run, failure: Run, brief: Brief | None = None, most: int = MOST_DRIVES
) -> SmallestChange:
    """Finds, among the differences between two Runs, the smallest change that makes the car fail.

    Both roads must have the same number of segments.

    Args:
        kept: a Run that passed.
        failure: a Run that failed.
        brief: requirements for every road that the search drives; None if there are no requirements.
        most: maximum number of drives.

    Raises:
        UsageError: the numbers of segments differ, a Run has no Design, or the second Run did not fail.
    """
    if kept.plain_design is None or failure.plain_design is None:
        raise UsageError("only roads with designs without junctions can be compared segment by segment")
    counts = len(kept.plain_design.segments), len(failure.plain_design.segments)
    if counts[0] != counts[1]:
        raise UsageError(
            f"the roads have {counts[0]} and {counts[1]} segments; "
            "a smallest change is looked for between roads of equally many"
        )
    trial = Trial(failure, brief, most)
    # from the start of the failing road; the car drives the same anywhere on the map
    base = failure.plain_design.model_copy(update={"segments": kept.plain_design.segments})
    every = _differences(base, failure.plain_design)
    needed = _fewest(base, every, trial)
    least = _least(base, needed, trial)
    run = trial.fails(_changed(base, least))
    return SmallestChange(run or failure, tuple(least), trial.drives)


def _differences(kept: Design, failing: Design) -> list[Difference]:
    return [
        Difference(index, field, getattr(old, field), getattr(new, field))
        for index, (old, new) in enumerate(zip(kept.segments, failing.segments, strict=True))
        for field in Segment.model_fields
        if getattr(old, field) != getattr(new, field)
    ]


def _changed(design: Design, differences: Sequence[Difference]) -> Design:
    segments = list(design.segments)
    for each in differences:
        segments[each.segment] = segments[each.segment].model_copy(update={each.field: each.failing})
    return design.model_copy(update={"segments": tuple(segments)})


def _fewest(base: Design, every: Sequence[Difference], trial: Trial) -> list[Difference]:
    """Returns some of the differences: with these the car still fails, and none can be left out."""
    left = [*every]
    size = max(1, len(left) // 2)
    while True:
        for at in range(0, len(left), size):
            fewer = left[:at] + left[at + size :]
            if fewer and trial.fails(_changed(base, fewer)) is not None:
                left = fewer
                break
        else:
            if size == 1:
                return left
            size = max(1, size // 2)


def _least(base: Design, differences: Sequence[Difference], trial: Trial) -> list[Difference]:
    """Returns the differences, all scaled by the smallest common fraction with which the car still fails."""
    low, high = 0.0, 1.0
    while high - low > FINEST:
        middle = (low + high) / 2
        if trial.fails(_changed(base, _scaled(differences, middle))) is not None:
            high = middle
        else:
            low = middle
    return _scaled(differences, high)


def _scaled(differences: Sequence[Difference], share: float) -> list[Difference]:
    return [
        replace(each, failing=each.kept + share * (each.failing - each.kept))
        if isinstance(each.kept, float) and isinstance(each.failing, float)
        else each
        for each in differences
    ]
