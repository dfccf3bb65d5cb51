"""Defines RoadGPT's test generator for the competition's own pipeline. Among the roads that meet a
description, it searches for roads on which the car fails. ``names/roadgpt_client.py`` says how it is used.

    python competition.py --module-name roadgpt_sbft --class-name RoadGPTTestGenerator ...
"""

import logging
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, TypeVar

from roadgpt import chat, plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.model import Cell, Proposal, Result
from roadgpt.design import draft_road
from roadgpt.errors import DesignError, UsageError
from roadgpt.geometry import interpolate
from roadgpt.road import Design, Road, World, build
from roadgpt.run import Request, Setup, brief_of, execution, perform
from roadgpt_sbft.client import ClientTestGenerator
from roadgpt_sbft.validator import sbft_verdict
from roadgpt_search.behaviour import behaviour_of
from roadgpt_search.quality_diversity import QualityDiversity

log = logging.getLogger(__name__)

USUAL = "a flat road"
MAP_SIZE = 200  # m, the competition's
DECIMALS = 5
DENSE = 2.0  # m, largest distance of road points at which the competition's spline keeps the radii
MOST_POINTS = 500
GIVE_UP = 20  # failed roads in a row after which the generator gives up
REMEMBERED = 50  # previous designs that the next one must not repeat
CAR_WIDTH = 2.0  # m, width of a typical car, with which the margin of a drive is estimated

Points = list[tuple[float, float]]
T = TypeVar("T")
U = TypeVar("U")


class HerePool:
    """Replaces a pool of worker processes: calls all functions in this process."""

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:  # noqa: D102
        return [function(item) for item in items]


class RoadSearch:
    """Searches for roads on which a car fails: ``ask`` returns a road, ``tell`` receives its outcome, if
    any."""

    def __init__(self, brief: Brief, words: str, seed: int, world: World, setup: Setup) -> None:
        self._brief, self._world = brief, world
        request = Request(words=words, seed=seed, world=world, setup=setup)
        cell = Cell("c01", request, brief, "quality_diversity", "failures")
        self._search = QualityDiversity(cell, is_interpolated=True)
        self._waiting: deque[Proposal] = deque()
        self._asked: tuple[Road, Result] | None = None
        """The last road, and its result but for the outcome; None once the outcome is known."""
        self._told: list[Result] = []
        self._batch = self._number = 0

    def ask(self) -> Road:
        """Returns the road of the next test."""
        if not self._waiting:
            self._search.tell(self._told)
            self._told = []
            found = self._search.ask(self._batch, self._number + 1, self._search.batch_size, HerePool())
            self._batch += 1
            if not found:
                raise DesignError("no road was found that keeps the description; ask for less")
            self._waiting.extend(found)
        proposal = self._waiting.popleft()
        self._number += 1
        given = proposal.design
        design = (
            given if isinstance(given, Design) else draft_road(self._brief, self._world, seed=proposal.seed)
        )
        road = self._world.lay(build(design))
        blank = Result(self._number, self._batch, replace(proposal, design=design), "ERROR", "", design)
        self._asked = road, blank
        return road

    def tell(
        self,
        outcome: str,
        steering: Sequence[float],
        distances: Sequence[float],
        outside: Sequence[float] | None = None,
    ) -> None:
        """Receives the outcome of the last road, once; ignores other outcomes than "PASS" and "FAIL", and
        drives of fewer than three records. For each record: the angle of the steering wheel in degrees, and
        the distance in metres from the car's middle to the edge of its lane, negative outside. ``outside`` is
        where the car was farthest outside, ``[x, y]`` in metres."""
        asked, self._asked = self._asked, None
        if asked is None or outcome not in ("PASS", "FAIL") or len(distances) < execution.FEWEST_RECORDS:
            return
        road, blank = asked
        margin = min(distances) + (self._world.limits.oob_tolerance - 0.5) * CAR_WIDTH
        features = behaviour_of(road, self._brief) | execution.features_of(interpolate(road.control_points()))
        features |= execution.features_of_drive(steering, distances)
        self._told.append(
            replace(
                blank,
                outcome="FAIL" if outcome == "FAIL" else "PASS",
                length=road.length,
                at_s=float(road.locate(*outside[:2])[0]) if outcome == "FAIL" and outside else None,
                margin=min(margin, -1e-3) if outcome == "FAIL" else max(margin, 1e-3),
                features=features,
            )
        )


