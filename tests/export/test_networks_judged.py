"""Programs of others, where they are at hand, find in the files of networks what was designed."""

import json
import re
import subprocess
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from exported import program, python_with
from network.random_designs import random_design, random_lanes_design, random_turn_lanes_design
from network.random_maps import map_route
from outside_judge import networks_referee
from roadgpt.export import save
from roadgpt.network import Network, Route, build_route
from roadgpt.road import World, read_design

SEEDS = range(6)
LANES = range(6)
MAPS = range(100, 104)
LEFT = range(40, 43)
CHECK = """
import logging, sys
from qc_opendrive import main
logging.disable(logging.CRITICAL)
for file in sys.argv[1:]:
    with open("config.xml", "w") as config:
        config.write(f'<Config><Param name="InputFile" value="{file}"/>')
        config.write('<CheckerBundle application="xodrBundle">')
        config.write(f'<Param name="resultFile" value="{file}.xqar"/></CheckerBundle></Config>')
    sys.argv = ["qc_opendrive", "-c", "config.xml"]
    main.main()
"""
DRIVE = """
import json, sys
import carla
found = {}
for file in sys.argv[1:]:
    with open(file) as text:
        road_map = carla.Map("map", text.read())
    waypoints = road_map.generate_waypoints(2.0)
    seen = {mark.id for each in waypoints for mark in each.get_landmarks(10.0)}
    lanes = {f"{each.road_id} {each.lane_id}" for each in waypoints}
    found[file] = [sorted(lanes), sorted(seen)]
print(json.dumps(found))
"""
CONVERT = """
import json, logging, sys, warnings
from collections import Counter
from pathlib import Path
logging.disable(logging.CRITICAL)
warnings.simplefilter("ignore")
from crdesigner.map_conversion.opendrive.odr2cr.opendrive_conversion.network import Network
from crdesigner.map_conversion.opendrive.odr2cr.opendrive_parser.parser import parse_opendrive
found = {}
for file in sys.argv[1:]:
    network = Network()
    network.load_opendrive(parse_opendrive(Path(file)))
    lanelets = network.export_commonroad_scenario().lanelet_network
    ways = [
        sorted(
            len(each.successors_left) + len(each.successors_straight) + len(each.successors_right)
            for each in intersection.incomings
        )
        for intersection in lanelets.intersections
    ]
    signs = [each.traffic_sign_elements[0].traffic_sign_element_id.name for each in lanelets.traffic_signs]
    found[file] = [sorted(ways), len(lanelets.traffic_lights), Counter(signs)]
print(json.dumps(found))
"""


Drawing = Callable[[int], dict[str, Any]]
"""Draws a design from a seed."""


def drawn(seed: int, draw: Drawing = random_design, left_hand: bool = False) -> tuple[dict[str, Any], Route]:
    """A design whose roads are straight near junctions, so that arms have the directions of the design."""
    data = draw(seed) | ({"left_hand": True} if left_hand else {})
    before = {each["after"] for key, each in data.items() if key.startswith("junction")}
    for number in sorted(before | {each + 1 for each in before}):
        data[f"road_segment{number}"] |= {"direction": "straight", "turn_degrees": 0.0}
    return data, build_route(read_design(data)[0], World())


def saved(folder: Path, format_: str = "opendrive") -> dict[str, Network]:
    """Files of the networks of all seeds, by path; those with several lanes and ramps are called lanes."""
    found = {}
    routes = [
        (f"network{seed}", map_route(seed) if seed in MAPS else drawn(seed)[1]) for seed in (*SEEDS, *MAPS)
    ]
    routes += [(f"lanes{seed}", drawn(seed, random_lanes_design)[1]) for seed in LANES]
    routes += [(f"left{seed}", drawn(seed, left_hand=True)[1]) for seed in LEFT]
    routes += [(f"left_lanes{seed}", drawn(seed, random_lanes_design, left_hand=True)[1]) for seed in LEFT]
    routes += [
        (f"turn_lanes{seed}", drawn(seed, random_turn_lanes_design, left_hand=seed in LEFT)[1])
        for seed in (0, 1, 40)
    ]
    for name, route in routes:
        written = save(route, folder, [format_], World(), name)
        (file,) = (path for path in written if path.suffix == ".xodr")
        found[str(file)] = route.network
    return found


