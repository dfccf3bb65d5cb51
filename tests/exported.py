"""Roads and a drive to export, and programs of others that may be at hand to read what came out."""

import os
import shutil
import sys
import warnings
import xml.etree.ElementTree as ET
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from unittest.mock import patch
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from roadgpt.export import Poses, Trajectories
from roadgpt.road import Design, Limits, Road, Segment, Site, World, build
from roadgpt.traffic import SIZES, Actor, Tracks

TO_MAP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # glTF's y is our z
WORLD = World(site=Site(friction=0.6), limits=Limits(speed_limit=50 / 3.6))
HILLY = Design(
    starting_point=(50, 40, -3),
    theta=30,
    segments=(
        Segment(distance=60, direction="straight", incline=4),
        Segment(distance=50, direction="left", incline=8, turn_degrees=70),
        Segment(distance=40, direction="right", incline=-10, turn_degrees=-60, radius=25),
        Segment(distance=45, direction="straight", incline=0),
    ),
)
ROADS = {
    "arcs": build(HILLY),
    "spline": build(HILLY, geometry="spline"),
    "flat points": Road.through([[20, 30], [70, 60], [120, 60], [180, 130]]),
    "short": Road.through([[10, 10, 0], [13, 10, 0.1]]),
    "far away": Road.through([[-60_000, 90_000, 500], [-59_900, 90_050, 505], [-59_800, 90_000, 500]]),
}
"""By name: one of each kind that an exporter meets."""


def asam_says(file: Path) -> tuple[list[str], dict[str, int]]:
    """Issues that ASAM's checker of scenarios finds, and how many of its checks ended how."""
    result, settings = file.with_suffix(".xqar"), file.with_suffix(".settings")
    settings.write_text(
        f'<Config><Param name="InputFile" value={quoteattr(str(file))}/>'
        '<CheckerBundle application="xoscBundle">'
        f'<Param name="resultFile" value={quoteattr(str(result))}/></CheckerBundle></Config>'
    )
    with warnings.catch_warnings(action="ignore"), patch.object(sys, "argv", ["", "-c", str(settings)]):
        from qc_openscenario.main import main

        main()
    root = ET.parse(result).getroot()
    ends = [checker.get("status", "") for checker in root.iter("Checker")]
    issues = [f"{issue.get('ruleUID')}: {issue.get('description')}" for issue in root.iter("Issue")]
    return issues, {end: ends.count(end) for end in set(ends)}


def drive(road: Road, world: World = WORLD) -> Poses:
    """A car that sways about the middle of the right lane at 8 m/s, pitching and rolling."""
    time = np.arange(0.0, (road.length - 2.5) / 8.0, 0.02) if road.length > 3 else np.array([0.0, 0.02])
    s = np.minimum(2.5 + 8.0 * time, road.length)
    x, y, z = road.at(s, -world.section.lane_width / 2 + 0.4 * np.sin(s / 7)).T
    pitch, roll = np.arctan(road.grade(s)) + 0.01 * np.sin(s), 0.03 * np.cos(s / 5)
    return Poses(time, x, y, z + 0.56, road.heading(s) + 0.02 * np.sin(s), pitch, roll, np.full(len(s), 8.0))


KINDS = (*SIZES, "car", "truck")
MOVES, LATE, LEAVES = 0, len(SIZES), len(SIZES) + 1


def among_others() -> tuple[Poses, Tracks]:
    """One of each kind; the first waits, drives off uphill and stops, one comes late, one leaves."""
    road = ROADS["arcs"]
    poses = drive(road)
    time = np.arange(0, poses.time[-1] + 0.1, 0.1)
    states = np.zeros((len(time), len(KINDS), 5))
    for number in range(len(KINDS)):
        states[:, number, :4] = 5.0 * number, -30, 2, 0.3 * number
    for number, aside in ((MOVES, -3.0), (LATE, 0.0), (LEAVES, 3.0)):
        s = np.clip(30 + 5 * (time - 4), 30, 110) + 20 * (number == LATE)
        place = road.at(s, aside)
        states[:, number] = np.column_stack([place, np.unwrap(road.heading(s)), np.gradient(s, time)])
    states[time < 7.05, LATE] = np.nan
    states[time > 9.05, LEAVES] = np.nan
    actors = tuple(Actor(f"{kind} {n}", kind, SIZES[kind]) for n, kind in enumerate(KINDS))
    states[..., :3], states[..., 3] = np.round(states[..., :3], 3), np.round(states[..., 3], 4)
    sizes = np.array([actor.size for actor in actors])
    others = Trajectories(tuple(actor.name for actor in actors), KINDS, sizes, time, states)
    return replace(poses, others=others), Tracks(actors, states)


def python_with(module: str, venv: str) -> str:
    """A Python that has this module: ours, or that of an environment in the folder JUDGE_HOME; or skip."""
    if find_spec(module) is not None:
        return sys.executable
    for folder in filter(None, [os.environ.get("JUDGE_HOME"), Path(__file__).parents[1] / "judges"]):
        python = Path(folder, venv, "bin", "python")
        if python.exists():
            return str(python)
    pytest.skip(f"{module} is not at hand")


def program(name: str, venv: str = "tools") -> str:
    """A program: on the path, or in a folder of JUDGE_HOME; or skip."""
    places = [
        Path(os.environ.get("JUDGE_HOME") or Path(__file__).parents[1] / "judges") / venv / part
        for part in ("bin", "")
    ]
    found = shutil.which(name) or next(
        filter(None, (shutil.which(name, path=place) for place in places)), None
    )
    return found or pytest.skip(f"{name} is not at hand")


def contents(folder: Path) -> dict[str, bytes]:
    """Every file by its path; some formats are folders."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def read_gltf(file: Path) -> dict[str, Any]:
    """Meshes by the name of their node, in coordinates of the map."""
    import trimesh

    scene = trimesh.load_scene(file)
    out = {}
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        mesh = scene.geometry[name].copy()
        mesh.apply_transform(place)
        normals = mesh.vertex_normals @ TO_MAP.T  # of the file; trimesh forgets them when vertices move
        mesh.vertices = mesh.vertices @ TO_MAP.T
        mesh.metadata["normals"] = normals
        out[node] = mesh
    return out
