"""Holds the total cost of a campaign's questions, and stops before a limit is exceeded.

Each reader and each designer has its own Chat, which counts its questions with an Account; one Meter counts
for all of them. ``counting`` makes a meter the current one inside a ``with`` block.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from math import ceil
from typing import NamedTuple

from roadgpt.chat.model import LEAST_REPLY, ChatSettings, Message, Spent, Usage
from roadgpt.chat.prices import cost_of, price_of
from roadgpt.errors import BudgetError

LETTERS_PER_TOKEN = 4  # bytes of English and JSON; an estimate until the server has counted
ENDLESS = 10**15


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

    def reply_tokens(self, messages: Sequence[Message], settings: ChatSettings, model: str) -> int:
        """Returns the largest number of tokens that the answer to these messages may have without exceeding a
        limit. Raises BudgetError if too few are left, or if money is limited and a price is unknown.
        """
        prompt = tokens_in(*(message.text for message in messages))
        affordable = self._affordable(prompt, price_of(settings, model), model)
        reply_tokens = min(settings.max_completion, self._tokens_left(prompt), affordable)
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
            from roadgpt.chat.strict_json import plain  # only for the message

            raise BudgetError(
                f"the price of '{plain(model)}' is not known, so --max-cost cannot be checked; "
                "give --price 0.15/0.60 (USD per million tokens of question and answer)"
            )
        left = self.max_cost - self.spent.cost - prompt * price[0] / 1e6
        if price[1] > 0:
            return int(left * 1e6 / price[1])
        return ENDLESS if left >= 0 else 0


class _Now(NamedTuple):
    meter: Meter | None = None
    occasion: str = ""


NOBODY = _Now()
_now: ContextVar[_Now] = ContextVar("roadgpt_meter", default=NOBODY)


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


def occasion() -> str:
    """Returns the label of the current questions, as given to ``counting``; empty if there is none."""
    return _now.get().occasion


class Account:
    """Counts what one Chat spends, and adds the same amounts to the campaign's Meter. Without a campaign,
    they are added to the Chat's own Meter.
    """

    def __init__(self, settings: ChatSettings) -> None:
        self.settings = settings
        self.spent = Spent()
        self._own = Meter.of(settings)

    @property
    def meter(self) -> Meter:
        """The meter of the current campaign; the Chat's own meter if there is no campaign."""
        return _now.get().meter or self._own

    def count(self, model: str, usage: Usage, seconds: float) -> None:
        """Counts one answered request."""
        cost = cost_of(usage, price_of(self.settings, model))
        self.add(Spent(calls=1, usage=usage, seconds=seconds, cost=cost))

    def add(self, spent: Spent) -> None:
        """Adds costs that are already known, such as those of a recorded exchange."""
        self.spent = self.spent + spent
        self.meter.add(spent)


def tokens_in(*texts: str) -> int:
    """Returns the estimated number of tokens of some texts."""
    return sum(ceil(len(text.encode("utf-8", "replace")) / LETTERS_PER_TOKEN) for text in texts)
