"""Roads of many descriptions, as other programs read them: how long a format takes, how far points are off.

    python benchmarks/bench_readers.py [ROADS [FORMAT...]]

Every second road is a spline. A reader that is not installed is left out. Prints one table.
"""

import contextlib
import io
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.export import Poses, save
from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.road import Road, World, build, in_short_segments

WORDS = (
    "a road",
    "an uphill road with 3 turns",
    "a sharp left turn, then a long straight, then two gentle right turns",
    "a downhill road with four alternating turns",
    "a hairpin to the right",
    "an s-bend uphill followed by a straight downhill segment",
    "a straight road of 150 m that climbs 8 %",
    "a hilly road with 5 turns",
    "a road with two left turns of radius 20 m",
    "a crest, then a sharp right turn",
)
WORLD = World()


def main(count: int = 200, *formats: str) -> None:
    roads = drawn(count)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in formats or READERS:
            begin = time.process_time()
            for i, road in enumerate(roads):
                poses = drive(road) if name == "openscenario" and i % 10 == 0 else None
                save(road, folder, [name], WORLD, f"{name}{i}", poses)
            seconds = time.process_time() - begin
            try:
                rows.append((name, seconds, *READERS[name](roads, Path(folder))))
            except ImportError as error:
                rows.append((name, seconds, f"not asked: {error}", None, 0.0))
    print(f"{count} roads, {sum(road.length for road in roads) / 1000:.1f} km")
    print(f"{'format':14s} {'processor':>11s}  {'read by':28s} {'refused':>8s} {'farthest off':>13s}")
    for name, seconds, who, refused, off in rows:
        found = f"{'-':>8s} {'-':>13s}" if refused is None else f"{refused:8d} {off * 1000:10.2f} mm"
        print(f"{name:14s} {seconds:9.1f} s  {who:28s} {found}")


def drawn(count: int) -> list[Road]:
    """Roads of all descriptions in turn, as arcs and as splines in turn."""
    briefs = [read(words) for words in WORDS]
    designs = [draft(briefs[i % len(briefs)], WORLD, seed=i) for i in range(count)]
    # splines through hops, as `roadgpt run --geometry spline` draws them
    return [
        build(in_short_segments(each), "spline") if i % 2 else build(each) for i, each in enumerate(designs)
    ]


def drive(road: Road) -> Poses:
    """Along the middle of the right lane at 10 m/s."""
    time_ = np.arange(0.0, (road.length - 10.0) / 10.0, 0.02)
    s = 2.5 + 10.0 * time_
    x, y, z = road.at(s, -2.0).T
    flat = np.zeros(len(s))
    return Poses(time_, x, y, z + 0.56, road.heading(s), np.arctan(road.grade(s)), flat, flat + 10.0)


def asked_of_asam(roads: list[Road], folder: Path) -> tuple[str, int, float]:
    """The scenario of each road and the drive of every tenth; every rule is checked."""
    import logging

    from qc_baselib import Configuration, Result
    from qc_openscenario import constants
    from qc_openscenario.main import run_checks

    logging.disable()
    refused = 0
    files = sorted(folder.glob("openscenario*.xosc"))
    for file in files:
        settings = Configuration()
        settings.set_config_param("InputFile", str(file))
        settings.register_checker_bundle(constants.BUNDLE_NAME)
        result = Result()
        result.register_checker_bundle(name=constants.BUNDLE_NAME, description="", version="1", summary="")
        with contextlib.redirect_stdout(io.StringIO()):
            run_checks(settings, result)
        ends = [str(each.status.value) for each in result.get_checker_results(constants.BUNDLE_NAME)]
        assert len(ends) == 17
        refused += result.get_issue_count() > 0 or {*ends} != {"completed"}
    return f"ASAM's checker, {len(files)} files", refused, 0.0


