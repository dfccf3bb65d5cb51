"""A file of settings sets what an option sets, says so, and gives a stranger's folder no power."""

import json
import tomllib
from pathlib import Path

import click
import pytest

from command_line import invoke
from roadgpt.cli import app
from roadgpt.run import read_run
from rows import rows

OF_A_CALL = {
    "roads", "seed", "out", "plan", "no_drive", "no_plot", "junit", "json", "quiet", "verbose", "help_all",
    "route", "fail_on", "baseline", "margin_loss", "again", "workers",
}  # fmt: skip
"""Options that are given with each call, and that no file sets."""
OTHERWISE = {
    "speed_limit": "speed_limit_kmh", "headless": "beamng_headless", "nogpu": "beamng_nogpu",
    "gfx": "beamng_gfx",
}  # fmt: skip
WHOLE = """
[run]
reader = "plan"
designer = "thesis"
driver = "pure_pursuit"
simulator = "beamng"
keep_driving = true
tracks = "/others.csv"
scenario = "ncap:CCRs"
geometry = "spline"
rules = "sbft"
axes = "thesis"
format = ["svg", "pdf"]
export = ["csv", "opendrive"]

[world]
map_size = 400
ground = "hilly:3"
lanes = "2+1"
lane_width = 3.25
lane_width_end = 3.5
bank = 5.0
shoulder = 1
friction = 0.6
scene = "medium; wet"
speed_limit_kmh = 50
oracle = "departure"
oob_tolerance = 0.5
lane_departure = true
avoidable = "r157"

[beamng]
home = "/beamng"
user = "/beamng-user"
host = "host"
port = 1234
level = "italy"
aggression = 0.5
recycle = 9
headless = true
nogpu = true
gfx = "vk"
"""


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's own file of settings; the working folder is another one."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    own = tmp_path / "home" / "roadgpt" / "config.toml"
    own.parent.mkdir(parents=True)
    return own


def shown() -> dict[str, dict[str, object]]:
    result = invoke("config", "show", "--json", "--origin")
    assert result.exit_code == 0, result.output
    found: dict[str, dict[str, object]] = json.loads(result.stdout)
    return found


def given(*words: str) -> dict[str, object]:
    """The values with which ``roadgpt run`` would work."""
    command = app.get_command(click.Context(app, **app.context_settings), "run")
    assert command is not None
    return command.make_context("run", ["a road", *words], click.Context(app, **app.context_settings)).params


def options_of_run() -> set[str]:
    command = app.get_command(click.Context(app, **app.context_settings), "run")
    assert command is not None
    every = command.get_params(click.Context(command, **app.context_settings))
    options = [each for each in every if isinstance(each, click.Option) and "--help" not in each.opts]
    longest = [max(each.opts, key=len).lstrip("-").replace("-", "_") for each in options]
    return {OTHERWISE.get(name, name) for name in longest}


def test_the_listing_has_every_option_but_those_of_a_call() -> None:
    assert {*shown()} - {"api_key"} == options_of_run() - OF_A_CALL
    lines = invoke("config", "show").stdout.splitlines()
    assert [line for line in lines if line.startswith("[")] == ["[run]", "[world]", "[beamng]", "[chat]"]
    assert {line.split()[0] for line in lines if not line.startswith("[")} == {*shown()}
    assert {entry["origin"] for entry in shown().values()} == {"default", "nowhere"}


def test_the_users_own_file_sets_every_option(home: Path) -> None:
    home.write_text(WHOLE)
    found = shown()
    for table, keys in tomllib.loads(WHOLE).items():
        for key, value in keys.items():
            name = f"beamng_{key}" if table == "beamng" else key
            expected = ",".join(value) if isinstance(value, list) else value
            assert found[name] == {"value": expected, "origin": f"{home} [{table}]"}
    of_files = {name for name, entry in found.items() if str(home) in str(entry["origin"])}
    assert of_files == options_of_run() - OF_A_CALL - {
        "model", "base_url", "provider", "temperature", "timeout", "retries", "max_completion",
        "max_tokens", "max_cost", "price", "record", "replay", "rounds", "repair", "strategy",
    }  # fmt: skip


def test_a_run_in_the_folder_is_made_as_its_file_says_and_says_so() -> None:
    Path("roadgpt.toml").write_text('[world]\nfriction = 0.5\n[run]\nreader = "plan"')
    words = ("run", "straight | turns=0", "--seed", "1", "--no-drive", "--no-plot")
    result = invoke(*words, "--out", "one")
    assert result.exit_code == 0, result.output
    assert result.stderr == "roadgpt: roadgpt.toml sets reader = plan, friction = 0.5\n"
    assert read_run(Path("one/runs/0001")).world.site.friction == 0.5
    assert invoke(*words, "--out", "two", "--quiet").stderr == ""
    assert invoke(*words, "--out", "three", "--friction", "0.7", "--reader", "plan").stderr == ""
    assert read_run(Path("three/runs/0001")).world.site.friction == 0.7


