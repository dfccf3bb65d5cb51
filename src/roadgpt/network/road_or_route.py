"""Tells single roads and Routes apart, and makes a road from anything that describes one.

The packages that drive, judge and draw roads use these functions. Importing this module loads no module that
builds or describes networks; a single road needs none of those modules."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from typing_extensions import TypeIs

from roadgpt.errors import UsageError
from roadgpt.road import Design, Geometry, Road, World, build

if TYPE_CHECKING:
    from roadgpt.network.network import Leg, Network, NetworkRoad
    from roadgpt.network.route import Route

ONLY = 1  # the id of the road in the network of a single road


def is_route(road: Road) -> "TypeIs[Route]":
    """Returns whether a road is a Route: the network of a map, or a way through its junctions."""
    return road.is_route


def refuse_without_route(road: Road, what: str) -> None:
    """Raises UsageError if no route was asked for; ``what`` says what cannot be done then, as in "driven"."""
    if not road.has_way:
        raise UsageError(
            f"a map without a route cannot be {what}; give its design one, the nodes in driving order, such "
            'as "route": [1, 2, 4], or take routes through an OpenDRIVE map with roadgpt import and its '
            "--random-routes"
        )


def refuse_other_lane(road: Road, world: World) -> None:
    """Raises UsageError if the scene says in which lane the tested car starts, and it starts in another."""
    if (lane := world.scene.lane) is None:
        return
    first = legs_of(road, world)[0]
    profile = network_of(road, world).road(first.road).profile
    ids = profile.along_ids if profile.leads_along(first.lane) else profile.against_ids
    here, said = sorted(ids, key=abs, reverse=True).index(first.lane), lane - (lane > 0)
    if here != said % len(ids) or abs(lane) > len(ids):
        raise UsageError(
            f"the scene says lane={lane}, and on this road the tested car starts in lane {1 + here} of"
            f" {len(ids)} from the kerb; write lane={1 + here}, or leave it out"
        )


# The next three functions are where single roads and Routes become one: all other code asks them.


def network_of(road: Road, world: World) -> "Network":
    """Returns the network of a Route. A single road is a network of one road, with the id ``ONLY`` and with
    the lanes of the World where it has none of its own."""
    if is_route(road):
        return road.network
    from roadgpt.network.network import Network, NetworkRoad

    return Network((NetworkRoad(ONLY, road.with_profile(world.profile_of(road))),))


def legs_of(road: Road, world: World) -> "tuple[Leg, ...]":
    """Returns the roads and lanes of ``network_of`` that a Route follows; of a single road, its driven
    lane."""
    if is_route(road):
        return road.legs
    from roadgpt.network.network import Leg

    profile = world.profile_of(road)
    return (Leg(ONLY, profile.driven_id),)


def only_road(road: Road, world: World) -> "NetworkRoad | None":
    """Returns the road that makes up the network of a single road, which is written and drawn as it is: it
    may be a spline, and banked. None for a Route, whose network is level areas between lines, arcs and
    clothoids."""
    return None if is_route(road) else network_of(road, world).roads[0]


def made_from(blueprint: Design | Road, world: World, geometry: Geometry = "arcs") -> Road:
    """Returns the road that a design describes, or the road itself. The World gives the lanes and banked
    bends that it lacks; ``geometry`` says how a design without junctions becomes a road. Raises UsageError if
    the road is too long, or ``geometry`` is not "arcs" for a design with junctions or a map; see also
    ``build_route``."""
    if isinstance(blueprint, Road):
        return world.lay(blueprint)
    if blueprint.is_plain:
        return world.lay(build(blueprint, geometry))
    from roadgpt.network.growing import build_route

    if geometry != "arcs":
        raise UsageError("a route with junctions is built from arcs; leave out --geometry spline")
    return build_route(blueprint, world).on_ground()


def road_from_json(data: Mapping[str, Any]) -> Road:
    """Restores a road or a route from JSON data as returned by ``to_json``. A route gets shoulders to the
    edge of the ground; see ``Route.on_ground``. Raises UsageError if a field is missing or of the wrong type,
    a number is not finite, the road is too long or too steep, or the route does not fit its network."""
    if "network" not in data:
        return Road.from_json(data)
    from roadgpt.network.network import legs_from_json, network_from_json
    from roadgpt.network.route import Route

    return Route.along(network_from_json(data["network"]), legs_from_json(data.get("route"))).on_ground()
