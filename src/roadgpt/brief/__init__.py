"""The room of the Brief: words in, what was asked for out.

A reader is a part on the shelf ``readers``: an object, or a class that is made without arguments or with
ChatSettings as ``settings``, with

    read(words: str) -> Brief

It raises BriefError, with one sentence of advice, where the words make no Brief: they are empty, not about
a road, in contradiction with each other or ask for the impossible. It lists the words that it did not
understand in ``Brief.unused``. What the words mean is one table for all readers: ``words.py``.
"""

from functools import cache
from typing import Protocol, cast, runtime_checkable

from roadgpt import plugins
from roadgpt.brief.feasible import check
from roadgpt.brief.map_fit import ROAD_WIDTH
from roadgpt.brief.model import (
    Amount,
    Brief,
    Clause,
    Kind,
    Sharpness,
    Side,
    Size,
    Slope,
    at_least,
    at_most,
    between,
    exactly,
)
from roadgpt.brief.motorway import remarks, says_motorway
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Feature, Group, Outline, outline
from roadgpt.brief.refusal import NoRoomError, TooMuchError
from roadgpt.brief.sentence import sentence
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST, USUAL_MAP, Range
from roadgpt.chat import ChatSettings, instantiate, settings_for
from roadgpt.errors import BriefError, PartError

__all__ = [
    "Amount",
    "Brief",
    "Clause",
    "Feature",
    "Group",
    "Kind",
    "NoRoomError",
    "Outline",
    "Range",
    "Reader",
    "Sharpness",
    "Side",
    "Size",
    "Slope",
    "alternatives",
    "at_least",
    "at_most",
    "between",
    "check",
    "exactly",
    "normal",
    "outline",
    "read",
    "reader_of",
    "remarks",
    "sentence",
]


class Reader(Protocol):
    """A part that reads descriptions."""

    def read(self, words: str) -> Brief:
        """The Brief of a description; BriefError where there is none."""
        ...


@runtime_checkable
class ReaderWithAlternatives(Protocol):
    """A reader that knows more than one reading of vague words."""

    def alternatives(self, words: str, number: int, temperature: float, seed: int) -> tuple[Brief, ...]:
        """Different readings, the likeliest first."""
        ...


def read(
    words: str,
    reader: str = "model",
    map_size: float | None = USUAL_MAP,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
    chat: ChatSettings | None = None,
    road_width: float = ROAD_WIDTH,
) -> Brief:
    """What a description asks for.

    Args:
        words: up to 2,000 characters.
        reader: name of a part on the shelf ``readers``.
        map_size: metres along one side of the map on which the road shall fit; None: do not ask.
        min_radius: metres, of the tightest turn that the world allows.
        max_grade: ratio, of the steepest slope that it allows.
        chat: the language model, for readers that ask one; None: what the user's settings say.
        road_width: metres, of the carriageway.

    Raises:
        NoRoomError: the map does not hold such a road; says what would fit, and on which map this one does.
        BriefError: no road can be read out of the words; says what to change.
        PartError: no such reader.
        ChatError: a language model could not be asked.
    """
    words = words.encode("utf-8", "replace").decode()  # half letters from a broken terminal fit into no file
    try:
        brief = reader_of(reader, chat).read(words)
    except TooMuchError as refusal:
        brief = refusal.brief
        check(brief, map_size, min_radius, max_grade, road_width)
        if map_size is not None and map_size <= USUAL_MAP and min_radius >= LEAST_RADIUS:
            raise
    else:
        check(brief, map_size, min_radius, max_grade, road_width)
    return brief.model_copy(update={"motorway": True}) if says_motorway(words) else brief


def alternatives(
    words: str,
    number: int = 3,
    reader: str = "model",
    map_size: float | None = USUAL_MAP,
    temperature: float = 1.0,
    seed: int = 0,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
) -> tuple[Brief, ...]:
    """Up to ``number`` different readings of a description, the likeliest first.

    Readers that know only one reading give that one. Readings that no road of this map can keep are left out.

    Raises:
        BriefError: as ``read``, of the likeliest one.
        PartError: no such reader.
    """
    first = read(words, reader, map_size, min_radius, max_grade)
    part = reader_of(reader)
    if not isinstance(part, ReaderWithAlternatives):
        return (first,)
    try:
        others = part.alternatives(first.words, number, temperature, seed)[1:]
    except TooMuchError:  # it is read in one way, as an ordinary road with other numbers
        return (first,)
    if first.motorway:
        others = tuple(brief.model_copy(update={"motorway": True}) for brief in others)
    return (first, *(brief for brief in others if _is_possible(brief, map_size, min_radius, max_grade)))


def _is_possible(brief: Brief, map_size: float | None, min_radius: float, max_grade: float) -> bool:
    try:
        check(brief, map_size, min_radius, max_grade)
    except BriefError:
        return False
    return True


def reader_of(name: str, chat: ChatSettings | None = None) -> Reader:
    """The reader of that name, made now or before; 'model:FOLDER' reads with weights of one's own.

    Raises:
        PartError: no such reader, or no weights in the folder.
    """
    part, _, folder = name.partition(":")
    return _made(part, settings_for(plugins.find("readers", part), chat), folder)


@cache
def _made(name: str, chat: ChatSettings | None, folder: str) -> Reader:
    """The one reader of that name: a network is loaded once."""
    part = plugins.find("readers", name)
    if not folder:
        return cast(Reader, instantiate(part, chat))
    if not callable(getattr(part, "from_folder", None)):
        raise PartError(f"the reader '{name}' takes no folder; say --reader {name}")
    return cast(Reader, part.from_folder(folder))
