"""The hallway's door to parts: whatever a package registers, the others go on working."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint

import click
import pytest
from click.testing import CliRunner

from roadgpt import plugins
from roadgpt.cli import app
from roadgpt.errors import PartError

MAY_BE_EMPTY = {
    f"roadgpt.{kind}" for kind in ("commands", "checks", "reports", "chapters", "analyses", "settings")
}
SOUND = EntryPoint("sound", "collections:Counter", "roadgpt.drivers")


@pytest.fixture
def shelf(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[EntryPoint]]:
    """What lies on every shelf; of commands, checks, reports and settings, on that which it names."""
    parts = [SOUND]

    def found(group: str) -> list[EntryPoint]:
        return [part for part in parts if part.group == group] if group in MAY_BE_EMPTY else parts

    monkeypatch.setattr(plugins, "entry_points", found)
    plugins._registered.cache_clear()
    yield parts
    plugins._registered.cache_clear()


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("collections:Gone", "AttributeError"),
        ("no_such_module_at_all:X", "ModuleNotFoundError"),
        ("this has no form", ""),
    ],
)
def test_a_part_that_cannot_be_loaded_costs_only_itself(
    shelf: list[EntryPoint], value: str, reason: str
) -> None:
    shelf.append(EntryPoint("broken", value, "roadgpt.drivers"))
    with pytest.raises(PartError, match=rf"the driver 'broken' cannot be loaded \({reason}.*; repair or"):
        plugins.find("drivers", "broken")
    assert plugins.find("drivers", "sound")() == {}
    listed = CliRunner().invoke(app, ["config", "plugins"])
    assert listed.exit_code == 0
    assert "cannot be loaded" in listed.stdout


def test_two_parts_of_one_name_are_refused(shelf: list[EntryPoint]) -> None:
    shelf.append(EntryPoint("sound", "collections:OrderedDict", "roadgpt.drivers"))
    assert plugins.names("drivers") == ["sound"]
    with pytest.raises(
        PartError, match=r"2 packages register a driver called 'sound' .*; uninstall all but one"
    ):
        plugins.find("drivers", "sound")


def test_an_empty_shelf_is_an_error(shelf: list[EntryPoint]) -> None:
    shelf.clear()
    with pytest.raises(PartError, match="no rules are installed"):
        plugins.names("rules")


@click.command(short_help="Count the trees.")
def trees() -> None:
    """A command of somebody else's package."""
    click.echo("17 trees")


def test_a_command_of_another_package_stands_in_the_help_and_a_broken_one_says_so(
    shelf: list[EntryPoint],
) -> None:
    shelf[:] = [
        EntryPoint("trees", f"{__name__}:trees", "roadgpt.commands"),
        EntryPoint("broken", "no_such_module_at_all:X", "roadgpt.commands"),
    ]
    said = " ".join(CliRunner().invoke(app, ["--help"]).stdout.split())
    others = said.split("Of other packages: ")[1]
    assert others.startswith("broken the command 'broken' cannot be loaded (ModuleNotFoundError")
    assert "trees Count the trees." in others
    assert CliRunner().invoke(app, ["trees"]).stdout == "17 trees\n"
    broken = CliRunner().invoke(app, ["broken"])
    assert "the command 'broken' cannot be loaded (ModuleNotFoundError" in broken.stderr
    assert CliRunner().invoke(app, ["--version"]).exit_code == 0


def test_there_may_be_no_commands_checks_reports_and_settings(shelf: list[EntryPoint]) -> None:
    shelf.clear()
    assert all(plugins.names(kind) == [] for kind in sorted(kind.partition(".")[2] for kind in MAY_BE_EMPTY))
    assert "compete" not in CliRunner().invoke(app, ["--help"]).stdout
