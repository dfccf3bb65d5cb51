"""Verdicts of drives among others: who hit whom, where, how fast, and whose fault it was, worked out on
paper."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from roadgpt.campaign.columns import features_in
from roadgpt.campaign.model import Proposal
from roadgpt.campaign.single_test import Task, result_of
from roadgpt.cli.screen import row_of
from roadgpt.drive import Columns, Drive
from roadgpt.errors import UsageError
from roadgpt.network import Route
from roadgpt.road import Limits, Profile, Road, World
from roadgpt.run import Request, Run, Setup
from roadgpt.traffic import Tracks
from roadgpt.verdict import Cause, Incident, Verdict, judge
from roadgpt.verdict.contact import contacts_of
from roadgpt.verdict.criteria import limits_at
from roadgpt_search.faults.failures import manner_of, reason_of
from staged import among, driven, level, straight, tracks
from verdict.test_incidents import WORLD as ROUTE_WORLD
from verdict.test_incidents import crossroads
from verdict.test_incidents import driven as on_route

ROAD = level(0, 300)
WORLD = World(limits=Limits(speed_limit=30.0))
HALF = 4.7 / 2


def scene(own: Any, duration: float = 8.0, ended: str = "goal", **others: Any) -> Drive:
    return among(driven(own, duration, ROAD, ended), tracks(duration, **others))


def kinds(verdict: Verdict) -> list[str]:
    return [each.kind for each in verdict.incidents or ()]


def only(drive: Drive) -> Incident:
    (found,) = contacts_of(drive)
    return found


def test_a_rear_end_collision_is_told_with_everything() -> None:
    # 30 m from the middle of one to that of the other, 15 against 5 m/s; half of the lengths: 2.35 + 3.25 m
    drive = scene(straight(10, -2.0, 0, 15), van_1=("van", straight(40, -3.0, 0, 5)))
    found = only(drive)
    assert found.at_time == pytest.approx((30 - HALF - 3.25) / 10, abs=1e-3)
    contact = found.contact
    assert contact is not None
    assert (found.other, contact.face, contact.other_face) == ("van 1", "front", "rear")
    assert contact.nuplan_at_fault
    assert (contact.speed, contact.other_speed, contact.impact_speed) == pytest.approx((15, 5, 10), abs=2e-3)
    # the car covers -2.93 to -1.07, the van -4.08 to -1.92
    assert contact.overlap == pytest.approx((2.93 - 1.92) / 1.86)
    assert contact.xy == pytest.approx((10 + 15 * found.at_time + HALF, -(2.93 + 1.92) / 2), abs=1e-2)
    verdict = judge(ROAD, drive, WORLD)
    assert (verdict.outcome, verdict.cause, verdict.first_contact) == ("FAIL", "collision", contact)
    assert verdict.description == (
        "hit van 1 after 47 m at 54 km/h: its front met the rear of van 1, at 18 km/h, with 36 km/h of "
        "difference and 54 % overlap; at fault; avoidable by any of four drivers: "
        "careful driver avoids it, Reg157 avoids it, FSM avoids it, RSS avoids it"
    )
    assert (verdict.at_s, verdict.at_xy, verdict.at_time) == (found.at_s, found.at_xy, found.at_time)
    assert verdict.sbft_description == "Car collided"
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict


def aside(time: Any) -> tuple[Any, Any, Any]:
    """Sideways to the left, without turning."""
    return 20 + 9 * time, -2 + time, np.zeros_like(time)


@pytest.mark.parametrize(
    ("own", "kind", "other", "faces", "fault"),
    [
        (straight(50, -2, 0, 5), "car", straight(30, -2, 0, 15), ("rear", "front"), False),  # from behind
        (straight(50, -2, 0, 0), "car", straight(90, -2, np.pi, 9), ("front", "front"), False),  # it stands
        (straight(10, -2, 0, 9), "car", straight(60, -2, np.pi / 2, 0), ("front", "left"), True),  # it stands
        (straight(10, -2, 0, 9), "adult", straight(55, -6, np.pi / 2, 0.9), ("front", "left"), True),
        (straight(10, -2, 0, 9), "bicycle", straight(55, -12, np.pi / 2, 2.2), ("front", "left"), True),
        # into its side, within its lane, and while it goes aside, partly outside; at more than 20 degrees a
        # corner is of the front, and at less two sides meet, whichever corner touches first
        (straight(20, -2, 0, 9), "car", straight(18, -6, 0.4, 9.8), ("right", "front"), False),
        (straight(20, -2, 0, 9), "car", straight(18, -5, 0.1, 9.05), ("right", "left"), False),
        (straight(20, -2, 0, 14), "car", straight(20.2, 1, -0.16, 14.2), ("left", "right"), False),
        (aside, "car", straight(22, 2.0, 0, 9), ("left", "right"), True),
        (straight(20, -2, -0.1, 9.05), "car", straight(22, -5.2, 0, 9), ("right", "left"), True),
        (straight(60, -2, np.pi, -9), "barrier", straight(90, -2, 0, 0), ("rear", "rear"), True),  # backwards
    ],
)  # fmt: skip
def test_faces_and_faults(own: Any, kind: str, other: Any, faces: tuple[str, str], fault: bool) -> None:
    found = only(scene(own, it=(kind, other))).contact
    assert found is not None
    assert found.face == faces[0]
    if kind not in ("adult", "bicycle"):  # their corner may be the first to touch
        assert found.other_face == faces[1]
    assert found.nuplan_at_fault == fault
    assert (found.overlap is None) == (found.face != "front")


def test_a_collision_that_nobody_could_avoid_is_no_failure() -> None:
    verdict = judge(ROAD, scene(straight(50, -2, 0, 5), car_2=("car", straight(30, -2, 0, 15))), WORLD)
    assert (verdict.outcome, verdict.cause) == ("UNAVOIDABLE", "collision")
    told = "was hit by car 2 after 58 m at 18 km/h: its rear met the front of car 2, "
    assert verdict.description.startswith(told)
    assert "; not at fault; not avoidable by any of four drivers: careful driver coll" in verdict.description


def test_who_reverses_into_somebody_who_stands_hits_that_one() -> None:
    own = straight(80, -2, 0, -3)
    verdict = judge(ROAD, scene(own, car_2=("car", straight(65, -2, 0, 0))), WORLD)
    assert verdict.description.startswith("hit car 2 after")
    assert "its rear met the front of car 2, standing" in verdict.description


def test_two_contacts_are_counted_and_the_first_one_is_the_cause() -> None:
    others = {f"cones_{n}": ("cones", straight(60.0 + 20 * n, -2, 0, 0)) for n in range(3)}
    verdict = judge(ROAD, scene(straight(10, -2, 0, 15), **others), WORLD)
    assert [each.other for each in verdict.incidents or ()] == ["cones 0", "cones 1", "cones 2"]
    assert (
        "; at fault; 3 times in all; avoidable by any of four drivers: careful driver stops "
        in verdict.description
    )
    assert "standing" in verdict.description


def leaves(time: Any) -> tuple[Any, Any, Any]:
    """To the left from the lane's middle, with 2 m/s; half of the car is outside where its middle is at 0."""
    y = np.clip(-2 + 2 * (time - 2), -2, 3)
    return 10 + 14 * time, y, np.zeros_like(time)


