"""The test generator ``random``: independent drafts of the planner.

It is the baseline for searches: its roads satisfy the Brief too, but the generator does not learn from
results.
"""

from roadgpt.campaign.model import Pool, Proposal
from roadgpt_search.searching import SearchGenerator
from roadgpt_search.variation import VariationTask


class Random(SearchGenerator):
    """Proposes roads that the planner drafts independently of each other."""

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Proposes up to n drafts of the planner."""
        seeds = self._rng(batch).integers(2**53, size=n)
        tasks = [VariationTask("draft", (), "draft", (int(seed),), self._setting) for seed in seeds]
        return self._proposals(first, n, self._candidates(tasks, pool))
