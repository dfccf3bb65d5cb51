"""Edits a Design as a change request asks, and leaves the rest unchanged. Main functions: ``read_request``,
``edit``.

    words --read_request--> EditRequest --pointed--> elements --steps--> requirements --fit--> Edited

Turns and straights are those that ``check.measures`` finds on the finished road. They are numbered as on the
road before the edit. Elements that the request does not name keep all their values, but the road as a whole
may be shifted or rotated, so that it stays inside the map.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from roadgpt import plugins
from roadgpt.chat import ChatSettings, asks_a_model, configured, open_chat
from roadgpt.check.measures import Measures
from roadgpt.design.edit.candidates import alternating_candidates, change_candidates
from roadgpt.design.edit.chatting import edited_by_chat
from roadgpt.design.edit.diff_text import sentences
from roadgpt.design.edit.insertion import insertion_candidates, removal_candidates
from roadgpt.design.edit.pointing import pointed
from roadgpt.design.edit.reading import read_request
from roadgpt.design.edit.request import Change, EditRequest, What
from roadgpt.design.edit.search import made
from roadgpt.design.edit.steps import Adjust, EditCandidate, EditStep, Mirror
from roadgpt.design.repair import changes_between
from roadgpt.design.road_elements import RoadElements, elements_on_road
from roadgpt.errors import EditError
from roadgpt.road import Design, Geometry, World

MOST_CHANGES = 12


class Edited(NamedTuple):
    """A changed Design, and sentences that describe how it differs from the old one."""

    design: Design
    changes: tuple[str, ...]
    unused: tuple[str, ...] = ()
    """Words of the request that were not understood."""


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
        words: a change request, or what was read from it.
        world: size of the map, and limits that the rules check, such as the steepest grade.
        geometry: the kind of geometry that the road is built with.
        designer: name of a designer. If it uses a language model, the model makes the change; otherwise rules
            make it.
        chat: settings of the language model; None for the user's settings.

    Raises:
        EditError: the words cannot be read, name something that is not on the road, or ask for something that
            no valid road can have; the message says which.
        PartError: there is no designer of that name.
        ChatError: the language model could not be asked.
    """
    part = plugins.find("designers", designer)
    if asks_a_model(part):
        settings = chat or configured()
        said = words if isinstance(words, str) else words.words
        return Edited(*edited_by_chat(open_chat(settings), settings, design, said, world, geometry))
    request = read_request(words) if isinstance(words, str) else words
    return _by_rules(design, request, world, geometry)


def _by_rules(design: Design, request: EditRequest, world: World, geometry: Geometry) -> Edited:
    if len(request.changes) > MOST_CHANGES:
        raise EditError(
            f"{len(request.changes)} changes at once are too many; ask for {MOST_CHANGES} or fewer"
        )
    elements, found = elements_on_road(design, geometry)
    rows: list[tuple[Change, Sequence[EditCandidate]]] = []
    idle: list[Change] = []
    for number, change in enumerate(request.changes, 1):
        ways = _ways(change, elements, found, world, number)
        if ways:
            rows.append((change, ways))
        else:
            idle.append(change)
    if not rows:
        raise EditError(f"nothing is to be changed: '{idle[0].words}' is so already")
    road, objection, draft = made(design, elements, _agreed(rows), world, geometry)
    if road is None:
        said = " and ".join(dict.fromkeys(f"'{change.words}'" for change, _ in rows))
        raise EditError(f"{said} cannot be done on this road: {objection}; ask for less, or elsewhere")
    if road.design.segments == design.segments and not _is_mirror(request):
        raise EditError(f"nothing is to be changed: '{rows[0][0].words}' is so already")
    told = sentences(design, elements, found, road, changes_between(draft, road.design))
    told += tuple(f"'{change.words}' was so already" for change in idle)
    return Edited(road.design, told, request.unused)


def _agreed(rows: Sequence[tuple[Change, Sequence[EditCandidate]]]) -> list[Sequence[EditCandidate]]:
    """The ways of all; where one says the angle of a turn and another its radius, each keeps to its own."""
    said: dict[What, set[str]] = {"angle": set(), "radius": set()}
    for change, ways in rows:
        if change.what in said and (change.to or change.by or change.times):
            said[change.what] |= {step.element.name for step in ways[0] if isinstance(step, Adjust)}
    both = said["angle"] & said["radius"]

    def own(step: EditStep, what: What) -> EditStep:
        if not isinstance(step, Adjust) or step.element.name not in both or what not in said:
            return step
        return replace(step, radius=None) if what == "angle" else replace(step, degrees=None)

    return [[tuple(own(step, change.what) for step in way) for way in ways] for change, ways in rows]


def _is_mirror(request: EditRequest) -> bool:
    return any(change.what == "mirror" for change in request.changes)


def _ways(
    change: Change, elements: RoadElements, found: Measures, world: World, number: int
) -> tuple[EditCandidate, ...]:
    if change.what == "mirror":
        if not any(element.kind == "turn" for element in elements):
            raise EditError("the road has no turn, so its mirror image is the same")
        return ((Mirror(),),)
    if change.what == "add":
        return insertion_candidates(change, elements, world, number)
    assert change.target is not None
    meant = pointed(change.target, elements, change.what)
    if change.what == "alternate":
        return alternating_candidates(meant, world)
    if change.what == "remove":
        return removal_candidates(meant, elements)
    return change_candidates(change, meant, found, world)


__all__ = ["EditRequest", "Edited", "edit", "read_request"]
