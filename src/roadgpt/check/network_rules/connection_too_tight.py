"""Requires the middle of the lane of every connecting road to have a radius of at least 5 m.

A car 4.7 m long can just follow this radius: its turning circle between kerbs usually has a diameter of 11 m.
Then its outer front wheel runs on a radius of 5.5 m, and the middle of the car on a radius of about 4.7 m."""

from collections.abc import Iterator

from roadgpt.check.finding import Finding, bends_below
from roadgpt.check.network_measures import tightest_radius
from roadgpt.network import Junction, Network, Route
from roadgpt.road import World

LEAST = 5.0  # m
MIDDLE = 0.5  # of the width of the lane


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction with a connecting road that is too tight, and the smallest radius there."""
    what = "the lane of a connecting road has a radius of {:.1f} m in its middle"
    return bends_below("connection_too_tight", network, route, LEAST, what, _lanes)


def _lanes(network: Network, junction: Junction) -> Iterator[float]:
    for each in junction.connections:
        yield tightest_radius(network.road(each.road), MIDDLE)
