"""What a stranger types first gets one sentence of advice, exit status 2, and never a traceback."""

import pytest
from click.testing import CliRunner, Result

from roadgpt import __version__
from roadgpt.cli import app
from roadgpt.cli.app import COMMANDS


def invoke(*words: str) -> Result:
    return CliRunner().invoke(app, list(words), prog_name="roadgpt")


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        (["-n", "0"], "0 is not possible; give the number of roads, a whole number from 1"),
        (["-n", "-3"], "-3 is not possible"),
        (["-n", "many"], "'many' is no whole number"),
        (["-n", "2.5"], "'2.5' is no whole number"),
        (["--seed", "-1"], "give a seed, a whole number from 0"),
        (["--map-size", "5"], "5 is not possible; give a number from 50 to 40000 metres"),
        (["--map-size", "nan"], "nan is not possible"),
        (["--map-size", "1e9"], "from 50 to 40000"),
        (["--speed-limit", "fast"], "'fast' is no number; give a number from 5 to 300 km/h"),
        (["--oob-tolerance", "0"], "give a number above 0, up to 1"),
        (["--oob-tolerance", "1.01"], "give a number above 0, up to 1"),
        (["--verge", "-1"], "from 0 to 100 metres"),
        (["--friction", "inf"], "inf is not possible"),
        (["--geometry", "nurbs"], "'nurbs' is not one of 'arcs', 'spline'"),
        (["--axes", "log"], "'log' is not one of 'equal', 'thesis'"),
        (["--frobnicate"], "No such option"),
        (["--out", ""], "a folder without a name"),
    ],
)
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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "-5 % slope, then a turn"], "-- '-5 % slope, then a turn'"),
        (["run", "-n", "2", "-5 % slope"], "-n 2 -- '-5 % slope'"),
        (["run", "-5 % slope", "--json"], "--json -- '-5 % slope'"),
        (["run", "-5", "%", "slope", "-n", "2"], "-n 2 -- '-5 % slope'"),
        (["run", "- a road"], "-- '- a road'"),
        (["run", "-q road with 3 turns"], "-- '-q road with 3 turns'"),
        (["-5 % slope"], "-- '-5 % slope'"),
    ],
)
def test_a_description_that_begins_with_a_dash_is_told_where_it_belongs(words: list[str], said: str) -> None:
    result = invoke(*words)
    assert result.exit_code == 2
    assert f"after two dashes: roadgpt run {said}" in result.stderr.replace("\n", " ")


def test_a_change_that_begins_with_a_dash_is_told_where_it_belongs() -> None:
    result = invoke("edit", "runs/0001", "-3 turns")
    assert result.exit_code == 2
    assert "after two dashes: roadgpt edit runs/0001 -- '-3 turns'" in result.stderr.replace("\n", " ")


def test_behind_two_dashes_it_is_a_description(tmp_path) -> None:
    words = [
        "-n",
        "1",
        "--no-drive",
        "--no-plot",
        "--out",
        str(tmp_path),
        "--",
        "-5 % slope over 100 m, a left turn",
    ]
    result = invoke("run", *words)
    assert "No such option" not in result.stderr
    assert "after two dashes" not in result.stderr


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


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        (["run"], 'roadgpt run "an uphill road with 3 turns"'),
        (["drive"], "Name one or more road files"),
        (["show"], "Name the folder of a run"),
        (["learn", "data"], "Name the folder to write into"),
        (["uphill"], "Is it a description? Say: roadgpt run uphill"),
    ],
)
def test_what_is_missing_is_told_with_what_to_do(typed: list[str], told: str) -> None:
    result = invoke(*typed)
    assert result.exit_code == 2
    assert told in result.stderr


def test_an_option_before_a_command_is_told_where_it_belongs() -> None:
    result = invoke("--seed", "7")
    assert result.exit_code == 2
    assert "No such option '--seed' here" in result.stderr
    assert "roadgpt run 'an uphill road with 3 turns' --seed 7" in result.stderr


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_and_refuses_unknown_options(name: str) -> None:
    assert invoke(name, "--help").exit_code == 0
    assert "Usage: roadgpt " + name in invoke(name, "-h").stdout
    assert invoke(name, "--no-such-option").exit_code == 2


def test_version() -> None:
    assert invoke("--version").stdout == f"roadgpt {__version__}\n"


def test_a_part_that_is_not_installed_is_answered_with_those_that_are() -> None:
    for option, known in (("--driver", "pure_pursuit"), ("--designer", "planner"), ("--simulator", "mujoco")):
        result = invoke("run", "a road", option, "gtp", "-n", "1")
        assert result.exit_code == 2, result.output
        assert "called 'gtp'; there are: " in result.stderr
        assert known in result.stderr


def test_one_network_that_is_replaced_is_given_alone() -> None:
    result = invoke("learn", "export", "run", "out", "--only", "routes", "--second", "another")
    assert result.exit_code != 0
    assert "--only routes takes CHECKPOINT alone; leave out --second and --routes" in result.stderr


def test_both_networks_that_are_replaced_are_given() -> None:
    result = invoke("learn", "export", "run", "out", "--only", "both")
    assert result.exit_code != 0
    assert "--only both takes CHECKPOINT and --second" in result.stderr
