"""The test generator ``given``: roads that are there, one after another."""

from collections.abc import Sequence

from roadgpt.campaign.given import given_roads
from roadgpt.campaign.model import Cell, Pool, Proposal, Result
from roadgpt.errors import UsageError
from roadgpt.run import seed_of


class Given:
    """Proposes the roads of a folder in their order; after the last one the first again, with another
    seed."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None:
        self._seed, self._roads = cell.request.seed, given_roads(cell.settings)
        if not self._roads:
            raise UsageError("the generator 'given' tests roads that are there; say which: --on FOLDER")

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Returns the next n roads."""
        numbered = [(n, self._roads[(n - 1) % len(self._roads)]) for n in range(first, first + n)]
        return [Proposal(road, seed_of(self._seed, number), road.name) for number, road in numbered]

    def tell(self, results: Sequence[Result]) -> None:
        """Ignores the results."""
