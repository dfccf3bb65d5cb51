"""Measures of drives among others, against motions that are followed step by step."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from roadgpt.drive import Columns, Drive
from roadgpt.road import Design, Road, Segment, World, build
from roadgpt.traffic.actor import SIZES
from roadgpt.verdict.measures import Measures, measure
from staged import BOX, among, driven, level, straight, tracks

ROAD = level(0, 500)
HALF = 4.7 / 2


def measured(own: Any, duration: float, road: Road = ROAD, **others: Any) -> Measures:
    drive = driven(own, duration, None)
    s, t = road.locate(drive["x"], drive["y"])
    drive = replace(drive, columns=Columns({**drive.columns, "s": s, "t": t}))
    return measure(road, among(drive, tracks(duration, **others)), World())


def along(v: float, a: float = 0.0, begin: float = 0.0, y: float = -2.0, from_time: float = 0.0) -> Any:
    """Straight on at ``v`` m/s, with ``a`` m/s2 from a time on, until it stands."""

    def motion(time: Any) -> Any:
        late = np.clip(time - from_time, 0, v / -a if a < 0 else np.inf)
        return begin + v * (np.minimum(time, from_time) + late) + a * late**2 / 2, y + 0 * time, 0 * time

    return motion


def test_following_at_even_speeds() -> None:
    found = measured(along(20, begin=10), 5.0, car_1=("car", along(15, begin=60)))
    gap = 50 - 2 * HALF - 5 * found.time
    np.testing.assert_allclose(found.gap[:, 0], gap, atol=2e-3)
    np.testing.assert_allclose(found.ttc[:, 0], gap / 5, atol=2e-3)
    np.testing.assert_allclose(found.conflict[:, 0], gap / 5, atol=2e-3)
    np.testing.assert_allclose(found.deceleration[1:-1, 0], (25 / 2 / gap)[1:-1], rtol=5e-3)
    reached = found.time < 5 - gap / 20  # before the drive ends
    np.testing.assert_allclose(found.headway[reached, 0], gap[reached] / 20, atol=2e-3)
    assert np.isinf(found.headway[-1, 0])
    assert np.isinf(found.pet[0])


def test_cones_beside_the_way_of_the_body_are_not_ahead_of_it() -> None:
    beside, before = ("cones", straight(60, -3.4, 0, 0)), ("cones", straight(60, -2.6, 0, 0))
    found = measured(along(20, begin=20), 1.0, beside=beside, before=before)
    assert np.isinf(found.gap[:, 0]).all()
    assert np.isinf(found.ttc[:, 0]).all()
    gap = 40 - HALF - SIZES["cones"].length / 2 - 20 * found.time
    np.testing.assert_allclose(found.ttc[:, 1], gap / 20, atol=2e-3)


def test_who_is_behind_beside_or_away_has_no_time_to_collision() -> None:
    others: dict[str, Any] = {
        "behind": ("car", along(25, begin=0)),
        "oncoming": ("car", straight(80, 2, np.pi, 15)),
        "faster": ("car", along(25, begin=60)),
        "beside": ("van", straight(30, -6.2, 0, 15)),
        "far": ("car", straight(400, -2, 0, 0)),
    }
    found = measured(along(20, begin=20), 0.5, **others)
    assert np.isinf(found.ttc).all()
    assert np.isfinite(found.headway[0]).tolist() == [False] * 5  # within the half second
    assert np.isinf(found.distance[:, -1]).all()
    assert (found.distance[0, :-1] > 0).all()
    assert (found.deceleration == 0).all()
    # the same one in the tested car's own lane comes towards it: no braking helps
    towards = measured(along(20, begin=20), 0.5, it=("car", straight(80, -2, np.pi, 15)))
    assert towards.ttc[0, 0] == pytest.approx((60 - 2 * HALF) / 35, abs=1e-3)
    assert np.isinf(towards.deceleration[0, 0])


@pytest.mark.parametrize("hand", [-1, 1])
def test_in_a_bend_distances_are_those_along_the_lane(hand: int) -> None:
    bend = Segment(
        distance=2 * 30, direction="left" if hand > 0 else "right", turn_degrees=hand * 60 / 30 * 180 / np.pi,
        radius=30, transition=0.001,
    )  # fmt: skip
    road = build(Design(starting_point=(0, 0, 0), theta=0, segments=(bend,)))
    radius = 30 + 2 * hand  # of the middle of the right lane

    def around(begin: float, speed: float) -> Any:
        """Along the lane, from ``begin`` metres on."""

        def motion(time: Any) -> Any:
            angle = hand * (begin + speed * time) / radius
            x, y = radius * hand * np.sin(angle), hand * (30 - radius * np.cos(angle))
            return x, y, angle

        return motion

    found = measured(around(5, 6), 1.0, road, car_1=("car", around(25, 4)))
    gap = 20 - 2 * HALF - 2 * found.time
    np.testing.assert_allclose(found.gap[:, 0], gap, atol=0.02)
    np.testing.assert_allclose(found.ttc[:, 0], gap / 2, rtol=0.01)


def hardest(gap: float, v: float, w: float, a: float) -> float:
    """The smallest deceleration with which a car does not touch the one ahead, by trying."""
    time = np.arange(0.0, 60.0, 0.002)

    def way(speed: float, gained: float) -> Any:
        until = np.minimum(time, speed / -gained if gained < 0 else np.inf)
        return speed * until + gained * until**2 / 2

    low, high = 0.0, 60.0
    if (way(v, 0.0) < way(w, a) + gap).all():
        return 0.0
    for _ in range(30):
        mid = (low + high) / 2
        low, high = (low, mid) if (way(v, -mid) < way(w, a) + gap).all() else (mid, high)
    return high


def test_the_required_deceleration_is_the_least_that_helps() -> None:
    rng = np.random.default_rng(3)
    needed = 0
    for _ in range(60):
        v, w, a = rng.uniform(5, 30), rng.uniform(0, 25), rng.choice([-6, -3, -1, 0, 1.0])
        gap = rng.uniform(5, 60)
        it = along(w, a, begin=20 + 2 * HALF + gap - w * 0.2)
        found = measured(along(v, begin=20 - v * 0.2), 0.4, car_1=("car", it))
        # at 0.2 s, where the acceleration of the track is a difference over two samples
        behind = gap + (w * 0.2 + a * 0.02 if w + a * 0.2 > 0 else w**2 / 2 / -a) - w * 0.2
        its = max(w + a * 0.2, 0.0)
        if its == 0 or w + a * 0.4 < 0 or behind < 1:
            continue
        needed += 1
        assert found.deceleration[2, 0] == pytest.approx(hardest(behind, v, its, a), rel=0.02, abs=0.05)
    assert needed > 30


@pytest.mark.parametrize("early", [-2.0, -0.9, -0.3, 0.3, 0.9, 2.0])
def test_post_encroachment_times(early: float) -> None:
    # an adult, 0.6 m long and 0.5 m wide, crosses from the right at 1.5 m/s; the strip is 1.86 m wide
    needs = (1.86 + 0.6) / 1.5
    # from the car's front at 80 - 0.25 m to its rear at 80 + 0.25 m
    enters, leaves = (80 - 0.25 - HALF - 10) / 12, (80 + 0.25 + HALF - 10) / 12
    comes = enters - needs - early if early > 0 else leaves - early
    walker = straight(80, -2 - 0.93 - 0.3 - 1.5 * comes, np.pi / 2, 1.5)
    found = measured(along(12, begin=10), 12.0, adult_1=("adult", walker))
    assert found.pet[0] == pytest.approx(abs(early), abs=0.02)
    assert found.pet_time[0] == pytest.approx(comes + needs if early > 0 else leaves, abs=0.02)


def test_who_does_not_cross_has_no_post_encroachment_time() -> None:
    back = lambda time: (50 + 0 * time, -6 + np.minimum(2 * time, 8 - 2 * time), np.pi / 2)  # noqa: E731
    others: dict[str, Any] = {"back": ("adult", back), "parked": ("car", straight(60, -5.2, 0, 0))}
    found = measured(along(12, begin=10), 4.0, **others)
    assert np.isinf(found.pet).all()


def test_both_in_the_area_at_once_is_zero() -> None:
    walker = straight(50, -4, np.pi / 2, 0.3)
    found = measured(along(4, begin=30), 12.0, adult_1=("adult", walker))
    assert found.pet[0] == 0


def test_nobody_there_gives_no_value_and_no_warning() -> None:
    drive: Drive = driven(along(12, begin=10), 2.0, None)
    others = tracks(2.0, car_1=("car", along(5, begin=30)))
    gone = others.states.copy()
    gone[8:] = np.nan
    drive = replace(drive, columns=Columns({**drive.columns, "s": drive["x"], "t": drive["y"]}))
    found = measure(ROAD, among(drive, replace(others, states=gone)), World())
    assert np.isfinite(found.ttc[:8, 0]).all()
    assert np.isinf(found.ttc[8:, 0]).all()
    assert BOX.width < 2


def test_a_car_that_slides_goes_where_it_moves_and_not_where_it_looks() -> None:
    def slides(time: Any) -> Any:
        return 10 + 15 * time, -2 + 0 * time, 0.1 + 0 * time

    # straight on past somebody who stands on the left; with its heading it would come 1.5 m nearer in 1 s
    found = measured(slides, 1.0, car_1=("car", straight(32, 0.7, 0, 0)))
    assert np.isinf(found.conflict).all()
    ahead = measured(slides, 1.0, car_1=("car", straight(32, 0.7, -np.pi / 2, 1.0)))
    assert np.isfinite(ahead.conflict[0, 0])
