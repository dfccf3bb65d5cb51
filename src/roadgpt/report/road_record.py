"""Collects the properties of each road for the reports: validity by each rule set, the results of the drive,
and measured geometry. They are read or computed from the files of the road's run."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.outline import outline
from roadgpt.campaign.columns import ToldNumber, features_in, told_of
from roadgpt.check import inspect
from roadgpt.check.measures import measure
from roadgpt.check.truth import Criterion, Truth, criteria_of
from roadgpt.errors import RoadGPTError
from roadgpt.report.canvas import FORMATS
from roadgpt.report.similarity import Likeness, Spread, likeness, spread
from roadgpt.road import Road
from roadgpt.run import Run
from roadgpt.run.folder import finished, finished_run_in, slug, test_in
from roadgpt.verdict import Verdict
from roadgpt.verdict.verdict import DEPARTURES

Array = NDArray[np.float64]

MOST_COMPARED = 150  # roads of a part, each of which is compared with every other one
LETTERS = 32  # of a description, in the name of its folder
STRAIGHT = np.stack([np.linspace(0.0, 30.0, 31), np.zeros(31)], axis=1)
"""Points of a straight of 30 m. If there is no road, this straight is measured instead of the road, to learn
which criteria a description mentions."""


@dataclass(frozen=True, eq=False)
class RoadRecord:
    """The properties of one road, as used in reports."""

    index: int
    outcome: str
    says: str  # the outcome as a sentence
    is_valid: bool  # true if the road breaks no strict rule
    is_sound: bool
    """True if the road breaks no strict rule; the rule on the requirements of the description is ignored."""
    is_sbft: bool  # true if the road passes the SBFT competition's validator
    sbft_says: str
    """The first reason why the SBFT competition's validator rejects the road, or "no road"; empty if it
    accepts the road."""
    verdict: Verdict | None  # the result of the drive; None if the road was not driven
    points: Array  # points of the centre line ``(n, 2)``, metres, one every 2 m; empty if there is no road
    kept: Mapping[Criterion, bool]
    """For each criterion that the description mentions, True if the road meets it."""
    likeness: Likeness | None
    """The properties by which the road is compared with other roads; None if no road was made or it cannot
    be compared."""
    features: Mapping[str, float] = field(default_factory=dict)
    """Features of the SBFT competition's feature maps, by name; empty if they are not known."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Versions of RoadGPT and of the libraries that made the run, by name."""
    friction: float | None = None  # friction coefficient of the road; None if it is not known
    numbers: tuple[ToldNumber, ...] = ()  # those of the plug-ins ``columns`` that are told

    @property
    def is_driven(self) -> bool:
        """True if the road was driven and the drive was evaluated."""
        return self.outcome in ("PASS", "FAIL")

    @property
    def has_left(self) -> bool:
        """True if the car left its lane or fell."""
        return self.verdict is not None and self.verdict.cause in DEPARTURES


@dataclass(frozen=True, eq=False)
class RoadGroup:
    """All roads that one designer made from one description."""

    designer: str
    words: str  # the description
    roads: tuple[RoadRecord, ...]
    truth: Truth | None = None
    """The requirements that people wrote down; None: roads are checked against those that the reader
    finds."""
    number: int = 1  # of the description, counted from 1
    id: str = "1"  # of the description
    home: str = ""  # group's folder, relative to the report's folder; empty if both folders are the same
    problem: str = ""  # the reason why roads are missing; empty if none is missing
    picture_format: str = ""  # format of the roads' pictures, such as "png"; empty if there are no pictures
    wanted: int = 1  # number of roads that the user requested

    @property
    def name(self) -> str:
        """The name of the group, as of ``name_of``."""
        return name_of(self.designer, self.number, self.words)

    def count(self, which: str) -> int:
        """Returns the number of roads with a property of RoadRecord, such as "is_valid" or "has_left"."""
        return sum(getattr(road, which) for road in self.roads)

    def kept(self, criterion: Criterion) -> list[bool]:
        """Returns, for each road, whether it meets a criterion that the description mentions; if no road
        could be made, False for each requested road and the criterion "general"."""
        found = [road.kept[criterion] for road in self.roads if criterion in road.kept]
        return found if self.roads or criterion != "general" else [False] * self.wanted

    @cached_property
    def compared(self) -> tuple[RoadRecord, ...]:
        """The roads that are compared with each other: the first 150 roads that can be compared."""
        return tuple(road for road in self.roads if road.likeness is not None)[:MOST_COMPARED]

    @cached_property
    def likenesses(self) -> list[Likeness]:
        """The properties by which the roads in ``compared`` are compared."""
        return [road.likeness for road in self.compared if road.likeness is not None]

    @cached_property
    def spread(self) -> Spread:
        """How different the compared roads are; indices in the Spread refer to roads in ``compared``."""
        return spread(self.likenesses)

    def href(self, road: RoadRecord) -> str:
        """Returns the address of the road's bird's-eye view, or of its file run.json."""
        is_drawn = self.picture_format and len(road.points)
        name = f"birds_eye.{self.picture_format}" if is_drawn else "run.json"
        return f"{self.home}/runs/{road.index:04d}/{name}".lstrip("/")

    @property
    def overview(self) -> str:
        """The address of the picture of all roads of the group, or of the table of roads."""
        name = f"overview.{self.picture_format}" if self.picture_format else "generation_stats.csv"
        return f"{self.home}/{name}".lstrip("/")


