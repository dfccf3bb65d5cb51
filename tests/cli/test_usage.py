"""What a stranger types first gets one sentence of advice, exit status 2, and never a traceback."""

import pytest

from command_line import invoke
from rows import rows


@pytest.mark.parametrize(("words", "advice"), rows(__file__, "impossible_values"))
def test_a_value_that_is_not_possible_says_which_ones_are(words: list[str], advice: str) -> None:
    result = invoke("run", "a road", *words)
    assert result.exit_code == 2
    assert advice in result.stderr.replace("\n", " ")
    assert result.stdout == ""


def test_a_file_cannot_be_the_output_folder(tmp_path) -> None:
    file = tmp_path / "taken"
    file.write_text("")
    for out in (file, file / "below"):
        result = invoke("run", "a road", "--out", str(out))
        assert result.exit_code == 2
        assert f"'{file}' is a file; give the name of a folder" in result.stderr


def test_a_description_without_a_command_is_told_where_it_belongs() -> None:
    result = invoke("an uphill road with 3 turns")
    assert result.exit_code == 2
    assert "roadgpt run 'an uphill road with 3 turns'" in result.stderr


@pytest.mark.parametrize(("words", "said"), rows(__file__, "words_after_a_dash"))
def test_a_description_that_begins_with_a_dash_is_told_where_it_belongs(words: list[str], said: str) -> None:
    result = invoke(*words)
    assert result.exit_code == 2
    assert f"after two dashes: roadgpt run {said}" in result.stderr.replace("\n", " ")


def test_an_unknown_command_is_a_usage_error() -> None:
    result = invoke("fly")
    assert result.exit_code == 2
    assert "No such command 'fly'" in result.stderr
    assert "Did you mean" not in result.stderr


@pytest.mark.parametrize(("typed", "meant"), [("rnu", "run"), ("Drive", "drive"), ("docter", "doctor")])
def test_a_command_that_is_misspelt_is_guessed(typed: str, meant: str) -> None:
    result = invoke(typed, "a road")
    assert result.exit_code == 2
    assert f"No such command '{typed}'. Did you mean '{meant}'?" in result.stderr


@pytest.mark.parametrize(("typed", "told"), rows(__file__, "missing_words"))
def test_what_is_missing_is_told_with_what_to_do(typed: list[str], told: str) -> None:
    result = invoke(*typed)
    assert result.exit_code == 2
    assert told in result.stderr


def test_an_option_before_a_command_is_told_where_it_belongs() -> None:
    result = invoke("--seed", "7")
    assert result.exit_code == 2
    assert "No such option '--seed' here" in result.stderr
    assert "roadgpt run 'an uphill road with 3 turns' --seed 7" in result.stderr


def test_a_part_that_is_not_installed_is_answered_with_those_that_are() -> None:
    for option, known in (("--driver", "pure_pursuit"), ("--designer", "planner"), ("--simulator", "mujoco")):
        result = invoke("run", "a road", option, "gtp", "-n", "1")
        assert result.exit_code == 2, result.output
        assert "called 'gtp'; there are: " in result.stderr
        assert known in result.stderr
