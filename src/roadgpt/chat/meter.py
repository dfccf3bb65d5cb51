"""What a campaign's questions cost, and the limits that end it before they are passed.

A Meter counts for a whole campaign, whoever asks: readers and designers each have a Chat of their own. The
one that counts now is set around a block by ``counting``.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from roadgpt.chat.model import ChatSettings, Message, Spent, Usage
from roadgpt.chat.prices import cost_of, price_of
from roadgpt.chat.strict_json import plain
from roadgpt.errors import BudgetError

LETTERS_PER_TOKEN = 4  # bytes of English and JSON; only guesses what is still to be counted by the server
ENDLESS = 10**15
LEAST_REPLY = 64  # tokens; a shorter answer is of no use


class Meter:
    """Counts tokens, seconds and money against a campaign's limits."""

    def __init__(self, max_tokens: int | None = None, max_cost: float | None = None) -> None:
        self.max_tokens, self.max_cost = max_tokens, max_cost
        self.spent = Spent()
        self.turns: Counter[tuple[str, str, str]] = Counter()
        """How often a question was asked on an occasion, as recordings count."""

    @classmethod
    def of(cls, settings: ChatSettings | None) -> "Meter":
        """With the limits of the settings; without any where there are none."""
        return cls() if settings is None else cls(settings.max_tokens, settings.max_cost)

    def add(self, spent: Spent) -> None:
        """Count what was spent."""
        self.spent = self.spent + spent

    def room(self, prompt: int, most: int, price: tuple[float, float] | None, model: str) -> int:
        """How many tokens an answer may have, so that no limit is passed.

        Args:
            prompt: tokens of the question, guessed.
            most: tokens of any answer.
            price: USD per million tokens of prompt and completion; None: not known.
            model: its name, for the sentence.

        Raises:
            BudgetError: too few for an answer.
        """
        room = min(most, self._tokens_left(prompt), self._affordable(prompt, price, model))
        if room >= LEAST_REPLY:
            return room
        spent = self.spent
        limit, so_far, flag = f"{self.max_tokens or 0:,} tokens", f"{spent.usage.total:,}", "--max-tokens"
        if self._tokens_left(prompt) > room:
            limit, so_far, flag = f"{self.max_cost or 0:g} USD", f"{spent.cost or 0:.4f}", "--max-cost"
        raise BudgetError(
            f"the limit of {limit} leaves no room for the next question ({so_far} are spent); "
            f"go on with the same command, --out and a higher {flag}"
        )

    def _tokens_left(self, prompt: int) -> int:
        if self.max_tokens is None:
            return ENDLESS
        return self.max_tokens - self.spent.usage.total - prompt

    def _affordable(self, prompt: int, price: tuple[float, float] | None, model: str) -> int:
        """Tokens of an answer that the money is enough for."""
        if self.max_cost is None:
            return ENDLESS
        if price is None or self.spent.cost is None:
            raise BudgetError(
                f"what '{plain(model)}' costs is not known, so --max-cost cannot be kept; "
                "say --price 0.15/0.60 (USD per million tokens of question and answer)"
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
    """Count all questions of a block with this meter; the occasion, which road, tells recordings apart."""
    before = _now.set(_Now(meter, occasion))
    try:
        yield meter
    finally:
        _now.reset(before)


def occasion() -> str:
    """What the questions of this moment are for."""
    now = _now.get()
    return now.occasion if now else ""


class Account:
    """What one Chat spends; passed on to the campaign's meter, or held against its own limits."""

    def __init__(self, settings: ChatSettings) -> None:
        self.settings = settings
        self.spent = Spent()
        self._own = Meter.of(settings)

    @property
    def meter(self) -> Meter:
        """The campaign's, or this Chat's own outside of one."""
        now = _now.get()
        return now.meter if now else self._own

    def room(self, messages: Sequence[Message], model: str) -> int:
        """Tokens that the answer to these messages may have; BudgetError where that is too few."""
        prompt = sum(tokens_in(message.text) for message in messages)
        price = price_of(self.settings, model)
        return self.meter.room(prompt, self.settings.max_completion, price, model)

    def count(self, model: str, usage: Usage, seconds: float) -> float | None:
        """Count one answered request; gives back its cost."""
        cost = cost_of(usage, price_of(self.settings, model))
        self.add(Spent(calls=1, usage=usage, seconds=seconds, cost=cost))
        return cost

    def add(self, spent: Spent) -> None:
        """Count what was spent elsewhere, as a recording tells."""
        self.spent = self.spent + spent
        self.meter.add(spent)


def tokens_in(text: str) -> int:
    """About how many tokens a text has."""
    return -(-len(text.encode("utf-8", "replace")) // LETTERS_PER_TOKEN)
