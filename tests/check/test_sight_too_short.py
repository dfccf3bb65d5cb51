"""The rule of stopping sight distance, by the geometry of crests and bends beside walls of earth."""

import math

import numpy as np
import pytest

from network.ruled import all_findings
from roadgpt.brief import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.check import Finding
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, World

EYE, OBJECT = 1.08, 0.60  # m (AASHTO Green Book 3.2.6)
LEVEL = 150.0  # m of even grade before and behind a crest
STOPPING = {50: 65.0, 80: 130.0, 100: 185.0}  # m (the Green Book's table 3-1)


def crest(radius: float, grade: float = 0.06) -> Road:
    """A straight road over a crest of this vertical radius, between equal grades."""
    half = radius * grade
    stations = (0.0, LEVEL, LEVEL + 2 * half, 2 * LEVEL + 2 * half)
    return Road(
        PieceCurve(300.0, 300.0, 0.0, (Piece(stations[-1]),)),
        GradeProfile(10.0, stations, (grade, grade, -grade, -grade)),
    )


def over_a_crest(radius: float) -> float:
    """How far one sees over a crest that is longer than that: the Green Book's formula 3-41."""
    return math.sqrt(2 * radius) * (math.sqrt(EYE) + math.sqrt(OBJECT))


def found(road: Road, speed: int | None, ground: str = "flat") -> tuple[Finding, ...]:
    brief = Brief() if speed is None else read_plan(f"| speed={speed}")
    return all_findings("sight_too_short", road, World().changed(ground=ground, map_size=2400), brief)


@pytest.mark.parametrize("speed", [50, 80, 100])
@pytest.mark.parametrize("share", [0.7, 0.85, 1.15, 1.5])
def test_a_crest_hides_the_road_where_its_radius_is_too_small(speed: int, share: float) -> None:
    radius = (STOPPING[speed] / (math.sqrt(2 * EYE) + math.sqrt(2 * OBJECT))) ** 2 * share**2
    told = found(crest(radius), speed)
    assert bool(told) == (share < 1)
    for finding in told:
        seen = over_a_crest(radius)
        assert f"{speed} km/h needs {STOPPING[speed]:.0f} m, the stopping sight distance" in finding.sentence
        assert finding.s is not None
        top = LEVEL + radius * 0.06
        assert LEVEL - seen <= finding.s <= top
        said = float(finding.sentence.split("sees ")[1].split(" m")[0])
        assert said == pytest.approx(seen, abs=5.0 + 0.05 * seen)  # stations are 5 m apart, 5 cm hide nothing


@pytest.mark.parametrize("scene", ["", "cutting len=200"])
def test_a_cutting_hides_the_road_in_a_bend(scene: str) -> None:
    """At 100 km/h, 185 m are seen past an obstacle 185^2 / (8 R) from the lane (the Green Book's 3.3.12)."""
    length, radius = 500.0, 250.0
    road = Road(
        PieceCurve(300.0, 600.0, 0.0, (Piece(length, -1 / radius, -1 / radius),)),
        GradeProfile.level(length, 10.0),
    )
    world = World().changed(ground="flat", map_size=1200, scene=scene)
    told = all_findings("sight_too_short", road, world, read_plan("| speed=100"))
    assert bool(told) == bool(scene)


def test_nothing_is_asked_without_land_or_a_design_speed() -> None:
    road = crest(60.0)
    assert found(road, None) == ()
    assert (
        all_findings("sight_too_short", road, World().changed(map_size=1200), read_plan("| speed=80")) == ()
    )
    assert len(found(road, 80)) == 1
    assert np.isfinite(found(road, 80)[0].x or np.nan)