class RoadGPTTestGenerator(ClientTestGenerator):
    """The client for other interpreters, but it designs the roads in the generator's own process."""

    description: str = USUAL
    designer: str = "planner"
    reader: str = "model"
    search: bool = True
    """Whether outcomes steer the choice of roads, if the designer is ``planner``."""
    oob_tolerance: float | None = None
    """Share of the car, 0 to 1, that may be outside its lane; None: the executor's, or else 0.95."""

    def __init__(self, executor: Any = None, map_size: int | None = None) -> None:
        """Takes what the competition passes; environment variables take precedence over class attributes.
        ``roads`` needs no executor. ``map_size`` is the side of the square map in metres, by default 200."""
        super().__init__(executor)
        self.map_size: int = map_size or MAP_SIZE
        self.description = os.environ.get("ROADGPT_DESCRIPTION", self.description)
        self.designer = os.environ.get("ROADGPT_DESIGNER", self.designer)
        self.reader = os.environ.get("ROADGPT_READER", self.reader)
        self.seed = _whole(os.environ.get("ROADGPT_SEED"), self.seed)
        self.search = _yes_or_no(os.environ.get("ROADGPT_SEARCH"), self.search)
        if self.oob_tolerance is None:
            self.oob_tolerance = getattr(executor, "oob_tolerance", None)
        self._road_search: RoadSearch | None = None

    def tell_columns(  # noqa: D102
        self,
        outcome: str,
        steering: Sequence[float],
        distances: Sequence[float],
        outside: Sequence[float] | None = None,
    ) -> None:
        if self._road_search is not None:
            self._road_search.tell(outcome, steering, distances, outside)

    def roads(self) -> Iterator[Points]:
        """Yields roads as the client does; raises DesignError after 20 failed attempts in a row."""
        world = World().changed(map_size=float(self.map_size), oracle="thesis")
        setup = Setup(reader=self.reader, designer=self.designer, drives=False, chat=_chat(self))
        brief = brief_of(self.description, world, setup)
        if brief.friction is not None:
            log.warning("the competition's simulator sets the friction; the surface in the words is not used")
        if self.search and self.designer == "planner":
            another = self._searching(brief, world, setup)
        else:
            another = self._drafting(brief, world, setup)
        failures = 0
        while True:
            try:
                road = another()
            except (DesignError, chat.ReplyError):
                failures += 1
                if failures >= GIVE_UP:
                    raise
                continue
            points = road_points(road) if road is not None else None
            if points is not None and sbft_verdict(points, world.site.map_size)[0]:
                failures = 0
                yield points
                continue
            failures += 1
            if failures >= GIVE_UP:
                raise DesignError(
                    f"{failures} roads in a row are not valid for the competition on a map of "
                    f"{self.map_size} m; ask for shorter roads or gentler turns"
                )

    def _searching(self, brief: Brief, world: World, setup: Setup) -> Callable[[], Road | None]:
        """Returns a function that returns the next road of a search, which learns from ``tell``."""
        tolerance = self.oob_tolerance
        if isinstance(tolerance, int | float) and 0 < tolerance < 1:
            world = world.changed(oob_tolerance=float(tolerance))
        official = setup.model_copy(update={"rules": "sbft"})
        self._road_search = RoadSearch(brief, self.description, self.seed, world, official)
        return self._road_search.ask

    def _drafting(self, brief: Brief, world: World, setup: Setup) -> Callable[[], Road | None]:
        """Returns a function that drafts the next road; the function returns None if a rule is broken."""
        earlier: deque[Design] = deque(maxlen=REMEMBERED)
        numbers = count(1)

        def another() -> Road | None:
            run = perform(brief, self.seed, world, setup, next(numbers), [*earlier])
            if run.plain_design is not None:
                earlier.append(run.plain_design)
            return run.road if run.is_valid else None

        return another


def road_points(road: Road) -> Points | None:
    """Returns the control points, in metres, of a spline that follows the road; None if the road needs
    more than 500 points.
    """
    if road.length > DENSE * (MOST_POINTS - 1):
        return None
    return [(round(float(x), DECIMALS), round(float(y), DECIMALS)) for x, y in road.control_points()]


def _whole(text: str | None, usual: int) -> int:
    if text is None:
        return usual
    if not text.isdecimal():
        raise UsageError(f"ROADGPT_SEED is '{text}'; give a whole number from 0 up")
    return int(text)


def _yes_or_no(text: str | None, usual: bool) -> bool:
    if text not in (None, "yes", "no"):
        raise UsageError(f"ROADGPT_SEARCH is '{text}'; say yes or no")
    return usual if text is None else text == "yes"


def _chat(made: RoadGPTTestGenerator) -> Any:
    """Returns the settings of the language model if the designer or the reader needs one, else None."""
    parts = (plugins.find("designers", made.designer), plugins.find("readers", made.reader))
    return chat.configured({}) if any(map(chat.asks_a_model, parts)) else None
