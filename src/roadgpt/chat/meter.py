"""Holds the total cost of a campaign's questions, and stops before a limit is exceeded.

Each reader and each designer has its own Chat, which counts its questions with an Account; one Meter counts
for all of them. ``counting`` makes a meter the current one inside a ``with`` block.

Prices are in USD per million tokens, separately for the question and the answer; ``prices.toml`` has those of
OpenAI, and their source. Discounts for cached prompts are not counted, so a computed cost may be too high,
but not too low. No price is known for models that are not in the table, nor for any model on a server other
than OpenAI's. For these, the user gives the price with ``--price``."""

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from math import ceil, inf
from pathlib import Path
from urllib.parse import urlsplit

from roadgpt.chat.model import LEAST_REPLY, OPENAI, ChatSettings, Message, Spent, Usage, two_prices
from roadgpt.errors import BudgetError
from roadgpt.reading import read_text

PRICES: dict[str, list[float]] = tomllib.loads(read_text(Path(__file__).with_name("prices.toml")))
DATED = re.compile(r"-\d{4}-\d{2}-\d{2}$")  # suffix of a dated snapshot of a model
SOLD_BY = ("api.openai.com", ".openai.azure.com")


def has_openai_prices(base_url: str | None) -> bool:
    """Returns True if the server charges OpenAI's prices."""
    host = urlsplit(base_url or OPENAI).hostname or ""
    return host.endswith(SOLD_BY)


def price_of(settings: ChatSettings, model: str = "") -> tuple[float, float] | None:
    """Returns the prices of a model: USD per million tokens of prompt and of completion; None if unknown."""
    if settings.price is not None:
        return two_prices(settings.price)
    if not has_openai_prices(settings.base_url):
        return None
    for name in (model, settings.model or ""):
        found = PRICES.get(name) or PRICES.get(DATED.sub("", name))
        if found:
            return found[0], found[1]
    return None


LETTERS_PER_TOKEN = 4  # bytes of English and JSON; an estimate until the server has counted


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
        limits."""
        return cls() if settings is None else cls(settings.max_tokens, settings.max_cost)

    def add(self, spent: Spent) -> None:
        """Adds costs to the total."""
        self.spent = self.spent + spent

    def reply_tokens(self, messages: Sequence[Message], settings: ChatSettings, model: str) -> int:
        """Returns the largest number of tokens that the answer to these messages may have without exceeding a
        limit. Raises BudgetError if too few are left, or if money is limited and a price is unknown."""
        prompt = tokens_in(*(message.text for message in messages))
        affordable = self._affordable(prompt, price_of(settings, model), model)
        left = inf if self.max_tokens is None else self.max_tokens - self.spent.usage.total - prompt
        reply_tokens = int(min(settings.max_completion, left, affordable))
        if reply_tokens >= LEAST_REPLY:
            return reply_tokens
        spent = self.spent
        limit, so_far, flag = f"{self.max_tokens or 0:,} tokens", f"{spent.usage.total:,}", "--max-tokens"
        if left > reply_tokens:
            limit, so_far, flag = f"{self.max_cost or 0:g} USD", f"{spent.cost or 0:.4f}", "--max-cost"
        raise BudgetError(
            f"the limit of {limit} is too low for the next question ({so_far} are spent); "
            f"continue with the same command, --out and a higher {flag}"
        )

    def _affordable(self, prompt: int, price: tuple[float, float] | None, model: str) -> float:
        """Returns the largest number of tokens in an answer that the remaining money can pay for."""
        if self.max_cost is None:
            return inf
        if price is None or self.spent.cost is None:
            from roadgpt.chat.answer import plain  # only for the message

            raise BudgetError(
                f"the price of '{plain(model)}' is not known, so --max-cost cannot be checked; "
                "give --price 0.15/0.60 (USD per million tokens of question and answer)"
            )
        left = self.max_cost - self.spent.cost - prompt * price[0] / 1e6
        return left * 1e6 / price[1] if price[1] > 0 else inf if left >= 0 else 0.0


NOBODY: tuple["Meter | None", str] = (None, "")
"""The meter that counts now, and the occasion."""
_now: ContextVar[tuple["Meter | None", str]] = ContextVar("roadgpt_meter", default=NOBODY)


@contextmanager
def counting(meter: Meter, occasion: str = "") -> Iterator[Meter]:
    """Makes this meter count all questions that are asked inside a ``with`` block.

    Args:
        meter: the meter.
        occasion: a label for what the questions are about, such as "road 3"; recordings use it to
            distinguish a question about one road from the same question about another."""
    before = _now.set((meter, occasion))
    try:
        yield meter
    finally:
        _now.reset(before)


def occasion() -> str:
    """Returns the label of the current questions, as given to ``counting``; empty if there is none."""
    return _now.get()[1]


class Account(Meter):
    """Counts what one Chat spends, and adds the same amounts to the Meter of the campaign, if any."""

    def __init__(self, settings: ChatSettings) -> None:
        super().__init__(settings.max_tokens, settings.max_cost)
        self.settings = settings

    @property
    def meter(self) -> Meter:
        """The meter of the current campaign; the Account itself if there is no campaign."""
        return _now.get()[0] or self

    def count(self, model: str, usage: Usage, seconds: float) -> None:
        """Counts one answered request."""
        price = price_of(self.settings, model)
        cost = price and (usage.prompt * price[0] + usage.completion * price[1]) / 1e6
        self.add(Spent(calls=1, usage=usage, seconds=seconds, cost=cost))

    def add(self, spent: Spent) -> None:
        """Adds costs that are already known, such as those of a recorded exchange."""
        super().add(spent)
        if self.meter is not self:
            self.meter.add(spent)


def tokens_in(*texts: str) -> int:
    """Returns the estimated number of tokens of some texts."""
    return sum(ceil(len(text.encode("utf-8", "replace")) / LETTERS_PER_TOKEN) for text in texts)
