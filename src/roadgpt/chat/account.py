"""Counts what the questions of one Chat cost, and adds it to the campaign's Meter."""

from collections.abc import Sequence

from roadgpt.chat.meter import Meter, meter_now
from roadgpt.chat.model import ChatSettings, Message, Spent, Usage
from roadgpt.chat.prices import cost_of, price_of
from roadgpt.chat.strict_json import plain

LETTERS_PER_TOKEN = 4  # bytes of English and JSON; an estimate until the server has counted


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
        return meter_now() or self._own

    def reply_tokens(self, messages: Sequence[Message], model: str) -> int:
        """Returns the largest number of tokens that the answer to these messages may have.

        Raises:
            BudgetError: too few tokens are left for an answer.
        """
        prompt = sum(tokens_in(message.text) for message in messages)
        price = price_of(self.settings, model)
        return self.meter.reply_tokens(prompt, self.settings.max_completion, price, plain(model))

    def count(self, model: str, usage: Usage, seconds: float) -> float | None:
        """Counts one answered request and returns its cost in USD; None if the price is unknown."""
        cost = cost_of(usage, price_of(self.settings, model))
        self.add(Spent(calls=1, usage=usage, seconds=seconds, cost=cost))
        return cost

    def add(self, spent: Spent) -> None:
        """Adds costs that are already known, such as those of a recorded exchange."""
        self.spent = self.spent + spent
        self.meter.add(spent)


def tokens_in(text: str) -> int:
    """Returns the estimated number of tokens of a text."""
    return -(-len(text.encode("utf-8", "replace")) // LETTERS_PER_TOKEN)
