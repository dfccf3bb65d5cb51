"""``roadgpt import`` of whole maps: what is written is viewed, checked, driven and searched on."""

import json
import re
import shutil
from pathlib import Path

import pytest

from command_line import invoke
from roadgpt.export import exporter_of
from roadgpt.network import Route, build_route, read_road
from roadgpt.road import World, read_design

CROSSING = {
    "starting_point": [400_000, 0, 0],
    "theta": 0,
    "road_segment1": {"distance": 90, "direction": "straight", "incline": 0, "turn_degrees": 0},
    "junction1": {"after": 1, "kind": "crossroads", "take": "left", "control": "stop"},
    "road_segment2": {"distance": 80, "direction": "straight", "incline": 0, "turn_degrees": 0},
}


ROUTE = build_route(read_design(CROSSING)[0], World())


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A crossing 400 km away, as another tool would have written it."""
    path = tmp_path_factory.mktemp("maps") / "town.xodr"
    exporter_of("opendrive").save(ROUTE, path, World())
    path.write_text(path.read_text().replace('vendor="RoadGPT"', 'vendor="other"'))
    return path


def test_a_map_is_read_whole_and_viewed_checked_and_exported(town: Path, tmp_path: Path) -> None:
    out = tmp_path / "map.json"
    result = invoke("import", str(town), "--out", str(out))
    assert result.exit_code == 0, result.output
    assert "crossroads" in result.stdout
    assert f"view it: roadgpt view {out}" in result.stdout
    assert "it is moved by (" in result.stderr
    assert "<geoReference> of the map" in result.stderr
    found = read_road(out)
    assert isinstance(found, Route)
    assert (len(found.network.roads_outside), found.legs) == (4, ())
    assert json.loads(out.read_text())["world"]["speed_limit"] == pytest.approx(70 / 3.6)
    again = tmp_path / "again"
    assert invoke("export", str(out), "--to", "opendrive", "--out", str(again)).exit_code == 0
    assert next(again.glob("*.xodr")).read_text().count("<road ") == len(found.network.roads)
    told = invoke("drive", str(out))
    assert told.exit_code == 2
    assert "a map without a route cannot be driven" in told.stderr


def test_a_road_with_lanes_on_its_left_only_goes_through_every_command(town: Path, tmp_path: Path) -> None:
    """As tools write one-way roads: nothing leads along the reference line."""
    text = town.read_text()
    begin = text.index('<road name="road 2"')
    own = text[begin : text.index("</road>", begin)]
    bare = own[: own.index("<right>")] + own[own.index("</right>") + len("</right>") :]
    path = tmp_path / "one-way.xodr"
    path.write_text(text.replace(own, bare))
    out = tmp_path / "map.json"
    assert invoke("import", str(path), "--random-routes", "1", "--out", str(out)).exit_code == 0
    found = read_road(out)
    assert isinstance(found, Route)
    assert found.network.road(2).profile.along_ids == ()
    assert invoke("check", str(out)).exit_code in (0, 1)
    drives = tmp_path / "drives"
    assert invoke("drive", str(out), "--out", str(drives)).exit_code in (0, 1)
    page, pictures = tmp_path / "page.html", tmp_path / "pictures"
    assert invoke("view", str(drives / "runs" / "0001"), "--out", str(page)).exit_code == 0
    assert invoke("view", str(out), "--format", "png", "--out", str(pictures)).exit_code == 0
    assert page.stat().st_size > 100_000
    assert list(pictures.rglob("*.png"))


def test_random_routes_are_written_and_driven(town: Path, tmp_path: Path) -> None:
    routes = tmp_path / "routes"
    result = invoke("import", str(town), "--random-routes", "3", "--seed", "5", "--out", str(routes))
    assert result.exit_code == 0, result.output
    remarks = [line for line in result.output.splitlines() if line.startswith("roadgpt:")]
    assert len(remarks) == len(set(remarks)) > 0
    files = sorted(routes.iterdir())
    assert [file.name for file in files] == ["route-1.json", "route-2.json", "route-3.json"]
    again = tmp_path / "again"
    invoke("import", str(town), "--random-routes", "3", "--seed", "5", "--out", str(again))
    assert [file.read_bytes() for file in sorted(again.iterdir())] == [file.read_bytes() for file in files]
    driven = invoke("drive", str(routes), "--json")
    rows = [json.loads(line) for line in driven.stdout.splitlines()]
    assert [row["test_outcome"] for row in rows] == ["PASS"] * 3
    assert result.stdout.count("over roads") == 3
    assert "199 m through 1 crossroads, over roads" in result.stdout


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--route", "1,99"), "there is no road 99 on the map; there are: 1, 2"),
        (("--route", ""), "--route needs the ids of roads, with commas between them"),
        (("--route", "1,,4"), "--route needs the ids of roads, with commas between them"),
        (("--route", "1", "--random-routes", "2"), "ask for different routes; give one of them"),
        (("--from", "3,4"), "a route needs both ends; give --from X,Y and --to X,Y"),
        (("--from", "3,x", "--to", "3,4"), "'3,x' is no point; give x and y in metres"),
        (("--from", "3,nan", "--to", "3,4"), "'3,nan' is not finite"),
        (("--from", "3,4", "--to", "3,5"), "there is no road within 10 m of (3, 4)"),
        (("--road", "1", "--route", "1"), "--route is for a map"),
    ],
)
def test_what_cannot_be_a_route_is_said(town: Path, options: tuple[str, ...], said: str) -> None:
    result = invoke("import", str(town), *options)
    assert result.exit_code == 2
    assert said in result.stderr


def test_a_named_route_and_one_between_points_are_the_same(town: Path, tmp_path: Path) -> None:
    named, between = tmp_path / "named.json", tmp_path / "between.json"
    assert invoke("import", str(town), "--route", "1,4", "--out", str(named)).exit_code == 0
    x, y, _ = ROUTE.at(ROUTE.length - 10.0).tolist()
    ends = ("--from", "400010,-2", "--to", f"{x:.3f},{y:.3f}")
    assert invoke("import", str(town), *ends, "--out", str(between)).exit_code == 0
    assert named.read_bytes() == between.read_bytes()
    route = read_road(named)
    assert isinstance(route, Route)
    assert route.legs == ROUTE.legs


@pytest.mark.parametrize("kept", [0, 2], ids=["nowhere", "on two lanes"])
def test_a_speed_limit_that_the_file_lacks_is_not_written_as_its_own(
    town: Path, tmp_path: Path, kept: int
) -> None:
    """The file has no speed limit, or on two lanes only; an option gives all lanes one."""
    path, out = tmp_path / "bare.xodr", tmp_path / "out"
    text = re.sub(r"\s*<speed max[^>]*/>", "", town.read_text())
    parts = re.split(r"(?=<speed sOffset)", text)
    path.write_text(
        "".join([*parts[: 1 + kept], *(re.sub(r"^<speed[^>]*/>", "", part) for part in parts[1 + kept :])])
    )
    files = [str(path)]
    for name, route in (("map", ()), ("route", ("--random-routes", "1"))):
        files.append(str(tmp_path / f"{name}.json"))
        told = invoke("import", str(path), *route, "--out", files[-1])
        assert ("it states no speed limit; it is driven at 70 km/h at most" in told.stderr) == (not kept)
    for file in files[bool(kept) :]:
        done = invoke("export", file, "--to", "opendrive,lanelet2,commonroad,geojson", "--out", str(out))
        assert done.exit_code == 0, done.stderr
        name = Path(file).stem
        assert (out / f"{name}.xodr").read_text().count("<speed ") == kept
        for other in (".osm", ".cr.xml", ".geojson"):
            written = (out / f"{name}{other}").read_text()
            assert not re.search("speed_limit|>274<|speed_kmh", written)
        invoke("export", file, "--to", "opendrive", "--speed-limit", "30", "--out", str(out))
        lanes = (out / f"{name}.xodr").read_text().count('type="driving"')
        assert (out / f"{name}.xodr").read_text().count("<speed sOffset") == lanes
    if not kept:
        return
    camp = tmp_path / "camp"
    for more, count in (((), kept), (("--speed-limit", "30"), lanes)):
        shutil.rmtree(camp, ignore_errors=True)
        on = ("campaign", "--on", files[-1], "--no-drive", "--out", str(camp), *more)
        assert invoke(*on).exit_code == 0
        assert invoke("export", f"{camp}/c01/1", "--to", "opendrive", "--out", str(camp)).exit_code == 0
        assert next(camp.glob("*.xodr")).read_text().count("<speed sOffset") == count
    whole = town.read_text().count("<speed sOffset")
    invoke("export", str(town), "--to", "opendrive", "--out", str(out))
    assert (out / "town.xodr").read_text().count("<speed sOffset") == whole > 0
