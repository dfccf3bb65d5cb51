"""`roadgpt` without a command: a conversation that survives every answer."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt import plugins
from roadgpt.brief import AnotherRoadError, Brief
from roadgpt.brief.plan import read_plan
from roadgpt.campaign import single_test
from roadgpt.cli import app
from roadgpt.cli.commands import make

QUICK = {"no_drive": True, "no_plot": True}


@pytest.fixture(autouse=True)
def quick_and_in_an_empty_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = make.usual_values
    monkeypatch.setattr(make, "usual_values", lambda *asked, **more: usual(*asked, **more) | QUICK)


def say(*answers: str) -> Result:
    result = CliRunner().invoke(app, [], input="".join(f"{answer}\n" for answer in answers))
    assert "Traceback" not in result.output
    return result


@pytest.mark.parametrize("answers", [["exit"], ["quit"], [""], [], ["a road", "exit"]])
def test_it_can_be_left_at_any_question(answers: list[str]) -> None:
    result = say(*answers)
    assert result.exit_code == 0
    assert "Describe a road" in result.stdout
    assert not Path("roadgpt-runs").exists()


def test_it_goes_on_from_one_description_to_the_next() -> None:
    result = say("an uphill road with 3 turns", "2", "", "a flat road", "", "", "exit")
    assert result.exit_code == 0
    assert "2 of 2 roads" in result.stdout
    assert "3 of 3 roads" in result.stdout
    assert len([*Path("roadgpt-runs").iterdir()]) == 2


@pytest.mark.parametrize("word", ["help", "?", "HELP"])
def test_help_is_given_at_either_question_and_is_no_description(word: str) -> None:
    result = say(word, "a road", word, "1", "", "exit")
    assert result.exit_code == 0
    assert result.stdout.count("'roadgpt run' takes options") == 2
    assert "1 of 1 roads" in result.stdout
    assert result.stderr == ""


def test_of_two_readings_the_person_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    doubtful = read_plan("turn x2 left").model_copy(update={"confidence": 0.3, "other": "turn x2 right"})
    monkeypatch.setattr("roadgpt.brief.read", lambda words, **_: doubtful)
    result = say("two bends", "2", "1", "", "two bends", "", "exit")
    assert result.exit_code == 0
    assert "1  a road with 2 left turns" in result.stdout
    assert "2  a road with 2 right turns" in result.stdout
    assert "I read this as: a road with 2 right turns" in result.stdout
    assert "1 of 1 roads" in result.stdout
    assert len([*Path("roadgpt-runs").iterdir()]) == 1  # an empty answer makes nothing


def test_another_road_is_offered(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(words: str, **_: object) -> Brief:
        raise AnotherRoadError(
            "this cannot be; the road without it", "turn x2 left", read_plan("turn x2 left")
        )

    monkeypatch.setattr("roadgpt.brief.read", refused)
    result = say("two lefts and a junction", "", "two lefts and a junction", "1", "1", "", "exit")
    assert result.exit_code == 0
    assert "this cannot be; the road without it: a road with 2 left turns" in result.stdout
    assert "1 of 1 roads" in result.stdout
    assert len([*Path("roadgpt-runs").iterdir()]) == 1  # an empty answer makes nothing


def test_a_wrong_answer_is_asked_again() -> None:
    result = say("a road", "none", "0", "1", "", "a hat", "exit")
    assert result.exit_code == 0
    assert "'none' is no whole number" in result.stderr
    assert "0 is not possible" in result.stderr
    assert "1 of 1 roads" in result.stdout
    assert result.stderr.count("roadgpt: ") == 3


def test_control_c_stops_the_roads_and_not_the_conversation(monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(single_test, "drafted", stopped)
        result = say("a road", "3", "exit")
    assert result.exit_code == 0
    assert "roadgpt: stopped; 0 of 3 roads are finished" in result.stderr


def test_roads_that_were_made_can_be_changed_one_after_another() -> None:
    result = say(
        "an uphill road with 3 turns",
        "2",
        "2: make the last turn sharper",
        "paint it blue",
        "2: make the last turn gentler",
        "",
        "a straight road",
        "1",
        "exit",
    )
    assert result.exit_code == 0
    assert result.stdout.count("changed road: ") == 2
    assert "roadgpt: " in result.stderr
    changed = sorted(path.name for path in Path("roadgpt-runs").iterdir() if path.name.startswith("make-"))
    assert len(changed) == 2
    (gentler,) = [name for name in changed if "gentler" in name]
    (sharper,) = [name for name in changed if "sharper" in name]
    card = json.loads(Path("roadgpt-runs", gentler, "runs", "0001", "edit.json").read_text())
    assert sharper in card["of"]  # the second change is one of the changed road


def test_a_change_heeds_the_settings_as_the_roads_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROADGPT_FORMAT", "svg")
    result = say("a flat road with 3 turns", "1", "make the last turn sharper", "exit")
    assert "changed road: " in result.stdout
    assert [*Path("roadgpt-runs").glob("make-*/runs/0001/height.svg")]
    assert not [*Path("roadgpt-runs").glob("make-*/runs/0001/*.png")]


def test_without_the_package_that_edits_nobody_is_asked_for_a_change(monkeypatch: pytest.MonkeyPatch) -> None:
    known = plugins.names
    monkeypatch.setattr(plugins, "names", lambda kind: [name for name in known(kind) if name != "edit"])
    result = say("a flat road with 3 turns", "1", "exit")
    assert result.exit_code == 0
    assert "1 of 1 roads" in result.stdout
    assert "change it?" not in result.stdout
