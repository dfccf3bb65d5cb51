"""Remembers what a server accepts while the process runs, so that it is found out only once.

JSON is asked for in three ways, from the strictest to the loosest: with a schema that the server enforces;
as any JSON object, with the schema in words; as plain text, from which the JSON is read.
"""

from dataclasses import dataclass, field
from enum import IntEnum

from roadgpt.chat.prices import has_openai_prices

# after so many unusable replies in a row in one format, the server is taken not to support it
UNUSABLE_IN_A_ROW = 2


class ResponseFormat(IntEnum):
    """A way of asking for JSON, the strictest first."""

    SCHEMA = 0
    OBJECT = 1
    TEXT = 2


@dataclass
class ServerQuirks:
    """What is known about one model on one server."""

    caps: tuple[str, ...]
    """Names for the limit of a reply that are still to be tried; the first is in use."""
    response_format: ResponseFormat = ResponseFormat.SCHEMA
    dropped: set[str] = field(default_factory=set)
    """Parameters that the server rejected."""
    unusable: dict[ResponseFormat, int] = field(default_factory=dict)
    keeps_conversations: bool = True

    def failed(self, response_format: ResponseFormat) -> None:
        """Counts a reply in this format that could not be used."""
        self.unusable[response_format] = self.unusable.get(response_format, 0) + 1

    def worked(self, response_format: ResponseFormat, refused: set[ResponseFormat]) -> None:
        """Starts with this format from now on, if all stricter ones were rejected or failed repeatedly."""
        self.unusable[response_format] = 0
        above = range(self.response_format, response_format)
        if all(
            ResponseFormat(one) in refused or self.unusable.get(ResponseFormat(one), 0) >= UNUSABLE_IN_A_ROW
            for one in above
        ):
            self.response_format = max(self.response_format, response_format)


_known: dict[tuple[str, str, str], ServerQuirks] = {}


def quirks_of(place: str, model: str, api: str) -> ServerQuirks:
    """Returns what is known about a model on a server, for one of its two APIs."""
    # OpenAI's newer models reject the old name, most other servers silently ignore the new one
    caps = ("max_completion_tokens", "max_tokens")
    caps = caps if has_openai_prices(place) else caps[::-1]
    return _known.setdefault(
        (place, model, api), ServerQuirks(("max_output_tokens",) if api == "responses" else caps)
    )


def forget() -> None:
    """Forgets everything, as a new process would."""
    _known.clear()
