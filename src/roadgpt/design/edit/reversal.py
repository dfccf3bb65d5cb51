"""Reverses a road, so that it leads from its end to its start."""

from dataclasses import dataclass, replace
from math import degrees, pi

from roadgpt.design.edit.steps import flipped
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.road import Design, Segment, World, build

DECIMALS = 6  # of the start and its direction


@dataclass(frozen=True, slots=True)
class Reverse:
    """Reverses the whole road: what climbed falls, and what turned to the left turns to the right."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements from the last to the first, each reversed."""
        return tuple(map(_reversed, reversed(elements)))


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
