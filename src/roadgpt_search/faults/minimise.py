"""Simplifies a road on which the car fails.

The method is delta debugging: A. Zeller and R. Hildebrandt, Simplifying and Isolating Failure-Inducing Input,
IEEE Transactions on Software Engineering 28 (2002). Unless the drives run out, the simplified road is
1-minimal: any single further simplification makes the failure disappear."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from roadgpt.check import inspect
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.road import Design, Segment, build
from roadgpt.run import Run, prove

MOST_DRIVES = 400  # of one minimisation; at 20 to 25 drives a second that is under half a minute
ROUNDED = (
    ("distance", 50.0), ("turn_degrees", 30.0), ("distance", 10.0), ("turn_degrees", 10.0), ("radius", 10.0),
    ("distance", 5.0), ("turn_degrees", 5.0), ("radius", 5.0), ("distance", 1.0), ("turn_degrees", 1.0),
    ("radius", 1.0),
)  # fmt: skip
"""The fields that are rounded, each with the unit, metres or degrees; the coarsest first."""

STRAIGHT = {"direction": "straight", "turn_degrees": 0.0, "radius": None, "transition": None}

Change = Callable[[Segment], Segment | None]  # returns the simplified segment, or None to remove the segment


Simplification = tuple[int, Change]
"""One simplification of one segment, whose index from 0 in the Design comes first."""


@dataclass(frozen=True)
class Simplest:
    """A failing road after simplification."""

    run: Run
    """The Run on the simplified road; it fails for the same cause and to the same side as the original."""
    segments_before: int
    drives: int  # number of drives that the search took
    is_minimal: bool
    """False if the maximum number of drives was reached before every simplification had been tried."""

    @property
    def sentence(self) -> str:
        """The result as text for users."""
        assert self.run.plain_design is not None
        left = len(self.run.plain_design.segments)
        what = f"{self.segments_before} segments" if self.segments_before != 1 else "1 segment"
        return (
            f"{what} -> {left}, {self.run.length:.0f} m: {self.run.description} ({self.drives} drives"
            f"{'' if self.is_minimal else ', given up before all was tried'})"
        )


class Trial:
    """Drives simplified versions of one failing road, each at most once, and counts the drives."""

    def __init__(self, failure: Run, most: int) -> None:
        """Begins without a drive; raises UsageError if the Run did not fail or has no Design."""
        if failure.verdict is None or not failure.verdict.failed or failure.plain_design is None:
            raise UsageError(
                f"road {failure.index} did not fail, or has no design without junctions; "
                "only failing roads with such designs are simplified"
            )
        self.failure, self.most = failure, most
        self.kind = (failure.verdict.cause, failure.verdict.side)
        self.drives = 0
        self.is_exhausted = False  # true if a drive was refused because all drives were used up
        self._known: dict[Design, Run | None] = {}

    def fails(self, design: Design | None) -> Run | None:
        """Drives the road of a Design; returns the Run if the car fails for the same cause and to the same
        side as before, otherwise None; also, undriven, for a road that is invalid anywhere on the map, or if
        no drives are left."""
        if design is None:
            return None
        if design not in self._known:
            self._known[design] = self._driven(design)
        return self._known[design]

    def _driven(self, design: Design) -> Run | None:
        request, failure = self.failure.request, self.failure
        for placed in (design, *_moved(design, failure)):
            road = build(placed, request.setup.geometry)
            if not inspect(road, None, request.world, request.setup.rules):
                break
        else:
            return None
        if self.drives >= self.most:
            self.is_exhausted = True
            return None
        self.drives += 1
        run = prove(placed, failure.seed, request.world, request.setup, failure.index)
        same = run.verdict is not None and (run.verdict.cause, run.verdict.side) == self.kind
        return replace(run, request=request) if same and run.outcome == "FAIL" else None


def _moved(design: Design, failure: Run) -> list[Design]:
    """Returns the Design in the middle of the map, since a simplified road may leave it; nothing if the road
    cannot be built."""
    try:
        points = build(design, failure.request.setup.geometry).centreline()
    except RoadGPTError:
        return []
    middle = failure.world.site.map_size / 2
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = design.starting_point
    dx, dy = (round(float(middle - (a + b) / 2), 2) for a, b in zip(low[:2], high[:2], strict=True))
    return [design.model_copy(update={"starting_point": (x + dx, y + dy, z)})]


def simplest(failure: Run, most: int = MOST_DRIVES) -> Simplest:
    """Simplifies the road of a failing Run with a Design such that the car still fails for the same cause and
    to the same side; there are at most ``most`` drives."""
    trial = Trial(failure, most)
    assert failure.plain_design is not None
    design, before = failure.plain_design, None
    while design != before:
        before = design
        for way in SIMPLIFIERS:
            design = _reduced(design, way(design), trial)
    run = failure if design == failure.plain_design else trial.fails(design)
    assert run is not None
    return Simplest(run, len(failure.plain_design.segments), trial.drives, not trial.is_exhausted)


def _reduced(design: Design, steps: Sequence[Simplification], trial: Trial) -> Design:
    """Returns the Design after all of the simplifications, if the car still fails; otherwise tries each half
    of them, then each quarter, and so on, and keeps those with which the car still fails."""
    kept: list[Simplification] = []

    def take(part: Sequence[Simplification]) -> None:
        if not part:
            return
        if trial.fails(simplified(design, [*kept, *part])) is not None:
            kept.extend(part)
        elif len(part) > 1:
            take(part[: len(part) // 2])
            take(part[len(part) // 2 :])

    take(steps)
    return simplified(design, kept) or design


def simplified(design: Design, steps: Sequence[Simplification]) -> Design | None:
    """Returns the Design with all the given simplifications applied; None if no segment would be left."""
    segments: list[Segment | None] = list(design.segments)
    for index, change in steps:
        segment = segments[index]
        if segment is not None:
            segments[index] = change(segment)
    left = tuple(segment for segment in segments if segment is not None)
    return design.model_copy(update={"segments": left}) if left else None


def _changing(field: str, change: Change, unit: float = 0.0) -> Callable[[Design], list[Simplification]]:
    """Returns a function that lists a change of every segment whose ``field`` is not 0, and no multiple of
    ``unit`` where one is given."""

    def way(design: Design) -> list[Simplification]:
        values = [getattr(segment, field) for segment in design.segments]
        return [(index, change) for index, value in enumerate(values) if value and (not unit or value % unit)]

    return way


def _rounding(field: str, unit: float) -> Callable[[Design], list[Simplification]]:
    def rounded(segment: Segment) -> Segment:
        value = round(getattr(segment, field) / unit) * unit
        return segment.model_copy(update={field: value}) if value else segment

    return _changing(field, rounded, unit)


SIMPLIFIERS: tuple[Callable[[Design], list[Simplification]], ...] = (
    # the last segment first: what comes after the departure matters least
    lambda design: [(index, lambda segment: None) for index in reversed(range(len(design.segments)))],
    _changing("incline", lambda segment: segment.model_copy(update={"incline": 0.0})),
    _changing("turn_degrees", lambda segment: segment.model_copy(update=STRAIGHT)),
    *(_rounding(field, unit) for field, unit in ROUNDED),
    _changing(
        "incline", lambda segment: segment.model_copy(update={"incline": float(round(segment.incline))}), 1.0
    ),
)
"""The types of simplification; those that simplify the road most come first."""
