"""``roadgpt read``: the Brief as a sentence, a table or JSON, and what was doubtful about it."""

import json
import re

import pytest
from click.testing import CliRunner, Result

from roadgpt.brief import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.cli.app import app
from roadgpt.cli.commands.make import understood
from roadgpt.road import World

WORDS = "two left turns uphill, then a straight of 60 metres"
PLAN = "turn x2 left up; straight len=60"


def _read(*words: str) -> Result:
    return CliRunner().invoke(app, ["read", *words], standalone_mode=False)


def test_a_sentence_says_what_was_read() -> None:
    done = _read(WORDS)
    assert done.output.startswith("I read this as: a road with 2 ")
    assert "60 metres" in done.output


def test_json_holds_the_brief_and_how_sure_the_reader_is() -> None:
    data = json.loads(_read(WORDS, "--json").output)
    assert data["plan"] == PLAN
    brief = Brief.model_validate(data["brief"])
    assert brief.clauses == read_plan(PLAN).clauses
    assert 0 <= data["confidence"] <= 1


def test_a_table_speaks_plain_words() -> None:
    line = "turn x3 left sharp up deg=60; straight down len=80 | len=300"
    lines = _read(line, "--table", "--reader", "plan").output.splitlines()[2:]
    assert [re.split(r"\s{2,}", line.strip()) for line in lines] == [
        ["1", "3 turns", "sharp, uphill, left, 60 degrees"],
        ["2", "straight", "downhill, 80 metres"],
        ["whole road", "300 metres long"],
    ]
    (row,) = _read("| turns=1..", "--table", "--reader", "plan").output.splitlines()[2:]
    assert row.split(maxsplit=2) == ["whole", "road", "nothing is asked of it"]


def test_a_list_of_readings_gives_each_its_chance_and_warns_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def readings(*chances: float) -> list[str]:
        briefs = [
            read_plan(f"turn x{n}").model_copy(update={"confidence": c}) for n, c in enumerate(chances, 1)
        ]
        monkeypatch.setattr("roadgpt.brief.alternatives", lambda *asked: tuple(briefs))
        return _read("some turns", "--alternatives", "4").output.splitlines()

    said = readings(0.42, 0.31, 0.012, 0.004)
    assert said[:3] == [
        "1.  42 %  a road with a turn",
        "2.  31 %  a road with 2 turns",
        "3.   1 %  a road with 3 turns",
    ]
    assert said[3:] == ["not sure of any: if none is what you mean, say it in other words"]
    assert readings(0.97, 0.004) == ["1.  97 %  a road with a turn", "no other reading has a chance of 1 %"]
    assert readings(0.004)[0] == "1.   0 %  a road with a turn", "the likeliest one in any case"
    said = readings(0.9, 0.6)
    assert [int(line.split()[1]) for line in said[:2]] == [60, 40], "of readings one at most is meant"


def test_a_plan_has_one_reading() -> None:
    done = _read("| turns=1..", "--alternatives", "3", "--reader", "plan", "--json")
    assert len(json.loads(done.output)) == 1


def test_the_second_reading_is_shown_with_its_plan() -> None:
    brief = read_plan("turn x3").model_copy(update={"confidence": 0.4, "other": "turn x2; hairpin"})
    told = understood(brief, World(), World())
    assert "it could also mean: a road with 2 turns, then a hairpin" in told
    assert "--plan 'turn x2; hairpin'" in told
    assert "also mean" not in understood(read_plan("turn x3"), World(), World())