def test_a_contact_within_three_seconds_stands_in_the_same_sentence() -> None:
    drive = scene(leaves, van_1=("van", straight(80, 2.5, np.pi, 0)))
    verdict = judge(ROAD, drive, WORLD)
    assert (verdict.cause, verdict.side) == ("out of lane", "left")
    assert verdict.at_time == pytest.approx(3.01, abs=0.011)
    # it reaches the van, at 76.75 m, at 4.6 s; then it covers 2.07 to 3.93 m, the van 1.42 to 3.58 m
    assert verdict.description == (
        "left its lane to the left after 52 m at 51 km/h and hit van 1 1.6 s later at 50 km/h: its front met "
        "the front of van 1, standing, with 50 km/h of difference and 81 % overlap; at fault; more than half "
        "of the car was outside"
    )
    assert kinds(verdict) == ["out of lane", "collision"]
    # 60 m later it is a matter of its own
    late = judge(ROAD, scene(leaves, van_1=("van", straight(120, 2.5, np.pi, 0))), WORLD)
    assert late.cause == "out of lane"
    assert "hit" not in late.description
    assert "; a contact once, after 114 m" in late.description


def test_the_earliest_cause_is_first() -> None:
    # it hits the cones first and leaves its lane then
    verdict = judge(ROAD, scene(leaves, cones_1=("cones", straight(30, -2, 0, 0))), WORLD)
    assert verdict.cause == "collision"
    assert "; out of its lane once, after 52 m" in verdict.description
    # without others it is out of lane, as ever
    assert judge(ROAD, driven(leaves, 8, ROAD), WORLD).incidents is None


