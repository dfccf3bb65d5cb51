"""The table of the language: its rows fit each other, and everything that needs a row has one."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import pytest

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import Change, Target
from roadgpt.brief.junctions import JunctionCount, MapClause
from roadgpt.brief.model import Brief, Clause, JunctionClause
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import grammar
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF
from roadgpt.language.__main__ import names
from roadgpt.language.names import ActorKind, WeatherKind
from roadgpt.language.table import (
    MANEUVERS,
    NUMBERS,
    PLACES,
    ROAD_USERS,
    ROADS,
    SURFACES,
    WEATHER,
    one_of,
    several_of,
)
from roadgpt.language.table import (
    PARTS as PARTS_OF_PLANS,
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


def test_the_pages_are_those_of_the_table() -> None:
    script = "import json, runpy, sys; pages = runpy.run_path(sys.argv[1])['PAGES']; "
    script += "print(json.dumps({name: page() for name, page in pages.items()}))"
    command = [sys.executable, "-X", "utf8", "-c", script, str(ROOT / "docs" / "language.py")]
    printed = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True).stdout
    pages = json.loads(printed)
    assert len(pages) > 1
    for name, page in pages.items():
        assert (ROOT / "docs" / name).read_text(encoding="utf-8") == page, "say make docs"


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


THINGS = {
    "clause": (Clause, "{kind} {}"), "road": (Brief, "turn | {}"), "junction": (JunctionClause, "star {}"),
    "map": (MapClause, "map crossroads x2 {}"), "new": (Change, "add {kind} {}"),
    "junctions": (JunctionCount, "map crossroads {}; junction"), "place": (Target, "turn {}: radius less"),
}  # fmt: skip


@pytest.mark.parametrize("thing", THINGS)
def test_every_part_of_a_thing_is_one_of_its_fields(thing: str) -> None:
    model, _ = THINGS[thing]
    fields = {*getattr(model, "model_fields", ()), *getattr(model, "__dataclass_fields__", ()), *dir(model)}
    assert PARTS_OF_PLANS[thing].keys() <= fields
    keys = [part.key for part in PARTS_OF_PLANS[thing].values() if part.key]
    assert len({*keys}) == len(keys)


@pytest.mark.parametrize("thing", THINGS)
def test_what_plans_write_of_a_thing_is_what_they_read(thing: str) -> None:
    _, line = THINGS[thing]
    is_change = thing in ("place", "new")
    read: Callable[[str], Any] = read_change_plan if is_change else read_plan
    write: Callable[[Any], str] = change_plan if is_change else plan
    for part in PARTS_OF_PLANS[thing].values():
        if part.brackets or (thing == "map" and part.key in ("columns", "rows")):
            continue
        before = part.key if part.key in ("", "x") else f"{part.key}="
        for value in part.words or ["3" if part.key == "width" else "75"]:
            said = line.format(f"{before}{value}", kind="straight" if part.of == "straights" else "turn")
            written = write(read(said))
            assert f"{before}{value}" in re.split(r"[ ;:]+", written), said
            assert write(read(written)) == written


def test_what_the_networks_write_has_a_token() -> None:
    for thing, parts in PARTS_OF_PLANS.items():
        for name, part in parts.items():
            if part.token and not part.brackets:
                key = {f"{part.key}="} if part.key not in ("", "x") else set()
                words = {*part.words} if not part.key else set()
                assert key | words <= NUMBER_OF.keys(), (thing, name)


def test_a_row_without_a_token_is_not_written() -> None:
    assert [*grammar.one_of("straight", "sinkhole").first()] == ["straight"]
    assert grammar.allowed((grammar.one_of("sinkhole"),)) == []


def test_what_junctions_have_is_in_a_form_and_has_a_way_to_say_it() -> None:
    for names_ in ROADS["forms"].values():
        assert {*names_} <= PARTS_OF_PLANS["junction"].keys()
    of_plans_only = ROADS["forms_of_plans"]  # the networks write no crosswalk as a place of its own
    assert {name for names_ in of_plans_only.values() for name in names_} <= PARTS_OF_PLANS["junction"].keys()
    forms = {row["form"] for row in ROADS["junctions"].values()}
    assert forms - of_plans_only.keys() == ROADS["forms"].keys()
    for thing in ("road", "junction"):
        silent = {"slope", "surroundings", "motorway", "beside", "size", "skew", "degrees", "exit"}
        assert PARTS_OF_PLANS[thing].keys() - silent <= ROADS["said"][thing].keys()
