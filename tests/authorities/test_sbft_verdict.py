"""The competition's verdict: against its own on many roads, and against a slow second opinion."""

import gzip
import json
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from authorities import sbft_official_slow as slow
from authorities.sbft_roads import mutated, random_road
from roadgpt.errors import UsageError
from roadgpt_sbft.validator import sbft_verdict

# Lies beside the checkout where the project is built; not part of it.
OFFICIAL = Path(__file__).resolve().parents[3] / "shared" / "data" / "sbft_verdicts.jsonl.gz"
FROZEN = Path(__file__).parent / "data" / "sbft_verdicts.jsonl"  # some of them


@cache
def official_verdicts() -> list[dict]:
    """Some that are kept here, and 1,000 more where they are at hand."""
    rows = FROZEN.read_text(encoding="utf-8").splitlines()
    if OFFICIAL.exists():
        rows += gzip.decompress(OFFICIAL.read_bytes()).decode().splitlines()[::3]
    return [json.loads(row) for row in rows]


def agree(points: np.ndarray, map_size: float) -> bool:
    """Do fast and slow say the same? Where the competition's code stops with an error, ours must not pass."""
    try:
        theirs = slow.verdict(points, map_size)
    except (ValueError, shapely.errors.GEOSException):
        try:
            return not sbft_verdict(points, map_size)[0]
        except UsageError:
            return True
    return sbft_verdict(points, map_size) == theirs


def test_ours_equals_every_official_verdict() -> None:
    rows = official_verdicts()
    assert len({row["validation_message"] for row in rows}) >= 5
    for row in rows:
        ours = sbft_verdict(row["road_points"], row["map_size"])
        assert ours == (row["is_valid"], row["validation_message"]), row


def test_the_second_opinion_equals_official_verdicts() -> None:
    for row in official_verdicts()[::10]:
        theirs = slow.verdict(row["road_points"], row["map_size"])
        assert theirs == (row["is_valid"], row["validation_message"]), row


def test_random_and_mutated_roads() -> None:
    rng = np.random.default_rng(7)
    for number in range(50):
        points, map_size = random_road(rng)
        for road in (points, mutated(points, rng)):
            assert agree(road, map_size), (number, road.tolist(), map_size)


def test_the_roads_to_hunt_with_meet_every_message_that_geometry_decides() -> None:
    rng = np.random.default_rng(8)
    said = Counter(sbft_verdict(*random_road(rng))[1] for _ in range(300))
    assert len(said) == 5
    assert min(said.values()) > 5


coordinates = st.floats(-20, 220).map(lambda v: round(v, 1))


@given(st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=9), st.sampled_from([100, 200]))
def test_any_points(points: list[tuple[float, float]], map_size: float) -> None:
    assert agree(np.array(points), map_size)


@given(st.lists(st.sampled_from("NESW"), min_size=1, max_size=12), st.sampled_from([4, 8, 16]))
@settings(max_examples=50)
def test_roads_on_a_lattice_that_touch_themselves(hops: list[str], step: int) -> None:
    moves = {"N": (0, 1), "E": (1, 0), "S": (0, -1), "W": (-1, 0)}
    points = 100 + step * np.cumsum([(0, 0), *(moves[hop] for hop in hops)], axis=0, dtype=float)
    assert agree(points, 200)


def line(start: tuple[float, float], end: tuple[float, float], count: int = 2) -> list[list[float]]:
    return np.linspace(start, end, count).tolist()


def circle(radius: float, turns: float) -> list[list[float]]:
    angle = np.arange(0, 2 * np.pi * turns, 2 / radius)
    return (100 + radius * np.stack((np.cos(angle), np.sin(angle)), axis=1)).tolist()


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[10, 10]], "Not enough road points."),
        (line((10, 10), (190, 190), 501), "The road definition contains too many points"),
        (line((10, 10), (190, 190), 500), ""),
        (line((100, 100), (300, 100)), "Not entirely inside the map boundaries"),
        (line((100, 4), (150, 4)), "Not entirely inside the map boundaries"),  # its edge touches the border
        (line((100, 4.1), (150, 4.1)), ""),
        (circle(30, 0.9), ""),
        (circle(30, 1.1), "The road is self-intersecting"),
        (circle(14, 0.4), "The road is too sharp"),
        (line((100, 100), (120, 100)), "The road is not long enough."),
        (line((100, 100), (120.1, 100)), ""),
        (line((300, 50), (400, 50)), ""),  # outside, and valid: 'and' binds before 'or'
        (line((50, 300), (50, 400)), ""),
        (line((-300, 50), (-200, 50)), "Not entirely inside the map boundaries"),
        (line((-300, 300), (-200, 300)), ""),  # outside on both axes, and valid
        # the road that the competition's guidelines print as their example
        ([[10, 20], [30, 20], [40, 30], [50, 40], [150, 100], [30, 180]], "The road is too sharp"),
    ],
)
def test_messages_and_quirks(points: list[list[float]], message: str) -> None:
    assert sbft_verdict(points, 200) == (not message, message)
    assert slow.verdict(points, 200) == (not message, message)


def test_points_that_coincide_or_are_no_numbers_are_refused_with_advice() -> None:
    with pytest.raises(UsageError, match="remove the duplicate"):
        sbft_verdict([[10, 10], [10, 10], [50, 50]], 200)
    with pytest.raises(UsageError, match="not finite"):
        sbft_verdict([[10, 10], [np.nan, 20], [50, 50]], 200)
