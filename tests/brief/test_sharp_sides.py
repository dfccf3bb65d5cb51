"""Sharp sides at skew crossroads, and the lanes of the motorway that a route joins."""

import pytest

from roadgpt.brief.plan import plan as plan_of
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.sharp_sides import with_sharp_side


@pytest.mark.parametrize(
    ("words", "plan", "wanted"),
    [
        ("turn sharp left at the skew crossroads", "crossroads left skew", "crossroads left skew deg=100.."),
        (
            "an der schiefen Kreuzung scharf rechts",
            "crossroads right skew",
            "crossroads right skew deg=100..",
        ),
        ("sharply right", "crossroads right angle=60", "crossroads right angle=60 deg=100.."),
        ("a sharp left bend, left at a skew crossroads", "crossroads left skew", "crossroads left skew"),
        ("sharp right, then left at a skew crossroads", "crossroads left skew", "crossroads left skew"),
        ("turn sharp left at the crossroads", "crossroads left", "crossroads left"),
    ],
)
def test_a_sharp_side_at_a_skew_crossroads(words: str, plan: str, wanted: str) -> None:
    assert with_sharp_side(read_plan(plan), words) == read_plan(wanted)


@pytest.mark.parametrize(
    ("words", "lanes"),
    [
        ("on-ramp onto a three-lane motorway", 3),
        ("join the 2-lane freeway", 2),
        ("Auffahrt auf eine dreispurige Autobahn", 3),
        ("rejoindre une autoroute à deux voies", 2),
        ("me incorporo a una autopista de tres carriles", 3),
        ("entro in un'autostrada a tre corsie", 3),
    ],
)
def test_the_lanes_of_the_motorway_that_is_joined(words: str, lanes: int) -> None:
    brief = ModelReader().read(words)
    assert plan_of(brief) == f"merge ramp // | motorway lanes={lanes}"
