"""What is offered where the map has no room holds: typed again it is read, drafted and valid, by any seed."""

import re
from itertools import islice

import numpy as np
import pytest

from roadgpt import check
from roadgpt.brief import read
from roadgpt.brief.map_fit import longest_straight
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.errors import RoadGPTError
from roadgpt.road import CrossSection, Road, Site, World, build
from roadgpt.run import Setup, brief_of

GRAMMAR = Setup(reader="grammar")
ROADS = (
    "a winding road of {}",
    "a road of {}",
    "an uphill road of {} with 3 turns",
    "a road of {} with 6 sharp turns",
    "a serpentine road of {}",
    "a road with one left turn, {} long",
    "a road of at least {}",
    "a hilly road of {}",
    "a straight road of {}",
    "a straight of {}, then a hairpin left, then a straight of 40 m",
)


def drafted(words: str, world: World, seed: int) -> Road:
    """The road, valid and true to the words; the refusal where there is none."""
    brief = brief_of(words, world, GRAMMAR)
    road = build(draft(brief, world, seed=seed))
    assert check.inspect(road, brief, world) == ()
    return road


def refusal(words: str, world: World) -> str:
    """What is said where there is no room; empty where there is."""
    try:
        drafted(words, world, seed=0)
    except RoadGPTError as error:
        return str(error)
    return ""


def cases(number: int) -> list[tuple[str, int, int]]:
    """Descriptions with more metres than the map is wide, a map, and a seed."""
    rng = np.random.default_rng(15)

    def one() -> tuple[str, int, int]:
        size = int(rng.choice([100, 120, 150, 200, 250, 400, 1000]))
        metres = int(size * rng.uniform(2, 12))
        return str(rng.choice(ROADS)).format(f"{metres} m"), size, int(rng.integers(1000))

    return [one() for _ in range(number)]


@pytest.mark.parametrize(("words", "size", "seed"), cases(24))
def test_what_is_offered_holds(words: str, size: int, seed: int) -> None:
    world = World(site=Site(map_size=size))
    said = refusal(words, world)
    if not said:
        return
    assert f"{size} m" in said, "the real map is named"
    assert f"--map-size {size}" not in said
    offers = re.search(r"ask for (?:a straight of )?(\d+) m", said)
    larger = re.search(r"--map-size (\d+)", said)
    assert offers or larger, said
    if offers:
        assert drafted(re.sub(r"\d+ m", f"{offers[1]} m", words, count=1), world, seed)
    if larger:
        assert drafted(words, World(site=Site(map_size=float(larger[1]))), seed)


def test_enough_of_the_descriptions_are_refused() -> None:
    tried = ((words, World(site=Site(map_size=size))) for words, size, _ in cases(24))
    assert len(list(islice((1 for words, world in tried if refusal(words, world)), 12))) == 12


@pytest.mark.parametrize("size", [100, 200, 250, 1000, 4000, 10_000])
@pytest.mark.parametrize("words", ["a straight road of {:.0f} m", "a straight road of at least {:.0f} m"])
def test_a_straight_road_goes_from_corner_to_corner(words: str, size: float) -> None:
    world = World(site=Site(map_size=size))
    longest = longest_straight(size)
    road = drafted(words.format(longest - 1), world, seed=int(size))
    assert road.length > 0.88 * longest if "least" not in words else road.length >= int(longest - 1)
    x, y = road.sample().x, road.sample().y
    assert min(x.min(), y.min()) > 4.0
    assert max(x.max(), y.max()) < size - 4.0
    said = refusal(words.format(1.3 * longest), world)
    assert f"ask for {int(longest)} m" in said
    assert f"map of {size:g} m" in said


def test_wider_lanes_leave_less_room() -> None:
    wide = World(site=Site(map_size=100), section=CrossSection(lane_width=8.0))
    with pytest.raises(RoadGPTError, match=f"ask for {int(longest_straight(100, 16.0))} m"):
        brief_of("a straight road of 200 m", wide, GRAMMAR)
    assert drafted("a straight road of 110 m", wide, seed=1).length <= longest_straight(100, 16.0)


@pytest.mark.parametrize(
    ("words", "size"),
    [
        ("a winding road of 2 km", 1000),
        ("an uphill road with 3 turns", 120),
        ("a road of 10 km", 10_000),
        ("a road with 3 turns of 6 km", 4000),
        ("a road", 100),
    ],
)
def test_maps_of_any_size_work_with_the_default_reader(words: str, size: float) -> None:
    world = World(site=Site(map_size=size))
    brief = read(words, map_size=size)
    assert check.inspect(build(draft(brief, world, seed=3)), brief, world) == ()


@pytest.mark.parametrize(
    ("words", "size", "least_turns"),
    [
        ("a winding road of 2 km", 1000, 8),
        ("a winding road of 5 km", 1000, 20),
        ("a winding road of 10 km", 4000, 40),
        ("a winding road of 900 m", 250, 5),
        ("a mountain road with hairpins, 4 km", 4000, 6),
        ("a zig-zag road of 3 km, uphill", 2000, 8),
    ],
)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_long_road_has_turns_all_along(words: str, size: float, least_turns: int, seed: int) -> None:
    world = World(site=Site(map_size=size))
    road = drafted(words, world, seed)
    turns = measure(road.centreline()).turns
    assert len(turns) >= least_turns
    gaps = np.diff([0.0, *(turn.start for turn in turns), road.length])
    assert gaps.max() < 0.3 * road.length


def test_the_same_seed_grows_the_same_road() -> None:
    brief, world = read("a winding road of 2 km", "grammar", map_size=1000), World(site=Site(map_size=1000))
    one, same, other = (draft(brief, world, seed=seed) for seed in (5, 5, 6))
    assert one == same != other


def test_a_long_road_keeps_its_number_of_turns() -> None:
    road = drafted("a road with 8 turns of 800 m", World(), 3)
    assert len(measure(road.centreline()).turns) == 8
    assert 720 <= road.length <= 880
