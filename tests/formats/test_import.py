"""``roadgpt import``: the command that it prints works when it is typed."""

import json
import math
import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from command_line import invoke
from network.ruled import findings
from roadgpt.cli.roads import on_a_map
from roadgpt.network import read_opendrive, read_road, read_source
from roadgpt.road import World
from rows import rows

LANES = """<lanes><laneSection s="0"><left>
<lane id="1" type="driving"><width sOffset="0" a="{width}"/></lane></left><right>
<lane id="-1" type="driving"><width sOffset="0" a="{width}"/></lane></right></laneSection></lanes>"""


def file(folder: Path, line: str, rest: str = "", width: float = 3.5) -> Path:
    path = folder / "town.xodr"
    lanes = LANES.format(width=width)
    path.write_text(f'<OpenDRIVE><road id="5"><planView>{line}</planView>{rest}{lanes}</road></OpenDRIVE>')
    return path


def element(x: float, y: float, heading: float, length: float, shape: str = "<line/>", s: float = 0) -> str:
    return f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">{shape}</geometry>'


def typed(path: Path) -> tuple[dict[str, object], str]:
    """The row of the command that ``import`` prints, and what ``import`` told on the way."""
    result = invoke("import", str(path), "--out", str(path.with_suffix(".json")))
    assert result.exit_code == 0, result.output
    command = shlex.split(re.findall(r"drive it: roadgpt (drive .*)$", result.stdout, re.M)[0])
    return json.loads(invoke(*command, "--json").stdout.splitlines()[-1]), result.stderr


@pytest.mark.parametrize("y", [0.0, 2.0, 3.4, 4.2, 247.0, 250.0, -0.01])
def test_a_road_whose_lane_would_leave_the_map_is_moved(tmp_path: Path, y: float) -> None:
    """Its centre line is on the map, the edge of a lane is not, or not by as much as the rule wants."""
    row, told = typed(file(tmp_path, element(20, y, 0, 100)))
    assert row["findings"] == []
    assert row["test_outcome"] == "PASS"
    assert "into the middle of the map" in told


@given(
    st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-3.2, 3.2), st.floats(25, 3_000),
    st.floats(2, 10), st.floats(-0.01, 0.01),
)  # fmt: skip
@settings(max_examples=20, deadline=None)
def test_placing_and_the_rule_have_one_measure(
    tmp_path_factory: pytest.TempPathFactory,
    x: float,
    y: float,
    heading: float,
    length: float,
    width: float,
    bend: float,
) -> None:
    folder = tmp_path_factory.mktemp("place")
    arc = f'<arc curvature="{bend!r}"/>'
    found = read_opendrive(file(folder, element(x, y, heading, length, arc), width=width))
    road, size, movement, _ = on_a_map(found.road, World().changed(**found.world_values), keep_place=False)
    world = World().changed(**found.world_values).changed(map_size=size)
    s = np.linspace(0, road.length, 50)
    assert road.at(s) - movement == pytest.approx(found.road.at(s), abs=1e-9)
    assert findings("inside_map", road, world) == ()
    t = np.array([-world.section.lane_width, world.section.lane_width])[:, None]
    edges = road.at(np.linspace(0, road.length, 5_000), t)[..., :2]
    assert edges.min() > 0
    assert edges.max() < world.site.map_size


def test_a_map_far_away_and_deep_down_is_brought_here(tmp_path: Path) -> None:
    heights = '<elevationProfile><elevation s="0" a="-412.5" b="0.02" c="0" d="0"/></elevationProfile>'
    row, told = typed(file(tmp_path, element(691_000.25, 5_335_900.5, 1.1, 120), heights))
    assert (row["test_outcome"], row["findings"]) == ("PASS", [])
    assert "it is lifted by 413 m: its lowest place was below the ground of the map" in told


def test_a_road_too_large_for_any_map_is_driven_where_it_is(tmp_path: Path) -> None:
    result = invoke(
        "import", str(file(tmp_path, element(0, 0, 0, 45_000))), "--out", str(tmp_path / "a.json")
    )
    assert "45040 m wide, too large for a map; its place is kept" in result.stderr


