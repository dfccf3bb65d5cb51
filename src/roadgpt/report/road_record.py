"""Collects the properties of each road for the reports: validity by each rule set, and measured geometry.
They are computed from the roads of a Record."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.campaign.folder_record import has_tests, open_record
from roadgpt.campaign.model import MOST_TESTS, Cell, NumberedTest, Result
from roadgpt.campaign.record import Record
from roadgpt.check import inspect
from roadgpt.check.measures import measure
from roadgpt.check.truth import KeptCriterion, Truth, criteria_of
from roadgpt.errors import RoadGPTError
from roadgpt.geometry.curve import Array
from roadgpt.report.canvas import FORMATS
from roadgpt.report.similarity import Likeness, Spread, likeness, spread
from roadgpt.road import Road, World
from roadgpt.run.folder import is_run
from roadgpt.run.versions import Versions
from roadgpt.verdict.verdict import DEPARTURES

MOST_COMPARED = 150  # roads of a part, each of which is compared with every other one
STRAIGHT = np.stack([np.linspace(0.0, 30.0, 31), np.zeros(31)], axis=1)
"""Points of a straight of 30 m. If there is no road, this straight is measured instead of the road, to learn
which criteria a description mentions."""


@dataclass(frozen=True, eq=False)
class RoadRecord:
    """The properties of one road, as used in reports."""

    result: Result
    world: World | None  # None if there is no road
    is_valid: bool  # true if the road breaks no strict rule
    is_sound: bool
    """True if the road breaks no strict rule; the rule on the requirements of the description is ignored."""
    sbft_says: str
    """The first reason why the SBFT competition's validator rejects the road, or "no road"; empty if it
    accepts the road."""
    points: Array  # points of the centre line ``(n, 2)``, metres, one every 2 m; empty if there is no road
    kept: Mapping[KeptCriterion, bool]
    """For each criterion that the description mentions, True if the road meets it."""
    likeness: Likeness | None
    """The properties by which the road is compared with other roads; None if no road was made or it cannot
    be compared."""
    href: str  # address of the road's bird's-eye view or run.json; empty if it has none
    failed_at: tuple[float, float] | None  # middle of its lane where the car failed, x and y in metres

    @property
    def index(self) -> int:
        """Number of the road in its cell, from 1."""
        return self.result.number

    @property
    def is_sbft(self) -> bool:
        """True if the road passes the SBFT competition's validator."""
        return not self.sbft_says

    @property
    def is_driven(self) -> bool:
        """True if the road was driven and the drive was evaluated."""
        return self.result.outcome in ("PASS", "FAIL")

    @property
    def has_left(self) -> bool:
        """True if the car left its lane or fell."""
        return self.result.cause in DEPARTURES


@dataclass(frozen=True, eq=False)
class RoadGroup:
    """The roads of one cell, or all that one designer made from one description."""

    designer: str
    words: str  # the description
    roads: tuple[RoadRecord, ...] = ()
    truth: Truth | None = None
    """The requirements that people wrote down; None: roads are checked against those that the reader
    finds."""
    id: str = "1"  # of the description
    name: str = ""  # the cell's; empty if there is one
    overview: str = ""  # address of the picture of all roads, or of their table; empty if there is none
    problem: str = ""  # the reason why roads are missing; empty if none is missing
    wanted: int = 1  # number of roads that the user requested
    versions: Versions = field(default_factory=dict)

    @property
    def size(self) -> float:
        """Side of a square map that holds all roads, metres."""
        return max((road.world.site.map_size for road in self.roads if road.world), default=1.0)

    def name_of(self, road: RoadRecord) -> str:
        """Returns the name of one of the roads."""
        return f"{self.name}, road {road.index}" if self.name else f"road {road.index}"

    def count(self, which: str) -> int:
        """Returns the number of roads with a property of RoadRecord, such as "is_valid" or "has_left"."""
        return sum(getattr(road, which) for road in self.roads)

    def kept(self, criterion: KeptCriterion) -> list[bool]:
        """Returns, for each road, whether it meets a criterion that the description mentions; if no road
        could be made, False for each requested road and the criterion "general"."""
        found = [road.kept[criterion] for road in self.roads if criterion in road.kept]
        return found if self.roads or criterion != "general" else [False] * self.wanted

    @cached_property
    def compared(self) -> tuple[RoadRecord, ...]:
        """The roads that are compared with each other: the first ones, as far as they can be compared."""
        return tuple(road for road in self.roads if road.likeness is not None)

    @cached_property
    def likenesses(self) -> list[Likeness]:
        """The properties by which the roads in ``compared`` are compared."""
        return [road.likeness for road in self.compared if road.likeness is not None]

    @cached_property
    def spread(self) -> Spread:
        """How different the compared roads are; indices in the Spread refer to roads in ``compared``."""
        return spread(self.likenesses)


