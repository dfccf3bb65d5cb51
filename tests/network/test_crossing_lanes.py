"""Which lanes lead where at a junction: every lane leads on where it can, and no two ways cross."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.network import RoadEnd
from roadgpt.network.building import LaneWay, Stub, lane_ways
from roadgpt.road import Profile

Arms = list[tuple[float, int, int]]
"""Direction out of the junction in degrees, lanes into it, lanes out of it."""

counts = st.integers(0, 4)


@st.composite
def junctions(draw: st.DrawFn) -> Arms:
    """Three to six arms; the first one has lanes into the junction."""
    number = draw(st.integers(3, 6))
    gaps = [draw(st.floats(25, 120)) for _ in range(number)]
    directions = [360 * sum(gaps[:n]) / sum(gaps) for n in range(number)]
    return [(angle, draw(st.integers(1, 4)) if n == 0 else draw(counts), draw(counts))
            for n, angle in enumerate(directions)]  # fmt: skip


def ways(arms: Arms) -> dict[int, LaneWay]:
    """The lanes from the first arm to each other one."""
    stubs = []
    for n, (angle, into, out_of) in enumerate(arms):
        # a road has at least one lane along it, so one that leads only inwards ends at the junction
        contact, forward, backward = ("start", out_of, into) if out_of else ("end", into, 0)
        if not forward:
            continue
        end = RoadEnd(n, "start" if contact == "start" else "end")
        stubs.append(Stub(end, math.radians(angle), Profile.of(forward, backward, 3.5), 0.0))
    if stubs[0].end.road != 0:
        return {}
    return {stubs[j].end.road: way for j, way in lane_ways(stubs, 0)}


def turn(arms: Arms, to: int) -> float:
    """Change of direction in degrees on the way from the first arm to another, left positive."""
    return math.remainder(arms[to][0] - 180.0, 360.0)


@given(junctions())
@settings(max_examples=50, deadline=None)
def test_every_arm_with_lanes_out_is_reached_by_lanes_that_are_there(arms: Arms) -> None:
    found = ways(arms)
    assert set(found) == {n for n, (_, _, out_of) in enumerate(arms) if n and out_of}
    for to, way in found.items():
        assert way
        assert all(0 <= i < arms[0][1] and 0 <= j < arms[to][2] for i, j in way)
        assert all((i2 - i, j2 - j) == (1, 1) for (i, j), (i2, j2) in pairwise(way))


@given(junctions())
@settings(max_examples=50, deadline=None)
def test_ways_from_one_arm_never_cross(arms: Arms) -> None:
    """Of two ways, the lanes of the one farther to the left lie to the left; they may share one lane."""
    by_turn = sorted(ways(arms).items(), key=lambda each: turn(arms, each[0]))
    for n, (_, right) in enumerate(by_turn):
        for _, left in by_turn[n + 1 :]:
            assert max(i for i, _ in left) <= min(i for i, _ in right)


@given(junctions())
@settings(max_examples=50, deadline=None)
def test_every_lane_leads_on_where_there_is_room(arms: Arms) -> None:
    found = ways(arms)
    led = {i for way in found.values() for i, _ in way}
    room = sum(arms[to][2] for to in found)
    assert len(led) == arms[0][1] or len(led) == room or len(found) > arms[0][1]


def cross(into: int, *out: int) -> Arms:
    """Crossroads: lanes of the first arm, and lanes out to the right, straight on and to the left."""
    return [(180.0, into, 0), *((angle, 0, n) for angle, n in zip((270.0, 360.0, 450.0), out, strict=True))]


@pytest.mark.parametrize(
    ("arms", "expected"),
    [
        (cross(1, 1, 1, 1), {1: [(0, 0)], 2: [(0, 0)], 3: [(0, 0)]}),
        (cross(2, 1, 2, 1), {1: [(1, 0)], 2: [(0, 0), (1, 1)], 3: [(0, 0)]}),
        (cross(3, 2, 3, 2), {1: [(2, 1)], 2: [(0, 0), (1, 1), (2, 2)], 3: [(0, 0)]}),
        (cross(3, 1, 1, 1), {1: [(2, 0)], 2: [(1, 0)], 3: [(0, 0)]}),  # each lane for one way
        (cross(2, 1, 0, 1), {1: [(1, 0)], 3: [(0, 0)]}),
        (cross(3, 2, 0, 2), {1: [(2, 1)], 3: [(0, 0), (1, 1)]}),
        (cross(2, 0, 2, 0), {2: [(0, 0), (1, 1)]}),
        (cross(4, 1, 1, 0), {1: [(3, 0)], 2: [(0, 0)]}),  # two lanes end: there is room for two only
        (cross(4, 1, 1, 1), {1: [(3, 0)], 2: [(1, 0)], 3: [(0, 0)]}),
    ],
)
def test_usual_junctions(arms: Arms, expected: dict[int, list[tuple[int, int]]]) -> None:
    assert {to: list(way) for to, way in ways(arms).items()} == expected


@pytest.mark.parametrize("directions", [(180.0, 270.0, 360.0), (170.0, 275.0, 10.0, 95.0)])
@pytest.mark.parametrize("lanes", [1, 2, 3, 4])
def test_between_roads_with_as_many_lanes_every_lane_is_left_and_reached(
    directions: tuple[float, ...], lanes: int
) -> None:
    """Whatever one may do in a town: no lane of a T-junction or of crossroads is a trap or stays empty."""
    left, reached = set(), set()
    for start in range(len(directions)):
        turned = [(angle, lanes, lanes) for angle in (*directions[start:], *directions[:start])]
        for to, way in ways(turned).items():
            left |= {(start, i) for i, _ in way}
            reached |= {((start + to) % len(directions), j) for _, j in way}
    everything = {(arm, lane) for arm in range(len(directions)) for lane in range(lanes)}
    assert (left, reached) == (everything, everything)
