"""Scores a reader: compares its Briefs with the labels, as a whole and by aspects such as slope and order."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import BUMPS, normal
from roadgpt.brief.outline import outline
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError
from roadgpt_training.pair import Pair, grouped

Read = Callable[[str], Brief]
PARTS = ("turns", "slope", "order and side")


@dataclass(frozen=True, slots=True)
class Reading:
    """One description, its label, and what a reader returned for it."""

    pair: Pair
    got: str
    """The plan of the reader in normal form, or '!refused'."""
    confidence: float
    reason: str
    """The reason why the reader refused the description."""
    right: bool
    parts: frozenset[str]
    """The aspects in PARTS that the reader got right; all of them if it rightly refused the description."""

    @property
    def is_honest(self) -> bool:
        """True if the label says that the description asks for a road that can be built."""
        return not self.pair.is_refusal

    @property
    def was_refused(self) -> bool:
        """True if the reader refused the description."""
        return self.got.startswith("!")


class Score(NamedTuple):
    """The number of readings, and shares from 0 to 1, in the order of the columns of ``HEAD``.

    ``exact`` is the share of all readings that are right. Of the descriptions that should be refused,
    ``refused_rightly`` is the share that was refused. The other shares are of the valid descriptions: the
    share in which an aspect was read correctly, and the share that was refused (``refused_wrongly``).
    """

    number: int
    exact: float
    turns: float
    slope: float
    order_and_side: float
    refused_rightly: float
    refused_wrongly: float

    def row(self, name: str) -> str:
        """Returns the scores as one row of a Markdown table; the first cell of the row is ``name``."""
        return f"| {name} | {self.number} | " + " | ".join(f"{100 * share:.1f}" for share in self[1:]) + " |"


HEAD = (
    "| | descriptions | whole Brief exact | number of turns | slope | order and side"
    " | refused rightly | refused wrongly |\n"
    "|---|---|---|---|---|---|---|---|"
)


def readings(pairs: Iterable[Pair], read: Read) -> list[Reading]:
    """Reads each description with ``read`` and returns one Reading for each, including refused ones."""
    return [_reading(pair, read) for pair in pairs]


def _reading(pair: Pair, read: Read) -> Reading:
    wanted = None if pair.is_refusal else normal(read_plan(pair.plan))
    try:
        brief = read(pair.text)
    except BriefError as error:
        everything = frozenset(PARTS) if wanted is None else frozenset()
        return Reading(pair, "!refused", 1.0, str(error), wanted is None, everything)
    got = normal(brief)
    if wanted is None or not wanted.beside:  # older labels do not name what is beside the road
        got = got.model_copy(update={"beside": ()})
    parts = frozenset() if wanted is None else frozenset(_parts(wanted, got))
    return Reading(pair, plan(got), brief.confidence, "", got == wanted, parts)


def _parts(wanted: Brief, got: Brief) -> Iterable[str]:
    if outline(wanted).turns == outline(got).turns:
        yield "turns"
    if _slopes(wanted) == _slopes(got):
        yield "slope"
    if _order(wanted) == _order(got):
        yield "order and side"


def _slopes(brief: Brief) -> tuple[object, ...]:
    along = tuple((c.slope, c.incline) for c in brief.clauses if c.slope or c.kind in BUMPS)
    return (along, brief.slope, brief.incline, brief.steepest, brief.climb, brief.hills)


def _order(brief: Brief) -> tuple[object, ...]:
    along = tuple((c.kind, c.side, c.alternating) for c in brief.clauses)
    ends = tuple((c.kind, c.side) if c else None for c in (brief.starts, brief.ends))
    return (along, ends, brief.left, brief.right, brief.alternating)


def score(found: Sequence[Reading]) -> Score:
    """Returns the Score of these readings."""
    honest = [reading for reading in found if reading.is_honest]
    others = [reading for reading in found if not reading.is_honest]
    return Score(
        number=len(found),
        exact=_share(reading.right for reading in found),
        turns=_share("turns" in reading.parts for reading in honest),
        slope=_share("slope" in reading.parts for reading in honest),
        order_and_side=_share("order and side" in reading.parts for reading in honest),
        refused_rightly=_share(reading.was_refused for reading in others),
        refused_wrongly=_share(reading.was_refused for reading in honest),
    )


def _share(rights: Iterable[bool]) -> float:
    every = list(rights)
    return sum(every) / len(every) if every else 0.0


def by(found: Sequence[Reading], key: Callable[[Pair], str]) -> dict[str, Score]:
    """Returns the scores of groups of readings, such as languages; ``key`` maps a pair to its group."""
    groups = grouped(found, lambda reading: key(reading.pair))
    return {name: score(groups[name]) for name in sorted(groups)}


def confusion(found: Sequence[Reading]) -> Counter[tuple[str, str]]:
    """Counts, over all wrong readings, which words of the right plan were read as which other words. The
    words of a plan are compared without regard to their order, and those that differ are paired
    alphabetically; '-' stands for no word. A wrong refusal counts as the pair ('a road', 'refused'),
    and a missed refusal as a pair such as ('!impossible', 'a road').
    """
    table: Counter[tuple[str, str]] = Counter()
    for reading in found:
        if reading.right:
            continue
        if reading.was_refused or not reading.is_honest:
            wanted = "a road" if reading.is_honest else reading.pair.plan.split()[0]
            table[wanted, "refused" if reading.was_refused else "a road"] += 1
            continue
        wants, gots = Counter(_words(reading.pair.plan)), Counter(_words(reading.got))
        missing, extra = sorted((wants - gots).elements()), sorted((gots - wants).elements())
        for index in range(max(len(missing), len(extra))):
            pair = [words[index] if index < len(words) else "-" for words in (missing, extra)]
            table[pair[0], pair[1]] += 1
    return table


def _words(line: str) -> list[str]:
    return line.replace(";", " ").replace("|", " ").split()


def worst(found: Sequence[Reading], number: int = 30) -> list[Reading]:
    """Returns the wrong readings in which the reader was most confident."""
    misses = [reading for reading in found if not reading.right]
    return sorted(misses, key=lambda reading: (-reading.confidence, reading.pair.text))[:number]
