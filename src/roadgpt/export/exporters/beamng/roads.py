r"""A road as BeamNG has roads, for a level's files and for a running simulator alike.

    mesh road    what the wheels stand on: a strip with depth through nodes x, y, z, width, depth
    decal road   what is drawn on it, and what BeamNG's AI finds its way by: nodes x, y, z, width

RoadGPT lays both along one line and shakes the mesh's nodes, so that they do not flicker where they meet.
Here the decal lies a little above the mesh as well, and what shakes is drawn from the seed. The verge is a
second, wider mesh just below the first. It reaches down to the ground, which lies at the lowest place of the
road; a road without verge floats above a ground at ``world.z_floor``.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.errors import ExportError
from roadgpt.export.edges import line
from roadgpt.export.ego import goal_of, start_of
from roadgpt.export.exporters.opendrive.lanes import NO_VERGE
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

# m between nodes: denser and sharper ones fold (BeamNGpy issue 240), and uneven ones swing BeamNG's spline.
SPACING = 2.0
DEPTH = 5.0  # m, of a mesh road (RoadGPT)
STUB = 5.0  # m of mesh before the start and past the end (RoadGPT), so that no wheel stands on an edge
SHAKE = 0.01  # m, most that a mesh node is moved aside
ABOVE = 0.01, 0.02  # m that the decal lies above the mesh
LINE = 0.2  # m, width of a painted line (RoadGPT)
UNDER = 0.03  # m that the verge lies below the road
CLEAR = 0.05  # m that the ground lies below what is laid on it
DRIVABLE, NOT_DRIVABLE = 1, -1
GOAL = "goal"


class Materials(NamedTuple):
    """Names of a level's materials."""

    road: str
    verge: str
    surface: str
    """Of the decal that covers the road."""
    edge: str
    middle: str


OWN = Materials(
    "roadgpt_asphalt", "roadgpt_verge", "roadgpt_asphalt_decal", "roadgpt_white", "roadgpt_yellow"
)


@dataclass(frozen=True, eq=False)
class Strip:
    """A mesh road or a decal road."""

    name: str
    material: str
    nodes: Array
    """Shape (n, 5) of a mesh: x, y, z, width, depth; (n, 4) of a decal: x, y, z, width."""
    drivability: int = NOT_DRIVABLE
    priority: int = 0
    """Of a decal, among those of its scene: the painted lines lie on the asphalt."""
    is_dashed: bool = False
    """A decal whose paint is broken, by DASH and GAP of our OpenDRIVE files."""

    @property
    def is_mesh(self) -> bool:
        """Does it hold wheels?"""
        return bool(self.nodes.shape[1] == 5)


@dataclass(frozen=True, eq=False)
class LevelRoad:
    """Strips from below upwards, and where the drive begins and ends."""

    strips: tuple[Strip, ...]
    start: Array
    """x, y, z of the road under the car's centre of gravity."""
    heading: float
    """Radians."""
    grade: float
    goal: Array
    """x, y, z at the middle of the right lane."""
    ground: float
    """Height of the level's ground, metres."""


def level_road(
    road: Road, world: World, seed: int, materials: Materials = OWN, lift: float = 0.0, prefix: str = ""
) -> LevelRoad:
    """The road with verge, markings, start and goal; the same arguments give the same numbers.

    Args:
        road: what is laid.
        world: widths of lane and verge.
        seed: of the offsets against flicker.
        materials: of the level that it is laid in.
        lift: metres by which all of it is raised, where the level's ground is not at ``world.z_floor``.
        prefix: of the strips' names, which must be unique in a level.

    Raises:
        ExportError: the road has a number that is not finite.
    """
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, road.length, max(3, int(np.ceil(road.length / SPACING)) + 1))
    up = np.array([0.0, 0.0, lift])
    above = np.array([0.0, 0.0, rng.uniform(*ABOVE)])
    middle = line(road, s, 0.0) + up
    if not np.isfinite(middle).all():
        raise ExportError("the road has a number that is not finite; check it before it is exported")
    ground = _ground(middle, world) + lift
    meshes = _meshes(middle, world, rng, materials, prefix, ground)
    decals = _decals(road, world, s, up + above, materials, prefix)
    first, last = start_of(road), goal_of(road)
    right = -world.lane_width / 2
    return LevelRoad(
        (*meshes, *decals),
        road.at(first, right) + up,
        float(road.heading(first)),
        float(road.grade(first)),
        road.at((last + road.length) / 2, right) + up,
        ground,
    )


def _ground(middle: Array, world: World) -> float:
    """Just below the lowest place of the verge, or of the floor where there is none; metres."""
    if world.verge < NO_VERGE:
        return world.z_floor - CLEAR
    return float(middle[:, 2].min()) - UNDER - CLEAR


def _meshes(
    middle: Array,
    world: World,
    rng: np.random.Generator,
    materials: Materials,
    prefix: str,
    ground: float,
) -> list[Strip]:
    """The verge, where there is one, and the road."""
    strips = []
    if world.verge >= NO_VERGE:
        broad = 2 * (world.lane_width + world.verge)
        below = _lengthened(middle) - np.array([0.0, 0.0, UNDER])
        depths = np.maximum(DEPTH, below[:, 2] - ground)
        strips.append(_mesh(f"{prefix}verge", materials.verge, below, broad, depths))
    shaken = _lengthened(middle)
    shaken[:, :2] += rng.uniform(-SHAKE, SHAKE, (len(shaken), 2))
    return [*strips, _mesh(f"{prefix}road", materials.road, shaken, world.road_width)]


def _decals(road: Road, world: World, s: Array, up: Array, materials: Materials, prefix: str) -> list[Strip]:
    """What the AI finds its way by, and the painted lines."""
    wide = world.lane_width
    wanted = (
        ("lanes", materials.surface, 0.0, world.road_width, DRIVABLE),
        ("left", materials.edge, wide - LINE / 2, LINE, NOT_DRIVABLE),
        ("right", materials.edge, LINE / 2 - wide, LINE, NOT_DRIVABLE),
        ("middle", materials.middle, 0.0, LINE, NOT_DRIVABLE),
    )
    strips = []
    for priority, (name, material, t, width, drivability) in enumerate(wanted):
        points = line(road, s, t) + up
        nodes = np.column_stack([points, np.full(len(points), width)])
        strips.append(Strip(prefix + name, material, nodes, drivability, priority, name == "middle"))
    return strips


def _mesh(name: str, material: str, points: Array, width: float, depths: Array | None = None) -> Strip:
    deep = np.full(len(points), DEPTH) if depths is None else depths
    return Strip(name, material, np.column_stack([points, np.full(len(points), width), deep]))


def _lengthened(points: Array) -> Array:
    """Straight on at both ends."""
    first, last = points[0] - points[1], points[-1] - points[-2]
    before = points[0] + STUB * first / np.linalg.norm(first)
    after = points[-1] + STUB * last / np.linalg.norm(last)
    return np.vstack([before, points, after])
