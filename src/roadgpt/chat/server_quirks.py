"""Remembers which parameters and response formats a server accepts, so that each process has to find this out
only once.

There are three ways of asking for JSON, from the strictest to the loosest: with a schema that the server
enforces; as any JSON object, with the schema in the prompt; as plain text, from which the JSON is extracted.
"""

from dataclasses import dataclass, field
from enum import IntEnum

from roadgpt.chat.prices import has_openai_prices

# after so many unusable replies in a row in one format, the server is taken not to support it
UNUSABLE_IN_A_ROW = 2


class ResponseFormat(IntEnum):
    """The ways of asking for JSON, from the strictest to the loosest."""

    SCHEMA = 0
    OBJECT = 1
    TEXT = 2


@dataclass
class ServerQuirks:
    """What has been found out about one model on one server."""

    caps: tuple[str, ...]
    """Names that the server may use for the parameter that limits the length of a reply; the first is
    tried first.
    """
    response_format: ResponseFormat = ResponseFormat.SCHEMA
    takes_temperature: bool = True
    unusable: dict[ResponseFormat, int] = field(default_factory=dict)
    keeps_conversations: bool = True

    def failed(self, response_format: ResponseFormat) -> None:
        """Counts an unusable reply in this response format."""
        self.unusable[response_format] = self.unusable.get(response_format, 0) + 1

    def worked(self, response_format: ResponseFormat, refused: set[ResponseFormat]) -> None:
        """Notes that a reply in this response format was usable. If all stricter formats were rejected or
        failed repeatedly, this one is tried first from now on.
        """
        self.unusable[response_format] = 0
        above = range(self.response_format, response_format)
        if all(
            ResponseFormat(one) in refused or self.unusable.get(ResponseFormat(one), 0) >= UNUSABLE_IN_A_ROW
            for one in above
        ):
            self.response_format = max(self.response_format, response_format)


_known: dict[tuple[str, str, str], ServerQuirks] = {}


def quirks_of(place: str, model: str, api: str) -> ServerQuirks:
    """Returns what has been found out about a model on a server, for one of the server's two APIs."""
    # OpenAI's newer models reject the old name, most other servers silently ignore the new one
    caps = ("max_completion_tokens", "max_tokens")
    caps = caps if has_openai_prices(place) else caps[::-1]
    return _known.setdefault(
        (place, model, api), ServerQuirks(("max_output_tokens",) if api == "responses" else caps)
    )


def forget() -> None:
    """Forgets everything about all servers, as if the process had just started."""
    _known.clear()
