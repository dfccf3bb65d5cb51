"""What is offered where the map has no room holds: typed again it is read, drafted and valid, by any seed."""

import re
from collections import Counter

import numpy as np
import pytest

from grids import diagonal
from roadgpt import check
from roadgpt.brief import read
from roadgpt.brief.map_fit import longest_straight
from roadgpt.brief.outline import outline
from roadgpt.brief.plan import read_plan
from roadgpt.brief.words import LARGEST_MAP
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.advice import advice
from roadgpt.errors import RoadGPTError
from roadgpt.road import Road, Site, World, build
from roadgpt.run import Setup, brief_of

PLAN = Setup(reader="plan")
CASES = (
    ("serpentine | len=367", 150, 571),
    ("turn x3 sharp | hills=3.. len=985", 150, 975),
    ("| turns=1.. up len=500..", 120, 342),
    ("straight | turns=0 len=2283", 200, 18),
)
"""Plans for which the map has no room, the map's size in m, and a seed."""


def drafted(line: str, world: World, seed: int) -> Road:
    """The road, valid and true to the plan; the refusal where there is none."""
    brief = brief_of(line, world, PLAN)
    road = build(draft(brief, world, seed=seed))
    assert check.inspect(road, brief, world) == ()
    return road


def refusal(line: str, world: World) -> str:
    """What is said where there is no room; empty where there is."""
    try:
        drafted(line, world, seed=0)
    except RoadGPTError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(("line", "size", "seed"), CASES)
def test_what_is_offered_holds(line: str, size: int, seed: int) -> None:
    world = World(site=Site(map_size=size))
    said = refusal(line, world)
    assert f"{size} m" in said, "the real map is named"
    assert f"--map-size {size}" not in said
    offers = re.search(r"ask for (?:a straight of )?(\d+) m", said)
    larger = re.search(r"--map-size (\d+)", said)
    assert offers or larger, said
    if offers:
        assert drafted(re.sub(r"len=\d+", f"len={offers[1]}", line, count=1), world, seed)
    if larger:
        assert drafted(line, World(site=Site(map_size=float(larger[1]))), seed)


@pytest.mark.parametrize(
    ("size", "line"),
    diagonal(
        [100, 200, 250, 1000, 10_000], ["straight | turns=0 len={:.0f}", "straight | turns=0 len={:.0f}.."]
    ),
)
def test_a_straight_road_goes_from_corner_to_corner(line: str, size: float) -> None:
    world = World(site=Site(map_size=size))
    longest = longest_straight(size)
    road = drafted(line.format(longest - 1), world, seed=int(size))
    assert road.length > 0.88 * longest if not line.endswith("..") else road.length >= int(longest - 1)
    x, y = road.sample().x, road.sample().y
    assert min(x.min(), y.min()) > 4.0
    assert max(x.max(), y.max()) < size - 4.0
    said = refusal(line.format(1.3 * longest), world)
    assert f"ask for {int(longest)} m" in said
    assert f"map of {size:g} m" in said


@pytest.mark.parametrize(
    ("words", "size"),
    [
        ("a winding road of 2 km", 1000),
        ("an uphill road with 3 turns", 120),
        ("a road of 10 km", 10_000),
        ("a road of 6 km with 3 turns", 4000),
        ("a road", 100),
    ],
)
def test_maps_of_any_size_work_with_the_default_reader(words: str, size: float) -> None:
    world = World(site=Site(map_size=size))
    brief = read(words, map_size=size)
    assert check.inspect(build(draft(brief, world, seed=3)), brief, world) == ()


@pytest.mark.parametrize(
    ("line", "size", "least_turns"),
    [
        ("winding | len=2000", 1000, 8),
        ("winding | len=5000", 1000, 20),
        ("winding | len=10000", 4000, 40),
        ("winding | len=900", 250, 5),
        ("hairpin x2.. | steepest=4.. len=4000", 4000, 6),
        ("zigzag | up len=3000", 2000, 8),
    ],
)
def test_a_long_road_has_turns_all_along(line: str, size: float, least_turns: int) -> None:
    world = World(site=Site(map_size=size))
    road = drafted(line, world, seed=1)
    turns = measure(road.centreline()).turns
    assert len(turns) >= least_turns
    gaps = np.diff([0.0, *(turn.start for turn in turns), road.length])
    assert gaps.max() < 0.3 * road.length


def test_nobody_is_told_to_take_a_map_larger_than_the_largest() -> None:
    for size, is_told in ((LARGEST_MAP, False), (LARGEST_MAP - 1, True)):
        world = World().changed(map_size=size)
        brief = read_plan("turn x2")
        said = advice(brief, outline(brief), world, Counter(["steep"]), (), lambda *_: None)
        assert ("--map-size" in said) == is_told
