"""What a server has been found to take, remembered while the process lives: each lesson is paid for once.

The ladder, from the strictest way of asking for JSON to the loosest: a schema that the server keeps to;
"some JSON", with the schema in words; plain text, out of which the JSON is read.
"""

from dataclasses import dataclass, field
from enum import IntEnum

from roadgpt.chat.prices import has_openai_prices

UNUSABLE_IN_A_ROW = (
    2  # unusable replies in a row on one rung, after which the server is taken not to be able to do it
)


class ResponseFormat(IntEnum):
    """A way of asking for JSON."""

    SCHEMA = 0
    OBJECT = 1
    TEXT = 2


@dataclass
class ServerQuirks:
    """Of one model on one server."""

    caps: tuple[str, ...]
    """Names for the cap on a reply that are still to be tried; the first is in use."""
    response_format: ResponseFormat = ResponseFormat.SCHEMA
    dropped: set[str] = field(default_factory=set)
    """Parameters that it refused."""
    unusable: dict[ResponseFormat, int] = field(default_factory=dict)
    keeps_conversations: bool = True

    def failed(self, response_format: ResponseFormat) -> None:
        """A reply on this rung could not be used."""
        self.unusable[response_format] = self.unusable.get(response_format, 0) + 1

    def worked(self, response_format: ResponseFormat, refused: set[ResponseFormat]) -> None:
        """A reply on this rung was good: begin here, where those above were refused or failed repeatedly."""
        self.unusable[response_format] = 0
        above = range(self.response_format, response_format)
        if all(
            ResponseFormat(one) in refused or self.unusable.get(ResponseFormat(one), 0) >= UNUSABLE_IN_A_ROW
            for one in above
        ):
            self.response_format = max(self.response_format, response_format)


_known: dict[tuple[str, str, str], ServerQuirks] = {}


def quirks_of(place: str, model: str, api: str) -> ServerQuirks:
    """What is known of a model on a server, asked through one of its doors."""
    # OpenAI's newer models refuse the old name, most other servers ignore the new one without a word
    caps = ("max_completion_tokens", "max_tokens")
    caps = caps if has_openai_prices(place) else caps[::-1]
    return _known.setdefault(
        (place, model, api), ServerQuirks(("max_output_tokens",) if api == "responses" else caps)
    )


def forget() -> None:
    """Begin anew, as a new process does."""
    _known.clear()
