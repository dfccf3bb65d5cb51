"""Who takes the right of way from others or passes a red light, on motions written by hand at crossroads
whose priorities are read off the signs."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from roadgpt.drive import Columns, Drive
from roadgpt.network import Route
from roadgpt.traffic import STEP
from roadgpt.verdict import Verdict, judge
from staged import Motion, among, tracks
from verdict.test_incidents import WORLD, crossroads, driven

V, FRONT, HALF = 10.0, 2.25, 4.7 / 2
LANE = 2.0  # m, from the middle of a road to that of a lane
STRIP = 1.86 / 2 + 1.8 / 2  # half of the widths of the tested car and of another


def passing(route: Route, waits: float = 0.0) -> Drive:
    """Stands for a while and drives straight through with 10 m/s, at 10 + 10 t."""
    time = np.arange(0, 9 + waits, 0.02)
    x = 10 + V * np.maximum(time - waits, 0)
    speed = np.where(time >= waits, V, 0.0)
    drive = driven(route, x, -LANE, 0.0, speed, 0.02)
    return replace(drive, columns=Columns({**drive.columns, "vx": speed, "z": np.full(len(x), 0.56)}))


def moving(x: float, heading: float, at: float, way: Any) -> Motion:
    """Along a lane across, at ``x``; its middle is at y = -2 when ``way(time)`` is that of ``at``."""
    side = np.sign(heading)
    return lambda time: (x + 0 * time, -LANE + side * (way(time) - way(np.array([at]))), heading)


def node(route: Route) -> float:
    return float(route.network.junctions[0].node[0])


def crossing(route: Route, gap: float, heading: float, v: float = V) -> Motion:
    """With an even speed, so that ``gap`` seconds lie between the two in the place that both need; negative
    if the other is first."""
    x = node(route) + LANE * np.sin(heading)
    # the tested car is over the other's strip between these times
    enters, leaves = ((x + side * 0.9 - 10 - side * HALF + 0.1) / V for side in (-1, 1))
    room = (HALF + 0.93) / v
    at = leaves + gap + room if gap >= 0 else enters + gap - room
    return moving(x, heading, at, lambda time: v * time)


def kinds(verdict: Verdict) -> list[str]:
    return [each.kind for each in verdict.incidents or ()]


def judged(route: Route, other: Motion, kind: str = "car", waits: float = 0.0) -> Verdict:
    drive = passing(route, waits)
    return judge(route, among(drive, tracks(drive.duration, it_1=(kind, other))), WORLD)


LEFT, RIGHT = -np.pi / 2, np.pi / 2  # headings of those who come from there


@pytest.mark.parametrize(
    ("control", "heading", "gives_way"),
    [("yield", LEFT, True), ("yield", RIGHT, True), ("priority", LEFT, False), ("priority", RIGHT, False),
     ("none", LEFT, False), ("none", RIGHT, True)],
)  # fmt: skip
def test_only_who_has_priority_by_the_signs_is_denied_it(
    control: str, heading: float, gives_way: bool
) -> None:
    route = crossroads("straight", control)
    for gap, expected in ((0.5, gives_way), (2.0, False), (-0.5, False)):
        found = judged(route, crossing(route, gap, heading))
        assert ("failure to yield" in kinds(found)) is expected, gap
        assert ("near miss" in kinds(found)) is (abs(gap) < 1)
        assert found.kept is not expected
    (it,) = [each for each in judged(route, crossing(route, 0.5, heading)).incidents or ()
             if each.kind == "failure to yield"] or [None]  # fmt: skip
    if gives_way:
        assert it is not None
        assert it.other == "it 1"
        # its front is at the edge of the junction: roads of 8 m and kerbs of 10 m
        assert it.at_s + FRONT == pytest.approx(50.0, abs=0.3)


def test_who_is_no_vehicle_or_far_away_is_denied_nothing() -> None:
    route = crossroads("straight", "yield")
    assert "failure to yield" not in kinds(judged(route, crossing(route, 0.5, LEFT), "adult"))
    behind = moving(node(route) - LANE, LEFT, 20.0, lambda time: V * time)
    assert kinds(judged(route, behind)) == []


@pytest.mark.parametrize(
    ("gap", "hard", "expected"),
    [(1.15, 2.0, False), (1.15, 2.8, False), (1.15, 3.3, True), (1.15, 6.0, True), (2.5, 6.0, False)],
)
def test_who_has_to_brake_abruptly_is_denied_its_priority(gap: float, hard: float, expected: bool) -> None:
    route = crossroads("straight", "yield")
    begins, free = (50 - 10 - FRONT) / V + 0.3, crossing(route, gap, LEFT, 14.0)

    def braking(time: Any) -> Any:
        x, y, heading = free(time)
        slowing = np.clip(time - begins, 0, 1.0)
        return x, y + hard * (slowing**2 / 2 + np.maximum(time - begins - 1.0, 0)), heading

    assert kinds(judged(route, braking)) == ["failure to yield"] * expected
    assert "failure to yield" not in kinds(judged(crossroads("straight", "priority"), braking))


def test_who_stands_at_its_line_is_denied_nothing() -> None:
    route = crossroads("straight", "none")
    stands = moving(node(route) + LANE, RIGHT, 0.0, lambda time: 8 * np.maximum(time - 8, 0))

    def there(time: Any) -> Any:
        x, y, heading = stands(time)
        return x, y - 14, heading

    assert kinds(judged(route, there)) == []


def test_a_collision_with_who_has_priority_is_told_as_not_giving_way() -> None:
    route = crossroads("straight", "yield")
    x = node(route) - LANE
    verdict = judged(route, moving(x, LEFT, (x - 10) / V, lambda time: V * time))
    assert verdict.cause == "failure to yield"
    assert kinds(verdict) == ["failure to yield", "collision"]
    told = "did not give way to it 1 after 48 m: it entered the junction at 36 km/h and "
    assert verdict.description.startswith(told)
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict
    main = crossroads("straight", "priority")
    assert judged(main, moving(x, LEFT, (x - 10) / V, lambda time: V * time)).cause == "collision"


def test_lights_are_red_for_twenty_two_of_forty_seconds(tmp_path: Path) -> None:
    route, red = crossroads("straight", "lights"), list[bool]()
    far = {"it_1": ("car", lambda time: (-500 + 0 * time, 0 * time, 0.0))}
    for waits in range(40):
        drive = passing(route, waits)
        drive = replace(among(drive, tracks(drive.duration, **far)), lights=True)
        verdict = judge(route, drive, WORLD)
        red.append("red light" in kinds(verdict))
        assert verdict.cause == ("red light" if red[-1] else None)
        if red[-1]:
            (found,) = (each for each in verdict.incidents or () if each.kind == "red light")
            assert found.at_s + FRONT == pytest.approx(49.5, abs=0.02)  # a line of 0.5 m next to the junction
            assert verdict.description.startswith("ran a red light after 47 m: it crossed the line at 36 km")
        if waits % 8 == 0:  # twice while they are green, three times while they are red
            assert judge(route, replace(drive, lights=False), WORLD).kept
    # two pairs of arms, each with 15 s of green, 3 of yellow and 2 of red for all: FHWA
    assert sum(red) == 22
    assert np.count_nonzero(np.diff([*red, red[0]])) == 2
    (tmp_path / "drive.npz").write_bytes(drive.to_bytes())
    assert Drive.load(tmp_path / "drive.npz").lights
    assert b"lights" not in json.dumps([*Drive.load(tmp_path / "drive.npz").columns]).encode()
    assert STEP == 0.1
