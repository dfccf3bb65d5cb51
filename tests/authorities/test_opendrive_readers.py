"""Other people's readers find in our OpenDRIVE files what we wrote: ASAM's checker, pyxodr, esmini.

ASAM's checker wants another numpy than ours, and is asked in an environment of its own: ``make judges``.
"""

import subprocess
import warnings
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD, program, python_with
from profiled import missed, outer_edges, random_road
from roadgpt.export import save
from roadgpt.network import read_opendrive
from roadgpt.road import Road

DATA = Path(__file__).parents[1] / "formats" / "opendrive" / "data"
PROFILED = {f"seed{seed}": random_road(seed) for seed in (1, 9, 17)}
CONFIG = """<Config><Param name="InputFile" value="{file}"/><CheckerBundle application="xodrBundle">
<Param name="resultFile" value="{result}"/></CheckerBundle></Config>"""


ASK = """
import logging, sys
from qc_opendrive import main
logging.disable(logging.CRITICAL)
for config in sys.argv[1:]:
    sys.argv = ["qc_opendrive", "-c", config]
    main.main()
"""


def complaints(python: str, files: list[Path]) -> dict[str, tuple[dict[str, int], list[str]]]:
    """By file: how many checkers came to what end, and all issues."""
    for file in files:
        config = CONFIG.format(file=file, result=file.with_suffix(".xqar"))
        file.with_suffix(".config.xml").write_text(config)
    ask = [python, "-c", ASK, *(str(file.with_suffix(".config.xml")) for file in files)]
    subprocess.run(ask, check=True, capture_output=True, cwd=files[0].parent)
    found = {}
    for file in files:
        report = ET.parse(file.with_suffix(".xqar")).getroot()
        ends: dict[str, int] = {}
        for checker in report.iter("Checker"):
            ends[checker.attrib["status"]] = ends.get(checker.attrib["status"], 0) + 1
        issues = [f"{each.attrib['ruleUID']}: {each.attrib['description']}" for each in report.iter("Issue")]
        found[file.name] = (ends, issues)
    return found


def test_asams_checker_has_nothing_to_say(tmp_path: Path) -> None:
    python = python_with("qc_opendrive", "venv-qc")
    files = []
    for number, road in enumerate(ROADS.values()):
        *_, file = save(road, tmp_path, ["opendrive"], WORLD, f"road{number}")
        files.append(file)
    for number in (0, 2):
        older = tmp_path / f"older{number}.xodr"  # 1.8 leaves one rule out that 1.7 has
        older.write_text(files[number].read_text().replace('revMinor="8"', 'revMinor="7"'))
        files.append(older)
    files += [save(road, tmp_path, ["opendrive"], WORLD, name)[-1] for name, road in PROFILED.items()]
    for ends, issues in complaints(python, files).values():
        assert issues == []
        assert ends["completed"] >= 22
        assert "error" not in ends


def read_by_pyxodr(file: Path) -> dict[str, np.ndarray]:
    """Reference lines with heights ``(n, 3)``, by the id of the road."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pyxodr.road_objects.network import RoadNetwork

        network = RoadNetwork(xodr_file_path=str(file), ignored_lane_types=set(), resolution=0.1)
        return {
            str(road.id): np.column_stack([road.reference_line, road.z_coordinates])
            for road in network.get_roads()
        }


def aside(road: Road, points: np.ndarray) -> tuple[float, float]:
    """How far points lie beside a road, and above or below it."""
    s, t = road.locate(points[:, 0], points[:, 1])
    return float(np.abs(t).max()), float(np.abs(points[:, 2] - road.at(s)[:, 2]).max())


@pytest.mark.parametrize("name", [name for name in ROADS if name != "short"])
def test_pyxodr_reads_our_line(tmp_path: Path, name: str) -> None:
    *_, file = save(ROADS[name], tmp_path, ["opendrive"], WORLD)
    (points,) = read_by_pyxodr(file).values()
    across, above = aside(ROADS[name], points)
    assert across < 1e-3
    assert above < 1e-3
    assert points[-1] == pytest.approx(ROADS[name].at(ROADS[name].length), abs=5e-3)


@pytest.mark.parametrize("name", ["sg_spiral", "sg_poly", "sg_merge", "sumo_polyline"])
def test_pyxodr_and_we_read_the_same_in_files_of_others(name: str) -> None:
    for id_, points in read_by_pyxodr(DATA / f"{name}.xodr").items():
        found = read_opendrive(DATA / f"{name}.xodr", id_)
        across, above = aside(found.road, points)
        assert across < 5e-3, id_
        assert above < 5e-2, id_  # pyxodr takes a chord for the station


EDGES = """
import sys
from lxml import etree
from qc_opendrive.base import utils
sides = utils.get_left_lanes_from_lane_section, utils.get_right_lanes_from_lane_section
for file in sys.argv[1:]:
    road = etree.parse(file).getroot().find("road")
    section = road.find("lanes/laneSection")
    for n in range(41):
        s = float(road.get("length")) * (0.01 + 0.98 * n / 40)
        for side in sides:
            edges = utils.get_outer_border_points_from_lane_group_by_s(side(section), 0.0, 0.0, s)
            for lane, t in edges.items():
                point = utils.get_point_xyz_from_road(road, s, t, 0.0)
                print(lane, point.x, point.y, point.z)
    print()