LOOP = element(0, 0, 0, 2.2 * math.pi * 40, '<arc curvature="0.025"/>')
HOOK = element(0, 0, 0, 60) + element(60, 0, 0, math.pi * 6, f'<arc curvature="{1 / 6!r}"/>', 60.0)


@pytest.mark.parametrize(
    ("line", "finding"),
    [(LOOP, "overlaps itself at s ="), (HOOK, "tighter than"), (element(0, 0, 0, 12), "longer than 20 m")],
    ids=["loop", "hook", "short"],
)
def test_what_the_rules_say_stands_beside_the_verdict(tmp_path: Path, line: str, finding: str) -> None:
    row, _ = typed(file(tmp_path, line))
    assert row["test_outcome"] in ("PASS", "FAIL")
    assert any(finding in sentence for sentence in row["findings"])  # type: ignore[attr-defined]
    assert row["validation_message"] == row["findings"][0]  # type: ignore[index]


LONG = element(-100, 3, 0.4, 400)
ICE = '<material sOffset="0" friction="0.3"/><speed sOffset="0" max="40" unit="km/h"/>'


def long_road(folder: Path) -> Path:
    """The road file of an imported road of 400 m that names its lanes, friction and speed limit."""
    path = file(folder, LONG)
    path.write_text(
        path.read_text().replace(
            '<width sOffset="0" a="3.5"/></lane></right>', f'<width sOffset="0" a="3.5"/>{ICE}</lane></right>'
        )
    )
    out = folder / "long.json"
    assert invoke("import", str(path), "--out", str(out)).exit_code == 0
    return out


def test_check_and_drive_know_the_world_of_an_imported_road(tmp_path: Path) -> None:
    out = long_road(tmp_path)
    stored = json.loads(out.read_text())["world"]
    assert stored == {
        "map_size": 450, "lane_width": 3.5, "shoulder": 0.0, "friction": 0.3,
        "speed_limit": pytest.approx(40 / 3.6),
    }  # fmt: skip
    assert invoke("check", str(out)).exit_code == 0
    row = json.loads(invoke("drive", str(out), "--json").stdout.splitlines()[-1])
    assert (row["findings"], row["test_outcome"]) == ([], "PASS")


def of(runs: Any) -> float:
    """The size of the map of a run, or of the first of several."""
    return float((runs[0] if isinstance(runs, list) else runs).world.site.map_size)


def test_an_option_goes_before_the_file_and_is_said(tmp_path: Path) -> None:
    out = long_road(tmp_path)
    result = invoke("check", str(out), "--map-size", "300")
    assert result.exit_code == 1
    assert "--map-size goes before the 450 of the file" in result.stdout
    assert "the map runs from 0 to 300 m" in result.stdout
    driven = invoke("drive", str(out), "--speed-limit", "30", "--json")
    assert "--speed-limit goes before the 40 of the file" in driven.stderr


def test_the_file_goes_before_the_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = long_road(tmp_path)
    monkeypatch.setenv("ROADGPT_MAP_SIZE", "200")
    result = invoke("check", str(out))
    assert result.exit_code == 0
    assert "the 450 of the file goes before --map-size of the configuration" in result.stdout


@pytest.mark.parametrize(
    ("world", "sentence"),
    [
        ({"map_size": 1}, "its world cannot be read: site.map_size: is out of range; give 50 or more"),
        ({"oracle": 3}, "its world is not an object with map_size, lane_width"),
        ([250], "its world is not an object with map_size, lane_width"),
        ({"friction": float("nan")}, "its world cannot be read: site.friction"),
    ],
)
def test_a_world_that_is_none_is_refused(tmp_path: Path, world: object, sentence: str) -> None:
    out = long_road(tmp_path)
    out.write_text(json.dumps(json.loads(out.read_text()) | {"world": world}))
    result = invoke("check", str(out))
    assert result.exit_code == 2
    assert sentence in result.stderr


