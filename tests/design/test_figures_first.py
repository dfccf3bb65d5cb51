"""A figure that goes with a word wins over what the word usually means; measured on the finished road."""

import numpy as np
import pytest

from roadgpt import check
from roadgpt.brief.feasible import check as possible
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.errors import BriefError
from roadgpt.road import World, build

WORLD = World()


def grades(line: str, seed: int) -> np.ndarray:
    """The slopes of a road of this plan over each 10 m, in percent."""
    brief = read_plan(line)
    possible(brief)
    road = build(draft(brief, WORLD, seed=seed))
    assert check.inspect(road, brief, WORLD) == ()
    points = road.sample().points
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points[:, :2], axis=0).T))])
    heights = np.interp(np.arange(0, along[-1], 10.0), along, points[:, 2])
    return 10 * np.diff(heights)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("line", "sign", "most"),
    [
        ("turn x3 right | up steepest=..3", 1, 3),
        ("turn x5 | up steepest=..2", 1, 2),
        ("turn x3 | gently_down steepest=..1.5", -1, 1.5),
        ("| steeply_up steepest=..6", 1, 6),
    ],
)
def test_a_limit_leaves_a_slope_below_it(line: str, sign: int, most: float, seed: int) -> None:
    along = sign * grades(line, seed)
    assert 1.0 <= along.mean() <= most
    assert along.min() > -0.2
    assert along.max() <= most + 0.1


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "line", ["| up climb=7 len=300", "hairpin x4 | up climb=12", "| down climb=-5 len=350"]
)
def test_a_height_over_a_length_makes_the_slope(line: str, seed: int) -> None:
    brief = read_plan(line)
    road = build(draft(brief, WORLD, seed=seed))
    heights = road.sample().points[:, 2]
    asked = brief.climb.lo if brief.climb and brief.climb.lo else 0.0
    assert heights[-1] - heights[0] == pytest.approx(asked, rel=0.16)
    assert np.all(np.sign(asked) * grades(line, seed) > -0.2)


@pytest.mark.parametrize(
    "line",
    [
        "turn sweeping r=20",
        "turn sharp r=90",
        "turn gentle r=16",
        "| up steepest=..0.8",
        "| steeply_up steepest=..3",
    ],
)
def test_a_figure_that_is_far_from_its_word_is_a_contradiction(line: str) -> None:
    with pytest.raises(BriefError, match=r"leave out|allow"):
        possible(read_plan(line))
