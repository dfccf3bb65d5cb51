"""The search that competes: it listens to outcomes, whoever tells them, and in another process too."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from itertools import islice
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from authorities.sbft_official_slow import verdict
from roadgpt.campaign.model import Cell
from roadgpt.geometry import interpolate, radii
from roadgpt.road import Site, World
from roadgpt_sbft import RoadGPTTestGenerator, generator
from roadgpt_sbft.command import sbft_command
from roadgpt_sbft.competition import PLAIN, USUAL

WORLD = World(site=Site(map_size=200.0))
FLAT = "| flat turns=1.."
JUDGED = range(5, 10)  # roads that the slow validator judges: the first that were chosen by outcomes


class SteeringRecord(NamedTuple):
    """What is read of one record of the competition's execution data."""

    steering: float
    oob_distance: float
    pos: tuple[float, float, float] | None = None


def tight_right(points: np.ndarray) -> float:
    """The largest mean curvature over 10 m of a right bend, 1/m, by headings alone."""
    step = np.diff(points[:, :2], axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turned = heading[10:] - heading[:-10]
    return float(max(-turned.min() / 10, 0.0)) if len(turned) else 0.0


def driven(points: np.ndarray) -> tuple[str, list[SteeringRecord]]:
    """A car that runs off where right bends are tighter than 17 m over 10 m."""
    tight = tight_right(points)
    steering = np.degrees(np.arctan(2.8 / np.maximum(radii(points), 1.0))) * 15
    nearest = 2.0 - 34 * tight
    return ("FAIL" if nearest < 0 else "PASS"), [SteeringRecord(float(one), nearest) for one in steering[:40]]


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth of the usual sketches for each road."""
    monkeypatch.setattr("roadgpt_sbft.generator.Cell", partial(Cell, settings={"candidates": 4}))


def campaign(
    tests: int, seed: int, search: bool, heard: Callable[[str], str] = str, judged: range = range(0)
) -> list[tuple[str, float]]:
    generator = type("Mine", (RoadGPTTestGenerator,), {"seed": seed, "search": search})(None, 200)
    out = []
    for points in generator.roads():
        nodes = np.array(interpolate(np.array(points)))
        assert len(out) not in judged or verdict(points, 200) == (True, "")
        outcome, records = driven(nodes)
        generator.tell(heard(outcome), records)
        out.append((outcome, tight_right(nodes)))
        if len(out) == tests:
            return out
    raise AssertionError("the roads ended")


@pytest.mark.usefixtures("few")
def test_outcomes_lead_it_to_failures() -> None:
    """Of 24 roads; the search finds twice the failures of drafts of the same words."""
    searched, drafted = campaign(24, 3, True, judged=JUDGED), campaign(24, 3, False)
    found, usual = (sum(outcome == "FAIL" for outcome, _ in some) for some in (searched, drafted))
    assert found >= max(12, 2 * usual)


@pytest.mark.usefixtures("few")
def test_the_same_outcomes_give_the_same_roads_and_others_give_others() -> None:
    one, same = campaign(8, 4, True), campaign(8, 4, True)
    other = campaign(8, 4, True, heard=lambda outcome: "PASS" if outcome == "FAIL" else "FAIL")
    assert one == same
    assert one[:5] == other[:5]  # nothing is known yet
    assert one[5:] != other[5:]


def test_the_competitions_doors_drive_and_judge_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    searched: list[World] = []
    monkeypatch.setattr(generator, "RoadSearch", lambda *given: searched.append(given[3]) or given)
    for executor in (SimpleNamespace(), SimpleNamespace(oob_tolerance=0.85)):
        with pytest.raises(AttributeError):  # the stand-in brings no roads
            next(RoadGPTTestGenerator(executor).roads())
    assert [world.limits.oracle for world in searched] == ["thesis", "sbft"]
    assert (USUAL.limits.oracle, PLAIN.driver) == ("thesis", "beamng_like")
    words = ["--module-path", ".", "--module-name", "m", "--class-name", "C"]
    values = sbft_command.make_context("sbft", words).params
    assert (values["driver"], values["oob_tolerance"]) == ("beamng_like", 0.95)


CLIENT = """
import json, sys
sys.path.insert(0, sys.argv[1])
import roadgpt_client
from collections import namedtuple
Record = namedtuple("Record", "steering oob_distance pos")
generator = roadgpt_client.RoadGPTTestGenerator(map_size=200)
generator.description, generator.reader, generator.seed = sys.argv[2], "plan", 4
roads = []
for points in generator.roads():
    roads.append(points)
    if len(roads) == 14:  # the last four are chosen by outcomes and places
        break
    x, y = points[len(points) // 2]
    size, outcome = 10.0 * (1 + len(roads) % 5), "FAIL" if len(roads) % 3 else "PASS"
    generator.tell(outcome, [Record(size * (i % 7), -1.0 - (i == 20), (x + i - 20, y, 0)) for i in range(30)])
print(json.dumps(roads))
"""


def test_outcomes_reach_it_from_another_interpreter(tmp_path: Path) -> None:
    """The roads are those of a generator here that is told the same; without outcomes they are others."""
    names = Path(sys.modules[RoadGPTTestGenerator.__module__].__file__ or "").parent / "names"
    words = [sys.executable, "-c", CLIENT, str(names), FLAT]
    env = {**os.environ, "ROADGPT_PYTHON": sys.executable}
    done = subprocess.run(words, env=env, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told, untold = (roads_told(with_place) for with_place in (True, False))
    assert json.loads(done.stdout) == told
    assert told[:10] == untold[:10]
    assert told[10:] != untold[10:]  # where the car left its lane is learnt, too


def roads_told(with_place: bool) -> list[list[list[float]]]:
    """Roads of a generator here that is told what CLIENT tells, with or without the places."""
    generator = RoadGPTTestGenerator(None, 200)
    generator.description, generator.reader, generator.seed = FLAT, "plan", 4
    roads = []
    for points in islice(generator.roads(), 14):
        roads.append([[x, y] for x, y in points])
        x, y = points[len(points) // 2]
        size, outcome = 10.0 * (1 + len(roads) % 5), "FAIL" if len(roads) % 3 else "PASS"
        records = []
        for i in range(30):
            place = (x + i - 20, y, 0.0) if with_place else None
            records.append(SteeringRecord(size * (i % 7), -1.0 - (i == 20), place))
        generator.tell(outcome, records)
    return roads
