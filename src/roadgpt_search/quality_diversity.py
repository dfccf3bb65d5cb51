"""The test generator ``quality_diversity``: searches for diverse roads that satisfy the Brief and make the
car fail.

    elites of the maps --mutate--> 40 sketches for each test --surrogate--> the best are built and driven

MAP-Elites (Mouret, Clune 2015) with a surrogate (Gaier, Asteroth, Mouret 2018): a drive takes far longer than
sketching a road, so the outcomes on most sketches are only predicted. The goal decides which sketches are
valuable. Batches 0 and 1 are requested before any result is known; they consist of diverse roads that look
hard.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.element import Elements
from roadgpt.campaign.model import GOALS, Cell, Goal, Pool, Proposal, Result
from roadgpt.design.elements import elements_of
from roadgpt.design.variety import PlanShape
from roadgpt.geometry.curve import Array
from roadgpt.road import Design
from roadgpt_search.archive import Archive, is_far, select, spread_out, stacked
from roadgpt_search.behaviour import DRIVEN
from roadgpt_search.boundary_pairs import paired
from roadgpt_search.searching import SearchGenerator
from roadgpt_search.surrogate import (
    FEWEST,
    FEWEST_FAILURES,
    MOST,
    NAMES,
    STEERING,
    TREES,
    DepartureModel,
    Surrogate,
    hazard_of,
    target_of,
)
from roadgpt_search.variation import (
    NUMERIC,
    Candidate,
    Kind,
    Sketch,
    VariationTask,
    candidate_of,
    sketch,
    sketch_of,
)

KINDS: tuple[Kind, ...] = ("vary", "cross", "wild")
OFTEN = (0.7, 0.27, 0.03)  # share of sketches of each kind, once there are results
OFTEN_AT_BOUNDARY = (0.97, 0.0, 0.03)  # a crossover corresponds to hardly any other road (boundary_pairs)
UNTAUGHT = 12  # sketches for each road as long as there are no results, when every sketch needs a draft
SPARE = 6  # sketches that are kept for each road to drive, since some violate a requirement or a rule
FAILED_PARENTS = 0.5  # share of parents drawn from failed elites; the others are drawn from all elites
BISECTED = 0.6  # share of a batch that lies between two tests, if the goal is the boundary
SHARES = (0.5, 0.3, 0.7)  # position between the roads of a pair; changes by batch, so that roads do too
CLOSE = 0.05  # distance up to which a pair is near enough (see boundary_pairs.distance)


class QualityDiversity(SearchGenerator):
    """Searches for roads that serve a goal; uses one or two feature maps of elites and a surrogate model."""

    goals = GOALS

    def __init__(self, cell: Cell, is_interpolated: bool = False) -> None:
        """Begins with empty maps; raises UsageError if a setting cannot be used. ``is_interpolated`` says
        whether the roads are driven as the competition interpolates them."""
        super().__init__(cell)
        self._setting = self._setting._replace(is_interpolated=is_interpolated)
        self._goal: Goal = cell.goal or "failures"
        self._maps = [Archive(axes, self._wanted.cells) for axes in self._wanted.maps]
        self._driven = [axis for axis in self._setting.axes if axis in DRIVEN]
        self._results: dict[int, Result] = {}
        self._looks: dict[int, tuple[Sketch, PlanShape]] = {}
        self._roads: dict[int, Elements] = {}
        self._elites: list[int] = []

    def _learn(self, result: Result) -> None:
        """Adds a result to the maps; everything else is computed in ``ask``."""
        assert result.margin is not None
        self._results[result.number] = result
        for each in self._maps:
            each.add(result.number, result.features, -result.margin, result.failed)

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Proposes the candidates that are most valuable for the goal."""
        rng = self._rng(batch)
        self._look(pool)
        elites = dict.fromkeys(number for each in self._maps for number in each.elites())
        self._elites = [*elites] or list(self._results)
        found = self._bisected(batch, n, pool) if self._goal == "boundary" else []
        missing = n - len(found)
        usual = self._wanted.candidates
        each = usual if self._results else min(usual, UNTAUGHT)
        tasks = [self._task(rng) for _ in range(missing * each)]
        sketches = [one for one in pool.map(sketch, tasks) if one is not None]
        found += self._built(self._chosen(sketches, SPARE * missing), missing, pool)
        return self._proposals(first, n, found)

    def _look(self, pool: Pool) -> None:
        """Sketches the roads added since the last call; keeps those of the last 1500."""
        known = list(self._results)[-MOST:]
        self._looks = {number: self._looks[number] for number in known if number in self._looks}
        new = [number for number in known if number not in self._looks]
        found = pool.map(sketch_of, [(self._design(number), self._setting) for number in new])
        self._looks |= dict(zip(new, found, strict=True))

    def _built(self, sketches: Sequence[Sketch], n: int, pool: Pool) -> list[Candidate]:
        """Returns the first n sketches that keep every requirement and rule and resemble no tested road."""
        found: list[Candidate] = []
        tested = stacked([shape for _, shape in self._looks.values()]) if self._looks else None
        at = 0
        while len(found) < n and at < len(sketches):
            some = sketches[at : at + n - len(found)]
            at += len(some)
            for one in pool.map(candidate_of, [(each, self._setting) for each in some]):
                if one is None or not is_far(one.shape, tested, self._wanted.apart):
                    continue
                own = stacked([other.shape for other in found]) if found else None
                if is_far(one.shape, own, self._wanted.apart):
                    found.append(one)
        return found

    def _task(self, rng: np.random.Generator) -> VariationTask:
        """Draws the task to make one candidate: a variation of one elite, a crossover of two, or a new road.
        Elites that failed are preferred, unless the goal is coverage."""
        often = OFTEN_AT_BOUNDARY if self._goal == "boundary" else OFTEN
        kind = KINDS[int(rng.choice(len(KINDS), p=often))] if self._results else "wild"
        seed = (int(rng.integers(2**53)),)
        if kind == "wild":
            return VariationTask(kind, (), "draft", seed, self._setting)
        numbers = [self._parent(rng) for _ in range(1 + (kind == "cross"))]
        parents = tuple(self._design(number) for number in numbers)
        origin = f"{kind} {'+'.join(map(str, numbers))}"
        numeric = NUMERIC[self._goal == "boundary"]  # relatives have the same row of turns and straights
        return VariationTask(kind, parents, origin, seed, self._setting, numeric=numeric)

    def _parent(self, rng: np.random.Generator) -> int:
        elites = self._elites
        failed = [number for number in elites if self._results[number].failed]
        if self._goal != "coverage" and failed and rng.random() < FAILED_PARENTS:
            elites = failed
        return elites[int(rng.integers(len(elites)))]

    def _chosen(self, sketches: Sequence[Sketch], n: int) -> list[Sketch]:
        if not sketches:
            return []
        features = [one.surrogate_features for one in sketches]
        if len(self._looks) < FEWEST:
            return [sketches[i] for i in spread_out(features, n, hazard_of(features))]
        results = [self._results[number] for number in self._looks]
        known, fresh = self._seen(results, sketches)
        columns = (*STEERING, *range(len(NAMES), known.shape[1] - 1))
        guesses = {1 + self._driven.index("STD_SA"): columns} if "STD_SA" in self._driven else {}
        driven = [[its.features.get(axis, 0.0) for axis in self._driven] for its in results]
        targets = [target_of(its.margin or 0.0, its.failed) for its in results]
        outcomes = [[one, *others] for one, others in zip(targets, driven, strict=True)]
        model = Surrogate([*known], outcomes, guesses)
        opinions = model.opinions([*fresh])
        cells = [self._cells(each, opinions, sketches) for each in self._maps]
        counts = [each.tests if self._goal == "coverage" else each.failures for each in self._maps]
        return [sketches[i] for i in select(self._goal, n, opinions[..., 0], cells, counts)]

    def _seen(self, results: Sequence[Result], sketches: Sequence[Sketch]) -> tuple[Array, Array]:
        """Returns what the trees see of the driven roads, and of sketches: a row for each road."""
        looks = [look for look, _ in self._looks.values()]
        known, fresh = (np.array([one.surrogate_features for one in some]) for some in (looks, sketches))
        told = [at for at, one in enumerate(results) if not one.failed or one.at_s is not None]
        if sum(results[at].failed for at in told) < FEWEST_FAILURES:
            return known, fresh
        places = DepartureModel([looks[at].stations for at in told], [results[at].at_s for at in told])
        here, there = (places.predict([one.stations for one in some]) for some in (looks, sketches))
        return np.concatenate([known, here], axis=1), np.concatenate([fresh, there], axis=1)

    def _cells(self, archive: Archive, opinions: Array, sketches: Sequence[Sketch]) -> NDArray[np.intp]:
        """Returns the cells ``(trees, n)`` of a map that the trees predict for n sketches."""
        places = np.zeros((TREES, len(sketches), len(archive.axes)))
        for column, axis in enumerate(archive.axes):
            if axis in self._driven:
                places[..., column] = opinions[..., 1 + self._driven.index(axis)]
            else:
                places[..., column] = [one.features.get(axis, 0.0) for one in sketches]
        return archive.cells(places.reshape(-1, places.shape[-1])).reshape(places.shape[:2])

    def _bisected(self, batch: int, n: int, pool: Pool) -> list[Candidate]:
        """Returns roads that lie between a passed test and the most similar failed test."""
        for number in self._results.keys() - self._roads:
            self._roads[number] = elements_of(self._design(number).segments)
        kept = [number for number, result in self._results.items() if not result.failed]
        lost = [number for number, result in self._results.items() if result.failed]
        tasks: list[VariationTask] = []
        for pair in paired(self._roads, kept, lost):
            if pair.distance > CLOSE and len(tasks) < BISECTED * n:
                ends = self._design(pair.kept), self._design(pair.lost)
                origin = f"between {pair.kept}+{pair.lost}"
                share = SHARES[batch % len(SHARES)]
                tasks.append(VariationTask("between", ends, origin, (batch,), self._setting, share))
        return self._candidates(tasks, pool)

    def _design(self, number: int) -> Design:
        design = self._results[number].plain_design
        assert design is not None
        return design
