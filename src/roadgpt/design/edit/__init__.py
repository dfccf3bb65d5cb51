"""Edits a Design as a change request asks, and leaves the rest unchanged. Main function: ``edit``.

    words --checked_request--> EditRequest --placed, settled--> PlacedChanges
          --candidates_of--> ChangeCandidates --made--> Look --sentences--> Edited

Changes that cannot be made at once go through the second line one after the other (``stages``). A Look is a
Design with the road that was built from it, the findings of the rules, and measurements.
Turns and straights are those that ``check.measures`` finds on the finished road. They are numbered as on the
road before the edit. Elements that the request does not name keep all their values, but the road as a whole
may be shifted or rotated, so that it stays inside the map."""

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

from roadgpt.brief.change import EditRequest, checked_request, other_readings, read_request
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.change.request import OF_SLOPE, Change
from roadgpt.brief.readers.model.trained import DOUBT
from roadgpt.brief.words import SURFACES
from roadgpt.chat import ChatSettings
from roadgpt.design.differences import grades_changed, sentences
from roadgpt.design.edit.candidates import RENAMED, candidates_of, sentence_of
from roadgpt.design.edit.places import placed
from roadgpt.design.edit.search import made
from roadgpt.design.edit.stages import (
    carried_over,
    directions,
    renamed,
    settled,
    stages,
    unchanged,
    with_final_heights,
)
from roadgpt.design.road_elements import elements_on_road
from roadgpt.errors import EditError, IdleEditError, UnclearPlaceError
from roadgpt.road import Design, Geometry, Site, World

MOST_CHANGES = 12


class Edited(NamedTuple):
    """A changed Design, and sentences that describe how it differs from the old one."""

    design: Design
    changes: tuple[str, ...]
    unused: tuple[str, ...] = ()  # words of the request that were not understood
    confidence: float = 1.0  # estimated probability that the request was read correctly
    other: str = ""  # the plan of another reading that is likely; empty if there is none
    world: World = World()  # the World before the edit, or one with a larger map if the changed road needs it


def edit(
    design: Design,
    words: str | EditRequest,
    world: World,
    geometry: Geometry = "arcs",
    chat: ChatSettings | None = None,
) -> Edited:
    """Returns the Design, changed as the words ask: the text of a change request, or the EditRequest read
    from it.

    A map of the usual size grows if the changed road needs it. ``chat`` are the settings of the language
    model that reads the words; None for RoadGPT's own networks. Raises EditError if the words cannot be read,
    name something that is not on the road, or ask for something that no valid road can have, and ChatError if
    the language model could not be asked."""
    request = read_request(words, chat) if isinstance(words, str) else words
    try:
        return _edited(design, checked_request(request), world, geometry)
    except EditError as error:
        for other in other_readings(request) if _may_be_other(request, error) else ():
            with suppress(EditError):
                return _instead(error, request, _edited(design, other, world, geometry))
        raise


def _may_be_other(request: EditRequest, error: EditError) -> bool:
    """Returns whether a request that this road cannot have may be meant as its next likely readings. That is
    so if the first reading is doubtful. If the road is as asked already, or has several such places, it is so
    if the next reading asks for the same kinds of changes: "the descent" of a road that falls all the way is
    the whole road."""
    if request.confidence < DOUBT:
        return True
    if not request.others or not isinstance(error, IdleEditError | UnclearPlaceError):
        return False
    other = read_change_plan(request.other)
    is_alike = {each.what for each in other.changes} == {each.what for each in request.changes}
    return is_alike and (isinstance(error, IdleEditError) or all(each.is_of_road for each in other.changes))


def _instead(error: EditError, request: EditRequest, made: Edited) -> Edited:
    """Returns what was made of another reading, with a sentence on why the likeliest one was not."""
    asked = "; ".join(change.words for change in request.changes)
    told = f"'{asked}', the likeliest reading, cannot be done: {error}"
    return made._replace(changes=(*made.changes, told), unused=request.unused)


def _edited(design: Design, request: EditRequest, world: World, geometry: Geometry) -> Edited:
    if len(request.changes) > MOST_CHANGES:
        raise EditError(
            f"{len(request.changes)} changes at once are too many; ask for {MOST_CHANGES} or fewer"
        )
    groups, told, idle = directions(request.changes), list[str](), 0
    now, place, may_grow = design, world, world.site.map_size == Site().map_size
    for changes in groups:
        made_of, place, said = _in_one_direction(now, changes, place, geometry, may_grow)
        idle += made_of is None
        now = made_of or now
        told += said
        if changes[0].what == "reverse" and changes is not groups[-1]:
            told.append(RENAMED)
    surface = SURFACES.get(request.surface)
    if surface and surface.friction != place.site.friction:
        told.append(f"friction {place.site.friction:g} -> {surface.friction:g}, as {surface.said}")
        place = place.changed(friction=surface.friction)
    elif surface and idle == len(groups):
        raise IdleEditError(f"nothing is to be changed: friction is {surface.friction:g} already")
    elif idle == len(groups):
        raise IdleEditError(f"nothing is to be changed: '{request.changes[0].words}' is so already")
    if place.site.map_size != world.site.map_size:
        sizes = place.site.map_size, world.site.map_size
        told.append(
            "the map is {:g} m wide, since the changed road does not fit on one of {:g} m".format(*sizes)
        )
    return Edited(now, tuple(told), request.unused, request.confidence, request.other, place)


def _in_one_direction(
    design: Design, changes: Sequence[Change], world: World, geometry: Geometry, may_grow: bool
) -> tuple[Design | None, World, list[str]]:
    """Returns the Design with changes that name their places on the same road, its World, and what to say;
    None instead of the Design if the road is so already."""
    elements, found = elements_on_road(design, geometry)
    asked = placed(changes, elements)
    once = settled(asked)
    wanted = with_final_heights(once)
    now, road = unchanged(elements, found), None
    told, idle, fitted = list[str](), list[str](), list[tuple[Design, Design]]()
    number = 1
    for stage in stages(wanted):
        if road is not None:
            now = renamed(road, now, geometry, number)
        own = [carried_over(each, now, wanted) for each in stage]
        ways = candidates_of(own, now.elements, now.found, world, first=number)
        number += len(ways)
        pairs = zip(stage, own, strict=True)
        said = [sentence_of(each, elements, there, now.elements) for each, there in pairs]
        try:
            before = design if road is None else road.design
            road, draft = made(before, now.elements, ways, world, geometry, may_grow)
            fitted.append((draft, road.design))
            world = road.requirements.world
        except IdleEditError:
            ways = tuple(each._replace(ways=()) for each in ways)
        told += [sentence for sentence, each in zip(said, ways, strict=True) if each.ways and sentence]
        idle += [f"'{each.change.words}' was so already" for each in ways if not each.ways]
    if road is None:
        return None, world, idle
    is_of_slope = all(change.change.what in OF_SLOPE for change in wanted)
    stretches = [change.stretch for change in wanted if change.stretch and is_of_slope]
    told += [
        *grades_changed(design, road.design, stretches, geometry),
        *sentences(design, elements, found, road, fitted),
        *idle,
        *(
            f"'{each.change.words}' is asked for twice and done once"
            for each in asked
            if all(each.change is not other.change for other in once)
        ),
    ]
    return road.design, world, told


__all__ = ["EditRequest", "Edited", "edit", "read_request"]
