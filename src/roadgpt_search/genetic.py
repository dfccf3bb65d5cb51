"""The test generator ``genetic``: a plain genetic algorithm whose roads all satisfy the Brief.

The fittest roads so far, those with the smallest margins, are crossed and mutated; the parents are the
winners of small tournaments. The generator has no feature map and no surrogate, and serves as a baseline for
``quality_diversity``.
"""

import numpy as np

from roadgpt.campaign.model import Cell, Goal, Pool, Proposal, Result
from roadgpt.road import Design
from roadgpt_search.searching import SearchGenerator
from roadgpt_search.variation import VariationTask

POPULATION = 20  # of the fittest
TOURNAMENT = 3
CROSSED = 0.6  # share of children with two parents; the others have one


class Genetic(SearchGenerator):
    """A genetic algorithm with tournaments, crossover and mutation."""

    goals: tuple[Goal, ...] = ("failures", "hardest")  # both need only a comparison of margins

    def __init__(self, cell: Cell) -> None:
        """Begins with an empty population; raises UsageError if a setting cannot be used."""
        super().__init__(cell)
        self._fittest: list[tuple[float, int, Design]] = []

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Proposes children of the fittest roads; until the first results arrive, proposes random drafts."""
        rng = self._rng(batch)
        tasks = [self._task(rng) for _ in range(n)]
        return self._proposals(first, n, self._candidates(tasks, pool))

    def _learn(self, result: Result) -> None:
        assert result.margin is not None
        assert result.plain_design is not None
        found = [*self._fittest, (result.margin, result.number, result.plain_design)]
        self._fittest = sorted(found, key=lambda one: one[:2])[:POPULATION]

    def _task(self, rng: np.random.Generator) -> VariationTask:
        seed = (int(rng.integers(2**53)),)
        if not self._fittest:
            return VariationTask("draft", (), "draft", seed, self._setting)
        (_, number, mother), (_, other, father) = self._winner(rng), self._winner(rng)
        if rng.random() < CROSSED and number != other:
            return VariationTask("cross", (mother, father), f"cross {number}+{other}", seed, self._setting)
        return VariationTask("vary", (mother,), f"vary {number}", seed, self._setting)

    def _winner(self, rng: np.random.Generator) -> tuple[float, int, Design]:
        drawn = rng.integers(len(self._fittest), size=TOURNAMENT)
        return self._fittest[int(drawn.min())]  # they are sorted