@given(
    st.floats(-1e7, 1e7),
    st.floats(-1e7, 1e7),
    st.floats(-9_000, 9_000),
    st.floats(0, 6.2),
    st.floats(20, 500),
)
@settings(max_examples=25, deadline=None)
def test_the_coordinates_of_the_file_are_those_here_plus_the_origin(
    tmp_path_factory: pytest.TempPathFactory, x: float, y: float, z: float, heading: float, length: float
) -> None:
    folder = tmp_path_factory.mktemp("origin")
    heights = f'<elevationProfile><elevation s="0" a="{z!r}"/></elevationProfile>'
    path = file(folder, element(x, y, heading, length), heights)
    told = invoke("import", str(path), "--out", str(folder / "here.json")).stderr
    here = json.loads((folder / "here.json").read_text())
    origin = here.get("origin", [0, 0, 0])
    back = [here["start"][0] + origin[0], here["start"][1] + origin[1], here["height"] + origin[2]]
    assert back == pytest.approx([x, y, z], abs=1e-9, rel=0)
    if origin[0] or origin[1]:
        assert f"add ({origin[0]:.0f}, {origin[1]:.0f}) m for its place in the file" in told


@pytest.mark.parametrize(("x", "size"), [(300, 450.0), (20, 250.0), (-20, 250.0)])
def test_a_road_that_keeps_its_place_gets_a_map_that_has_it(tmp_path: Path, x: float, size: float) -> None:
    path = file(tmp_path, element(x, 60, 0, 120))
    told = invoke("import", str(path), "--keep-place", "--out", str(tmp_path / "kept.json")).stderr
    assert json.loads((tmp_path / "kept.json").read_text())["world"]["map_size"] == size
    assert ("its place is off the map" in told) == (x < 0)
    assert (invoke("check", str(tmp_path / "kept.json")).exit_code == 0) == (x > 0)


POINTS = [[20 + 5 * n, 60 + 20 * math.sin(n / 6)] for n in range(30)]
NAMED = [{"x": x, "y": y} for x, y in POINTS]
TESTS = {
    "competition": {"_id": {"$oid": "64f1"}, "road_points": NAMED,
                    "meta_data": {"test_info": {"test_outcome": "FAIL"}}},
    "sbft": {"id": "64f1", "road_points": POINTS, "interpolated_points": [[x, y, 0.0] for x, y in POINTS]},
    "dense": {"id": "64f1", "interpolated_points": NAMED},
    "scissor": {"test_id": "64f1", "interpolated_road_points": [[x, y, -28.0, 8.0] for x, y in POINTS]},
    "asfault": {"name": "64f1", "m1": {"nodes": [[x, y, -28.0, 8.0] for x, y in POINTS]}},
}  # fmt: skip


@pytest.mark.parametrize("kind", TESTS)
@pytest.mark.parametrize("form", ["one", "list of one", "list", "lines"])
def test_tests_of_others_are_imported_one_by_one(kind: str, form: str) -> None:
    test, other = TESTS[kind], {"road_points": [[y, x] for x, y in POINTS]}
    content = {
        "one": json.dumps(test),
        "list of one": json.dumps([test]),
        "list": json.dumps([test, other]),
        "lines": f"{json.dumps(test)}\n\n{json.dumps(other)}\n",
    }[form]
    path = Path("tests.jsonl" if form == "lines" else "tests.json")
    path.write_text(content)
    result = invoke("import", str(path))
    assert result.exit_code == 0, result.output
    written = re.findall(r"written to (\S+);", result.stdout)[0]
    first = Path(written, "64f1.json") if form in ("list", "lines") else Path(written)
    road = read_road(first)
    assert road.locate(*np.transpose(POINTS))[1] == pytest.approx(0, abs=0.02)
    assert len([*Path(written).glob("*.json")]) == (2 if first != Path(written) else 0)
    assert ("the width of its points is not used" in result.stderr) == (kind in ("scissor", "asfault"))
    if form in ("list", "lines"):
        assert invoke("import", str(path), "--road", "64f1", "--out", "one.json").exit_code == 0
        assert read_road("one.json").to_json() == road.to_json()
        assert "roadgpt import" in invoke("check", str(path)).stderr


