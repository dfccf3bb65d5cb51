"""Commands on a map without a route, and the name of the file in what is wrong with a network."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from command_line import invoke
from rows import rows

MAP: dict[str, Any] = {
    "node1": {"at": [20, 80, 0], "kind": "end"},
    "node2": {"at": [80, 80, 0], "kind": "t_junction"},
    "node3": {"at": [80, 150, 1], "kind": "end"},
    "node4": {"at": [150, 80, 0], "kind": "end"},
    "roads": [[1, 2], [2, 3], [2, 4]],
}
ROUTED = {**MAP, "route": [1, 2, 3]}
NO_ROUTE = "this map has no route; give it one"


@pytest.fixture(autouse=True)
def in_a_folder_with_maps() -> None:
    maps = {"map.json": MAP, "empty.json": {**MAP, "route": []}, "routed.json": ROUTED}
    for name, data in maps.items():
        Path(name).write_text(json.dumps(data))


@pytest.mark.parametrize("name", ["map", "empty"])
def test_opendrive_of_a_map_without_a_route_has_an_empty_route(name: str) -> None:
    assert invoke("export", f"{name}.json", "--to", "opendrive,opendrive17", "--out", "out").exit_code == 0
    assert json.loads(Path(f"out/{name}.route.json").read_text()) == {"route": []}
    assert json.loads(Path(f"out/{name}.1.7.route.json").read_text()) == {"route": []}
    assert invoke("export", "routed.json", "--to", "opendrive", "--out", "out").exit_code == 0
    assert Path(f"out/{name}.xodr").read_bytes() == Path("out/routed.xodr").read_bytes()


@pytest.mark.parametrize("format_", ["csv", "openscenario"])
def test_formats_that_hold_a_way_need_a_route(format_: str) -> None:
    done = invoke("export", "map.json", "--to", format_, "--out", "out")
    assert done.exit_code == 1
    assert f"map.json: {format_} holds a way to drive, and {NO_ROUTE}" in done.stderr
    assert not list(Path().glob("out/*"))


def test_commonroad_has_no_task_without_a_route() -> None:
    """All else is the same, but for the place of the speed limit, which is where the route begins."""
    assert invoke("export", "map.json", "--to", "commonroad", "--out", "out").exit_code == 0
    assert invoke("export", "routed.json", "--to", "commonroad", "--out", "out").exit_code == 0
    alone, routed = (Path(f"out/{name}.cr.xml").read_text() for name in ("map", "routed"))
    assert "planningProblem" not in alone
    assert alone.count("<lanelet id=") == routed.count("<lanelet id=") > 0
    reader = pytest.importorskip("commonroad.common.file_reader")
    scenario, problems = reader.CommonRoadFileReader("out/map.cr.xml").open()
    assert len(scenario.lanelet_network.lanelets) == alone.count("<lanelet id=")
    assert problems.planning_problem_dict == {}


def test_formats_without_a_way_take_a_map() -> None:
    assert invoke("export", "map.json", "--to", "geojson,lanelet2", "--out", "out").exit_code == 0
    assert invoke("export", "routed.json", "--to", "geojson,lanelet2", "--out", "out").exit_code == 0
    features = {
        name: [
            each["properties"]["name"]
            for each in json.loads(Path(f"out/{name}.geojson").read_text())["features"]
        ]
        for name in ("map", "routed")
    }
    assert features["routed"] == ["centre line", *features["map"]]
    assert Path("out/map.osm").read_bytes() == Path("out/routed.osm").read_bytes()


def test_check_says_that_there_is_no_route() -> None:
    done = invoke("check", "map.json")
    assert done.exit_code == 0
    assert "map.json: the map has no route, so only its roads and junctions are checked" in done.output
    (row,) = [json.loads(line) for line in invoke("check", "--json", "map.json").stdout.splitlines()]
    assert row["is_valid"]
    assert row["length_m"] is None


@pytest.mark.parametrize(("command", "done_with_it"), rows(__file__, "what_needs_a_route"))
def test_what_needs_a_route_is_refused_in_one_sentence(command: list[str], done_with_it: str) -> None:
    done = invoke(*command)
    assert done.exit_code == 2
    (line,) = done.output.splitlines()
    wanted = rf"map\.json: a map without a route cannot be {done_with_it}; give its design one, .*, or take"
    assert re.search(wanted, line)


TOO_NARROW = {**MAP, "node2": {**MAP["node2"], "kerb": 90}}


@pytest.mark.parametrize(
    "command", rows(__file__, "commands_for_a_bad_file"), ids=lambda command: " ".join(command)
)
@pytest.mark.parametrize(
    ("data", "wanted"),
    [
        (TOO_NARROW, "nodes 2 and 3 are|nodes 1 and 2 are"),  # found when the roads are built
        ({**MAP, "roads": []}, "roads are a list"),  # found when the file is read
    ],
    ids=["built", "read"],
)
def test_what_is_wrong_names_the_file_once(command: list[str], data: Any, wanted: str) -> None:
    Path("bad.json").write_text(json.dumps(data))
    done = invoke(*command)
    assert done.exit_code == 2
    assert re.search(rf"bad\.json: ({wanted})", done.output)
    assert done.output.count("bad.json") == 1
