"""Small roads for tests, put together from straights and turns of known size."""

from math import radians

from roadgpt.road import Design, Road, Segment, build


def road_of(*segments: Segment) -> Road:
    return build(Design(starting_point=(60, 60, 0), theta=20, segments=segments))


def straight(length: float, incline: float = 0.0) -> Segment:
    return Segment(distance=length, direction="straight", incline=incline)


def turn(degrees: float, radius: float = 30.0, incline: float = 0.0, ramp: float = 6.0) -> Segment:
    """A turn of this radius between clothoids of ``ramp`` metres; left positive."""
    return Segment(
        distance=radius * radians(abs(degrees)) + ramp,
        direction="left" if degrees > 0 else "right",
        turn_degrees=degrees,
        radius=radius,
        transition=ramp,
        incline=incline,
    )
