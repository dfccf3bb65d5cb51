from collections.abc import Callable

from roadgpt.campaign.single_test import Allowance
from roadgpt.chat import ChatSettings, Spent


class BudgetAllocator:
    """Divides a campaign's limits on tokens and money among the tests that run at the same time. The campaign
    stays within the limits even if every test spends its whole allowance."""

    def __init__(self, chat: ChatSettings | None, tokens: int, cost: float) -> None:
        """Takes the limits, and the tokens and USD that were spent before."""
        self._limits = Allowance(chat.max_tokens, chat.max_cost) if chat else Allowance()
        self._spent = [float(tokens), cost]
        self._given: dict[int, Allowance] = {}

    def share(self, parts: int = 1) -> Allowance:
        """Divides the remaining tokens and money into ``parts`` equal parts; returns one part."""
        tokens, cost = self._limits
        if tokens is not None:
            tokens -= int(self._spent[0] + sum(given.tokens or 0 for given in self._given.values()))
            tokens = int(max(tokens, 0) / parts)
        if cost is not None:
            cost -= self._spent[1] + sum(given.cost or 0.0 for given in self._given.values())
            cost = max(cost, 0.0) / parts
        return Allowance(tokens, cost)

    def give(self, key: int, allowance: Allowance) -> None:
        """Reserves an allowance for a test that is about to start; ``key`` identifies the test."""
        self._given[key] = allowance

    def back(self, key: int, spent: Spent | None) -> None:
        """Releases the allowance of a test that has ended, and counts the tokens and money it spent."""
        self._given.pop(key, None)
        if spent is not None:
            self._spent[0] += spent.usage.total
            self._spent[1] += spent.cost or 0.0

    def sentence(self, to_resume: Callable[..., str]) -> str:
        """Returns a message that says which limit was reached, and how to go on with twice this limit;
        ``to_resume`` returns the command that continues the campaign, with further options."""
        tokens, cost = self._limits
        is_cost = tokens is None or (cost is not None and self.share().cost == 0)
        limit = f"{cost:g} USD" if is_cost else f"{tokens:,} tokens"
        more = ("--max-cost", f"{2 * (cost or 0):g}") if is_cost else ("--max-tokens", 2 * (tokens or 0))
        so_far = f"{self._spent[0]:,.0f} tokens and {self._spent[1]:.4f} USD are spent"
        return (
            f"the limit of {limit} leaves no room for the next question ({so_far}); "
            f"continue with a higher one, such as: {to_resume(*more)}"
        )
