"""Builds networks for tests from a few words, and damages them on purpose."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.network import (
    Arm,
    Connection,
    Junction,
    Network,
    NetworkRoad,
    RoadEnd,
    Roundabout,
    Route,
    build_route,
)
from roadgpt.road import Road, Site, World, read_design

WORLD = World(site=Site(map_size=500))


def design(
    *parts: dict[str, Any] | float,
    start: tuple[float, float, float] = (100.0, 250.0, 0.0),
    theta: float = 0.0,
    width: float = 4.0,
) -> dict[str, Any]:
    """Returns a design: a number is a straight of that length, other parts are segments or junctions."""
    data: dict[str, Any] = {
        "starting_point": list(start),
        "theta": theta,
        "lanes": {"forward": 1, "backward": 1, "width": width},
    }
    segments = junctions = 0
    for part in parts:
        if isinstance(part, dict) and "kind" in part:
            junctions += 1
            data[f"junction{junctions}"] = {"after": segments, **part}
        else:
            segments += 1
            given = part if isinstance(part, dict) else {"distance": part}
            data[f"road_segment{segments}"] = {
                "direction": "straight", "incline": 0, "turn_degrees": 0, **given,
            }  # fmt: skip
    return data


def built(data: dict[str, Any], world: World = WORLD) -> Route:
    """Returns the route of a design."""
    return build_route(read_design(data)[0], world)


def passing(kind: str, take: int | str = 1, **more: Any) -> Route:
    """Returns a route of 60 m, a junction and 60 m."""
    return built(design(60.0, {"kind": kind, "take": take, **more}, 60.0))


def with_road(network: Network, number: int, change: Callable[[NetworkRoad], NetworkRoad]) -> Network:
    """Returns the network with one road changed."""
    return replace(
        network, roads=tuple(change(each) if each.id == number else each for each in network.roads)
    )


def with_junction(network: Network, number: int, change: Callable[[Junction], Junction]) -> Network:
    """Returns the network with one junction changed."""
    changed = tuple(change(each) if each.id == number else each for each in network.junctions)
    return replace(network, junctions=changed)


def with_plan(member: NetworkRoad, **fields: Any) -> NetworkRoad:
    """Returns the road with fields of its plan changed, such as x or pieces."""
    assert isinstance(member.road.plan, PieceCurve)
    return replace(
        member, road=Road(replace(member.road.plan, **fields), member.road.elevation, profile=member.profile)
    )


def with_heights(member: NetworkRoad, elevation: GradeProfile) -> NetworkRoad:
    """Returns the road with other heights."""
    return replace(member, road=Road(member.road.plan, elevation, profile=member.profile))


def raised(member: NetworkRoad, by: float) -> NetworkRoad:
    """Returns the road ``by`` metres higher."""
    heights = member.road.elevation
    assert isinstance(heights, GradeProfile)
    return with_heights(member, replace(heights, z0=heights.z0 + by))


def beside(network: Network, dx: float, dy: float) -> Network:
    """Returns the network and, in the same network but not joined to it, a copy of it that is moved."""
    step = 1000

    def end(each: RoadEnd) -> RoadEnd:
        return RoadEnd(each.road + step, each.contact)

    roads = [
        replace(
            with_plan(each, x=each.road.plan.x + dx, y=each.road.plan.y + dy),  # type: ignore[attr-defined]
            id=each.id + step,
            junction=None if each.junction is None else each.junction + step,
        )
        for each in network.roads
    ]
    junctions = [
        replace(
            each,
            id=each.id + step,
            arms=tuple(Arm(end(arm.end), arm.direction, arm.control) for arm in each.arms),
            connections=tuple(
                Connection(way.road + step, end(way.incoming), end(way.outgoing), way.lanes)
                for way in each.connections
            ),
            node=(each.node[0] + dx, each.node[1] + dy, each.node[2]),
        )
        for each in network.junctions
    ]
    rings = [
        Roundabout(
            tuple(number + step for number in each.junctions),
            tuple(number + step for number in each.ring),
            (each.centre[0] + dx, each.centre[1] + dy, each.centre[2]),
            each.radius,
            each.width,
        )
        for each in network.roundabouts
    ]
    return Network((*network.roads, *roads), (*network.junctions, *junctions), (*network.roundabouts, *rings))
