"""The generator ``words``: so many roads of one description, each different from those before it."""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result


class Words:
    """Roads of one description, drafted by the workers, as ``roadgpt run`` makes them."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None:
        self._seed = cell.request.seed

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """The next roads."""
        return [Proposal(None, self._seed, "draft")] * n

    def tell(self, results: Sequence[Result]) -> None:
        """A draft is shown all earlier designs as it is; nothing else is learnt here."""
