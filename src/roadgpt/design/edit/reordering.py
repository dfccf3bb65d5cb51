"""Reorders the elements of a road: reverses the whole road, moves turns, or lets two turns or two straights
change places.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.pointing import straights, turns
from roadgpt.design.edit.steps import EditCandidate
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import World

REVERSED = "the road leads from its former end to its former start; its parts are named as before"
RENAMED = "what follows names the parts as they come in the new direction"


@dataclass(frozen=True, slots=True)
class Reverse:
    """Reverses the whole road: climbs become falls, and left turns become right turns."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements from the last to the first, each reversed."""
        return tuple(
            element.with_segments(
                segment.model_copy(update={"incline": 0.0 - segment.incline})
                for segment in reversed(element.segments)
            )
            for element in map(RoadElement.mirrored, reversed(elements))
        )


@dataclass(frozen=True, slots=True)
class Swap:
    """Lets two elements change places; each keeps its length, angle, radius, side and grade."""

    one: str
    other: str

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in their new order."""
        by_name = {element.name: element for element in elements}
        places = {self.one: by_name[self.other], self.other: by_name[self.one]}
        return tuple(places.get(element.name, element) for element in elements)


@dataclass(frozen=True, slots=True)
class Move:
    """Moves turns to another place among the turns; each keeps its angle, radius, side and grade.

    The straights between them stay where they are.
    """

    names: tuple[str, ...]
    after: str
    """The name of the turn behind which the moved turns come; empty for the beginning of the road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in their new order."""
        turns = [element for element in elements if element.is_turn]
        moved = [turn for turn in turns if turn.name in self.names]
        others = [turn for turn in turns if turn.name not in self.names]
        names = [turn.name for turn in others]
        index = names.index(self.after) + 1 if self.after else 0
        order = iter((*others[:index], *moved, *others[index:]))
        return tuple(next(order) if element.is_turn else element for element in elements)


def swap_of(chosen: Sequence[RoadElement]) -> Swap:
    """Returns the step that lets two turns, or two straights, change places.

    Raises:
        EditError: the chosen elements are not two turns or two straights.
    """
    if len(chosen) != 2 or chosen[0].is_turn != chosen[1].is_turn:
        raise EditError(
            "two turns, or two straights, can change places; name two, for example: swap turns 1 and 3"
        )
    return Swap(chosen[0].name, chosen[1].name)


def move_of(placed: PlacedChange, elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns the candidate that moves turns to another place among the turns; none if already there.

    Raises:
        EditError: something other than a turn is to be moved, a turn is to be moved next to itself, or the
            second of two places named in the request does not lie behind the first.
    """
    moved = [element.name for element in placed.elements]
    place = placed.change.place
    if place is None or not all(element.is_turn for element in placed.elements):
        raise EditError(f"'{placed.change.words}' moves a straight; only turns can be moved")
    before = _turn_names(elements)
    others = [name for name in before if name not in moved]
    at = {element.name: index for index, element in enumerate(elements)}
    match place.how:
        case "start":
            index = 0
        case "end":
            index = len(others)
        case "middle":
            index = len(others) // 2
        case how:
            marks = (*placed.marks, *([placed.stop] if placed.stop else []))
            if any(mark.name in moved for mark in marks):
                raise EditError(f"'{placed.change.words}' moves a turn next to itself; name another place")
            mark = at[placed.marks[0 if how == "before" else -1].name]
            if placed.stop and at[placed.stop.name] <= mark:
                raise EditError(f"'{placed.change.words}' names its places the other way round")
            index = sum(at[name] < mark + (how != "before") for name in others)
    if (*others[:index], *moved, *others[index:]) == before:
        return ()
    return ((Move(tuple(moved), others[index - 1] if index else ""),),)


def reordering_sentence(placed: PlacedChange, elements: RoadElements) -> str:
    """Returns a sentence on a change that only reorders elements."""
    match placed.change.what:
        case "reverse":
            return REVERSED
        case "move":
            names = _turn_names(elements)
            numbers = [str(names.index(element.name) + 1) for element in placed.elements]
            moved = f"turn {numbers[0]} has" if len(numbers) == 1 else f"turns {' and '.join(numbers)} have"
            return f"{moved} moved; the turns are named as before"
        case _:
            is_of_turns = placed.elements[0].is_turn
            alike = turns(elements) if is_of_turns else straights(elements)
            one, other = (alike.index(element) + 1 for element in placed.elements)
            noun = "turn" if is_of_turns else "straight"
            return f"{noun} {one} and {noun} {other} have changed places; they are named as before"


def _turn_names(elements: Sequence[RoadElement]) -> tuple[str, ...]:
    return tuple(element.name for element in turns(elements))