def answers(python: str, script: str, files: dict[str, Network], folder: Path) -> dict[str, Any]:
    run = [python, "-c", script, *files]
    done = subprocess.run(run, capture_output=True, text=True, cwd=folder, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(json.loads(done.stdout.splitlines()[-1])) if done.stdout.strip() else {}


@pytest.mark.parametrize(("format_", "each"), [("opendrive", 3), ("opendrive17", 1)])
def test_asams_checker_has_nothing_to_say_of_networks(tmp_path: Path, format_: str, each: int) -> None:
    python = python_with("qc_opendrive", "venv-qc")
    # the schema of 1.8 takes two seconds a file, so every third file of each kind has to do
    files = dict([*saved(tmp_path, format_).items()][::each])
    answers(python, CHECK, files, tmp_path)
    for file in files:
        report = ET.parse(f"{file}.xqar").getroot()
        assert [f"{each.attrib['ruleUID']}: {file}" for each in report.iter("Issue")] == []
        ends = Counter(checker.attrib["status"] for checker in report.iter("Checker"))
        assert ends["completed"] >= 22
        assert not ends["error"]


def test_carla_finds_all_lanes_and_signals(tmp_path: Path) -> None:
    files = saved(tmp_path)
    for file, (lanes, signals) in answers(python_with("carla", "venv-carla"), DRIVE, files, tmp_path).items():
        root = ET.parse(file).getroot()
        ours = {
            f"{road.attrib['id']} {lane.attrib['id']}"
            for road in root.iter("road")
            for lane in road.iter("lane")
            if lane.attrib["type"] == "driving"
        }
        assert set(lanes) == ours
        assert set(signals) == {signal.attrib["id"] for signal in root.iter("signal")}


def test_commonroad_counts_the_same_ways_lights_and_signs(tmp_path: Path) -> None:
    files = saved(tmp_path)
    found = answers(python_with("crdesigner", "venv-cr"), CONVERT, files, tmp_path)
    for file, (ways, lights, signs) in found.items():
        junctions = files[file].junctions
        controls = Counter(arm.control for junction in junctions for arm in junction.arms)
        ours = [sorted(Counter(c.incoming for c in junction.connections).values()) for junction in junctions]
        if "lanes" not in Path(file).name:  # it makes several arms of one with several lanes
            assert ways == sorted(ours)
        assert lights == controls["lights"]
        for control, sign in (("stop", "STOP"), ("yield", "YIELD"), ("priority", "PRIORITY")):
            assert signs.get(sign, 0) == controls[control]


def test_sumo_counts_the_same_ways_lights_and_roundabouts(tmp_path: Path) -> None:
    netconvert = program("netconvert", "venv-sumo")
    for file, network in saved(tmp_path).items():
        target = tmp_path / "converted.net.xml"
        run = [netconvert, "--opendrive-files", file, "-o", str(target)]
        done = subprocess.run(run, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        if network.left_hand:
            continue  # it takes no notice of the rule of roads: traffic on the right
        root = ET.parse(target).getroot()
        # its edges begin where a lane does: "-3#1" is part of road 3
        theirs = {
            (re.split("[.#]", each.attrib["from"])[0], re.split("[.#]", each.attrib["to"])[0])
            for each in root.iter("connection")
            if not each.attrib["from"].startswith(":") and each.attrib["dir"] != "t"
        }
        theirs = {(before, after) for before, after in theirs if before != after}
        # SUMO puts a minus before the id of a road for its edge along the road
        ours = {
            (
                f"{'-' if c.incoming.contact == 'end' else ''}{c.incoming.road}",
                f"{'-' if c.outgoing.contact == 'start' else ''}{c.outgoing.road}",
            )
            for junction in network.junctions
            for c in junction.connections
        }
        for each in network.continuations:
            ours |= {(f"-{each.before.road}", f"-{each.after.road}") for lane, _ in each.lanes if lane < 0}
            ours |= {(f"{each.after.road}", f"{each.before.road}") for lane, _ in each.lanes if lane > 0}
        assert theirs == ours
        lit = [j for j in network.junctions if any(arm.control == "lights" for arm in j.arms)]
        assert len(list(root.iter("tlLogic"))) == len(lit)
        assert len(list(root.iter("roundabout"))) == len(network.roundabouts)


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    return networks_referee()


KINDS = {"t_junction": "T", "y_junction": "Y", "crossroads": "X", "star": "star", "roundabout": "roundabout"}


@pytest.mark.parametrize("seed", range(10))
def test_the_referee_measures_what_was_designed(tmp_path: Path, referee: ModuleType, seed: int) -> None:
    data, route = drawn(seed)
    save(route, tmp_path, ["opendrive"], World(), "network")
    legs = json.loads((tmp_path / "network.route.json").read_text())["route"]
    found = referee.measure(str(tmp_path / "network.xodr"), legs)
    assert (found["breaks"], found["faults"]) == ([], [])
    designed = [data[f"junction{n}"] for n in range(1, 5) if f"junction{n}" in data]
    last = 0
    for junction, measured in zip(designed, found["junctions"], strict=True):
        angle = sorted(arm["angle"] for arm in junction["arms"])[junction["take"] - 1]
        control = junction["control"]
        assert KINDS[junction["kind"]] in measured["kinds"]
        if junction["kind"] == "roundabout":
            assert measured["exit"] == junction["take"]
            assert measured["right_way"]
            assert measured["radius"] == pytest.approx(junction["radius"], abs=0.01)
            control = "yield" if control in ("none", "priority") else control
        else:
            assert measured["take"] == ("left" if angle > 25 else "right" if angle < -25 else "straight")
        assert measured["deg"] == pytest.approx(angle, abs=0.1)
        assert measured["control"] == control
        segments = range(last + 1, junction["after"] + 1)
        assert measured["after"] == pytest.approx(sum(data[f"road_segment{n}"]["distance"] for n in segments))
        last = junction["after"]


RAMPS = {"merge", "diverge"}
WIDE_IN_TAPER = 11.75  # m, of a taper of 60 m, in which a lane is wider than 0.9 of its width


@pytest.mark.parametrize("seed", range(12))
def test_the_referee_measures_the_lanes_and_ramps_that_were_designed(
    tmp_path: Path, referee: ModuleType, seed: int
) -> None:
    data, route = drawn(seed, random_lanes_design)
    save(route, tmp_path, ["opendrive"], World(), "network")
    legs = json.loads((tmp_path / "network.route.json").read_text())["route"]
    found = referee.measure(str(tmp_path / "network.xodr"), legs)
    assert (found["breaks"], found["faults"]) == ([], [])
    places = [data[f"junction{n}"] for n in range(1, 5) if f"junction{n}" in data]
    junctions = [(n, place) for n, place in enumerate(places) if not place["kind"].startswith("lane_")]
    assert len(found["junctions"]) == len(junctions)
    for (n, place), measured in zip(junctions, found["junctions"], strict=True):
        if place["kind"] not in RAMPS:
            angle = sorted(arm["angle"] for arm in place["arms"])[place["take"] - 1]
            assert measured["deg"] == pytest.approx(angle, abs=0.1)
            continue
        assert measured["kinds"] == [place["kind"]]
        beside = {each["kind"] for each in (*places[max(n - 1, 0) : n], *places[n + 1 : n + 2])}
        if beside & {"lane_drop", "lane_gain"}:
            continue  # it may take a lane that ends or begins there for that of the ramp
        takes = {"ramp": "exit" if place["kind"] == "diverge" else "ramp", "main": "main"}
        assert measured["take"] == takes[place["take"]]
        length = measured["accel" if place["kind"] == "merge" else "decel"]
        assert length == pytest.approx(place.get("length", 130.0) + WIDE_IN_TAPER, abs=1.5)
        assert measured["side"] == place.get("side", "right")
    events = [event["kind"] for stretch in found["stretches"] for event in stretch["events"]]
    for kind in ("lane_drop", "lane_gain"):
        assert events.count(kind) >= sum(place["kind"] == kind for place in places)
