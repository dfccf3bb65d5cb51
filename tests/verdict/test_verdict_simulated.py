"""Verdicts on drives of the real simulator: they agree with how it ended, whoever drove."""

import math
from typing import Any

import pytest

from roadgpt.drive import Command, View, simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.pure_pursuit import PurePursuit
from roadgpt.drive.drivers.reference import Reference
from roadgpt.road import CrossSection, Design, Limits, Road, Segment, Site, World, build
from roadgpt.verdict import judge


class NeverSteers:
    def steer(self, view: View) -> Command:
        return Command(0.0, 0.3)


def road_of(*bends: tuple[float, float]) -> Road:
    """A straight, then bends of so many degrees and metres of radius, 20 m apart."""
    straight = Segment(distance=25, direction="straight", incline=4)
    segments = [straight]
    for degrees, radius in bends:
        turn: Any = {"direction": "left" if degrees > 0 else "right", "turn_degrees": degrees}
        length = abs(math.radians(degrees)) * radius * 1.25
        segments += [Segment(distance=length, incline=4, **turn), straight]
    return build(Design(starting_point=(100, 100, 0), theta=200, segments=tuple(segments)))


ROADS = [road_of((60, 30), (-50, 25)), road_of((-65, 16), (-40, 40))]
WORLDS = [
    World(),
    World(section=CrossSection(shoulder=0.0), site=Site(friction=0.5)),
    World(limits=Limits(oob_tolerance=0.5)),
]
CAUSE = {"goal": None, "out_of_lane": "out of lane", "fell": "fell", "stuck": "stuck", "timeout": "timeout"}


@pytest.mark.parametrize("driver", [BeamngLike, PurePursuit, Reference, NeverSteers])
def test_the_verdict_agrees_with_how_the_drive_ended(driver: type[Any]) -> None:
    for road in ROADS:
        for world in WORLDS:
            drive = simulate(road, world, driver())
            verdict = judge(road, drive, world)
            assert verdict.cause == CAUSE[drive.ended]
            assert verdict.kept == (drive.ended == "goal")
            assert (verdict.margin < 0) == (drive.ended in ("out_of_lane", "fell"))
            counts = len(drive) - (drive.ended in ("goal", "stuck"))
            assert verdict.max_oob == drive["outside"][:counts].max()
            assert verdict.oob_counter == (1 if drive.ended == "out_of_lane" else 0)
            if drive.ended == "out_of_lane":  # it ended at the first step outside, where it hardly is outside
                assert verdict.at_s == drive["s"][-1]
                assert (drive["outside"][:-1] <= world.limits.oob_tolerance).all()
                assert verdict.margin > -0.3
            if driver is NeverSteers:
                assert verdict.side == ("right" if road is ROADS[0] else "left") or drive.ended == "fell"


def test_the_reference_keeps_its_lane_where_a_car_can() -> None:
    for road in ROADS:
        for world in (
            World(limits=Limits(speed_limit=40 / 3.6), section=CrossSection(shoulder=0)),
            World(section=CrossSection(shoulder=0)),
            World(site=Site(friction=0.35)),
        ):
            verdict = judge(road, simulate(road, world, Reference()), world)
            assert verdict.kept
            # of the 2 m from the middle of its lane to the edge, it uses at most 0.2 m where there is a verge
            assert verdict.margin > (0.7 if world.section.shoulder == 0 else 1.8)
