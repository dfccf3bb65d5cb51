"""Requires the kerb between two neighbouring arms of a junction to have a radius of at least 3 m.

The kerb is the right edge of the connecting road on which traffic turns right from one arm to the next. With
traffic on the left, it is the left edge of the connecting road on which traffic turns left. The smallest
radius of the kerb is measured; clothoids make it smaller than the radius of an arc with the same ends.
Source: Urban Street Design Guide (NACTO, 2013), corner radii: standard curb radii are 10 to 15 ft."""

from collections.abc import Iterator

from roadgpt.check.finding import Finding, bends_below
from roadgpt.check.network_measures import tightest_radius
from roadgpt.network import Junction, Network, Route
from roadgpt.road import World

LEAST = 3.0  # m
EDGE = 1.0  # of the width of the lane


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction with a kerb that is too tight, and the smallest radius there."""
    what = "the kerb between two arms has a radius of {:.1f} m"
    return bends_below("kerb_too_tight", network, route, LEAST, what, _kerbs)


def _kerbs(network: Network, junction: Junction) -> Iterator[float]:
    ends = [arm.end for arm in junction.arms]
    following = dict(zip(ends, [*ends[1:], *ends[:1]], strict=True))
    for each in junction.connections:
        if following.get(each.incoming) == each.outgoing:
            yield tightest_radius(network.road(each.road), EDGE, only_right=True)
