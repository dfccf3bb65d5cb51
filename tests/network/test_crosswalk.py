"""Crosswalks away from junctions: where they lie, who has priority there, and what files say of them."""

import re
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.export import save
from roadgpt.network import is_route, read_map, road_from_json
from roadgpt.network.markings import strokes
from roadgpt.run import Run, Setup, perform

WORDS = "straight 120 // crosswalk // turn left 60 r60; straight 60"


def run_of(words: str, driver: str = "reference") -> Run:
    return perform(words, seed=3, setup=Setup(driver=driver, reader="plan"))


@pytest.fixture(scope="module")
def crossed() -> Run:
    return run_of(f"{WORDS} && ego v=40; adult crosswalk right v=5")


def test_it_lies_between_the_two_roads_and_is_painted_and_written(crossed: Run, tmp_path: Path) -> None:
    road = crossed.road
    assert road is not None
    assert is_route(road)
    (place,) = road.crosswalks
    assert place.passage is None
    first = road.ends[1]
    assert place.s == pytest.approx(first - 2.5)  # 1 to 4 m before the end of the road before
    stripes = np.vstack([each.points for each in strokes(road.network) if each.kind == "crosswalk"])
    ends = np.linalg.norm(stripes[:, :2] - road.at(place.s)[:2], axis=1)
    assert ends.max() < np.hypot(1.5, 4.0)
    save(road, tmp_path, ["opendrive"], crossed.world, "a")
    text = (tmp_path / "a.xodr").read_text(encoding="utf-8")
    (found,) = re.findall(r'type="crosswalk" s="([\d.]+)"', text)
    assert float(found) == pytest.approx(place.s, abs=0.01)
    read = read_map(tmp_path / "a.xodr")
    assert read.network.crossed == road.network.crossed
    assert not [each for each in read.remarks if "crosswalk" in each]
    assert road_from_json(road.to_json()).crosswalks == road.crosswalks


def test_the_driver_gives_way_there_and_the_person_crosses_on_it(crossed: Run) -> None:
    road, drive = crossed.road, crossed.drive
    assert road is not None
    assert drive is not None
    assert drive.others is not None
    assert crossed.outcome == "PASS"
    place = road.crosswalks[0].s
    walks = drive.others.states[:, 0]
    middle = np.linalg.norm(walks[:, :2] - road.at(place, -2.0)[:2], axis=1)
    assert np.nanmin(middle) < 1.0
    before = drive["s"] < place
    assert drive["speed"][before].min() < 0.7 * drive["speed"][0]


def test_who_hits_a_person_on_it_is_to_blame() -> None:
    run = run_of(f"{WORDS} && ego v=40; adult crosswalk right v=5", "robot")
    assert run.verdict is not None
    assert run.verdict.cause == "collision"
    assert run.verdict.at_fault == "ego"
    assert run.verdict.law is not None
    assert "priority" in run.verdict.law.ego


@pytest.mark.parametrize(
    "words", ["&& child crosswalk left", "| lanes=2 against=2 && ego v=50; bicycle crosswalk right v=15"]
)
def test_who_needs_a_crosswalk_gets_one_without_a_junction(words: str) -> None:
    run = run_of(words)
    assert run.road is not None
    assert not run.road.passages
    assert len(run.road.crosswalks) == 1
    assert run.outcome == "PASS"


@pytest.mark.parametrize("words", [WORDS, "crossroads left // crosswalk || left_hand", "crosswalk"])
def test_plans_with_crosswalks_read_back(words: str) -> None:
    brief = read_plan(words)
    assert read_plan(plan(brief)) == brief
    built = perform(words, seed=3, setup=Setup(reader="plan"))
    assert built.road is not None
    assert not built.findings
    assert [each.passage for each in built.road.crosswalks].count(None) == 1
