"""Reads a description of a road and returns what it asks for, as a Brief.

A reader is a plug-in registered under the entry point ``roadgpt.readers``. It is an object or a class. A
class is called without arguments, or with ChatSettings if it has a parameter ``settings``. The reader has one
method

    read(words: str) -> Brief

``read`` raises BriefError, with one sentence that says what to change, if the description is empty, is not
about a road, contradicts itself or asks for something impossible. Words that the reader did not understand
are listed in ``Brief.unused``. All readers take the meanings of words from one table, in ``words.py``. A
reader may also have a method ``alternatives(words, number, temperature)``, which returns several
different readings of a vague description, the likeliest first. One with ``takes_trials`` also takes a Trial:
what that says of a reading, the reader heeds in another one."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Protocol, cast

from roadgpt import plugins
from roadgpt.brief import beside
from roadgpt.brief.expressions import said_map_size, says_motorway, with_driving_side
from roadgpt.brief.feasible import check, is_possible
from roadgpt.brief.map_fit import ROAD_WIDTH, motorway_remarks
from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.refusal import AnotherRoadError, NoRoomError, TooMuchError
from roadgpt.brief.scene import land_remark
from roadgpt.brief.sentence import sentence
from roadgpt.brief.words import LARGEST_MAP, LEAST_RADIUS, STEEPEST, SURE, USUAL_MAP
from roadgpt.chat import ChatSettings, plugin_of
from roadgpt.errors import BriefError, PartError

__all__ = [
    "SURE",
    "AnotherRoadError",
    "Brief",
    "Clause",
    "NoRoomError",
    "Outline",
    "Reader",
    "alternatives",
    "check",
    "exactly",
    "normal",
    "outline",
    "read",
    "reader_of",
    "remarks",
    "sentence",
]

Trial = Callable[[Brief], Sequence[str]]
"""Builds and drives what was read, and returns in sentences what of it cannot be, or does not happen."""
PLAN = "plan"
"""The name of the plan reader. If a plan lists a roundabout or the like in ``beside(...)``, the road is built
without it. If another reader lists a roundabout in ``Brief.beside``, ``read`` raises AnotherRoadError."""


class Reader(Protocol):
    """A plug-in that reads descriptions."""

    def read(self, words: str) -> Brief:
        """Returns the Brief of a description.

        Raises:
            BriefError: the description does not ask for a road that can be built."""
        ...


def read(
    words: str,
    reader: str = "model",
    map_size: float | None = USUAL_MAP,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
    chat: ChatSettings | None = None,
    road_width: float = ROAD_WIDTH,
    is_map_fixed: bool = True,
    trial: Trial | None = None,
) -> Brief:
    """Reads a description and returns what it asks for.

    The Brief is also checked for contradictions and against the limits given here (see ``check``).

    Args:
        words: the description, up to 6,000 characters.
        reader: name of an installed reader, or 'model:FOLDER' for the model reader with weights in FOLDER.
        map_size: side of the square map that has to hold the road, in metres; None skips this check.
        min_radius: radius of the tightest turn allowed, in metres.
        max_grade: steepest slope allowed, as a ratio (0.15 is 15 %).
        chat: settings of the language model, for readers that use one; None takes the user's settings.
        road_width: width of the carriageway in metres.
        is_map_fixed: False if the map may be enlarged for the road, up to ``LARGEST_MAP``.
        trial: for readers that ask a language model again if a test does not happen as told.

    Raises:
        NoRoomError: the map is too small for the road that is asked for; the message says what would fit on
            this map, and which size of map would hold the road.
        AnotherRoadError: the description contradicts itself, or the place of a roundabout or the like on the
            route is not known; the message proposes a plan.
        BriefError: the description does not ask for a road that can be built; the message says what to
            change.
        PartError: no reader of that name is installed.
        ChatError: the language model could not be asked."""
    words = words.encode("utf-8", "replace").decode()  # lone surrogates cannot be written to a file
    sized = None if reader == PLAN else said_map_size(words)
    reads: Any = reader_of(reader, chat)
    brief: Brief
    heeds = {"trial": trial} if trial and getattr(reads, "takes_trials", False) else {}
    try:
        brief, too_much = reads.read(sized[1] if sized else words, **heeds), None
    except TooMuchError as refusal:
        brief, too_much = refusal.brief, refusal
    if sized:
        size = {"map_size": sized[0]}
        other = plan(read_plan(brief.other).model_copy(update=size)) if brief.other else ""
        brief = brief.model_copy(update={"words": words, "other": other, **size})
    if brief.map_size is not None and not is_map_fixed:
        map_size, is_map_fixed = brief.map_size, True
    try:
        check(brief, map_size if is_map_fixed else LARGEST_MAP, min_radius, max_grade, road_width)
    except BriefError as error:
        raise error if reader == PLAN or isinstance(error, NoRoomError) else _doubted(error, brief) from None
    is_usual = map_size is not None and map_size <= USUAL_MAP and min_radius >= LEAST_RADIUS
    if too_much is not None and is_map_fixed and is_usual:
        raise too_much
    if reader != PLAN and (missing := beside.networks_in(brief.beside)):
        rest = brief.model_copy(update={"beside": tuple(n for n in brief.beside if n not in beside.NETWORKS)})
        raise AnotherRoadError(f"{missing}; the road without it", plan(rest), rest)
    is_road = not brief.junctions and brief.map is None
    if reader != PLAN:
        brief = with_driving_side(brief, words)
    is_motorway = is_road and brief.surroundings is None and says_motorway(words)
    return brief.model_copy(update={"motorway": True}) if is_motorway else brief


def _doubted(error: BriefError, brief: Brief) -> BriefError:
    """Returns a refusal for the words behind a Brief; where the plan contradicts itself, it is a doubt."""
    what, _, advice = str(error).partition("; ")
    if advice.startswith("ask for") and brief.confidence >= SURE:
        return error  # only a number that was said is out of range
    said = f"I read this, perhaps wrongly, as '{sentence(brief)[:-1]}'"
    return BriefError(f"{said}: {what}; say it in other words")


def alternatives(
    words: str,
    number: int = 3,
    reader: str = "model",
    map_size: float | None = USUAL_MAP,
    temperature: float = 1.0,
) -> tuple[Brief, ...]:
    """Returns up to ``number`` different readings of a description, the likeliest first.

    If the reader can only give one reading, the result has only that one. Readings that no road on this map
    can satisfy are left out.

    Args:
        words: the description, up to 6,000 characters.
        number: the largest number of readings to return.
        reader: name of an installed reader.
        map_size: side of the square map in metres; None skips the check whether the road fits.
        temperature: how freely the readings after the first are sampled; 1 samples from the model's own
            distribution, lower values stay closer to the likeliest reading.

    Raises:
        BriefError: ``read`` would raise this error for the likeliest reading.
        PartError: no reader of that name is installed."""
    first = read(words, reader, map_size)
    more: Callable[..., tuple[Brief, ...]] | None = getattr(reader_of(reader), "alternatives", None)
    if more is None:
        return (first,)
    try:
        sized = said_map_size(first.words)
        others = more(sized[1] if sized else first.words, number, temperature)[1:]
    except TooMuchError:  # such a description has only one reading
        return (first,)
    same = {"words": first.words, "map_size": first.map_size} | ({"motorway": True} if first.motorway else {})
    others = tuple(brief.model_copy(update=same) for brief in others)
    return (first, *(brief for brief in others if is_possible(brief, map_size)))


def remarks(brief: Brief, map_size: float, *of_surface: Any) -> tuple[str, ...]:
    """Returns what the user should know about a road of this Brief on a map of ``map_size`` metres, as
    sentences without full stops: that a thing in ``brief.beside`` is not built, must be given as a number or
    an option, or sets the friction, and what a motorway requires. ``of_surface`` is what
    ``beside.surface_remark`` takes; without it, a surface of the description sets the friction."""
    things = (*brief.beside, *brief.scene.surfaces)
    of_land = filter(None, [land_remark(brief.scene)])
    return (*beside.remarks(things, *of_surface), *of_land, *motorway_remarks(brief, map_size))


def reader_of(name: str, chat: ChatSettings | None = None) -> Reader:
    """Returns the reader of that name; each reader is created once and then reused.

    Args:
        name: name of an installed reader; 'model:FOLDER' is the model reader with the weights in FOLDER.
        chat: settings of the language model, for readers that use one; None takes the user's settings.

    Raises:
        PartError: no such reader is installed, the reader takes no folder, or the folder holds no weights."""
    part, _, folder = name.partition(":")
    return _from_folder(part, folder) if folder else cast(Reader, plugin_of("readers", part, chat))


@cache
def _from_folder(name: str, folder: str) -> Reader:
    """Creates a reader with weights of its own; the cache makes sure that they are loaded only once."""
    part = plugins.find("readers", name)
    if not callable(getattr(part, "from_folder", None)):
        raise PartError(f"the reader '{name}' takes no folder; say --reader {name}")
    return cast(Reader, part.from_folder(folder))