def name_of(designer: str, number: int, words: str) -> str:
    """Returns the name of the roads that a designer makes from the description with this number, a path with
    forward slashes."""
    return f"{slug(designer)}/{number:02d}-{slug(words)[:LETTERS].strip('-')}"


def read_group(place: Path, designer: str, words: str, truth: Truth | None = None, **more: Any) -> RoadGroup:
    """Returns all roads of the folder of runs ``place``; ``more`` are further fields of the group."""
    roads = tuple(
        _record_of(finished_run_in(place, n), truth, _features(place, n))
        for n in (finished(place) if place.is_dir() else [])
    )
    drawn = next((kind for kind in FORMATS if (place / f"overview.{kind}").is_file()), "")
    return RoadGroup(designer, words, roads, truth, picture_format=drawn, **more)


def _record_of(run: Run, truth: Truth | None, features: Mapping[str, float]) -> RoadRecord:
    road = run.road
    sbft = inspect(road, None, run.world, "sbft") if road is not None else ()
    return RoadRecord(
        index=run.index,
        outcome=run.outcome,
        says=run.description,
        is_valid=run.is_valid,
        is_sound=road is not None and all(finding.rule == "promises" for finding in run.findings),
        is_sbft=road is not None and not sbft,
        sbft_says=sbft[0].sentence if sbft else "" if road is not None else "no road",
        verdict=run.verdict,
        points=road.centreline(2.0)[:, :2] if road is not None else np.empty((0, 2)),
        kept=kept_of(run, truth),
        likeness=_likeness(road),
        features=features,
        versions=run.versions,
        friction=run.world.site.friction,
        numbers=told_of(features_in(run, told_alone=True)),
    )


def kept_of(run: Run, truth: Truth | None = None) -> dict[Criterion, bool]:
    """Returns, for each criterion of a description, whether the road of a run meets it; every value is False
    if no road was made. ``truth`` contains the requirements; if ``truth`` is None, the requirements that the
    reader found are used. Without any requirements, the result is empty."""
    points = run.road.centreline() if run.road is not None else STRAIGHT
    is_road = run.road is not None and bool(np.isfinite(points).all()) and len(points) > 1
    points = points if is_road else STRAIGHT
    read = outline(run.brief, run.world.site.map_size) if run.brief is not None else None
    asked = truth.outline() if truth is not None else read
    if asked is None:
        return {}
    found = measure(points, read.widest) if read else measure(points)
    return {criterion: good and is_road for criterion, good in criteria_of(found, asked).items()}


def _likeness(road: Road | None) -> Likeness | None:
    if road is None:
        return None
    try:
        return likeness(road)
    except (RoadGPTError, FloatingPointError, ValueError):  # a broken road cannot be compared
        return None


def _features(place: Path, number: int) -> dict[str, float]:
    try:
        found = test_in(place, number).get("features")
        return {str(key): float(value) for key, value in (found or {}).items()}
    except (OSError, ValueError, TypeError, AttributeError, OverflowError):
        return {}
