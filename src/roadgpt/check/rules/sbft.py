"""Requires the road to pass the SBFT competition's validator, which ``roadgpt.check.sbft`` reproduces.

A route through junctions never passes: the competition tests single roads."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, single_road
from roadgpt.check.sbft import sbft_verdict
from roadgpt.errors import UsageError
from roadgpt.network import Network
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the error message of the competition's validator if it rejects the road's control points."""
    road = single_road(route)
    if road is None:
        return (Finding("sbft", "the road leads through junctions, and SBFT tests are single roads"),)
    try:
        is_valid, message = sbft_verdict(road.control_points(), world.site.map_size)
    except UsageError as error:  # two points coincide in plan: the competition's code stops
        is_valid, message = False, str(error)
    return () if is_valid else (Finding("sbft", message),)
