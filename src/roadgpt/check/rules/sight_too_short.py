"""Requires a road with a design speed to show its driver the stopping sight distance everywhere: its land
may hide the road only farther ahead.

Source: AASHTO Green Book, chapter 3, as in ``brief.design_speed``. Without land, or without a design speed,
nothing is checked."""

from roadgpt.brief.design_speed import limits_at
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, single_road
from roadgpt.network import Network
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the place of a single road from which its driver sees least of it."""
    road = single_road(route)
    if road is None or brief is None or brief.speed is None or not world.has_ground:
        return ()
    from roadgpt.network.sight import sight_along

    stations, sight = sight_along(road, world)
    at, needed = int(sight.argmin()), limits_at(brief.speed).sight
    if sight[at] >= needed:
        return ()
    s, (x, y, _) = float(stations[at]), road.at(float(stations[at])).tolist()
    sentence = (
        f"at s = {s:.0f} m its driver sees {sight[at]:.0f} m of the road; {brief.speed:g} km/h needs"
        f" {needed:.0f} m, the stopping sight distance"
    )
    return (Finding("sight_too_short", sentence, s, x, y),)
