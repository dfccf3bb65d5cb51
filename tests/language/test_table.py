"""The table of the language: its rows fit each other, and everything that needs a row has one."""

import re
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from roadgpt.language.__main__ import names
from roadgpt.language.names import ActorKind, WeatherKind
from roadgpt.language.table import (
    MANEUVERS,
    NUMBERS,
    PLACES,
    ROAD_USERS,
    SURFACES,
    WEATHER,
    one_of,
    several_of,
)
from roadgpt.report.others import COLOURS
from roadgpt.scene.bodies import PARTS

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "src" / "roadgpt" / "report" / "view" / "page" / "others.js"


def test_the_types_are_those_of_the_table() -> None:
    written = (ROOT / "src" / "roadgpt" / "language" / "names.py").read_text(encoding="utf-8")
    assert written == names(), "say python -m roadgpt.language"
    assert get_args(ActorKind) == (*ROAD_USERS,)
    assert get_args(WeatherKind) == (*WEATHER,)


def test_the_page_is_that_of_the_table() -> None:
    script = "import runpy, sys; print(runpy.run_path(sys.argv[1])['page'](), end='')"
    command = [sys.executable, "-X", "utf8", "-c", script, str(ROOT / "docs" / "language.py")]
    printed = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True).stdout
    assert (ROOT / "docs" / "reference" / "road-users.md").read_text(encoding="utf-8") == printed, (
        "say make docs"
    )


@pytest.mark.parametrize("kind", ROAD_USERS)
def test_a_road_user_is_as_what_it_is_read_as(kind: ActorKind) -> None:
    row = ROAD_USERS[kind]
    if row.read_as is not None:
        known = ROAD_USERS[row.read_as]
        assert (known.group, known.read_as) == (row.group, None)  # so every scene that is read can be had
        assert row.words or row.unseen
    assert row.pull is not None or row.group in ("person", "thing")
    assert 0.05 < min(row.size) < max(row.size) < 30
    assert 0.1 < row.mass < 45_000


def test_everybody_can_be_drawn() -> None:
    script = PAGE.read_text(encoding="utf-8")
    looks = {row.look for row in ROAD_USERS.values()}
    drawn = {*re.findall(r"^  (\w+)\(\{", script, re.MULTILINE), "car"}
    assert looks <= drawn
    assert looks == {*PARTS}
    assert {row.key for row in ROAD_USERS.values()} == {*COLOURS}
    assert all(re.fullmatch(r"(#[0-9a-f]{6})?", row.paint) for row in ROAD_USERS.values())


def test_rows_name_rows() -> None:
    for maneuver in MANEUVERS.values():
        assert {*maneuver.numbers} <= {*NUMBERS}
        assert {*maneuver.starts} <= {*PLACES}
    for number in NUMBERS.values():
        assert {*number.where} <= {*PLACES}
        assert number.least < number.most
    assert len({number.key for number in NUMBERS.values()}) == len(NUMBERS)
    for air, row in WEATHER.items():
        assert row.least <= row.usual[0] < row.usual[1] <= row.most
        assert bool(row.falls) != bool(row.tint), f"{air} falls, or hides what is far"
        assert row.surface is None or row.surface in SURFACES
        assert row.read_as is None or bool(WEATHER[row.read_as].falls) == bool(row.falls)


def test_one_and_several_are_english() -> None:
    said = {kind: (one_of(kind), several_of(kind)) for kind in ROAD_USERS}
    assert said["adult"] == ("an adult", "adults")
    assert said["bus"] == ("a bus", "buses")
    assert said["deer"] == ("a deer", "deer")
    assert said["cones"] == ("cones", "cones")
    assert said["e_scooter"] == ("an e-scooter", "e-scooters")
    assert said["articulated_lorry"] == ("an articulated lorry", "articulated lorries")
    assert said["person_with_pushchair"] == ("a person with a pushchair", "persons with pushchairs")
