"""The test generator ``words``: roads for one description, each different from the earlier ones."""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result


class Words:
    """Proposes roads for one description; the workers design them in the same way as ``roadgpt run``."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None:
        self._seed = cell.request.seed

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Returns n equal proposals without a design: the workers design the roads."""
        return [Proposal(None, self._seed, "draft")] * n

    def tell(self, results: Sequence[Result]) -> None:
        """Ignores the results; the scheduler passes earlier designs to the workers that design roads."""
