"""The hallway's door to parts: whatever a package registers, the others go on working."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint

import pytest
from click.testing import CliRunner

from roadgpt import plugins
from roadgpt.cli import app
from roadgpt.errors import PartError

SOUND = EntryPoint("sound", "collections:Counter", "roadgpt.drivers")


@pytest.fixture
def shelf(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[EntryPoint]]:
    """What lies on every shelf."""
    parts = [SOUND]
    monkeypatch.setattr(plugins, "entry_points", lambda group: parts)
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
    listed = CliRunner().invoke(app, ["parts"])
    assert listed.exit_code == 0
    assert "cannot be loaded" in listed.stdout


def test_two_parts_of_one_name_are_refused(shelf: list[EntryPoint]) -> None:
    shelf.append(EntryPoint("sound", "collections:OrderedDict", "roadgpt.drivers"))
    assert plugins.names("drivers") == ["sound"]
    with pytest.raises(
        PartError, match=r"2 packages register a driver called 'sound' .*; uninstall all but one"
    ):
        plugins.find("drivers", "sound")


def test_one_part_that_is_found_twice_is_one_part(shelf: list[EntryPoint]) -> None:
    shelf.append(SOUND)
    assert plugins.find("drivers", "sound")() == {}


def test_an_empty_shelf_is_an_error(shelf: list[EntryPoint]) -> None:
    shelf.clear()
    with pytest.raises(PartError, match="no rules are installed"):
        plugins.names("rules")
