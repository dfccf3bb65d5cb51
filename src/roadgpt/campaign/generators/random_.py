"""The test generator ``random``: independent drafts of the planner.

It is the baseline for searches: its roads satisfy the Brief too, but the generator does not learn from
results.
"""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result
from roadgpt.campaign.search import batch_rng, context_of, make_candidates, proposals_of, settings_of
from roadgpt.campaign.variation import VariationTask


class Random:
    """Proposes roads that the planner drafts independently of each other."""

    def __init__(self, cell: Cell) -> None:
        """Reads the settings.

        Raises:
            UsageError: a setting cannot be used.
        """
        self._cell = cell
        self.batch_size = settings_of(cell).batch

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Proposes up to n drafts of the planner."""
        rng = batch_rng(self._cell, batch)
        setting = context_of(self._cell)
        tasks = [
            VariationTask("draft", (), "draft", (int(seed),), setting) for seed in rng.integers(2**53, size=n)
        ]
        return proposals_of(self._cell, first, n, make_candidates(tasks, pool))

    def tell(self, results: Sequence[Result]) -> None:
        """Ignores the results."""
