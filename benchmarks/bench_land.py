"""Lays roads and networks into land, exports them as glTF, and asks a ray caster of its own about gaps
between road and ground, open seams and buried roads; and says how long land takes.

    python benchmarks/bench_land.py [roads] [networks]
    python benchmarks/bench_land.py --ways FOLDER    ways over SRTM tiles (.hgt.zip) and straight lines"""

import argparse
import json
import struct
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from network.random_maps import map_route
from roadgpt import draft, read
from roadgpt.check.rules import not_in_land
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.export import save
from roadgpt.geometry import Piece, PieceCurve
from roadgpt.ground.ground import Ground
from roadgpt.ground.relief import Relief, Way, made
from roadgpt.ground.wayfinding import profile_over, way_between
from roadgpt.network import network_of
from roadgpt.network.road_or_route import made_from
from roadgpt.network.surface import pavement_of
from roadgpt.road import Road, World

KINDS = ("flat", "rolling", "hilly", "mountain")
PLANS = (
    "turn x3", "turn x4 | up", "hairpin x3 | up", "turn x5 | len=500..700", "straight 300", "turn x2 | down",
    "turn x6", "hairpin | down",
)  # fmt: skip
SCENES = (
    "", "", "lake along right", "bridge", "ridge through; tunnel", "valley", "river across", "forest",
    "valley across; bridge", "coast across",
)  # fmt: skip
CELL = 4.0  # m, side of a bucket of triangles
GAP = 0.01  # m


def meshes_of(path: Path) -> dict[str, np.ndarray]:
    """The triangles (m, 3, 3) of each node of a binary glTF, with z up."""
    data = path.read_bytes()
    (size,) = struct.unpack("<I", data[12:16])
    told, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def values(number: int, kind: str, wide: int) -> np.ndarray:
        of = told["accessors"][number]
        view = told["bufferViews"][of["bufferView"]]
        table = np.frombuffer(binary, kind, of["count"] * wide, view["byteOffset"])
        return table.reshape(-1, wide)

    origin, found = np.array(told["nodes"][0]["translation"]), {}
    for node in told["nodes"][1:]:
        part = told["meshes"][node["mesh"]]["primitives"][0]
        points = values(part["attributes"]["POSITION"], "<f4", 3).astype(float) + origin
        points = np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])
        found[node["name"]] = points[values(part["indices"], "<u4", 1).reshape(-1, 3)]
    return found


class Caster:
    """Upright rays through triangles."""

    def __init__(self, triangles: np.ndarray) -> None:
        self.triangles = triangles
        low, high = (np.floor(f(triangles[:, :, :2], axis=1) / CELL).astype(int) for f in (np.min, np.max))
        self.buckets: dict[tuple[int, int], list[int]] = {}
        for number, (a, b) in enumerate(zip(low, high, strict=True)):
            for i in range(a[0], b[0] + 1):
                for j in range(a[1], b[1] + 1):
                    self.buckets.setdefault((i, j), []).append(number)

    def highest(self, points: np.ndarray, slack: float = 1e-6) -> np.ndarray:
        """The highest hit at each point (n, 2), NaN without any."""
        found = np.full(len(points), np.nan)
        cells = np.floor(points / CELL).astype(int)
        order = np.lexsort(cells.T)
        cuts = np.flatnonzero(np.any(np.diff(cells[order], axis=0), axis=1)) + 1
        for own in np.split(order, cuts):
            near = self.triangles[self.buckets.get(tuple(cells[own[0]].tolist()), [])]
            if not len(near):
                continue
            x, y = points[own, 0, None], points[own, 1, None]
            a, b, c = near[:, 0], near[:, 1], near[:, 2]
            pairs = ((b, c), (c, a), (a, b))
            w = np.stack([(q[:, 0] - x) * (r[:, 1] - y) - (q[:, 1] - y) * (r[:, 0] - x) for q, r in pairs])
            whole = w.sum(axis=0)
            share = np.where(np.abs(whole) > 1e-12, w / np.where(whole == 0, 1.0, whole), -1.0)
            inside = share.min(axis=0) >= -slack
            z = np.where(
                inside, (share * np.stack([a[:, 2], b[:, 2], c[:, 2]])[:, None]).sum(axis=0), -np.inf
            )
            best = z.max(axis=1)
            found[own] = np.where(np.isfinite(best), best, np.nan)
        return found


def looked_at(road: Road, world: World, rng: np.random.Generator) -> dict[str, float]:
    """What rays say about one road or network in its land."""
    with tempfile.TemporaryDirectory() as folder:
        (file,) = save(road, Path(folder), ["gltf"], world)
        parts = meshes_of(file)
    solid = ("ground", "water", "path", "lines")
    lines = [name for name in parts if "line" in name]
    roads = [
        each for name, each in parts.items() if name not in (*solid, *lines) and not name.startswith("br")
    ]
    ground, surface = Caster(parts["ground"]), Caster(np.concatenate(roads))
    told = dict.fromkeys(("rays", "buried", "gap", "seams", "rims"), 0.0)
    from roadgpt.network.landscape import ground_around

    spans = ground_around(road, world).pavement.spans
    for member in network_of(road, world).roads_outside:
        s = rng.uniform(0.0, member.road.length, max(20, int(member.road.length / 2)))
        on_ground, is_open = np.ones(len(s), bool), np.ones(len(s), bool)
        for each in spans:
            if each.road == member.id:
                on_ground &= (s < each.start - 1) | (s > each.end + 1)
                is_open &= on_ground | (each.kind == "bridge")
        s, on_ground, rims = s[is_open], on_ground[is_open], member.profile.rims(s[is_open])
        for share in (-0.999, -0.7, -0.3, 0.0, 0.3, 0.7, 0.999):
            points = member.road.at(s, np.where(share > 0, share * rims.left, -share * rims.right))
            earth, road_z = ground.highest(points[:, :2]), surface.highest(points[:, :2])
            told["rays"] += len(s)
            told["buried"] += int((earth > points[:, 2] + GAP).sum())
            told["gap"] += int((~(np.abs(road_z - points[:, 2]) <= GAP)).sum())
        for rim in (rims.left, rims.right):
            for aside in (-0.02, -0.001, 0.001, 0.02, 0.3):
                points = member.road.at(s, rim + np.sign(rim) * aside)[:, :2]
                told["rims"] += int(on_ground.sum())
                is_hole = np.isnan(ground.highest(points)) & np.isnan(surface.highest(points))
                told["seams"] += int((is_hole & on_ground).sum())
    return told


