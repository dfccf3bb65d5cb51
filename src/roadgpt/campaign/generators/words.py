"""The test generator ``words``: roads for one description, each different from the earlier ones, or one for
each scenario."""

from collections.abc import Sequence

from roadgpt.campaign.model import Cell, Pool, Proposal, Result


class Words:
    """Proposes roads for one description; the workers design them in the same way as ``roadgpt run``."""

    batch_size = 16

    def __init__(self, cell: Cell) -> None:
        self._seed, self._points = cell.request.seed, cell.points[0]

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Returns n proposals without a design: the workers design the roads. They are equal, but for the
        scenarios, one after another; after the last one comes the first again."""
        if not self._points:
            return [Proposal(None, self._seed, "draft")] * n
        numbers = (number % len(self._points) for number in range(first - 1, first - 1 + n))
        return [Proposal(None, self._seed, str(self._points[number])) for number in numbers]

    def tell(self, results: Sequence[Result]) -> None:
        """Ignores the results; the scheduler passes earlier designs to the workers that design roads."""