def asked_of_lanelet2(roads: list[Road], folder: Path) -> tuple[str, int, float]:
    """Points, and a route from start to end."""
    import lanelet2
    import lanelet2.io
    import lanelet2.projection
    import lanelet2.routing
    import lanelet2.traffic_rules as traffic

    projector = lanelet2.projection.UtmProjector(lanelet2.io.Origin(LATITUDE, LONGITUDE))
    rules = traffic.create(traffic.Locations.Germany, traffic.Participants.Vehicle)
    refused, off = 0, 0.0
    for i, road in enumerate(roads):
        map_, errors = lanelet2.io.loadRobust(str(folder / f"lanelet2{i}.osm"), projector)
        graph = lanelet2.routing.RoutingGraph(map_, rules)
        places = [
            lanelet2.core.BasicPoint2d(*road.at(s, -2.0)[:2].tolist()) for s in (0.5, road.length - 0.5)
        ]
        ends = [lanelet2.geometry.findNearest(map_.laneletLayer, place, 1)[0][1] for place in places]
        route = graph.shortestPath(*ends)
        whole = route is not None and 2 * len(list(route)) == len(list(map_.laneletLayer))
        refused += bool(list(errors)) or bool(list(graph.checkValidity(False))) or not whole
        off = max(off, distance(road, np.array([[p.x, p.y, p.z] for p in map_.pointLayer])))
    return "lanelet2, routing graph", refused, off


def asked_of_opencrg(roads: list[Road], folder: Path) -> tuple[str, int, float]:
    """The reference line and its heights."""
    import pycrg

    pycrg.set_message_level(pycrg.MSG_LEVEL_NONE)
    refused, off = 0, 0.0
    for i, road in enumerate(roads):
        with pycrg.DataSet.open(folder / f"crg{i}.crg") as data, data.create_contact_point() as contact:
            refused += not data.check()
            u = np.linspace(0, road.length * (1 - 1e-9), 200)
            points = np.column_stack([*contact.uv_to_xy_many(u, 0 * u), contact.uv_to_z_many(u, 0 * u)])
            off = max(off, float(np.linalg.norm(points - road.at(u), axis=1).max()))
    return "ASAM's OpenCRG library", refused, off


def asked_of_trimesh(roads: list[Road], folder: Path) -> tuple[str, int, float]:
    """Slabs are closed, and their upper side is the road."""
    import trimesh

    refused, off = 0, 0.0
    for i, road in enumerate(roads):
        scene = trimesh.load_scene(folder / f"gltf{i}.glb")
        place, mesh = scene.graph["road"]
        slab = scene.geometry[mesh].copy()
        slab.merge_vertices(merge_norm=True, merge_tex=True)
        refused += not (slab.is_watertight and slab.is_winding_consistent)
        x, y, z = (slab.vertices + place[:3, 3]).T
        points = np.column_stack([x, -z, y])
        s, _ = road.locate(points[:, 0], points[:, 1])
        upper = np.abs(road.at(s)[:, 2] - points[:, 2]) < 0.25
        off = max(off, distance(road, points[upper]))
    return "trimesh, closed slabs", refused, off


def distance(road: Road, points: Any) -> float:
    """The farthest of some points of lane borders and middle from where the road has them."""
    s, t = road.locate(points[:, 0], points[:, 1])
    borders = np.array([-WORLD.section.lane_width, 0.0, WORLD.section.lane_width])
    nearest = borders[np.abs(t[:, None] - borders).argmin(axis=1)]
    return float(np.linalg.norm(road.at(s, nearest) - points, axis=1).max())


def not_asked(roads: list[Road], folder: Path) -> tuple[str, None, float]:
    return "(see tests/authorities)", None, 0.0


READERS: dict[str, Callable[[list[Road], Path], tuple[str, int | None, float]]] = {
    "openscenario": asked_of_asam,
    "gltf": asked_of_trimesh,
    "lanelet2": asked_of_lanelet2,
    "crg": asked_of_opencrg,
    "commonroad": not_asked,
    "sumo": not_asked,
}

if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
