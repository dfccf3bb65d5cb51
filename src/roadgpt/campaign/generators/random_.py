"""The generator ``random``: one fresh draft of the planner after another, without looking back.

What searches are measured against: it keeps the Brief as they do, and learns nothing.
"""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result
from roadgpt.campaign.search import batch_rng, context_of, make_candidates, proposals_of, settings_of
from roadgpt.campaign.variation import VariationTask


class Random:
    """Drafts, each by itself."""

    def __init__(self, cell: Cell) -> None:
        """Nothing to prepare.

        Raises:
            UsageError: a setting cannot be.
        """
        self._cell = cell
        self.batch_size = settings_of(cell).batch

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """The next drafts."""
        rng = batch_rng(self._cell, batch)
        setting = context_of(self._cell)
        tasks = [
            VariationTask("draft", (), "draft", (int(seed),), setting) for seed in rng.integers(2**53, size=n)
        ]
        return proposals_of(self._cell, first, n, make_candidates(tasks, pool))

    def tell(self, results: Sequence[Result]) -> None:
        """Nothing is learnt."""