def read_group(place: Path, designer: str, words: str, truth: Truth | None = None, **more: Any) -> RoadGroup:
    """Returns all roads of the folder of runs ``place``; ``more`` are further fields of the group, of which
    ``name`` is the way from the report's folder to this one."""
    if not has_tests(place):
        return RoadGroup(designer, words, truth=truth, **more)
    with open_record(place) as record:
        return group_of(record, record.cells()[0], words, truth=truth, home=more["name"], **more)


def group_of(
    record: Record, cell: Cell, words: str, truth: Truth | None = None, home: str = "",
    most: int = MOST_TESTS, compared: int = MOST_COMPARED, **more: Any,
) -> RoadGroup:  # fmt: skip
    """Returns the roads of the first ``most`` tests of a cell, of which the first are ``compared``. ``home``
    is the way from the report's folder to that of the record; ``more`` are further fields of the group."""
    names = [*(f"overview.{kind}" for kind in FORMATS), "results.csv"]
    drawn = next((name for name in names if (record.folder / name).is_file()), "")
    results = record.results(cell.name, "tests.number <= ?", (most,))
    roads = tuple(_road_of(record, cell, each, truth, home, each.number <= compared) for each in results)
    setup = cell.request.setup
    more |= {"overview": under(home, drawn), "versions": record.versions(setup.driver)}
    return RoadGroup(setup.designer, words, roads, truth, **more)


def under(home: str, name: str) -> str:
    """Returns the address of a file in the folder ``home``; empty if there is no file."""
    return f"{home}/{name}".lstrip("/") if name else ""


def file_of(folder: Path, cell: str, number: int) -> str:
    """Returns the address of the picture of a test from above, or of its Run; empty if neither is there."""
    run = f"runs/{number:04d}/"
    places = ("",) if is_run(folder) else (run, f"{cell}/{run}", f"again/{cell}/{run}")
    names = [*(f"birds_eye.{kind}" for kind in FORMATS), "run.json"]
    paths = [f"{place}{name}".replace("//", "/").lstrip("/") for place in places for name in names]
    return next((path for path in paths if (folder / path).is_file()), "")


def named(folder: Path, test: NumberedTest) -> str:
    """Returns how commands name a test."""
    return str(folder) if is_run(folder) else f"{folder}/{test}"


def _road_of(
    record: Record, cell: Cell, result: Result, truth: Truth | None, home: str, is_compared: bool
) -> RoadRecord:
    road, request = record.road(cell, result) or (None, cell.request)
    href = under(home, file_of(record.folder, cell.name, result.number))
    brief = cell.of_test(result.proposal).brief
    kept = kept_of(road, brief, request.world, truth)
    if road is None:
        return RoadRecord(result, None, False, False, "no road", np.empty((0, 2)), kept, None, href, None)
    is_checked = result.outcome == "INVALID" or brief is None  # others were driven because they break no rule
    findings = inspect(road, brief, request.world, request.setup.rules) if is_checked else ()
    sbft, at = inspect(road, None, request.world, "sbft"), None
    if result.at_s is not None and result.cause in DEPARTURES:
        x, y, _ = road.at(result.at_s, request.world.profile_of(road).middle(result.at_s)).tolist()
        at = x, y
    its = None
    with suppress(RoadGPTError, FloatingPointError, ValueError):  # a broken road cannot be compared
        its = likeness(road) if is_compared else None
    return RoadRecord(
        result, request.world, not findings, all(finding.rule == "promises" for finding in findings),
        sbft[0].sentence if sbft else "", road.centreline(2.0)[:, :2], kept, its, href, at,
    )  # fmt: skip


def kept_of(
    road: Road | None, brief: Brief | None, world: World, truth: Truth | None = None
) -> dict[KeptCriterion, bool]:
    """Returns, for each criterion of a description, whether a road meets it; every value is False if no road
    was made. ``truth`` contains the requirements; if ``truth`` is None, those that the reader found, in the
    ``brief``, are used. Without any requirements, the result is empty."""
    points = road.centreline() if road is not None else STRAIGHT
    is_road = road is not None and bool(np.isfinite(points).all()) and len(points) > 1
    points = points if is_road else STRAIGHT
    read = outline(brief, world.site.map_size) if brief is not None else None
    asked = truth.outline() if truth is not None else read
    if asked is None:
        return {}
    found = measure(points, read.widest) if read else measure(points)
    return {criterion: good and is_road for criterion, good in criteria_of(found, asked).items()}
