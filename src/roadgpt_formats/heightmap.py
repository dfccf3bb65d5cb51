"""Exports the land with the roads in it as a picture of heights with 16 bits, with its world file, and a JSON
file with the roads, as terrain tools import them."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.ground.files import write_ground
from roadgpt.network import network_of
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

NODES = 5.0  # m between the nodes of a road
MARGIN = 1.0  # m beyond the verge, within which the land keeps the height of the road
DECIMALS = 3


class Heightmap:
    """A 16-bit PNG of the land with the roads in it, its world file, and the roads as JSON."""

    name = "heightmap"
    suffix = ".png"
    holds_junctions = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the picture, NAME.pgw with the place of its pixels, and NAME.json: the metres of its levels,
        and the nodes, widths and domain of influence of each road, in metres. A drive is left out."""
        ground = ground_around(road, world)
        write_ground(ground.heights, ground.cell, path, (float(ground.x[0]), float(ground.y[0])))
        said = path.with_suffix(".json")
        told = json.loads(said.read_text(encoding="utf-8"))
        told["roads"] = [_road(each.id, each.road, world) for each in network_of(road, world).roads]
        spans = ground.pavement.spans
        told["structures"] = [{**each._asdict()} for each in spans]
        said.write_text(json.dumps(told) + "\n", encoding="utf-8")


def _road(number: int, road: Road, world: World) -> dict[str, Any]:
    profile = world.profile_of(road)
    s = np.linspace(0.0, road.length, max(2, round(road.length / NODES) + 1))
    paved, rims = profile.edges(s), profile.rims(s)
    t = (paved.left + paved.right) / 2
    influence = np.maximum(rims.left - t, t - rims.right) + MARGIN
    middle = road.at(s, t)
    nodes = np.column_stack([middle, paved.left - paved.right])
    return {
        "id": number,
        "nodes": np.round(nodes, DECIMALS).tolist(),  # x, y, z, width
        "domain_of_influence": round(float(influence.max()), DECIMALS),
        "margin": MARGIN,
    }
