"""Compares routes and maps with their requirements. Single roads do not need these rooms."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.map_promises import broken_map
from roadgpt.check.route_promises import broken_promises
from roadgpt.network import Route


def broken_network(route: Route, brief: Brief, map_size: float) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that a route, or the map that it leads through, does not meet.

    Args:
        route: The route.
        brief: The requirements.
        map_size: Side of the square map in metres.
    """
    if brief.map is not None:
        return broken_map(route, brief.map, brief.length)
    return broken_promises(route, brief, map_size)
