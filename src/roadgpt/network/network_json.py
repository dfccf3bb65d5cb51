"""Writes networks and routes as JSON data, and reads them back exactly.

A road file with a route has two more fields: ``route``, a list of [road, lane], and ``network``.
"""

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter

from roadgpt.errors import UsageError
from roadgpt.network.network import Continuation, Junction, Leg, Network, NetworkRoad, Roundabout
from roadgpt.reading import strictly
from roadgpt.road import Road

MOST_ROADS = 20_000


@dataclass(frozen=True)
class _StoredRoad:
    """A road of a network in a file; the other fields are those of a road file."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="ignore", allow_inf_nan=False)

    id: int
    junction: int | None = None


@dataclass(frozen=True)
class _StoredNetwork:
    """The junctions and roundabouts of a network in a file."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="ignore", allow_inf_nan=False)

    junctions: tuple[Junction, ...]
    roundabouts: tuple[Roundabout, ...]
    continuations: tuple[Continuation, ...] = ()


def network_to_json(network: Network) -> dict[str, Any]:
    """Returns a network as JSON data for ``network_from_json``."""
    roads = [{"id": each.id, "junction": each.junction, **each.road.to_json()} for each in network.roads]
    plain = TypeAdapter(_StoredNetwork).dump_python(
        _StoredNetwork(network.junctions, network.roundabouts, network.continuations), mode="json"
    )
    return {"roads": roads, **plain}


def network_from_json(data: Any) -> Network:
    """Restores a network from JSON data as returned by ``network_to_json``.

    Raises:
        UsageError: A field is missing or of the wrong type, a road cannot be read or has no lanes, or the
            parts do not make a Network.
    """
    try:
        rows = data["roads"]
        if not isinstance(rows, list) or len(rows) > MOST_ROADS:
            raise ValueError(f"roads are a list of at most {MOST_ROADS:,}")
        roads = tuple(_road(row) for row in rows)
        rest = {key: data[key] for key in ("junctions", "roundabouts")}
        rest["continuations"] = data.get("continuations", [])
        stored = strictly(_StoredNetwork, {**rest, "junctions": _with_lane_links(rest["junctions"])})
        return Network(roads, stored.junctions, stored.roundabouts, stored.continuations)
    except KeyError as error:
        raise UsageError(f"the network cannot be read: {error} is missing; make the road again") from error
    except (TypeError, ValueError) as error:
        first = str(error).splitlines()[0][:200]
        raise UsageError(f"the network cannot be read ({first}); make the road again") from error


def _with_lane_links(junctions: Any) -> Any:
    """Returns stored junctions in which every lane link has three lanes.

    Older files have pairs without the outgoing lane. Their roads have one lane in each direction, so the
    missing id is 1 or -1.
    """
    found = copy.deepcopy(junctions)
    for junction in found:
        for each in junction["connections"]:
            after = -1 if each["outgoing"][1] == "start" else 1
            each["lanes"] = [[*lanes, after] if len(lanes) == 2 else lanes for lanes in each["lanes"]]
    return found


def _road(row: Mapping[str, Any]) -> NetworkRoad:
    stored = strictly(_StoredRoad, {key: row.get(key) for key in ("id", "junction")})
    road = Road.from_json(row, in_network=True)
    if road.profile is None:
        raise ValueError(f"road {stored.id} has no lanes")
    return NetworkRoad(stored.id, road, stored.junction)


def legs_from_json(data: Any) -> tuple[Leg, ...]:
    """Restores the legs of a route from a list of [road, lane]. Raises UsageError if the data are something
    else.
    """
    try:
        return strictly(tuple[Leg, ...], data)
    except (TypeError, ValueError) as error:
        raise UsageError("a route is a list of [road, lane], two whole numbers each") from error
