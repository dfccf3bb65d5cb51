"""Prices of language models in USD per million tokens, separately for the question and the answer.

Source: OpenAI's price page as stored in the package genai-prices 0.2.3, standard rates for prompts below
272,000 tokens, taken on 2026-11-20. Discounts for cached prompts are not counted, so a computed cost may be
too high, but not too low. No price is known for models that are not in the table, nor for any model on a
server other than OpenAI's. For these, the user gives the price with ``--price``.
"""

import re
from urllib.parse import urlsplit

from roadgpt.chat.address import OPENAI
from roadgpt.chat.model import ChatSettings, Usage, two_prices

PRICES: dict[str, tuple[float, float]] = {
    "gpt-3.5-turbo": (0.5, 1.5),
    "gpt-4": (30, 60),
    "gpt-4-turbo": (10, 30),
    "gpt-4.1": (2, 8),
    "gpt-4.1-mini": (0.4, 1.6),
    "gpt-4.1-nano": (0.1, 0.4),
    "gpt-4o": (2.5, 10),
    "gpt-4o-mini": (0.15, 0.6),
    "gpt-5": (1.25, 10),
    "gpt-5-mini": (0.25, 2),
    "gpt-5-nano": (0.05, 0.4),
    "gpt-5.1": (1.25, 10),
    "gpt-5.2": (1.75, 14),
    "gpt-5.3": (1.75, 14),
    "gpt-5.4": (2.5, 15),
    "gpt-5.4-mini": (0.75, 4.5),
    "gpt-5.4-nano": (0.2, 1.25),
    "gpt-5.5": (5, 30),
    "gpt-5.6-luna": (0.2, 1.2),
    "gpt-5.6-sol": (4, 20),
    "gpt-5.6-terra": (2, 12),
    "gpt-6-astra": (10, 50),
    "gpt-6-luna": (0.1, 0.5),
    "gpt-6-sol": (2, 10),
    "gpt-6.1-sol": (2, 10),
    "gpt-6.1-terra": (1, 5),
    "o3": (2, 8),
    "o4-mini": (1.1, 4.4),
}
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
            return found
    return None


def cost_of(usage: Usage, price: tuple[float, float] | None) -> float | None:
    """Returns the cost of these tokens in USD; None if the price is unknown."""
    return None if price is None else (usage.prompt * price[0] + usage.completion * price[1]) / 1e6
