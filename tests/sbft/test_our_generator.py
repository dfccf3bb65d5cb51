"""Our generator in a pipeline with the competition's names, judged by the slow validator."""

import json
import math
import os
import subprocess
import sys
from functools import cache, partial
from itertools import islice, pairwise
from pathlib import Path

import pytest

from authorities.sbft_official_slow import verdict
from roadgpt.campaign.model import Cell
from roadgpt.errors import BriefError, UsageError
from roadgpt_sbft import RoadGPTTestGenerator

ROOT = Path(__file__).resolve().parents[2]
LEFT = {"ROADGPT_DESCRIPTION": "two sharp left turns", "ROADGPT_SEED": "3"}
FEW = 3  # roads of a pipeline

# A pipeline in the competition's shape, of which roadgpt knows nothing: the same names, calls and demands.
FACTORY = """
class RoadTestFactory:
    made = 0
    class RoadTest:
        def __init__(self, road_points):
            assert type(road_points) is list
            assert all(len(point) == 2 for point in road_points)
            self.road_points = road_points[:]
    @staticmethod
    def create_road_test(road_points):
        RoadTestFactory.made += 1
        return RoadTestFactory.RoadTest(road_points)
"""
COMPETITION = """
import importlib, json, sys
from code_pipeline.tests_generation import RoadTestFactory

class Executor:
    def __init__(self, tests):
        self.left, self.roads = tests, []
    def is_over(self):
        return self.left <= 0
    def execute_test(self, test):
        assert type(test) is RoadTestFactory.RoadTest
        if self.is_over():
            sys.exit(123)
        self.left -= 1
        self.roads.append(test.road_points)
        return "PASS", "Successful test", []

module, name, tests = sys.argv[1:]
executor = Executor(int(tests))
getattr(importlib.import_module(module), name)(executor=executor, map_size=200).start()
assert RoadTestFactory.made == len(executor.roads) == int(tests)
print(json.dumps(executor.roads))
"""


def run_pipeline(folder: Path, module: str, name: str, **environment: str) -> list[list[list[float]]]:
    (folder / "code_pipeline").mkdir(exist_ok=True)
    (folder / "code_pipeline" / "__init__.py").write_text("")
    (folder / "code_pipeline" / "tests_generation.py").write_text(FACTORY)
    (folder / "competition.py").write_text(COMPETITION)
    done = subprocess.run(
        [sys.executable, "competition.py", module, name, str(FEW)],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    roads: list[list[list[float]]] = json.loads(done.stdout)
    return roads


def test_it_works_in_a_pipeline_that_knows_nothing_of_it(tmp_path: Path) -> None:
    roads = run_pipeline(tmp_path, "roadgpt_sbft", "RoadGPTTestGenerator", **LEFT)
    assert len(roads) == FEW
    assert all(verdict(points, 200) == (True, "") for points in roads)
    assert all(turned(points) > 1.2 for points in roads)  # rad to the left, of two sharp turns
    assert roads == roads_here()


@cache
def roads_here() -> list[list[list[float]]]:
    """The roads that our generator brings without a pipeline and without a client."""

    class Mine(RoadGPTTestGenerator):
        description = "two sharp left turns"
        seed = 3

    return [[[*point] for point in points] for points in islice(Mine(map_size=200).roads(), FEW)]


def turned(points: list[list[float]]) -> float:
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    return sum(math.remainder(b - a, 2 * math.pi) for a, b in pairwise(headings))


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """A third of the usual sketches for each road."""
    monkeypatch.setattr("roadgpt_sbft.generator.Cell", partial(Cell, settings={"candidates": 4}))


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize(
    "words",
    [
        "a road",
        "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
        RoadGPTTestGenerator.description,
    ],
)
def test_every_road_is_dense_and_valid_for_the_competition(words: str) -> None:
    generator = RoadGPTTestGenerator(map_size=200)
    generator.description = words
    roads = list(islice(generator.roads(), 4))
    for points in roads:
        assert 2 <= len(points) <= 500
        assert max(math.dist(a, b) for a, b in pairwise(points)) <= 2.0 + 1e-4
        assert verdict(points, 200) == (True, "")
    assert len({tuple(points) for points in roads}) == 4


@pytest.mark.usefixtures("few")
def test_the_environment_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    def first(seed: str) -> list[tuple[float, float]]:
        monkeypatch.setenv("ROADGPT_SEED", seed)
        return next(RoadGPTTestGenerator(map_size=200).roads())

    assert first("4") == first("4") != first("5")
    monkeypatch.setenv("ROADGPT_SEED", "four")
    with pytest.raises(UsageError, match="'four'"):
        RoadGPTTestGenerator()
    monkeypatch.setenv("ROADGPT_SEED", "4")
    monkeypatch.setenv("ROADGPT_SEARCH", "perhaps")
    with pytest.raises(UsageError, match="'perhaps'; say yes or no"):
        RoadGPTTestGenerator()
    monkeypatch.setenv("ROADGPT_SEARCH", "no")
    assert not RoadGPTTestGenerator().search
    monkeypatch.delenv("ROADGPT_SEARCH")
    monkeypatch.setenv("ROADGPT_DESCRIPTION", "a straight road of 5 km")
    with pytest.raises(BriefError):
        next(RoadGPTTestGenerator(map_size=200).roads())
    monkeypatch.setenv("ROADGPT_DESIGNER", "nobody")
    with pytest.raises(UsageError, match="nobody"):
        next(RoadGPTTestGenerator(map_size=200).roads())