def test_the_first_place_counts(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home.write_text("[world]\nfriction = 0.1")
    assert given()["friction"] == 0.1
    Path("roadgpt.toml").write_text("[world]\nfriction = 0.2")
    assert given()["friction"] == 0.2
    Path(".env").write_text("ROADGPT_FRICTION=0.3")
    assert given()["friction"] == 0.3
    assert shown()["friction"]["origin"] == ".env (ROADGPT_FRICTION)"
    monkeypatch.setenv("ROADGPT_FRICTION", "0.4")
    assert given()["friction"] == 0.4
    assert given("--friction", "0.5")["friction"] == 0.5


def test_a_switch_that_a_file_sets_can_be_taken_back() -> None:
    Path("roadgpt.toml").write_text("[run]\nkeep_driving = true")
    assert given()["keep_driving"] is True
    assert given("--no-keep-driving")["keep_driving"] is False


def test_the_line_that_makes_a_run_again_holds_under_the_settings_of_the_folder() -> None:
    words = ("run", "straight | turns=0", "--seed", "1", "--no-drive", "--no-plot", "--reader", "plan")
    assert invoke(*words, "--out", "one").exit_code == 0
    (line,) = [line for line in invoke("show", "one/runs/0001").stdout.splitlines() if "roadgpt run" in line]
    assert "--friction" not in line
    Path("roadgpt.toml").write_text("[world]\nfriction = 0.5\n[run]\nkeep_driving = true")
    (line,) = [line for line in invoke("show", "one/runs/0001").stdout.splitlines() if "roadgpt run" in line]
    assert "--friction 1 " in f"{line} "
    assert "--no-keep-driving" in line


@pytest.mark.parametrize(("table", "line"), rows(__file__, "settings_of_strangers"))
@pytest.mark.parametrize("place", ["roadgpt.toml", ".env"])
def test_a_strangers_folder_cannot_choose_code_or_servers(table: str, line: str, place: str) -> None:
    key, _, value = line.partition(" = ")
    middle = "BEAMNG_" if table == "beamng" else ""
    text = f"[{table}]\n{line}" if place != ".env" else f"ROADGPT_{middle}{key.upper()}={value}"
    Path(place).write_text(text)
    Path("mine.py").write_text("open('ran', 'w').close()\nclass Mine: pass\n")
    for words in (
        ("run", "a road"),
        ("campaign", "a road", "-n", "1"),
        ("study", "thesis"),
        ("config", "show"),
    ):
        if words[0] == "study" and table == "run" and key not in ("reader", "driver", "designer"):
            continue
        if words[0] == "study" and table == "beamng":
            continue  # it has no options of BeamNG
        result = invoke(*words)
        assert result.exit_code == 2, (words, result.output)
        (told,) = result.stderr.strip().splitlines()
        assert place in told
        assert f"{key} = " in told
        assert "yourself" in told
    assert not Path("ran").exists()
    assert not Path("roadgpt-runs").exists()


@pytest.mark.parametrize("value", ["mine.py:Mine", "~/mine.py:Mine", "./mine.py"])
def test_a_path_that_depends_on_the_folder_is_refused_in_the_users_own_file(
    home: Path, value: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("mine.py").write_text("open('ran', 'w').close()\nclass Mine: pass\n")
    home.write_text(f'[run]\ndriver = "{value}"')
    result = invoke("run", "a road")
    assert result.exit_code == 2
    assert "give the whole path" in result.stderr
    home.write_text("")
    monkeypatch.setenv("ROADGPT_DRIVER", value)
    assert invoke("run", "a road").exit_code == 2
    assert not Path("ran").exists()


def test_a_driver_that_the_users_own_file_names_whole_drives(home: Path) -> None:
    mine = home.with_name("mine.py")
    mine.write_text(
        "from roadgpt.drive import Command\nclass Mine:\n    def steer(self, view):\n"
        "        return Command(0.0, throttle=0.3)\n"
    )
    home.write_text(f'[run]\ndriver = "{mine}:Mine"')
    Path("road.json").write_text(json.dumps([[40, 100], [60, 100], [80, 100]]))
    result = invoke("drive", "road.json", "--json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["test_outcome"] in ("PASS", "FAIL")


@pytest.mark.parametrize(("text", "told"), rows(__file__, "mistakes_in_settings"))
@pytest.mark.parametrize("words", [("run", "a road"), ("config", "show")])
def test_a_mistake_is_told_with_its_place(text: str, told: str, words: tuple[str, ...]) -> None:
    Path("roadgpt.toml").write_text(text)
    result = invoke(*words)
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.strip().splitlines()
    assert told in line
    assert "roadgpt.toml" in line
    assert result.stdout == ""


def test_help_is_given_whatever_a_file_says() -> None:
    Path("roadgpt.toml").write_text("[world]\nfriction = 5")
    assert invoke("run", "--help").exit_code == 0
    assert invoke("run", "--help-all").exit_code == 0


def test_settings_of_others_in_the_environment_are_no_strangers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROADGPT_BEAMNG_LEVEL", "tig")
    monkeypatch.setenv("ROADGPT_FRICTOIN", "1")
    result = invoke("config", "show")
    assert "ROADGPT_FRICTOIN in the environment is not a setting" in result.stderr
    assert "ROADGPT_BEAMNG_LEVEL" not in result.stderr
