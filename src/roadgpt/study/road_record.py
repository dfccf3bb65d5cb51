"""Reads from each run what a report needs: validity by every set of rules, the drive, measured geometry."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.model import Brief
from roadgpt.check import inspect
from roadgpt.check.measures import measure
from roadgpt.check.rules.promises import promises_of
from roadgpt.errors import RoadGPTError
from roadgpt.reading import read_json
from roadgpt.report.canvas import FORMATS
from roadgpt.road import Road, World
from roadgpt.run import Run, read_run
from roadgpt.run.folder import finished, run_folder
from roadgpt.run.sbft_json import test_name
from roadgpt.study.criteria import Criterion, criteria_of_outline, criteria_of_truth
from roadgpt.study.plan import StudyPart
from roadgpt.study.similarity import Likeness, likeness
from roadgpt.study.truth import SHORTEST, Truth

Array = NDArray[np.float64]

DEPARTURES = ("out of lane", "fell")  # causes of failures by which the car left its lane
STRAIGHT = np.stack([np.linspace(0.0, 30.0, 31), np.zeros(31)], axis=1)
"""The road that is measured where there is none, to learn which criteria a description mentions."""


@dataclass(frozen=True, eq=False)
class RoadRecord:
    """The properties of one road that reports use."""

    index: int
    folder: str
    """Folder of its run, relative to the report's, with forward slashes."""
    outcome: str
    says: str
    """The outcome as a sentence."""
    is_valid: bool
    """Whether the road breaks no strict rule."""
    is_sound: bool
    """Whether the road breaks no strict rule except the description's requirements.

    The thesis did not check these.
    """
    is_sbft: bool
    """Whether the road passes the SBFT competition's validator."""
    sbft_says: str
    """The first objection of that validator; empty if there is none."""
    has_left: bool
    """Whether the car left its lane or fell."""
    margin: float | None
    """Least distance of the car to out of bounds, metres, negative if it failed; None if it did not drive."""
    points: Array
    """Centre line ``(n, 2)``, metres; empty if there is no road."""
    failed_at: tuple[float, float] | None
    """Where the car failed, metres; None if it did not."""
    kept: Mapping[Criterion, bool]
    """Whether the road keeps each criterion that the description mentions."""
    likeness: Likeness | None
    """The properties that are compared with those of other roads; None if the road cannot be compared."""
    features: Mapping[str, float] = field(default_factory=dict)
    """Features of the competition's feature maps."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Versions of RoadGPT and of the libraries that made the run."""
    max_oob: float | None = None
    """Largest share of the car outside its lane, 0 to 1; None if the road was not driven."""
    beyond: float | None = None
    """Largest distance of the car beyond the lane marking, metres."""

    @property
    def is_driven(self) -> bool:
        """Whether the road was driven to a verdict."""
        return self.outcome in ("PASS", "FAIL")


@dataclass(frozen=True, eq=False)
class StudyPartRecord:
    """All roads of one description by one designer."""

    part: StudyPart
    roads: tuple[RoadRecord, ...]
    home: str = ""
    """The part's folder, relative to the report's."""
    problem: str = ""
    """Why roads are missing; empty if none is."""
    picture_format: str = ""
    """Format of the roads' pictures; empty if there are none."""
    wanted: int = 1
    """Number of roads that were asked for."""

    @property
    def words(self) -> str:
        """The description."""
        return self.part.prompt.prompt

    @property
    def designer(self) -> str:
        """The name of the designer."""
        return self.part.designer

    def count(self, which: str) -> int:
        """Returns the number of roads with a property: is_valid, is_sound, is_sbft, has_left or is_driven."""
        return sum(getattr(road, which) for road in self.roads)

    def kept(self, criterion: Criterion) -> list[bool]:
        """Returns for each road whether it keeps a criterion; empty if the description does not mention it.

        A missing road keeps nothing: a prompt without any road counts with as many roads as were asked for.
        """
        found = [road.kept[criterion] for road in self.roads if criterion in road.kept]
        return found if self.roads or criterion != "general" else [False] * self.wanted

    def href(self, road: RoadRecord) -> str:
        """Returns the address of the road's bird's-eye view, or of its run if no picture was drawn."""
        is_drawn = self.picture_format and len(road.points)
        return f"{road.folder}/{f'birds_eye.{self.picture_format}' if is_drawn else 'run.json'}"

    @property
    def overview(self) -> str:
        """Address of the picture or table of all roads."""
        name = f"overview.{self.picture_format}" if self.picture_format else "generation_stats.csv"
        return f"{self.home}/{name}".lstrip("/")


