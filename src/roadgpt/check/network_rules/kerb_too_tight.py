"""Requires the kerb between two neighbouring arms of a junction to have a radius of at least 3 m.

The kerb is the right edge of the connecting road on which traffic turns right from one arm to the next. With
traffic on the left, it is the left edge of the connecting road on which traffic turns left. The smallest
radius of the kerb is measured; clothoids make it smaller than the radius of an arc with the same ends.
Source: Urban Street Design Guide (NACTO, 2013), corner radii: standard curb radii are 10 to 15 ft.
"""

from roadgpt.check.finding import Finding
from roadgpt.check.lane_bends import tightest_bend
from roadgpt.check.network_places import junction_finding, more_room
from roadgpt.network import Network, Route
from roadgpt.road import World

LEAST = 3.0  # m
EDGE = 1.0  # of the width of the lane
ROUNDING = 1e-9  # m


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction with a kerb that is too tight, and the smallest radius there."""
    found = []
    for _, junctions in network.nodes:
        radii = [radius for junction in junctions for radius in _kerbs(network.right_hand, junction.id)]
        least = min(radii, default=LEAST)
        if least < LEAST - ROUNDING:
            what = (
                f"the kerb between two arms has a radius of {least:.1f} m, tighter than {LEAST:g} m; "
                f"{more_room(junctions[0])}"
            )
            found.append(junction_finding("kerb_too_tight", route, junctions[0], what))
    return tuple(found)


def _kerbs(network: Network, number: int) -> list[float]:
    """Returns the smallest radius in metres of each kerb of a junction; traffic must drive on the right.

    A kerb that never bends to the right is left out.
    """
    junction = network.junction(number)
    ends = [arm.end for arm in junction.arms]
    following = dict(zip(ends, [*ends[1:], *ends[:1]], strict=True))
    found = []
    for each in junction.connections:
        if following.get(each.incoming) == each.outgoing:
            bend = tightest_bend(network.road(each.road), EDGE, only_right=True)
            if bend is not None:
                found.append(bend.radius)
    return found
