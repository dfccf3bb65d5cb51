"""``roadgpt read``: the Brief as a sentence, a table or JSON, and what was doubtful about it."""

import json

from click.testing import CliRunner, Result

from roadgpt.brief import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.cli.app import app
from roadgpt.cli.work import understood

WORDS = "two left turns uphill, then a straight of 60 metres"
PLAN = "turn x2 left up; straight len=60"


def _read(*words: str) -> Result:
    return CliRunner().invoke(app, ["read", *words], standalone_mode=False)


def test_a_sentence_says_what_was_read() -> None:
    done = _read(WORDS)
    assert done.output.startswith("I read this as: a road with 2 ")
    assert "60 metres" in done.output


def test_json_holds_the_brief_and_how_sure_the_reader_is() -> None:
    data = json.loads(_read(WORDS, "--json", "--reader", "grammar").output)
    assert data["plan"] == PLAN
    brief = Brief.model_validate(data["brief"])
    assert brief.clauses == read_plan(PLAN).clauses
    assert 0 <= data["confidence"] <= 1


def test_a_table_has_a_row_for_each_thing() -> None:
    lines = _read(WORDS + ", the whole road 200 m long", "--table", "--reader", "grammar").output.splitlines()
    cells = [line.split(maxsplit=2) for line in lines[1:]]
    assert cells[0] == ["what", "how"]
    assert [cell[0] for cell in cells[1:]] == ["1", "2", "whole"]


def test_vague_words_have_several_readings_and_the_same_ones_again() -> None:
    many = [_read("some road with bends", "--alternatives", "4", "--json").output for _ in range(2)]
    assert many[0] == many[1]
    plans = [reading["plan"] for reading in json.loads(many[0])]
    assert 2 <= len(plans) == len({*plans}) <= 4


def test_rules_know_one_reading() -> None:
    done = _read("a road", "--alternatives", "3", "--reader", "grammar", "--json")
    assert len(json.loads(done.output)) == 1


def test_doubt_and_words_that_were_not_used_are_said() -> None:
    brief = read_plan("turn x3")
    assert "not sure" not in understood(brief)
    doubtful = brief.model_copy(update={"confidence": 0.4, "unused": ("purple",)})
    assert "not understood: 'purple'" in understood(doubtful)
    assert "not sure of this (40 %)" in understood(doubtful)


def test_what_is_no_road_is_told() -> None:
    done = _read("what time is it in Paris")
    assert done.exception is not None
    assert "road" in str(done.exception)


def test_options_of_designers_are_none_of_reading() -> None:
    for option in ("--repair", "--strategy"):
        done = CliRunner().invoke(app, ["read", WORDS, option, "full"])
        assert done.exit_code == 2
