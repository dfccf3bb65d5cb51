"""The test generator ``words``: roads of one description, each different from the earlier ones."""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result


class Words:
    """Roads of one description that the workers draft, as ``roadgpt run`` does."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None:
        self._seed = cell.request.seed

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Proposes the next roads."""
        return [Proposal(None, self._seed, "draft")] * n

    def tell(self, results: Sequence[Result]) -> None:
        """Ignores the results; the scheduler passes earlier designs to the drafting workers."""