def read_part(
    place: Path, part: StudyPart, home: str = "", problem: str = "", wanted: int = 1
) -> StudyPartRecord:
    """Returns all roads of a folder of runs.

    Args:
        place: the folder of runs.
        part: the description and the designer.
        home: the folder, relative to that of the report; empty: the report lies in it.
        problem: why roads are missing; empty if none is.
        wanted: number of roads that were asked for.

    Raises:
        UsageError: a run cannot be read.
    """
    roads = tuple(
        _record_of(read_run(run_folder(place, n)), part, home, _features(place / test_name(n)))
        for n in (finished(place) if place.is_dir() else [])
    )
    drawn = next((kind for kind in FORMATS if (place / f"overview.{kind}").is_file()), "")
    return StudyPartRecord(part, roads, home, problem, drawn, wanted)


def _record_of(run: Run, part: StudyPart, home: str, features: Mapping[str, float]) -> RoadRecord:
    verdict, road = run.verdict, run.road
    sbft = inspect(road, None, run.world, "sbft") if road is not None else ()
    return RoadRecord(
        index=run.index,
        folder=f"{home}/runs/{run.index:04d}".lstrip("/"),
        outcome=run.outcome,
        says=run.description,
        is_valid=run.is_valid,
        is_sound=road is not None and all(finding.rule == "promises" for finding in run.findings),
        is_sbft=road is not None and not sbft,
        sbft_says=sbft[0].sentence if sbft else "" if road is not None else "no road",
        has_left=verdict is not None and verdict.cause in DEPARTURES,
        margin=verdict.margin if verdict is not None else None,
        points=road.centreline(2.0)[:, :2] if road is not None else np.empty((0, 2)),
        failed_at=verdict.at_xy if verdict is not None else None,
        kept=kept_of(road, run.brief, run.world, part.prompt.truth),
        likeness=_likeness(road),
        features=features,
        versions=run.versions,
        max_oob=verdict.max_oob if verdict is not None else None,
        beyond=verdict.beyond if verdict is not None else None,
    )


def kept_of(
    road: Road | None, brief: Brief | None, world: World, truth: Truth | None = None
) -> dict[Criterion, bool]:
    """Returns whether a road keeps each criterion of a description.

    Args:
        road: the road; None: all criteria are False.
        brief: what the reader read; None: only the truth counts.
        world: the map, which limits what can be asked for.
        truth: what people wrote down; if given, it counts, and not the Brief.
    """
    points = road.centreline() if road is not None else STRAIGHT
    is_road = road is not None and bool(np.isfinite(points).all()) and len(points) > 1
    points = points if is_road else STRAIGHT
    asked = promises_of(brief, world) if brief is not None else None
    found = measure(points, asked.widest) if asked else measure(points)
    if truth is not None:
        kept = criteria_of_truth(found, truth)
    elif asked is not None:
        kept = criteria_of_outline(found, asked)
    else:
        return {}
    return {criterion: good and is_road and found.length >= SHORTEST for criterion, good in kept.items()}


def _likeness(road: Road | None) -> Likeness | None:
    if road is None:
        return None
    try:
        return likeness(road)
    except (RoadGPTError, FloatingPointError, ValueError):  # a broken road is like no other
        return None


def _features(test: Path) -> dict[str, float]:
    try:
        found = read_json(test).get("features")
        return {str(key): float(value) for key, value in (found or {}).items()}
    except (OSError, ValueError, TypeError, AttributeError, OverflowError):
        return {}
