"""``roadgpt read --ask``, and the same questions in the conversation: each answer changes the plan."""

import re

import pytest
from click.testing import CliRunner, Result

from command_line import invoke
from roadgpt.brief import Brief
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.questions import questions
from roadgpt.cli import app


def ask(line: str, *answers: str, monkeypatch: pytest.MonkeyPatch, **reading: object) -> Result:
    """What a terminal shows for a plan that stands for a reading."""
    brief = read_plan(line).model_copy(update=reading)
    monkeypatch.setattr("click.testing._NamedTextIOWrapper.isatty", lambda _: True, raising=False)
    monkeypatch.setattr("roadgpt.run.brief_of", lambda *_: brief)
    return CliRunner().invoke(app, ["read", "words", "--ask"], input="".join(f"{each}\n" for each in answers))


def made(result: Result) -> str:
    assert result.exit_code == 0, result.output
    (found,) = re.findall(r"\(for that: --plan '(.+)'\)\n$", result.output)
    return str(found)


@pytest.mark.parametrize(
    ("line", "answers", "meant"),
    [
        ("straight 300 && child crossing: cross", ["2"], "straight len=300 && child crossing right: cross"),
        ("straight 300 && child crossing: cross", [""], "straight len=300 && child crossing: cross"),
        ("straight 300 && child crossing: cross", ["7", "x", "1"],
         "straight len=300 && child crossing left: cross"),
        ("junction && car junction left", ["2", "3"], "crossroads straight && car junction left"),
        ("| turns=3..5", ["3"], "| turns=5"),
        ("turn x2 && fog 50..150", ["2"], "turn x2 && fog 100"),
        ("turn x2 && truck ahead gap=20..: brake decel=4..6", ["3", "2"],
         "turn x2 && truck ahead gap=30: brake decel=6"),
        ("turn x2 && truck ahead gap=30: brake", [], "turn x2 && truck ahead gap=30: brake"),
    ],
)  # fmt: skip
def test_an_answer_changes_the_plan_and_enter_keeps_it(
    line: str, answers: list[str], meant: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = made(ask(line, *answers, monkeypatch=monkeypatch))
    assert found == meant
    assert plan(read_plan(found)) == found  # it can be given to --plan


def test_no_more_than_three_questions_are_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "junction // junction // junction && car lane: cut_in; adult crossing: cross"
    shown = ask(line, "", "", "", monkeypatch=monkeypatch)
    assert made(shown) == line
    assert shown.output.count("or Enter to leave it as it is> ") == 3


def test_the_other_reading_comes_first_and_then_what_is_open_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = ask(
        "turn x2", "1", "1", monkeypatch=monkeypatch, confidence=0.3, other="turn x2 && car lane: cut_in"
    )
    assert made(shown) == "turn x2 && car lane left: cut_in"


def test_who_does_it_is_asked_where_the_reading_is_not_sure(monkeypatch: pytest.MonkeyPatch) -> None:
    line = "turn x2 && truck ahead: brake decel=6; bus ahead gap=90"
    assert made(ask(line, "1", monkeypatch=monkeypatch, confidence=0.3)) == (
        "turn x2 && truck ahead; bus ahead gap=90: brake decel=6"
    )
    assert made(ask(line, "2", monkeypatch=monkeypatch, confidence=0.3)) == (
        "turn x2 && ego: brake decel=6; truck ahead; bus ahead gap=90"
    )
    assert made(ask(line, monkeypatch=monkeypatch)) == line


def test_a_word_without_effect_can_be_given_one(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = ask("turn x2", "2", monkeypatch=monkeypatch, unused=("child", "blue"))
    assert "not used: 'child', 'blue'" in shown.output
    assert made(shown) == "turn x2 && child crossing right: cross"


@pytest.mark.parametrize("more", [["--json"], ["--alternatives", "2"], []])
def test_without_somebody_to_answer_one_sentence_says_so(more: list[str]) -> None:
    told = invoke("read", "two bends", "--ask", *more)
    assert told.exit_code == 2
    assert re.fullmatch("roadgpt: --ask is for one reading at a terminal; .+\n", told.output)


def test_the_conversation_asks_which_side_but_not_how_many(monkeypatch: pytest.MonkeyPatch) -> None:
    read = lambda words, **_: read_plan("| turns=1..2 && adult crossing: cross")  # noqa: E731
    monkeypatch.setattr("roadgpt.brief.read", read)
    given: list[str] = []
    monkeypatch.setattr("roadgpt.cli.commands.make.carry_out", lambda _, words, **rest: given.append(words))
    shown = CliRunner().invoke(app, [], input="words\n1\n1\nwords\n\n1\nexit\n")
    assert shown.exit_code == 0, shown.output
    assert given == ["| turns=1..2 && adult crossing left: cross", "words"]


def test_every_choice_is_another_plan() -> None:
    brief: Brief = read_plan("junction && car junction; adult crosswalk: cross; rain 2..5").model_copy(
        update={"confidence": 0.2, "unused": ("dog", "hail")}
    )
    found = [*questions(brief)]
    assert len(found) > 5
    for about, choices in found:
        lines = {plan(each) for each in choices}
        assert len(lines) == len(choices), about
        assert plan(brief) not in lines, about
