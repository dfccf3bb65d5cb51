"""--oracle, --oob-tolerance and --lane-departure: which of them counts, and what tables say of it."""

import json
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign.plan_file import read_plan
from roadgpt.cli import app, options
from roadgpt.errors import UsageError
from roadgpt.road import Limits

ROAD = [[40, 100], [90, 100], [140, 100]]


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of settings of the working folder."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    return tmp_path / "roadgpt.toml"


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")


def limits(*words: str, name: str = "run") -> Limits:
    """The limits with which a command would judge."""
    above = click.Context(app, **app.context_settings)
    command: click.Command | None = app
    for part in name.split():
        assert isinstance(command, click.Group)
        command = command.get_command(above, part)
    assert command is not None
    asked = ["a road", *words] if name in ("run", "campaign") else [*words]
    with command.make_context(name, asked, above) as context:
        return options.world_of(dict(context.params)).limits


@pytest.mark.parametrize(
    ("typed", "tolerance", "departure"),
    [
        ("", 0.5, False),
        ("--oracle half", 0.5, False),
        ("--oracle sbft", 0.85, False),
        ("--oracle thesis", 0.95, False),
        ("--oracle departure", 0.5, True),
        ("--oracle 0.7", 0.7, False),
        ("--oracle 1", 1.0, False),
        ("--oob-tolerance 0.9", 0.9, False),
        ("--lane-departure", 0.5, True),
        ("--lane-departure --oob-tolerance 0.95", 0.95, True),
        ("--oracle departure --lane-departure", 0.5, True),
        ("--oracle thesis --oob-tolerance 0.95", 0.95, False),
    ],
)
@pytest.mark.parametrize("command", ["run", "campaign"])
def test_what_is_typed_decides(typed: str, tolerance: float, departure: bool, command: str) -> None:
    found = limits(*typed.split(), name=command)
    assert (found.oob_tolerance, found.lane_departure) == (tolerance, departure)


@pytest.mark.parametrize(
    ("file", "typed", "tolerance", "departure"),
    [
        ('oracle = "thesis"', "", 0.95, False),
        ('oracle = "thesis"', "--oracle half", 0.5, False),
        ('oracle = "thesis"', "--lane-departure", 0.95, True),
        ('oracle = "departure"', "--no-lane-departure", 0.5, False),
        ("oob_tolerance = 0.9", "--oracle sbft", 0.85, False),
        ("oob_tolerance = 0.9", "--lane-departure", 0.9, True),
        ("lane_departure = true", "--oob-tolerance 0.6", 0.6, True),
        ("lane_departure = true", "--oracle 0.6", 0.6, False),
    ],
)
def test_what_is_typed_precedes_what_a_file_sets(
    home: Path, file: str, typed: str, tolerance: float, departure: bool
) -> None:
    home.write_text(f"[world]\n{file}\n")
    found = limits(*typed.split())
    assert (found.oob_tolerance, found.lane_departure) == (tolerance, departure)


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("--oracle thesis --oob-tolerance 0.5", "oracle thesis and oob_tolerance 0.5 contradict each other"),
        ("--oracle half --lane-departure", "oracle half and lane_departure true contradict each other"),
        ("--oracle most", "there is no oracle 'most'; give half, sbft, thesis, departure, or a share from 0"),
        ("--oracle 1.5", "there is no oracle '1.5'"),
    ],
)
def test_what_contradicts_itself_or_is_none_is_refused_in_a_sentence(typed: str, told: str) -> None:
    done = roadgpt("run", "straight", "--plan", *typed.split())
    assert done.exit_code == 2
    (line,) = done.stderr.splitlines()
    assert told in line
    assert not [*Path().glob("roadgpt-runs/*")]


def test_a_study_drives_and_judges_as_the_thesis_did(home: Path) -> None:
    assert limits(name="study thesis").oracle == "thesis"
    assert limits("--oob-tolerance", "0.8", name="study thesis").oracle == "0.8"
    assert limits("--oracle", "half", name="study thesis").oracle == "half"
    home.write_text("[world]\nlane_departure = true\n")
    assert limits(name="study thesis").oracle == "departure:0.95"


def test_a_plan_file_names_an_oracle_or_its_parts() -> None:
    file = Path("plan.toml")
    for table, name in (
        ("", "half"), ('oracle = "sbft"', "sbft"), ("oracle = 0.7", "0.7"),
        ("oob_tolerance = 0.95", "thesis"), ("lane_departure = true", "departure"),
        ('oracle = "thesis"\noob_tolerance = 0.95', "thesis"),
    ):  # fmt: skip
        file.write_text(f'prompts = "a road"\ntests = 1\n[world]\n{table}\n')
        plan = read_plan(file).plan
        assert (plan.world.limits.oracle, plan.drivers) == (name, ("lane_centring",))
    for table, told in (
        ('oracle = "half"\nlane_departure = true', "oracle half and lane_departure true contradict"),
        ('oracle = "most"', "there is no oracle 'most'"),
    ):
        file.write_text(f'prompts = "a road"\ntests = 1\n[world]\n{table}\n')
        with pytest.raises(UsageError, match=rf"^plan\.toml: {told}"):
            read_plan(file)


def test_the_table_on_the_screen_names_driver_and_oracle() -> None:
    Path("road.json").write_text(json.dumps(ROAD))
    said = roadgpt("drive", "road.json", "--driver", "reference", "--oracle", "0.85").stdout
    assert "driver reference, oracle sbft: FAIL when more than 85 % of the car is outside its lane" in said
    said = roadgpt("drive", "road.json").stdout
    assert (
        "driver lane_centring, oracle half: FAIL when more than half of the car is outside its lane" in said
    )
