"""Holds the total cost of a campaign's questions, and stops before a limit is exceeded.

Each reader and each designer has its own Chat; one Meter counts for all of them. ``counting`` makes a meter
the current one inside a ``with`` block. A Chat counts its questions with an Account (``chat.account``).
"""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from roadgpt.chat.model import ChatSettings, Spent
from roadgpt.errors import BudgetError

ENDLESS = 10**15
LEAST_REPLY = 64  # tokens; a shorter answer is of no use


class Meter:
    """Counts tokens, seconds and money, and compares tokens and money with the limits of a campaign."""

    def __init__(self, max_tokens: int | None = None, max_cost: float | None = None) -> None:
        self.max_tokens, self.max_cost = max_tokens, max_cost
        self.spent = Spent()
        self.turns: Counter[tuple[str, str, str]] = Counter()
        """How many answers to a question on an occasion were recorded or replayed; used by recordings."""

    @classmethod
    def of(cls, settings: ChatSettings | None) -> "Meter":
        """Returns a Meter with the limits in the settings; if ``settings`` is None, the Meter has no
        limits.
        """
        return cls() if settings is None else cls(settings.max_tokens, settings.max_cost)

    def add(self, spent: Spent) -> None:
        """Adds costs to the total."""
        self.spent = self.spent + spent

    def reply_tokens(self, prompt: int, most: int, price: tuple[float, float] | None, model: str) -> int:
        """Returns the largest number of tokens that an answer may have without exceeding a limit.

        Args:
            prompt: estimated number of tokens of the question.
            most: the largest number of tokens allowed for any answer.
            price: USD per million tokens of prompt and of completion; None if unknown.
            model: name of the model, for the error message.

        Raises:
            BudgetError: too few tokens are left for an answer.
        """
        reply_tokens = min(most, self._tokens_left(prompt), self._affordable(prompt, price, model))
        if reply_tokens >= LEAST_REPLY:
            return reply_tokens
        spent = self.spent
        limit, so_far, flag = f"{self.max_tokens or 0:,} tokens", f"{spent.usage.total:,}", "--max-tokens"
        if self._tokens_left(prompt) > reply_tokens:
            limit, so_far, flag = f"{self.max_cost or 0:g} USD", f"{spent.cost or 0:.4f}", "--max-cost"
        raise BudgetError(
            f"the limit of {limit} is too low for the next question ({so_far} are spent); "
            f"continue with the same command, --out and a higher {flag}"
        )

    def _tokens_left(self, prompt: int) -> int:
        if self.max_tokens is None:
            return ENDLESS
        return self.max_tokens - self.spent.usage.total - prompt

    def _affordable(self, prompt: int, price: tuple[float, float] | None, model: str) -> int:
        """Returns the largest number of tokens in an answer that the remaining money can pay for."""
        if self.max_cost is None:
            return ENDLESS
        if price is None or self.spent.cost is None:
            raise BudgetError(
                f"the price of '{model}' is not known, so --max-cost cannot be checked; "
                "give --price 0.15/0.60 (USD per million tokens of question and answer)"
            )
        left = self.max_cost - self.spent.cost - prompt * price[0] / 1e6
        if price[1] > 0:
            return int(left * 1e6 / price[1])
        return ENDLESS if left >= 0 else 0


@dataclass(frozen=True)
class _Now:
    meter: Meter
    occasion: str


_now: ContextVar[_Now | None] = ContextVar("roadgpt_meter", default=None)


@contextmanager
def counting(meter: Meter, occasion: str = "") -> Iterator[Meter]:
    """Makes this meter count all questions that are asked inside a ``with`` block.

    Args:
        meter: the meter.
        occasion: a label for what the questions are about, such as "road 3"; recordings use it to
            distinguish a question about one road from the same question about another.
    """
    before = _now.set(_Now(meter, occasion))
    try:
        yield meter
    finally:
        _now.reset(before)


def meter_now() -> Meter | None:
    """Returns the current meter; None if no campaign is counting."""
    now = _now.get()
    return now.meter if now else None


def occasion() -> str:
    """Returns the label of the current questions, as given to ``counting``; empty if there is none."""
    now = _now.get()
    return now.occasion if now else ""
