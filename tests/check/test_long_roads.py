"""The largest roads that there are, 50 km, are checked soon and in little memory."""

import math
import time
import tracemalloc

import pytest

from network.ruled import findings
from roadgpt.check import inspect
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, Site, World
from roadgpt_sbft.validator import sbft_verdict

WORLD = World(site=Site(map_size=10_000))
SECONDS, BYTES = 2.0, 200_000_000


def to_and_fro() -> list[Piece]:
    out = []
    for row in range(5):
        bend = (1 if row % 2 == 0 else -1) / 200
        out += [Piece(9_000.0), Piece(math.pi * 200, bend, bend)]
    return out


ROADS = {
    "straight": ([Piece(49_990.0)], False),
    "to and fro": (to_and_fro(), False),
    "round and round": ([Piece(49_000.0, 1 / 15, 1 / 15)], True),
    "back over its start": ([*to_and_fro()[:-1], Piece(300.0, 0.015, 0.015), Piece(1_000.0)], True),
}


@pytest.mark.parametrize("name", ROADS)
def test_overlap_is_found_or_ruled_out_soon_and_in_little_memory(name: str) -> None:
    pieces, overlaps = ROADS[name]
    plan = PieceCurve(300.0, 300.0, 0.0, tuple(pieces))
    road = Road(plan, GradeProfile(0.0, (0.0, plan.length), (0.0, 0.0)))
    begun = time.process_time()
    found = findings("no_overlap", road, WORLD)
    assert time.process_time() - begun < SECONDS  # 0.04 s on the machine it was written on
    assert bool(found) == overlaps
    if name not in ("to and fro", "round and round"):  # what it takes is counted slowly
        return
    tracemalloc.start()
    inspect(Road(plan, road.elevation), None, WORLD)
    sbft_verdict(road.control_points(), WORLD.site.map_size)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < BYTES
