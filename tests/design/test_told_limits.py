"""Lane widths and speed limits that a plan tells: measured on the road and in the exported file."""

import re
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.export import save
from roadgpt.road import World
from roadgpt.run import Setup, perform

PLANS = (
    "turn x2 | width=3 limit=50", "crossroads left || width=2.8 limit=30", "map columns=2 rows=2 || limit=60"
)  # fmt: skip


@pytest.mark.parametrize("words", PLANS[:2])
def test_lanes_are_as_wide_and_signed_as_told(words: str, tmp_path: Path) -> None:
    width, limit = (float(re.findall(rf"{key}=([\d.]+)", words)[0]) for key in ("width", "limit"))
    run = perform(words, seed=3, setup=Setup(reader="plan"))
    assert run.road is not None
    assert run.drive is not None
    profile = run.world.profile_of(run.road)
    s = np.linspace(1.0, 20.0, 5)
    left, right = profile.lane(s)
    assert np.abs(np.asarray(left) - np.asarray(right)) == pytest.approx(width)
    save(run.road, tmp_path, ["opendrive"], run.world, "a")
    text = (tmp_path / "a.xodr").read_text(encoding="utf-8")
    told = {float(each) * factor for each, unit in re.findall(r'<speed max="([\d.]+)" unit="([^"]+)"', text)
            for factor in [{"km/h": 1.0, "m/s": 3.6}[unit]]}  # fmt: skip
    assert len(told) == 1
    assert told.pop() == pytest.approx(limit, abs=0.1)
    assert run.drive["speed"].max() * 3.6 < limit * 1.05


@pytest.mark.parametrize("words", PLANS)
def test_such_plans_read_back(words: str) -> None:
    assert read_plan(plan(read_plan(words))) == read_plan(words)


def test_what_was_given_goes_before_what_is_told_and_that_is_said() -> None:
    brief, given = read_plan(PLANS[0]), World(speed_limit=20, lane_width=3.5)
    found = world_for(brief, given)
    assert (found.limits.speed_limit, found.section.lane_width) == (20, 3.5)
    said = " ".join(world_remarks(brief, given, found))
    assert "speed limit of 50" in said
    assert "lane width of 3" in said
    assert not [each for each in world_remarks(brief, World(), world_for(brief, World())) if "limit" in each]


@pytest.mark.parametrize("words", ["turn | limit=50..60", "turn | width=1", "turn // junction // | limit=50"])
def test_what_is_no_single_number_of_the_whole_is_refused(words: str) -> None:
    with pytest.raises(BriefError, match=r"limit|width"):
        read_plan(words)
