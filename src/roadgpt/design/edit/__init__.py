"""Edits a Design as a change request asks, and leaves the rest unchanged. Main functions: ``read_request``,
``edit``.

    words --read_request--> EditRequest --placed--> elements --made--> Look --sentences--> Edited

A Look is a Design with the road that was built from it, the findings of the rules, and measurements.
Turns and straights are those that ``check.measures`` finds on the finished road. They are numbered as on the
road before the edit. Elements that the request does not name keep all their values, but the road as a whole
may be shifted or rotated, so that it stays inside the map.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roadgpt import plugins
from roadgpt.chat import ChatSettings, asks_a_model, configured, open_chat
from roadgpt.design.differences import sentences
from roadgpt.design.edit.chatting import edited_by_chat
from roadgpt.design.edit.combinations import REORDERS, is_hill
from roadgpt.design.edit.hills import hill_of
from roadgpt.design.edit.placing import PlacedChange, placed
from roadgpt.design.edit.reading import read_request
from roadgpt.design.edit.request import OF_SLOPE, Change, EditRequest
from roadgpt.design.edit.search import made
from roadgpt.design.road_elements import RoadElements, elements_on_road
from roadgpt.errors import EditError
from roadgpt.road import Design, Geometry, World, build

MOST_CHANGES = 12
REVERSED = "the road leads from its former end to its former start; its parts are named as before"


class Edited(NamedTuple):
    """A changed Design, and sentences that describe how it differs from the old one."""

    design: Design
    changes: tuple[str, ...]
    unused: tuple[str, ...] = ()
    """Words of the request that were not understood."""
    confidence: float = 1.0
    """Estimated probability that the request was read correctly."""


def edit(
    design: Design,
    words: str | EditRequest,
    world: World,
    geometry: Geometry = "arcs",
    designer: str = "planner",
    chat: ChatSettings | None = None,
) -> Edited:
    """Returns the Design, changed as the words ask.

    Args:
        design: the Design before the edit; this value itself is not changed.
        words: the text of a change request, or the EditRequest read from it.
        world: size of the map, and limits that the rules check, such as the steepest grade.
        geometry: the kind of geometry that the road is built with.
        designer: name of a designer. If it uses a language model, the model makes the change; otherwise rules
            make it.
        chat: settings of the language model; None for the user's settings.

    Raises:
        EditError: the words cannot be read, name something that is not on the road, or ask for something that
            no valid road can have; the message gives the reason.
        PartError: there is no designer of that name.
        ChatError: the language model could not be asked.
    """
    asks = asks_a_model(plugins.find("designers", designer))
    elements, found = elements_on_road(design, geometry)
    allowed: set[int] | None = None
    try:
        request = read_request(words) if isinstance(words, str) else words
        changes = placed(request.changes, elements)
        if not request.unused:
            hills = {hill_of(change, elements).name for change in changes if is_hill(change.change)}
            named = [element for element in elements if element.name in hills]
            named += [element for change in changes for element in change.elements]
            allowed = {i + 1 for element in named for i in element.members}
    except EditError:  # a model may understand it all the same
        if not asks:
            raise
    idle: tuple[Change, ...] = ()
    unused: tuple[str, ...] = ()
    sure = 1.0
    if asks:
        model, said = chat or configured(), words if isinstance(words, str) else words.words
        road = edited_by_chat(
            open_chat(model), model, design, said, elements, found, allowed, world, geometry
        )
        draft = road.design
    elif len(changes) > MOST_CHANGES:
        raise EditError(f"{len(changes)} changes at once are too many; ask for {MOST_CHANGES} or fewer")
    else:
        road, draft, idle = made(design, elements, found, changes, world, geometry)
        unused, sure = request.unused, request.confidence
    told = sentences(design, elements, found, road, draft)
    if not asks:
        made_so = [change for change in changes if change.change not in idle]
        told = (*_announced(made_so, elements), *_sloped(changes, design, road.design, geometry), *told)
    told = (*told, *(f"'{change.words}' was so already" for change in idle))
    return Edited(road.design, told, unused, sure)


def _announced(changes: Sequence[PlacedChange], elements: RoadElements) -> Iterator[str]:
    """Yields a sentence on each change that its measurements alone would not tell."""
    for change in changes:
        if change.change.what in (*REORDERS, "reverse"):
            yield _reordering(change, elements)
        elif is_hill(change.change):
            hill = hill_of(change, elements)
            where = f", its middle at {hill.middle:.0f} m" if len(changes) == 1 else ""
            yield f"a {change.change.kind} of {2 * hill.half:.0f} m is new{where}"


def _sloped(
    changes: Sequence[PlacedChange], before: Design, after: Design, geometry: Geometry
) -> Iterator[str]:
    """Yields a sentence on the mean grade of each stretch before and after its change; none if other
    changes may have moved it.
    """
    if any(change.change.what not in OF_SLOPE for change in changes):
        return
    for start, end in dict.fromkeys(change.stretch for change in changes if change.stretch):
        grades = []
        for design in (before, after):
            road = build(design, geometry)
            low, high = (float(road.at(min(station, road.length))[2]) for station in (start, end))
            grades.append(100 * (high - low) / (end - start))
        yield f"from {start:.0f} to {end:.0f} m: grade {grades[0]:+.1f} -> {grades[1]:+.1f} %"


def _reordering(change: PlacedChange, elements: RoadElements) -> str:
    """Returns a sentence on a change that only reorders elements."""
    if change.change.what == "reverse":
        return REVERSED
    turns = [element.name for element in elements if element.is_turn]
    numbers = [str(turns.index(element.name) + 1) for element in change.elements]
    if change.change.what == "move":
        told = f"turn {numbers[0]} has" if len(numbers) == 1 else f"turns {' and '.join(numbers)} have"
        return f"{told} moved; the turns are named as before"
    return f"turn {numbers[0]} and turn {numbers[1]} have changed places; they are named as before"


__all__ = ["EditRequest", "Edited", "edit", "read_request"]
