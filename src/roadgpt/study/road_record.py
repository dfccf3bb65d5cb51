"""Reads from each run what a study needs: validity by every set of rules, drive, measured geometry."""

from collections.abc import Iterator, Mapping
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
from roadgpt.run.campaign_runs import finished
from roadgpt.run.folder import run_folder
from roadgpt.run.sbft_json import test_name
from roadgpt.study.criteria import Criterion, criteria_of_outline, criteria_of_truth
from roadgpt.study.plan import StudyPart, StudyPlan
from roadgpt.study.prompts import Prompt
from roadgpt.study.similarity import Likeness, likeness
from roadgpt.study.truth import SHORTEST

Array = NDArray[np.float64]

DEPARTURES = ("out of lane", "fell")  # causes of failures by which the car left its lane
BARE = np.stack([np.linspace(0.0, 30.0, 31), np.zeros(31)], axis=1)  # any road: to see what is asked for


@dataclass(frozen=True, eq=False)
class RoadRecord:
    """One road of a study."""

    index: int
    folder: str
    """Folder of its run, relative to the study's, with forward slashes."""
    outcome: str
    says: str
    """The outcome as a sentence."""
    is_valid: bool
    """Whether the road breaks no strict rule."""
    is_sound: bool
    """Whether the road breaks no strict rule but the words' requirements, which the thesis did not check."""
    is_sbft: bool
    """Whether the road passes the SBFT competition's validator."""
    sbft_says: str
    has_left: bool
    """Whether the car left its lane or fell."""
    margin: float | None
    length: float
    points: Array
    """Centre line ``(n, 2)``, metres; empty if there is no road."""
    failed_at: tuple[float, float] | None
    kept: Mapping[Criterion, bool]
    """Whether the road keeps each criterion that the description asks for."""
    likeness: Likeness | None
    features: Mapping[str, float] = field(default_factory=dict)
    """Features of the competition's feature maps."""
    versions: Mapping[str, str] = field(default_factory=dict)
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

    def count(self, which: str) -> int:
        """Returns the number of roads with a property: is_valid, is_sound, is_sbft, has_left or is_driven."""
        return sum(getattr(road, which) for road in self.roads)

    def href(self, road: RoadRecord) -> str:
        """Returns the address of the road's bird's-eye view, or of its run if no picture was drawn."""
        is_drawn = self.picture_format and len(road.points)
        return f"{road.folder}/{f'birds_eye.{self.picture_format}' if is_drawn else 'run.json'}"

    @property
    def overview(self) -> str:
        """Address of the picture or table of all roads."""
        name = f"overview.{self.picture_format}" if self.picture_format else "generation_stats.csv"
        return f"{self.home}/{name}".lstrip("/")


def read_parts(plan: StudyPlan, folder: Path, problems: Mapping[str, str]) -> Iterator[StudyPartRecord]:
    """Yields every part of a study, read from its folder.

    Args:
        plan: the study.
        folder: the study's folder.
        problems: why roads are missing, by the name of a part's folder.

    Raises:
        UsageError: a run cannot be read.
    """
    for part in plan.parts():
        yield _read_part(folder / part.name, part, part.name, problems.get(part.name, ""), plan.roads)


def read_campaign(place: Path, part: StudyPart) -> StudyPartRecord:
    """Returns the roads of a folder of ``roadgpt run`` as a single part.

    Raises:
        UsageError: a run cannot be read.
    """
    return _read_part(place, part, "", "")


def _read_part(place: Path, part: StudyPart, home: str, problem: str, wanted: int = 1) -> StudyPartRecord:
    indices = finished(place) if place.is_dir() else []
    roads = tuple(
        record_of(read_run(run_folder(place, n)), part, home, _features(place / test_name(n)))
        for n in indices
    )
    drawn = next((kind for kind in FORMATS if (place / f"overview.{kind}").is_file()), "")
    return StudyPartRecord(part, roads, home, problem, drawn, wanted)


def record_of(run: Run, part: StudyPart, home: str, features: Mapping[str, float]) -> RoadRecord:
    """Returns the record of a run."""
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
        length=run.length,
        points=road.centreline(2.0)[:, :2] if road is not None else np.empty((0, 2)),
        failed_at=verdict.at_xy if verdict is not None else None,
        kept=kept_of(road, part.prompt, run.brief, run.world),
        likeness=_likeness(road),
        features=features,
        versions=run.versions,
        max_oob=verdict.max_oob if verdict is not None else None,
        beyond=verdict.beyond if verdict is not None else None,
    )


def kept_of(road: Road | None, prompt: Prompt, brief: Brief | None, world: World) -> dict[Criterion, bool]:
    """Returns whether a road keeps each criterion of a description; all False if there is no road."""
    points = road.centreline() if road is not None else BARE
    is_road = bool(np.isfinite(points).all()) and len(points) > 1
    asked = promises_of(brief, world) if brief is not None else None
    points = points if is_road else BARE
    found = measure(points, asked.widest) if asked else measure(points)
    if prompt.truth is not None:
        kept = criteria_of_truth(found, prompt.truth)
    elif asked is not None:
        kept = criteria_of_outline(found, asked)
    else:
        return {}
    whole = road is not None and is_road and found.length >= SHORTEST
    return {criterion: good and whole for criterion, good in kept.items()}


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