def laid(count: int, networks: int) -> None:
    rng, total, times, done, refused = np.random.default_rng(1), {}, [], 0, 0
    for number in range(count + networks):
        kind, scene = KINDS[number % 4], SCENES[number % len(SCENES)]
        world = World().changed(ground=f"{kind}:{number % 100}", scene=scene)
        if number < count:
            brief = read(PLANS[number % len(PLANS)], reader="plan", is_map_fixed=False)
            try:
                road = made_from(draft(brief, World(), seed=number), world)
            except RoadGPTError:
                continue
        else:
            road = map_route(number - count)
        road = world.lay(road)
        if not_in_land.inspect(network_of(road, world), road, None, world):
            refused += 1
            continue
        start = time.perf_counter()
        told = looked_at(road, world, rng)
        times.append(time.perf_counter() - start)
        done += 1
        total = {name: total.get(name, 0.0) + value for name, value in told.items()}
        if told["buried"] or told["gap"] or told["seams"]:
            print(f"{number} {kind} {scene}: {told}")
    print(f"{done} roads and networks: {total}; {np.median(times):.2f} s each; {refused} refused by the rule")


def timed(count: int = 40) -> None:
    for size in (250.0, 1000.0):
        spent = []
        for number in range(count + 1):
            brief = read(PLANS[number % len(PLANS)], reader="plan", is_map_fixed=False)
            road = made_from(draft(brief, World(), seed=number), World())
            surface = pavement_of(network_of(road, World()))
            line = road.centreline(2.0)
            middle = (line[:, :2].min(axis=0) + line[:, :2].max(axis=0)) / 2
            box = middle - size / 2, middle + size / 2
            start = time.perf_counter()
            Ground.of(made(Way(line, line), KINDS[number % 4], (), number, box), surface, cell=1.0)
            spent.append(time.perf_counter() - start)
        print(f"ground of {size:g} m at 1 m: {1000 * np.median(spent[1:]):.1f} ms, median of {count}")


def ways(folder: Path, size: float = 2000.0, each: int = 34, cell: float = 90.0) -> None:
    rng, spent, areas, found, asked = np.random.default_rng(1), [], [], 0, 0
    for file in sorted(folder.glob("*.zip")):
        packed = zipfile.ZipFile(file)
        flat = np.frombuffer(packed.read(packed.namelist()[0]), ">i2").astype(float)
        tile, n = flat.reshape(int(np.sqrt(len(flat))), -1)[::-1], int(size / cell) + 1
        for _ in range(each):
            i, j = rng.integers(0, len(tile) - n, 2)
            heights = tile[i : i + n, j : j + n].copy()
            start, end = rng.uniform(60, (n - 1) * cell - 60, (2, 2))
            if heights.min() < -100 or np.ptp(heights) < 1 or np.hypot(*(end - start)) < 300:
                continue
            relief = Relief(0.0, 0.0, cell, heights, np.full(heights.shape, np.nan), np.empty((0, 3)))
            asked, begun = asked + 1, time.perf_counter()
            try:
                way = way_between(relief, tuple(start), tuple(end), 0.08, 20.0)
            except UsageError as error:
                print(f"{file.name}: {error}")
                continue
            finally:
                spent.append(time.perf_counter() - begun)
            found += 1
            s = np.linspace(0.0, way.plan.length, round(way.plan.length))
            own = np.abs(way.elevation.height(s) - relief.at(*way.plan.at(s).T)).mean() * way.plan.length
            far = float(np.hypot(*(end - start)))
            line = PieceCurve(*start, float(np.arctan2(*(end - start)[::-1])), (Piece(far),))
            if (straight := profile_over(relief, line, 0.08, 1e4)) is not None:
                s = np.linspace(0.0, far, 300)
                areas.append((own, np.abs(straight[0].height(s) - relief.at(*line.at(s).T)).mean() * far))
    own, line = np.sum(areas, axis=0)
    print(f"{found} of {asked} ways found, median {1000 * np.median(spent):.0f} ms; ", end="")
    print(f"area between road and land {own:.0f} m2, of straight lines {line:.0f} m2 ({own / line:.3f})")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("roads", nargs="?", type=int, default=500)
    parser.add_argument("networks", nargs="?", type=int, default=200)
    parser.add_argument("--ways", type=Path)
    given = parser.parse_args()
    if given.ways:
        ways(given.ways)
    else:
        timed()
        laid(given.roads, given.networks)