def test_others_far_away_change_nothing_but_the_list() -> None:
    drive = driven(straight(10, -2, 0, 15), 8, ROAD)
    with_them = judge(ROAD, among(drive, tracks(8, car_1=("car", straight(10, 2, np.pi, 5)))), WORLD)
    assert with_them.incidents == ()
    assert replace(with_them, incidents=None) == judge(ROAD, drive, WORLD)


def test_nobody_at_all_is_nobody() -> None:
    drive = driven(straight(10, -2, 0, 15), 8, ROAD)
    with_none = judge(ROAD, among(drive, Tracks((), np.empty((81, 0, 5)))), WORLD)
    assert replace(with_none, incidents=None) == judge(ROAD, drive, WORLD)


def test_near_misses() -> None:
    # crosses 0.5 s before the car, which needs 1.86 m: PET
    def crosses(early: float) -> Any:
        reached = (60 - 0.3 - 10 - HALF) / 15
        # its rear, 0.3 m behind its middle, leaves the strip at -1.07, with 2 m/s to the left
        return lambda time: (60 + 0 * time, -1.07 + 0.3 + 2 * (time - reached + early), np.pi / 2)

    for early, missed in ((0.5, True), (0.9, True), (1.2, False)):
        verdict = judge(ROAD, scene(straight(10, -2, 0, 15), adult_1=("adult", crosses(early))), WORLD)
        assert verdict.kept
        assert kinds(verdict) == (["near miss"] if missed else [])
        if missed:
            assert [each.other for each in verdict.incidents or ()] == ["adult 1"]
            assert "; a near miss once, after " in verdict.description

    def brakes(most: float) -> Any:
        """Approaches somebody who stands 60 m ahead and stops 1 m behind him."""
        way = 60 - 2 * HALF - 1
        v = np.sqrt(2 * most * way)

        def motion(time: Any) -> Any:
            t = np.minimum(time, v / most)
            return 10 + v * t - most * t**2 / 2, -2.0 + 0 * time, 0 * time

        return motion

    # the time to collision, (1 + v^2 / 2b) / v, is sqrt(2 / b) at least: below 0.95 s from b = 2.2 m/s2
    for hard, missed in ((1.5, False), (6.0, True)):
        drive = scene(brakes(hard), 15.0, car_1=("car", straight(70, -2, 0, 0)))
        assert kinds(judge(ROAD, drive, WORLD)) == (["near miss"] if missed else [])


def test_an_oncoming_car_in_its_own_lane_is_no_near_miss() -> None:
    bend = Road.through([[30 * np.sin(a), 30 - 30 * np.cos(a)] for a in np.linspace(0, 3, 30)])

    def around(radius: float, speed: float, begin: float) -> Any:
        turn = speed / radius
        return lambda time: (
            radius * np.sin(begin + turn * time),
            30 - radius * np.cos(begin + turn * time),
            begin + turn * time + (np.pi if speed < 0 else 0),
        )

    def other(time: Any) -> Any:
        x, y, heading = around(28, -8, 2.8)(time)
        return x, y, heading

    drive = among(driven(around(32, 8, 0.1), 8, bend), tracks(8, car_1=("car", other)))
    assert kinds(judge(bend, drive, WORLD)) == []


