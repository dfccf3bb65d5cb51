"""What a server has been found to take, remembered while the process lives: each lesson is paid for once.

The ladder, from the strictest way of asking for JSON to the loosest: a schema that the server keeps to;
"some JSON", with the schema in words; plain text, out of which the JSON is read.
"""

from dataclasses import dataclass, field
from enum import IntEnum

from roadgpt.chat.prices import is_sold

UNFIT = 2  # unusable replies in a row on one rung, after which the server is taken not to be able to do it


class Rung(IntEnum):
    """A way of asking for JSON."""

    SCHEMA = 0
    OBJECT = 1
    TEXT = 2


@dataclass
class Habits:
    """Of one model on one server."""

    caps: tuple[str, ...]
    """Names for the cap on a reply that are still to be tried; the first is in use."""
    rung: Rung = Rung.SCHEMA
    dropped: set[str] = field(default_factory=set)
    """Parameters that it refused."""
    unfit: dict[Rung, int] = field(default_factory=dict)
    keeps_conversations: bool = True

    def failed(self, rung: Rung) -> None:
        """A reply on this rung could not be used."""
        self.unfit[rung] = self.unfit.get(rung, 0) + 1

    def worked(self, rung: Rung, refused: set[Rung]) -> None:
        """A reply on this rung was good: begin here, where those above were refused or failed repeatedly."""
        self.unfit[rung] = 0
        above = range(self.rung, rung)
        if all(Rung(one) in refused or self.unfit.get(Rung(one), 0) >= UNFIT for one in above):
            self.rung = max(self.rung, rung)


_known: dict[tuple[str, str, str], Habits] = {}


def habits_of(place: str, model: str, api: str) -> Habits:
    """What is known of a model on a server, asked through one of its doors."""
    # OpenAI's newer models refuse the old name, most other servers ignore the new one without a word
    caps = ("max_completion_tokens", "max_tokens")
    caps = caps if is_sold(place) else caps[::-1]
    return _known.setdefault(
        (place, model, api), Habits(("max_output_tokens",) if api == "responses" else caps)
    )


def forget() -> None:
    """Begin anew, as a new process does."""
    _known.clear()
