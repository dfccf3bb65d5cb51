"""--oracle, --oob-tolerance and --lane-departure: which of them counts, and what tables say of it."""

from pathlib import Path

import click
import pytest

from roadgpt.cli import app, options
from roadgpt.road import Limits
from rows import rows


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of settings of the working folder."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    return tmp_path / "roadgpt.toml"


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


@pytest.mark.parametrize(("typed", "tolerance", "departure"), rows(__file__, "oracles_typed"))
@pytest.mark.parametrize("command", ["run", "campaign"])
def test_what_is_typed_decides(typed: str, tolerance: float, departure: bool, command: str) -> None:
    found = limits(*typed.split(), name=command)
    assert (found.oob_tolerance, found.lane_departure) == (tolerance, departure)


@pytest.mark.parametrize(("file", "typed", "tolerance", "departure"), rows(__file__, "oracles_in_files"))
def test_what_is_typed_precedes_what_a_file_sets(
    home: Path, file: str, typed: str, tolerance: float, departure: bool
) -> None:
    home.write_text(f"[world]\n{file}\n")
    found = limits(*typed.split())
    assert (found.oob_tolerance, found.lane_departure) == (tolerance, departure)


def test_a_study_drives_and_judges_as_the_thesis_did(home: Path) -> None:
    assert limits(name="study thesis").oracle == "thesis"
    assert limits("--oob-tolerance", "0.8", name="study thesis").oracle == "0.8"
    assert limits("--oracle", "half", name="study thesis").oracle == "half"
    home.write_text("[world]\nlane_departure = true\n")
    assert limits(name="study thesis").oracle == "departure:0.95"
