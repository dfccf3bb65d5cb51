"""Requires a lane for acceleration or deceleration beside every ramp, at least 28 m long without its taper.

A car at 50 km/h covers this distance in 2 s, about the shortest duration of a lane change in traffic.
Source: Toledo and Zohar, Modeling duration of lane changes (2007): 1 to 13 s, 4.6 s on average."""

from roadgpt.brief.junction_check import LEAST_BESIDE_RAMP as LEAST
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.measures import ramp_of
from roadgpt.network import Network
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each merge or exit whose lane for acceleration or deceleration is too short."""
    found = []
    for junction in network.junctions:
        ramp = ramp_of(network, junction)
        if ramp is not None and ramp.lane < LEAST:
            word = "acceleration" if junction.kind == "merge" else "deceleration"
            what = f"the lane for {word} is {ramp.lane:.0f} m long, shorter than {LEAST:g} m; make it longer"
            found.append(junction_finding("ramp_too_short", route, junction, what))
    return tuple(found)
