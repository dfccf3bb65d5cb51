"""Defines RoadGPT's test generator for the competition's own pipeline. Among the roads that meet a
description, the generator searches for roads on which the car fails.

    python competition.py --module-name roadgpt.sbft --class-name RoadGPTTestGenerator ...

The roads are controlled by environment variables (ROADGPT_DESCRIPTION, ROADGPT_SEED, ROADGPT_DESIGNER,
ROADGPT_READER, ROADGPT_SEARCH) or by a subclass:

    class Hairpins(RoadGPTTestGenerator):
        description = "three hairpins"
        seed = 7
"""

import logging
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from importlib import import_module
from itertools import count
from typing import Any

from roadgpt.brief.model import Brief
from roadgpt.chat import ReplyError
from roadgpt.check import sbft_verdict
from roadgpt.errors import DesignError, UsageError
from roadgpt.road import Design, Road, Site, World
from roadgpt.run import Setup, brief_of, perform
from roadgpt.sbft.search import RoadSearch

log = logging.getLogger(__name__)

USUAL = "a flat road"
MAP_SIZE = 200  # m, the competition's
DECIMALS = 5
DENSE = 2.0  # m, largest distance of road points at which the competition's spline keeps the radii
MOST_POINTS = 500
GIVE_UP = 20  # failed roads in a row after which the generator gives up
REMEMBERED = 50  # previous designs that the next one must not repeat

Points = list[tuple[float, float]]


class RoadGPTTestGenerator:
    """Submits roads that meet a description, one after another, until the budget is used up."""

    description = USUAL
    seed = 0
    designer = "planner"
    reader = "model"
    search = True
    """Whether outcomes steer the choice of roads. Without a search, or with another designer than
    ``planner``, roads are drafted one after another."""
    oob_tolerance: float | None = None
    """Share of the car, 0 to 1, that may be outside its lane; None: the executor's ``oob_tolerance``, or the
    World's default if the executor has none.
    """

    def __init__(self, executor: Any = None, map_size: int | None = None) -> None:
        """Takes the arguments that the competition passes. Environment variables take precedence over class
        attributes.

        Args:
            executor: the competition's executor, which drives the roads; None if only ``roads`` is used.
            map_size: side length of the square map, metres; None: 200 m.

        Raises:
            UsageError: the environment variable ROADGPT_SEED or ROADGPT_SEARCH has an invalid value.
        """
        self.executor = executor
        self.map_size = map_size or MAP_SIZE
        self.description = os.environ.get("ROADGPT_DESCRIPTION", self.description)
        self.designer = os.environ.get("ROADGPT_DESIGNER", self.designer)
        self.reader = os.environ.get("ROADGPT_READER", self.reader)
        self.seed = _whole(os.environ.get("ROADGPT_SEED"), self.seed)
        self.search = _yes_or_no(os.environ.get("ROADGPT_SEARCH"), self.search)
        if self.oob_tolerance is None:
            self.oob_tolerance = getattr(executor, "oob_tolerance", None)
        self._told: Callable[[str, Sequence[float], Sequence[float], Sequence[float] | None], None] = _unheard

    def start(self) -> None:
        """Submits tests to the executor, one after another, until the budget is used up.

        Raises:
            BriefError: the description cannot be read, or demands something that the map does not allow.
            DesignError: no valid road was found in 20 attempts in a row.
            ChatError: a language model cannot be used, or its answers are not usable.
        """
        create: Callable[[Points], Any] = import_module(
            "code_pipeline.tests_generation"
        ).RoadTestFactory.create_road_test
        for points in self.roads():
            if self.executor.is_over():
                return
            outcome, said, records = self.executor.execute_test(create(points))
            log.info("%s: %s", outcome, said)
            self.tell(outcome, records)

    def tell(self, outcome: str, records: Sequence[Any] | None) -> None:
        """Reports the outcome of the last road, so that the search learns from it.

        Args:
            outcome: "PASS", "FAIL" or another outcome of the competition.
            records: the execution data of the drive; each record has ``steering`` and ``oob_distance``, and
                should have ``pos``.
        """
        steering = [float(record.steering) for record in records or ()]
        distances = [float(record.oob_distance) for record in records or ()]
        outside = min(records, key=lambda record: float(record.oob_distance)) if records else None
        self.tell_columns(outcome, steering, distances, getattr(outside, "pos", None))

    def tell_columns(
        self,
        outcome: str,
        steering: Sequence[float],
        distances: Sequence[float],
        outside: Sequence[float] | None = None,
    ) -> None:
        """Reports the outcome of the last road as ``tell`` does, with the records as two columns.

        Args:
            outcome: as for ``tell``.
            steering: angle of the steering wheel in each record, degrees.
            distances: ``oob_distance`` of each record, metres.
            outside: position ``[x, y]`` of the record with the smallest ``oob_distance``, if known.
        """
        self._told(outcome, steering, distances, outside)

    def roads(self) -> Iterator[Points]:
        """Yields roads without end, each as its control points in metres. The points are at most 2 m apart,
        there are at most 500 per road, and every road is valid in the competition.

        Raises:
            BriefError, DesignError, ChatError: as for ``start``.
        """
        world = World(site=Site(map_size=float(self.map_size)))
        setup = Setup(reader=self.reader, designer=self.designer, drives=False, chat=_chat(self))
        brief = brief_of(self.description, world, setup)
        if brief.friction is not None:
            log.warning("the competition's simulator sets the friction; the surface in the words is not used")
        searches = self.search and self.designer == "planner"
        another = self._searching(brief, world, setup) if searches else self._drafting(brief, world, setup)
        failures = 0
        while True:
            try:
                road = another()
            except (DesignError, ReplyError):
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
        search = RoadSearch(brief, self.description, self.seed, world, official)

        def another() -> Road:
            number, _, road = search.ask()
            self._told = partial(search.tell, number)
            return road

        return another

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
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model, configured

    parts = (plugins.find("designers", made.designer), plugins.find("readers", made.reader))
    return configured({}) if any(map(asks_a_model, parts)) else None


def _unheard(
    outcome: str, steering: Sequence[float], distances: Sequence[float], outside: Sequence[float] | None
) -> None:
    """Takes an outcome from which nobody learns."""
    del outcome, steering, distances, outside
