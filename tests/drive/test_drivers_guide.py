"""The guide runs: its driver is copied out of the page, saved, loaded by path and driven."""

import re
from pathlib import Path

import numpy as np

from drive.slippery_bicycle import SlipperyBicycle
from road_parts import road_of
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.drive import View, simulate
from roadgpt.drive.loading import load_driver
from roadgpt.network import made_from
from roadgpt.road import World
from roadgpt.run import Setup, perform
from roadgpt.verdict import judge

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "own-driver.md"


def test_the_driver_of_the_guide_keeps_its_lane(tmp_path: Path) -> None:
    text = GUIDE.read_text(encoding="utf-8")
    code, _ = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    lines = [line for line in code.splitlines() if line.strip()]
    assert len(lines) <= 15
    spec, _ = re.findall(r"--driver (\S+)", text)
    (tmp_path / spec.split(":")[0]).write_text(code)
    parts = [(25.0, 0.0), (20.0, 60.0), (15.0, 0.0), (40.0, -69.0), (30.0, 0.0)]
    road = road_of(*[(distance, turn, 6) for distance, turn in parts])
    driver = load_driver(str(tmp_path / spec))
    verdict = judge(road, SlipperyBicycle().simulate(road, World(), driver, 0), World())
    assert verdict.kept, verdict.description


def test_the_driver_of_the_guide_overtakes_by_itself(tmp_path: Path) -> None:
    text = GUIDE.read_text(encoding="utf-8")
    code = "\n\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL))
    ((plan, spec),) = re.findall(r'--plan "([^"]+)" --driver (\S+)', text)
    (tmp_path / spec.split(":")[0]).write_text(code)
    run = perform(plan, 1, setup=Setup(reader="plan", drives=False))
    assert run.road is not None
    drive = simulate(run.road, run.world, load_driver(str(tmp_path / spec)), 1)
    verdict = judge(run.road, drive, run.world)
    assert verdict.outcome == "PASS", verdict.description
    assert not drive.handovers
    assert drive.others is not None
    truck, first, last = drive.others.states[:, 0, :2], drive.middles[0], drive.middles[-1]
    ahead = np.array([np.cos(first[2]), np.sin(first[2])])
    assert (truck[0] - first[:2]) @ ahead > 30.0
    assert (last[:2] - truck[-1]) @ ahead > 30.0
    aside = drive["t"] - drive["t"][0]
    assert np.abs(aside).max() > 3.0
    assert abs(aside[-1]) < 0.5


def test_the_guide_names_every_field_of_the_view() -> None:
    text = GUIDE.read_text(encoding="utf-8")
    missing = [name for name in View._fields if f"`{name}`" not in text]
    assert not missing


def test_every_name_that_the_guide_uses_is_there() -> None:
    text = GUIDE.read_text(encoding="utf-8")
    named = set(re.findall(r"\b(?:view\.)?((?:world|road|route)(?:\.[a-z_]+)+)", text))
    assert {"world.site.friction", "world.limits.speed_limit", "road.curvature", "route.legs"} <= named
    plan = read_plan("| len=60 // crossroads straight // | len=60")
    route = made_from(draft(plan, World(), seed=1), World())
    for name in named:
        found = {"world": World(), "road": route, "route": route}[name.split(".")[0]]
        for part in name.split(".")[1:]:
            assert hasattr(found, part), name
            found = getattr(found, part)
