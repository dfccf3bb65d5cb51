"""``roadgpt campaign --on FOLDER``: roads that are there are tested, with what was kept of them."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from command_line import invoke
from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.lifecycle import work
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.status import status_of
from roadgpt.export import exporter_of
from roadgpt.network import build_route, read_source
from roadgpt.road import World, read_design
from roadgpt.run import Setup, prove

pytestmark = pytest.mark.usefixtures("no_workers")

CROSSING = {
    "starting_point": [125, 20, 0],
    "theta": 90,
    "road_segment1": {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0},
    "junction1": {"after": 1, "kind": "crossroads", "take": "left", "control": "stop"},
    "road_segment2": {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0},
}
STRAIGHT = {
    "starting_point": [40, 125, 0],
    "theta": 0,
    "road_segment1": {"distance": 90, "direction": "straight", "incline": 0, "turn_degrees": 0},
}
DRIVERS = ("lane_centring", "pure_pursuit")


@pytest.fixture(scope="module")
def town(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A crossing, as another tool would have written it, with roads of 30 km/h."""
    path = tmp_path_factory.mktemp("maps") / "town.xodr"
    route = build_route(read_design(CROSSING)[0], World())
    exporter_of("opendrive").save(route, path, World().changed(speed_limit=30 / 3.6))
    path.write_text(path.read_text().replace('vendor="RoadGPT"', 'vendor="other"'))
    return path


