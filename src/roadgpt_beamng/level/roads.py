r"""Converts a road to BeamNG's mesh roads and decal roads, for the files of a level or for a running
simulator.

    mesh road    solid strip that carries the wheels: nodes x, y, z, width, depth
    decal road   strip that is drawn on the mesh road and that BeamNG's AI follows: nodes x, y, z, width

As in the bachelor thesis behind RoadGPT, both follow the same line, the middle of the carriageway, and the
nodes of the mesh road are shifted slightly at random so that the two surfaces do not flicker. In addition,
the decal is placed a little above the mesh. The shifts depend only on the seed. The shoulder is a second,
wider mesh just below the first one. It reaches down to the ground, which is just below the lowest point of
the road. A road without shoulders floats, and the ground is just below ``world.site.z_floor``.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.export.ego import goal_of, start_of
from roadgpt.geometry.curve import Array
from roadgpt.road import Edges, Profile, Road, World
from roadgpt.road.edges import finite, line, named_lines, normals
from roadgpt.road.profile import LINE

# m between nodes: denser ones fold (BeamNGpy issue 240), and uneven ones make BeamNG's spline swing.
SPACING = 2.0
DEPTH = 5.0  # m, of a mesh road (RoadGPT)
STUB = 5.0  # m of mesh before the start and past the end (RoadGPT), so that no wheel stands on an edge
SHAKE = 0.01  # m, the greatest random shift of a mesh node
ABOVE = 0.01, 0.02  # m by which the decal lies above the mesh
UNDER = 0.03  # m by which the shoulder lies below the road
CLEAR = 0.05  # m by which the ground lies below everything else
DRIVABLE, NOT_DRIVABLE = 1, -1
GOAL = "goal"


class Materials(NamedTuple):
    """Names of the materials of a level; each field is named after the surface that uses the material."""

    road: str
    verge: str
    surface: str
    """Material of the decal that covers the road."""
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
    """Shape (n, 5) for a mesh: x, y, z, width, depth; shape (n, 4) for a decal: x, y, z, width."""
    drivability: int = NOT_DRIVABLE
    priority: int = 0
    """Drawing order of a decal: painted lines have higher numbers, and are drawn on the asphalt."""
    is_dashed: bool = False
    """Whether a painted line is dashed. Dashes and gaps are as long as in exported OpenDRIVE files."""
    normals: Array | None = None
    """Upward unit normals ``(n, 3)`` of a banked mesh; None for a level cross-section."""
    is_one_way: bool = False
    """Whether the road has no oncoming lanes; only set for the decal road that BeamNG's AI follows."""

    @property
    def is_mesh(self) -> bool:
        """Whether the strip is a mesh road, on whose surface the car drives."""
        return bool(self.nodes.shape[1] == 5)


@dataclass(frozen=True, eq=False)
class LevelRoad:
    """The mesh roads and decal roads of a road, lowest first, and where the drive begins and ends."""

    strips: tuple[Strip, ...]
    start: Array
    """Point (x, y, z) of the road surface under the car's centre of gravity at the start, in metres."""
    heading: float
    """Heading at the start in radians."""
    grade: float
    goal: Array
    """Point (x, y, z) of the goal in the middle of the right lane, in metres."""
    ground: float
    """Height of the level's ground in metres."""


def level_road(
    road: Road, world: World, seed: int, materials: Materials = OWN, lift: float = 0.0, prefix: str = ""
) -> LevelRoad:
    """Returns the mesh roads and decal roads of a road with its shoulder and markings, and the start and goal
    of the drive. ``seed`` sets the random shifts against flicker; everything is raised by ``lift`` metres,
    for a level whose ground is not at ``world.site.z_floor``; ``prefix`` keeps the names in a level apart."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, road.length, max(3, int(np.ceil(road.length / SPACING)) + 1))
    up = np.array([0.0, 0.0, lift])
    above = np.array([0.0, 0.0, rng.uniform(*ABOVE)])
    finite(line(road, s, 0.0))
    profile = world.profile_of(road)
    banked = profile.superelevation_angle is not None
    across = np.pad(normals(road, s), ((1, 1), (0, 0)), mode="edge") if banked else None
    meshes, ground = [], world.site.z_floor - CLEAR + lift
    if profile.has_shoulders:
        rims = profile.rims(s)
        lowest = min(float(line(road, s, t)[:, 2].min()) for t in (0.0, *rims))
        ground = lowest - UNDER - CLEAR + lift
        below = _lengthened(_between(road, s, rims) + up) - np.array([0.0, 0.0, UNDER])
        depths = np.maximum(DEPTH, below[:, 2] - ground)
        meshes.append(_mesh(f"{prefix}verge", materials.verge, below, rims, across, depths))
    edges = profile.edges(s)
    shaken = _lengthened(_between(road, s, edges) + up)
    shaken[:, :2] += rng.uniform(-SHAKE, SHAKE, (len(shaken), 2))
    depths = np.full(len(shaken), DEPTH)
    meshes.append(_mesh(f"{prefix}road", materials.road, shaken, edges, across, depths))
    first, goal = start_of(road), (goal_of(road) + road.length) / 2
    return LevelRoad(
        (*meshes, *_decals(road, profile, s, up + above, materials, prefix)),
        road.at(first, profile.middle(first)) + up,
        float(road.heading(first)),
        float(road.grade(first)),
        road.at(goal, profile.middle(goal)) + up,
        ground,
    )


def _between(road: Road, s: Array, edges: Edges) -> Array:
    return line(road, s, (edges.left + edges.right) / 2)


def _decals(
    road: Road, profile: Profile, s: Array, up: Array, materials: Materials, prefix: str
) -> list[Strip]:
    """Returns the decal that the AI follows, and the painted lines."""
    left, right = edges = profile.edges(s)
    nodes = np.column_stack([_between(road, s, edges) + up, left - right])
    one_way = profile.count[1] == 0
    strips = [Strip(f"{prefix}lanes", materials.surface, nodes, DRIVABLE, is_one_way=one_way)]
    for priority, painted in enumerate(named_lines(profile, s), 1):
        name = f"line_{priority}" if painted.place == "between" else painted.place
        material = materials.middle if painted.place == "middle" else materials.edge
        nodes = np.column_stack([_between(road, s, painted.edges) + up, np.full(len(s), LINE)])
        strips.append(
            Strip(prefix + name, material, nodes, NOT_DRIVABLE, priority, is_dashed=painted.is_broken)
        )
    return strips


def _mesh(
    name: str, material: str, points: Array, edges: Edges, across: Array | None, depths: Array
) -> Strip:
    width = np.pad(edges.left - edges.right, 1, mode="edge")  # as many as the lengthened points
    return Strip(name, material, np.column_stack([points, width, depths]), normals=across)


def _lengthened(points: Array) -> Array:
    """Extends a line straight on at both ends."""
    first, last = points[0] - points[1], points[-1] - points[-2]
    before = points[0] + STUB * first / np.linalg.norm(first)
    after = points[-1] + STUB * last / np.linalg.norm(last)
    return np.vstack([before, points, after])
