"""With traffic on the left, a car drives the mirror image of the drive in the mirrored network."""

import numpy as np
import pytest

from network.mirrored import in_mirror
from roadgpt.drive import driver_of, simulate
from roadgpt.network import Route, build_route
from roadgpt.road import World, read_design
from roadgpt.verdict import judge

WORLD = World()
NEAR = 1e-6  # m
STRAIGHT = {"distance": 45, "direction": "straight", "incline": 0, "turn_degrees": 0}
DESIGN = {
    "starting_point": [20, 60, 0],
    "theta": 10,
    "lanes": {"width": 3.5, "forward": 2},
    "road_segment1": STRAIGHT,
    "junction1": {"after": 1, "kind": "crossroads", "take": "left", "control": "stop", "kerb": 9},
    "road_segment2": {"distance": 40, "direction": "right", "incline": 3, "turn_degrees": -40},
}


def routes() -> tuple[Route, Route]:
    left = build_route(read_design({**DESIGN, "left_hand": True})[0], WORLD)
    return left.on_ground(), build_route(read_design(in_mirror(DESIGN))[0], WORLD).on_ground()


@pytest.mark.parametrize("driver", ["reference", "beamng_like"])
def test_a_drive_is_the_mirrored_drive(driver: str) -> None:
    left, right = routes()
    mine, theirs = (simulate(route, WORLD, driver_of(driver), seed=4) for route in (left, right))
    n = len(mine)
    assert n == len(theirs)
    assert np.abs(mine["x"][:n] - theirs["x"][:n]).max() < NEAR
    assert np.abs(mine["y"][:n] + theirs["y"][:n]).max() < NEAR
    assert np.abs(mine["t"][:n] + theirs["t"][:n]).max() < NEAR
    verdicts = judge(left, mine, WORLD), judge(right, theirs, WORLD)
    assert verdicts[0].outcome == verdicts[1].outcome == "PASS"
    assert verdicts[0].margin == pytest.approx(verdicts[1].margin, abs=NEAR)
    assert [each.kind for each in verdicts[0].incidents or ()] == [
        each.kind for each in verdicts[1].incidents or ()
    ]