@pytest.fixture(scope="module")
def routes(town: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("routes") / "routes"
    done = invoke("import", str(town), "--random-routes", "3", "--seed", "1", "--out", str(folder))
    assert done.exit_code == 0, done.output
    return folder


def table(folder: Path) -> list[dict[str, str]]:
    with (folder / "results.csv").open() as file:
        return [*csv.DictReader(file)]


def campaign(on: object, out: Path, *words: object) -> str:
    done = invoke("campaign", "--on", str(on), "--out", str(out), *map(str, words))
    assert done.exit_code == 0, done.output
    return str(done.output)


def test_a_campaign_on_an_imported_map_is_resumed_without_its_source(
    routes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever happens to the source, the tables are those of a campaign that nobody interrupted, and each
    result is what driving the file of the source says."""
    source, whole, broken = tmp_path / "source", tmp_path / "whole", tmp_path / "broken"
    shutil.copytree(routes, source)
    words = ("--drivers", ",".join(DRIVERS), "--seed", 5)
    said = campaign(source, whole, *words)
    assert f"3 roads of {source}, kept in {whole / 'roads'}" in said
    rows = table(whole)
    assert [row["origin"] for row in rows] == ["route-1.json", "route-2.json", "route-3.json"] * 2
    assert len({row["seed"] for row in rows}) == 3
    for row in rows[::2]:  # both drivers, and every road once
        found, driver = read_source(routes / row["origin"]), DRIVERS[row["cell"] == "c02"]
        world = World().changed(**found.world)
        run = prove(found.blueprint, int(row["seed"]), world, Setup(driver=driver), despite_findings=True)
        assert run.verdict is not None
        assert (row["outcome"], float(row["margin_m"])) == (run.outcome, run.verdict.margin)
        assert run.findings == () or f"despite {len(run.findings)} finding" in row["description"]
        kept = kept_run(whole, row["cell"], int(row["test"]))
        assert kept.road is not None
        assert run.road is not None
        assert kept.road.to_json() == run.road.to_json()
        assert (kept.world.values(), kept.findings) == (world.values(), run.findings)
        assert kept.world.limits.speed_limit == pytest.approx(30 / 3.6)

    monkeypatch.setattr(Store, "group_seconds", 0.0)
    monkeypatch.setattr("roadgpt.cli.summary.watch", lambda *_: None)  # it would work to the end
    campaign(source, broken, *words)
    monkeypatch.undo()
    monkeypatch.setattr(Store, "group_seconds", 0.0)
    steps = work(broken)
    next(progress for progress in steps if progress.total())
    steps.close()  # type: ignore[attr-defined]
    assert 0 < status_of(broken).done < 6
    (source / "route-1.json").write_text((routes / "route-2.json").read_text())
    (source / "route-3.json").unlink()
    told = invoke("resume", str(broken))
    assert told.exit_code == 0, told.output
    assert "route-1.json has changed since the campaign began" in told.stderr
    assert "route-3.json is gone since the campaign began" in told.stderr
    assert "route-2.json" not in told.stderr
    for name in ("results.csv", "cells.csv"):
        assert (broken / name).read_bytes() == (whole / name).read_bytes()
    told = invoke("campaign", "--on", str(source), "--out", str(whole), *map(str, words))
    assert told.exit_code == 2
    assert (
        "(different number of tests or seconds, route-1.json has changed, route-3.json is gone)"
        in told.stderr
    )

    kept = whole / "roads" / "0002.json"
    kept.write_text(kept.read_text() + "\n")
    told = invoke("view", str(whole / "c01/2"), "--format", "png", "--out", str(tmp_path / "plots"))
    assert told.exit_code == 2
    assert f"{kept}, which keeps route-2.json, cannot be used: its content has changed" in told.stderr


def test_what_cannot_be_read_is_named_and_counted_and_the_rest_is_tested(
    town: Path, routes: Path, tmp_path: Path
) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    source.mkdir()
    shutil.copy(town, source)
    for number in (1, 2, 10):
        (source / f"road-{number}.json").write_text(json.dumps(STRAIGHT | {"theta": number}))
    (source / "broken.json").write_text("{")
    (source / "notes.txt").write_text("no road")
    told = campaign(source, out, "-n", 5, "--friction", 0.5)
    assert "left out, as without a road: notes.txt" in told
    assert f"{source / 'broken.json'} is not valid JSON" in told
    assert f"roadgpt import {source / 'town.xodr'} --random-routes 20" in told
    assert "3 roads" in told
    assert "2 files left out" in told
    assert "5 tests, so roads are driven again with other seeds" in told
    rows = table(out)
    names = [f"road-{number}.json" for number in (1, 2, 10, 1, 2)]
    assert [row["origin"] for row in rows] == names
    assert len({row["seed"] for row in rows}) == 5
    for number in (1, 3, 5):
        run = kept_run(out, "c01", number)
        assert run.world.site.friction == 0.5
        assert run.plain_design == read_design(STRAIGHT | {"theta": (1, 0, 10, 0, 2)[number - 1]})[0]
    with Record.opened(out) as record:
        assert {*record.plan().left_out} == {"broken.json", "town.xodr"}
    assert invoke("report", str(out)).exit_code == 0
    assert "is not valid JSON" in (out / "report.html").read_text()
    again = tmp_path / "again"
    told = campaign(out, again)  # on the tests of a campaign
    assert "5 roads" in told
    assert [row["length_m"] for row in table(again)] == [row["length_m"] for row in rows]
    assert [row["origin"] for row in table(again)] == [f"c01/{number}" for number in range(1, 6)]
    assert kept_run(again, "c01", 1).world.site.friction == 0.5


def test_a_plan_names_roads_drivers_seeds_and_a_world(routes: Path, tmp_path: Path) -> None:
    shutil.copytree(routes, tmp_path / "routes")
    file, out = tmp_path / "plan.toml", tmp_path / "out"
    file.write_text('on = "routes"\nseeds = [1, 2]\ndrive = false\n[world]\nspeed_limit_kmh = 20\n')
    done = invoke("campaign", str(file), "--out", str(out))
    assert done.exit_code == 0, done.output
    assert "2 cells" in done.output
    assert [(row["cell"], row["origin"]) for row in table(out)] == [
        (cell, f"route-{number}.json") for cell in ("c01", "c02") for number in (1, 2, 3)
    ]
    assert kept_run(out, "c02", 1).world.limits.speed_limit == pytest.approx(20 / 3.6)
    file.write_text('on = "routes"\nprompts = ["a road"]\n')
    done = invoke("campaign", str(file), "--out", str(tmp_path / "no"))
    assert done.exit_code == 2
    assert "'prompts' is for roads that are designed" in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("a road", "--on", "DIR"), "and a description is for roads that are designed"),
        (("--on", "DIR", "--goal", "failures"), "and --goal is for roads that are designed"),
        (("--on", "DIR", "--generator", "random"), "and --generator is for roads that are designed"),
        (("--on", "DIR", "--designer", "thesis"), "and --designer is for roads that are designed"),
        (("--on", "DIR", "--max-cost", "1"), "and --max-cost is for roads that are designed"),
        (("--on", "DIR/nothing"), "cannot read"),
        (("--generator", "given", "a road", "-n", "2"), "say which: --on FOLDER"),
        (("DIR/town.xodr",), "and this tests the road in a file: roadgpt campaign --on DIR/town.xodr"),
        ((), "Missing argument"),
    ],
)
def test_what_makes_no_sense_on_roads_that_are_there_is_refused(
    routes: Path, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    typed = [word.replace("DIR", str(routes)) for word in words]
    done = invoke("campaign", *typed, "--out", str(tmp_path / "out"))
    assert done.exit_code == 2
    assert said.replace("DIR", str(routes)) in done.stderr
    assert not (tmp_path / "out" / "campaign.sqlite").exists()


def test_a_road_file_is_no_description() -> None:
    done = invoke("run", "town.xodr")
    assert done.exit_code == 2
    assert (
        "roadgpt import reads maps, and this drives the road in a file: roadgpt drive town.xodr"
        in done.stderr
    )
