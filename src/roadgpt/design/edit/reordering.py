"""Reorders the elements of a road: reverses the whole road, or lets two turns change places."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees, pi

from roadgpt.design.edit.steps import flipped
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import Design, Segment, World, build

DECIMALS = 6  # of the start and its direction


@dataclass(frozen=True, slots=True)
class Reverse:
    """Reverses the whole road: what climbed falls, and what turned to the left turns to the right."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements from the last to the first, each reversed."""
        return tuple(map(_reversed, reversed(elements)))


@dataclass(frozen=True, slots=True)
class Swap:
    """Lets two elements change places; each keeps its angle, radius, side and grade."""

    one: str
    other: str

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in their new order."""
        by_name = {element.name: element for element in elements}
        places = {self.one: by_name[self.other], self.other: by_name[self.one]}
        return tuple(places.get(element.name, element) for element in elements)


def swap_of(elements: Sequence[RoadElement]) -> Swap:
    """Returns the step that lets two turns change places.

    Raises:
        EditError: these are not two turns.
    """
    if len(elements) != 2 or not all(element.is_turn for element in elements):
        raise EditError("two turns can change places; name two, for example: swap turns 1 and 3")
    return Swap(elements[0].name, elements[1].name)


def _reversed(element: RoadElement) -> RoadElement:
    turned = flipped(element)
    return replace(turned, segments=tuple(map(_falling, reversed(turned.segments))))


def _falling(segment: Segment) -> Segment:
    return segment.model_copy(update={"incline": 0.0 - segment.incline})


def started_at_end(design: Design, segments: tuple[Segment, ...]) -> Design:
    """Returns a Design with these segments, which starts where the road of ``design`` ends and heads back."""
    road = build(design)
    x, y, z = (round(float(value), DECIMALS) for value in road.at(road.length))
    theta = degrees(float(road.heading(road.length)) + pi) % 360
    return Design(starting_point=(x, y, z), theta=round(theta, DECIMALS) % 360, segments=segments)
