"""Roads of a few parts, as many tests want them."""

from dataclasses import replace

from roadgpt.road import Design, Road, Segment, build
from roadgpt.run import Run


def design_of(
    *parts: tuple[float, float, float],
    start: tuple[float, float, float] = (60.0, 60.0, 0.0),
    theta: float = 20.0,
) -> Design:
    """A design of parts: metres, degrees (to the left positive; 0 is a straight), percent of incline."""
    segments = tuple(
        Segment(
            distance=distance,
            direction="left" if turn > 0 else "right" if turn < 0 else "straight",
            turn_degrees=turn,
            incline=incline,
        )
        for distance, turn, incline in parts
    )
    return Design(starting_point=start, theta=theta, segments=segments)


def road_of(
    *parts: tuple[float, float, float],
    start: tuple[float, float, float] = (60.0, 60.0, 0.0),
    theta: float = 20.0,
) -> Road:
    """The road of such a design."""
    return build(design_of(*parts, start=start, theta=theta))


def named(run: Run, words: str) -> Run:
    """The run as if its road had been described in these words."""
    return replace(run, request=run.request.model_copy(update={"words": words}))
