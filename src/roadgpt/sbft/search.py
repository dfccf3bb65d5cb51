"""Searches for failing roads one road at a time; the caller drives the roads, in any simulator."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from roadgpt.brief.model import Brief
from roadgpt.campaign.behaviour import behaviour_of
from roadgpt.campaign.generators.quality_diversity import QualityDiversity
from roadgpt.campaign.model import Cell, Proposal, Result
from roadgpt.design import draft_road
from roadgpt.errors import DesignError
from roadgpt.geometry import interpolate
from roadgpt.road import Design, Road, World, build
from roadgpt.run import Request, Setup
from roadgpt.run.features import FEWEST_RECORDS, features_of, features_of_drive

KEPT = 100  # latest tests whose outcomes are still accepted
CAR_WIDTH = 2.0  # m, width of a typical car, with which the margin of a drive is estimated

T = TypeVar("T")
U = TypeVar("U")


class HerePool:
    """Replaces a pool of worker processes: calls all functions in this process."""

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items."""
        return [function(item) for item in items]


class RoadSearch:
    """Searches for roads on which a car fails: ``ask`` returns a road, and ``tell`` receives its outcome.

    Outcomes are accepted only for the latest 100 tests. The search ignores roads without an outcome.
    """

    def __init__(self, brief: Brief, words: str, seed: int, world: World, setup: Setup) -> None:
        """Begins a search among the roads that meet a description.

        Args:
            brief: the requirements that every road satisfies.
            words: the description.
            seed: seed of the search.
            world: the map, and the share of the car outside its lane above which a drive fails.
            setup: the rules that every road satisfies.

        Raises:
            UsageError: a search cannot make such roads, for example because they have junctions.
        """
        request = Request(words=words, seed=seed, world=world, setup=setup)
        self._cell = Cell("c01", request, brief, "quality_diversity", "failures")
        self._search = QualityDiversity(self._cell, is_interpolated=True)
        self._waiting: deque[Proposal] = deque()
        self._asked: dict[int, tuple[Road, Result]] = {}
        self._told: list[Result] = []
        self._batch = self._number = 0

    def ask(self) -> tuple[int, Design, Road]:
        """Returns the next test: its number, counted from 1, the design of its road, and the road.

        Raises:
            DesignError: no road can be designed.
        """
        while not self._waiting:
            self._think()
        proposal = self._waiting.popleft()
        self._number += 1
        world, brief = self._cell.request.world, self._cell.brief
        assert brief is not None
        given = proposal.design
        design = given if isinstance(given, Design) else draft_road(brief, world, seed=proposal.seed)
        road = world.lay(build(design))
        blank = Result(self._number, self._batch, replace(proposal, design=design), "ERROR", "", design)
        self._asked[self._number] = road, blank
        self._asked.pop(self._number - KEPT, None)
        return self._number, design, road

    def _think(self) -> None:
        """Chooses the next batch from all that was told."""
        self._search.tell(self._told)
        self._told = []
        found = self._search.ask(self._batch, self._number + 1, self._search.batch_size, HerePool())
        self._batch += 1
        if not found:
            raise DesignError("no road was found that keeps the description; ask for less")
        self._waiting.extend(found)

    def tell(
        self,
        number: int,
        outcome: str,
        steering: Sequence[float],
        distances: Sequence[float],
        outside: Sequence[float] | None = None,
    ) -> None:
        """Receives the outcome of a test.

        Args:
            number: the number that ``ask`` returned. Other numbers are ignored, and so are tests whose
                outcome was already received or that are not among the latest 100.
            outcome: "PASS" or "FAIL"; tests with another outcome, or with fewer than three records, are
                ignored.
            steering: angle of the steering wheel in degrees at each record of the drive.
            distances: distance in metres from the car's middle to the edge of its lane at each record,
                negative outside (``oob_distance`` of the competition).
            outside: where the car was farthest outside, ``[x, y]`` in metres; None if this is not known, and
                then the search learns less of where the car fails.
        """
        asked = self._asked.pop(number, None)
        if asked is None or outcome not in ("PASS", "FAIL") or len(distances) < FEWEST_RECORDS:
            return
        road, blank = asked
        tolerance = self._cell.request.world.limits.oob_tolerance
        margin = min(distances) + (tolerance - 0.5) * CAR_WIDTH
        features = behaviour_of(road, self._cell.brief) | features_of(interpolate(road.control_points()))
        features |= features_of_drive(steering, distances)
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