def test_blocked_only_with_a_free_way_ahead() -> None:
    def waits(time: Any) -> Any:
        return 10 + 10 * np.minimum(time, 2) + 10 * np.maximum(time - 33, 0), -2 + 0 * time, 0 * time

    for gap, expected in ((12.0, ["blocked"]), (8.0, [])):
        drive = scene(waits, 40.0, car_1=("car", straight(30 + gap + 2 * HALF, -2, 0, 0)))
        found = judge(ROAD, drive, WORLD)
        assert [kind for kind in kinds(found) if kind == "blocked"] == expected
        oncoming = scene(waits, 34.0, car_1=("car", straight(32 + 2 * HALF, 2, np.pi, 0)))
        assert kinds(judge(ROAD, oncoming, WORLD)) == ["blocked"]


def test_who_stays_behind_somebody_of_a_scene_has_passed_and_else_is_stuck() -> None:
    def stops(time: Any) -> Any:
        return 10 + 10 * np.minimum(time, 2), -2 + 0 * time, 0 * time

    def judged(gap: float, side: float, words: str) -> Verdict:
        other = straight(30 + gap + 2 * HALF, side, 0, 0)
        drive = scene(stops, 130.0, ended="stuck", car_1=("car", other))
        return judge(ROAD, drive, WORLD.changed(scene=words))

    for words in ("car ahead v=0", "car ahead v=0; oncoming light"):
        passed = judged(3.0, -2, words)
        assert passed.outcome == "PASS"
        assert "for 30 m and stayed 3.0 m behind car 1, which stands" in passed.description
    for gap, side, words in ((12.0, -2, "car ahead v=0"), (3.0, 2, "car oncoming"), (3.0, -2, "light")):
        found = judged(gap, side, words)
        assert (found.outcome, found.cause) == ("FAIL", "stuck")
        assert "moved less than 1 m in 120 s" in found.description


def test_speeding_takes_five_percent_one_metre_per_second_and_a_second() -> None:
    far = {"car_1": ("car", straight(0, 300, 0, 0))}
    for limit, speed, seconds, expected in (
        (20.0, 21.2, 2.0, 1), (20.0, 20.9, 2.0, 0), (10.0, 10.8, 2.0, 0), (10.0, 11.2, 2.0, 1), (10.0, 11.2,
        0.9, 0),
    ):  # fmt: skip
        drive = scene(straight(10, -2, 0, 8), **far)
        fast = np.where((drive["time"] > 3) & (drive["time"] <= 3 + seconds), speed, 8.0)
        drive = replace(drive, columns=Columns({**drive.columns, "speed": fast}))
        found = judge(ROAD, drive, World(limits=Limits(speed_limit=limit)))
        assert found.kept
        assert kinds(found) == ["speeding"] * expected