def test_a_bad_test_of_a_list_costs_only_itself() -> None:
    Path("tests.json").write_text(
        json.dumps([{"road_points": NAMED}, {"road_points": [[1, 1]]}, {"road_points": POINTS}])
    )
    result = invoke("import", "tests.json")
    assert result.exit_code == 2
    assert sorted(path.name for path in Path("tests").iterdir()) == ["1.json", "3.json"]
    assert "tests.json (road 2): " in result.stderr


@pytest.mark.parametrize("file", ["one.json", "lines.jsonl"])
def test_a_road_that_is_not_there_is_no_road(tmp_path: Path, file: str) -> None:
    test = json.dumps(TESTS["competition"])
    (tmp_path / file).write_text(test if file == "one.json" else f"{test}\n{test}\n")
    result = invoke("import", str(tmp_path / file), "--road", "64f2")
    assert (result.exit_code, "there is no road 64f2 in it" in result.stderr) == (2, True)


def test_names_of_tests_make_no_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    names = ["../../up", "..", "/etc/x", "a b"]
    Path("t.json").write_text(json.dumps([{"name": name, "road_points": NAMED} for name in names]))
    assert invoke("import", "t.json").exit_code == 0
    assert sorted(path.name for path in tmp_path.rglob("*.json")) == [
        "_.._up.json", "_etc_x.json", "a_b.json", "road.json", "t.json",
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["far.csv", "far.xodr"])
def test_files_that_know_no_map_get_one_that_holds_them(tmp_path: Path, name: str) -> None:
    path = file(tmp_path, element(300, 60, 0, 120)).rename(tmp_path / name)
    if name == "far.csv":
        path.write_text("x,y\n" + "\n".join(f"{300 + 4 * n},60" for n in range(31)))
    result = invoke("check", str(path))
    assert result.exit_code == 0, result.output
    assert "its map is 450 m wide" in result.stdout
    assert invoke("check", str(path), "--map-size", "250").exit_code == 1


def test_the_test_of_a_road_on_a_larger_map_states_its_size() -> None:
    for words, size in (("straight len=100", None), ("straight len=700", 1000)):
        run = invoke(
            "run", "--plan", words, "--no-drive", "--no-plot", "--map-size", str(size or 250), "--out", words
        )
        assert run.exit_code == 0, run.output
        test = json.loads(Path(words, "test.0001.json").read_text())
        assert test.get("world") == (size and {"map_size": size})
        assert invoke("check", f"{words}/test.0001.json").exit_code == 0


@pytest.mark.parametrize(("name", "content", "sentence"), rows(__file__, "no_roads_of_others"))
def test_what_is_no_road_of_others_is_named(tmp_path: Path, name: str, content: str, sentence: str) -> None:
    path = tmp_path / name
    path.write_text(content)
    result = invoke("import", str(path))
    assert result.exit_code == 2
    assert sentence in result.stderr


def test_the_road_of_a_run_keeps_the_map_of_the_run(tmp_path: Path) -> None:
    run = tmp_path / "runs"
    words = ("run", "a straight road of 500 metres", "--friction", "0.5", "--no-drive", "--no-plot")
    assert invoke(*words, "--out", run).exit_code == 0
    assert invoke("check", str(run / "runs/0001")).exit_code == 0
    assert invoke("check", str(run / "runs/0001/design.json")).exit_code == 0
    assert read_source(run / "runs/0001").world["friction"] == 0.5
    (run / "runs/0001/run.json").write_text("{}")
    damaged = invoke("check", str(run / "runs/0001/road.json"))
    assert (damaged.exit_code, "Traceback" in damaged.output) == (2, False)
