"""Requires a lane for acceleration or deceleration beside every ramp, at least 28 m long without its taper.

A car at 50 km/h covers this distance in 2 s, about the shortest duration of a lane change in traffic.
Source: Toledo and Zohar, Modeling duration of lane changes (2007): 1 to 13 s, 4.6 s on average."""

from roadgpt.brief.junction_check import LEAST_BESIDE_RAMP
from roadgpt.brief.junctions import RAMPS
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.network_measures import lengths_beside_ramp
from roadgpt.network import Network, Route
from roadgpt.road import World

LEAST = LEAST_BESIDE_RAMP


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each merge or exit whose lane for acceleration or deceleration is too short."""
    found = []
    for junction in network.junctions:
        if junction.kind not in RAMPS:
            continue
        length, _ = lengths_beside_ramp(network, junction)
        if length < LEAST:
            word = "acceleration" if junction.kind == "merge" else "deceleration"
            what = f"the lane for {word} is {length:.0f} m long, shorter than {LEAST:g} m; make it longer"
            found.append(junction_finding("ramp_too_short", route, junction, what))
    return tuple(found)
