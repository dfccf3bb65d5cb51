"""The catalogue of scenarios on the command line: listed, run and tested in campaigns."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from command_line import invoke, roadgpt
from roadgpt.brief.plan import read_scene
from roadgpt.brief.scenarios import MISSING, scenarios
from roadgpt.run import read_run

pytestmark = pytest.mark.usefixtures("no_workers")

CRAWL = "ncap:CCRs ego=10"
"""The quickest of all."""


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_list_has_every_scenario_on_a_screen_of_80_columns() -> None:
    said = roadgpt("scenarios").output
    assert all(f"  {name}\n" in said for name in scenarios())
    assert max(map(len, said.splitlines())) <= 80
    assert all(f"  {row.name}\n" in said for row in MISSING.values())
    assert said.count("not possible: ") == len(MISSING)
    assert "the tested car has no doors" in invoke("scenarios", "ncap:CBDA").stderr
    rows = [
        json.loads(line)
        for line in roadgpt("scenarios", "ncap:*", "r157:cut_in", "--json").output.splitlines()
    ]
    assert len(rows) == sum(name.startswith("ncap:") for name in scenarios()) + 1
    assert rows[-1]["parameters"]["gap"][0] == rows[-1]["values"]["gap"] == 30
    whole = roadgpt("scenarios", "r157:cut_in").output
    assert max(map(len, whole.splitlines())) <= 80
    assert all(f"{name}=" in whole for name in rows[-1]["parameters"])


def test_a_run_needs_words_or_a_scenario_and_repeats_with_both() -> None:
    assert invoke("run", "--no-drive").exit_code == 2
    roadgpt(
        "run", "--scenario", "r157:cut_in slower=30", "--no-drive", "--no-plot", "--seed", 3, "--out", "a"
    )
    run = read_run(Path("a/runs/0001"))
    assert run.request.setup.scenario == "r157:cut_in slower=30"
    scene = "ego test_robot v=60; car lane right gap=67.5 v=30: cut_in 2 accel=0 gap=30"
    assert run.world.scene == read_scene(scene)
    assert run.world.section.lane_width == 3.5
    again = roadgpt("show", "a/runs/0001").output
    assert "--scenario 'r157:cut_in slower=30'" in again


def test_a_scenario_and_a_scene_are_merged_or_refused() -> None:
    roadgpt("run", "--scenario", CRAWL, "--scene", "light; night", "--no-drive", "--no-plot", "--out", "a")
    scene = read_run(Path("a/runs/0001")).world.scene
    assert (scene.flow, scene.light, len(scene.actors)) == ("light", "night", 1)
    refused = invoke("run", "--scenario", CRAWL, "--scene", "truck ahead", "--no-drive")
    assert refused.exit_code == 2
    assert "contradict each other" in refused.stderr


def test_a_campaign_tests_scenarios_and_counts_refused_ones_apart() -> None:
    named = f"{CRAWL},r157:cut_out_fully_blocking"
    done = roadgpt(
        "campaign", "--plan", "straight | lanes=1", "--scenario", named, "--out", "c", "--driver", "robot"
    )
    assert "refused" in done.output
    first, second = csv.DictReader(Path("c/results.csv").read_text().splitlines())
    assert (first["origin"], first["outcome"], first["cause"]) == (CRAWL, "FAIL", "collision")
    assert (second["outcome"], second["description"][:9]) == ("INVALID", "refused: ")
    told = json.loads(roadgpt("show", "c", "--json").output)
    assert told["scenarios"] == {
        "ncap:CCRs": {"FAIL": 1}, "r157:cut_out_fully_blocking": {"refused": 1},
    }  # fmt: skip
    assert read_run_again("c", 1) == first["description"]


def read_run_again(folder: str, number: int) -> str:
    line = roadgpt("drive", "--again", folder, number, "--no-plot").output.splitlines()[-1]
    return line.split("  ", 2)[-1].strip().split("  ")[-1]


def test_a_plan_of_a_campaign_has_the_points_of_a_standard_grid() -> None:
    cut_in = "r157:cut_in ego=20 model=car lane=left gap=60 lateral_speed=3 acceleration=0"
    Path("p.toml").write_text(
        "drive = false\ntests = 4\n"
        f'settings = {{ scenario = "r157:free_driving, {cut_in}", grid = "standard" }}\n'
    )
    said = roadgpt("campaign", "p.toml", "--out", "c").output
    assert "14 points" in said  # 12, and two of five cut-ins that are slower than 20 km/h by 10 to 50 km/h
    assert "3 that lead to speeds below 0 are left out" in said
    origins = [row["origin"] for row in csv.DictReader(Path("c/results.csv").read_text().splitlines())]
    assert origins == [f"r157:free_driving ego={speed}" for speed in (5, 10, 15, 20)]


@pytest.mark.usefixtures("no_workers")
def test_scenario_and_criticality_stand_in_rows_tables_and_junit() -> None:
    """The robot holds 50 km/h and hits who stands: the difference of the velocities is 50 km/h."""
    name, words = "ncap:CCRs", ("--driver", "robot", "--seed", "1")
    run = ("run", "--scenario", f"{name} impact=75", *words, "--no-plot")
    done = invoke(*run, "--out", "r", "--junit", "r.xml")
    assert done.exit_code == 0, done.output
    (line,) = [each for each in done.stdout.splitlines() if each.startswith("1/1")]
    assert "margin" not in line
    assert f"  {name} impact=75  impact 50 km/h, TTC 0.0 s" in line
    asked = ("--scenario", f"{name} impact=75", *words, "--junit", "c.xml")
    done = invoke("campaign", *asked, "--out", "c")
    assert done.exit_code == 0, done.output
    with Path("c/results.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["scenario"], row["parameters"], row["margin_m"]) == (name, "impact=75", "")
    assert (float(row["GAP"]), float(row["IMPACT"])) == (0.0, pytest.approx(50, abs=0.5))
    for file in ("r.xml", "c.xml"):
        (case,) = ElementTree.parse(file).getroot().iter("testcase")
        told = {each.get("name"): each.get("value") for each in case.iter("property")}
        assert (told["scenario"], told["parameters"], told["gap_m"]) == (name, "impact=75", "0")
        assert float(told["impact_kmh"] or 0) == pytest.approx(50, abs=0.5)
        assert "margin_m" not in told
    suite = ElementTree.parse("c.xml").find("testsuite")
    assert suite is not None
    assert suite.get("name") == "nominal roads of scenarios"
    page = Path(invoke("report", "c").stdout.strip()).read_text()
    assert "“nominal roads of scenarios”" in page
    assert "roads that were given" not in page
    shown = [invoke("show", place).stdout for place in ("r", "r/1", "c/c01", "c/c01/1")]
    for text in shown:
        assert f"{name} impact=75" in text
        assert "impact 50 km/h" in text
        assert "+1.750 m" not in text
    one = json.loads(invoke("show", "--json", "r/1").stdout)
    assert (one["scenario"], one["parameters"], one["gap_m"], one["margin_m"]) == (name, "impact=75", 0, None)