def test_tables_and_reasons_say_who_was_at_fault() -> None:
    drives = {
        fault: scene(straight(50, -2, 0, own), car_2=("car", straight(30 if own < 9 else 90, -2, 0, its)))
        for fault, own, its in ((True, 15, 5), (False, 5, 15))
    }
    for fault, drive in drives.items():
        verdict = judge(ROAD, drive, WORLD)
        request = Request(words="", world=WORLD, seed=1, setup=Setup())
        run = Run(
            request=request, index=1, seed=1, road=ROAD, drive=drive, verdict=verdict,
            outcome=verdict.outcome, description=verdict.description,
        )  # fmt: skip
        row = row_of(run)
        assert row.outcome == ("FAIL (collision)" if fault else "UNAVOIDABLE")
        braked = replace(row, test_outcome="FAIL")
        assert braked.outcome == ("FAIL (collision)" if fault else "FAIL (collision, not at fault)")
        assert json.loads(row.to_json())["at_fault"] is fault
        features = features_in(run)
        assert (features["COLLISIONS"], features["AT_FAULT"]) == (1, fault)
        assert features["IMPACT"] == pytest.approx(36, abs=0.05)
        stored = result_of(run, Task(1, 0, Proposal(None, 1, "draft")), features)
        assert row_of(stored).outcome == row.outcome
        if fault:
            assert reason_of(run).sentence == verdict.description
        else:
            with pytest.raises(UsageError, match="did not fail"):
                reason_of(run)
        alone = replace(
            run, drive=replace(drive, others=None), verdict=judge(ROAD, driven(leaves, 8, ROAD), WORLD)
        )
        assert "AT_FAULT" not in features_in(alone)
        assert "at_fault" not in row_of(alone).to_json()


def test_on_a_route_the_earliest_cause_is_first_and_limits_are_those_of_its_lanes() -> None:
    route = crossroads("straight", "stop")
    x = np.arange(20.0, 110.0, 0.2)  # 10 m/s, without a stop at the line that ends at 50 m
    drive = on_route(route, x, -2.0, dt=0.02)
    drive = replace(
        drive, columns=Columns({**drive.columns, "vx": np.full(len(x), 10.0), "z": np.full(len(x), 0.56)})
    )
    node = float(route.network.junctions[0].node[0])
    crosses = straight(node, 20.0, -np.pi / 2, 20 / ((node - 20) / 10))
    verdict = judge(route, among(drive, tracks(9.0, car_1=("car", crosses))), ROUTE_WORLD)
    assert verdict.cause == "stop line"
    assert kinds(verdict)[:2] == ["stop line", "collision"]
    # from the left, so that its front comes when the middle of the tested car is there
    told = "did not stop at the stop sign after 47 m: it crossed the line at 36 km/h and was hit by car 1 "
    assert verdict.description.startswith(told)
    assert " s later at 36 km/h: its left side met the front of car 1, " in verdict.description
    # somebody in the way before the line comes first
    first = tracks(9.0, cones_1=("cones", straight(35, -2, 0, 0)), car_1=("car", crosses))
    verdict = judge(route, among(drive, first), ROUTE_WORLD)
    assert verdict.cause == "collision"
    assert "; 2 times in all; no stop at a stop sign once, after 47 m" in verdict.description
    far = among(drive, tracks(9.0, car_1=("car", straight(0, 300, 0, 0))))
    limits = limits_at(route, ROUTE_WORLD, far["s"])
    assert set(limits) == {ROUTE_WORLD.limits.speed_limit}
    last = route.legs[-1].road
    slow = [
        replace(each, road=each.road.with_profile(slower(each.profile))) if each.id == last else each
        for each in route.network.roads
    ]
    changed = Route.along(replace(route.network, roads=tuple(slow)), route.legs)
    limits = limits_at(changed, ROUTE_WORLD, far["s"])
    np.testing.assert_array_equal(limits == 5.0, far["s"] >= route.starts[-2])
    assert "speeding" in kinds(judge(changed, far, ROUTE_WORLD))


def slower(profile: Profile) -> Profile:
    left, right = (
        tuple(replace(lane, speed_limit=5.0) for lane in side) for side in (profile.left, profile.right)
    )
    return replace(profile, left=left, right=right)


@pytest.mark.parametrize("cause", ["red light", "failure to yield", "stop line", "collision"])
def test_a_broken_rule_is_no_matter_of_the_bend_where_it_was_broken(cause: Cause) -> None:
    bend = Road.through([[20, 100], [60, 100], [90, 120], [100, 150], [100, 190]])
    assert manner_of(bend, WORLD, 60.0, "out of lane", "right").radius is not None
    assert manner_of(bend, WORLD, 60.0, cause, None).radius is None