"""


def test_asams_checker_finds_our_edges_and_their_heights(tmp_path: Path) -> None:
    """On level roads: on a grade, its superelevation leaves the pitch of the road aside."""
    python = python_with("qc_opendrive", "venv-qc")
    roads = [random_road(seed, steepest=0.0) for seed in (1, 2, 3, 5, 9)]
    files = [save(road, tmp_path, ["opendrive"], WORLD, f"level{n}")[-1] for n, road in enumerate(roads)]
    ask = [python, "-c", EDGES, *map(str, files)]
    done = subprocess.run(ask, check=True, capture_output=True, text=True)
    for road, told in zip(roads, done.stdout.strip().split("\n\n"), strict=True):
        _near(road, np.array([line.split() for line in told.splitlines()], float))


def test_esmini_finds_our_edges_and_their_heights(tmp_path: Path) -> None:
    odrplot = program("odrplot")
    for name, road in PROFILED.items():
        *_, file = save(road, tmp_path, ["opendrive"], WORLD, name)
        subprocess.run(
            [odrplot, str(file), "track.csv"], check=True, capture_output=True, cwd=tmp_path, timeout=60
        )
        rows, lane = [], None
        for line in (tmp_path / "track.csv").read_text().splitlines():
            cells = [cell.strip() for cell in line.split(",")]
            if cells[0] == "lane":
                lane = float(cells[3])
            elif lane is not None and len(cells) == 4:
                rows.append([lane, *map(float, cells[:3])])
        _near(road, np.array(rows))


def _near(road: Road, rows: np.ndarray) -> None:
    """Rows of lane, x, y, z lie within a millimetre of the outer edges of a road's lanes."""
    assert road.profile is not None
    assert {*rows[:, 0]} | {0.0} == {0.0, *map(float, outer_edges(road.profile, np.zeros(1)))}
    for lane in {*rows[:, 0].astype(int)}:
        aside, above = missed(road, lane, rows[rows[:, 0] == lane][1:-1, 1:])
        assert aside < 1e-3, lane
        assert above < 1e-3, lane


def test_pyxodr_finds_our_edges_in_plan(tmp_path: Path) -> None:
    """On roads without superelevation, which it leaves aside."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pyxodr.road_objects.network import RoadNetwork

        for seed in (1, 2, 9):
            banked = random_road(seed)
            assert banked.profile is not None
            road = banked.with_profile(replace(banked.profile, superelevation_angle=None))
            *_, file = save(road, tmp_path, ["opendrive"], WORLD, f"plain{seed}")
            (found,) = RoadNetwork(str(file), ignored_lane_types=set(), resolution=0.1).get_roads()
            for lane in found.lane_sections[0].lanes:
                s, t = road.locate(*lane.boundary_line[5:-5].T)
                assert road.profile is not None
                assert t == pytest.approx(outer_edges(road.profile, s)[int(lane.id)], abs=1e-3), lane.id
