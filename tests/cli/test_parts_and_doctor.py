"""`roadgpt config plugins` and `roadgpt doctor`."""

import json
from importlib.metadata import entry_points

import pytest
from click.testing import CliRunner

from roadgpt import plugins
from roadgpt.cli import app
from roadgpt.cli.commands import set_up
from roadgpt.errors import PartError


def test_parts_lists_every_registered_part_with_a_sentence() -> None:
    listed = json.loads(CliRunner().invoke(app, ["config", "plugins", "--json"]).stdout)
    registered = {(s, p.name) for s in plugins.KINDS for p in entry_points(group=f"roadgpt.{s}")}
    assert {(part["shelf"], part["name"]) for part in listed} == registered
    assert all(part["about"] and part["origin"] and part["works"] for part in listed)
    plain = CliRunner().invoke(app, ["config", "plugins"]).stdout
    assert all(part["name"] in plain and part["about"] in plain for part in listed)


def test_a_part_that_cannot_be_loaded_is_listed_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def find(shelf: str, name: str) -> object:
        raise PartError(f"the {name} lacks a library")

    monkeypatch.setattr(plugins, "find", find)
    found = set_up.installed()
    assert not any(works for *_, works in found)
    assert all(about.endswith("lacks a library") for *_, about, _ in found)
    result = CliRunner().invoke(app, ["doctor"])
    assert result.exit_code == 1
    assert "PROBLEM" in result.stdout


def test_doctor_finds_this_installation_well() -> None:
    result = CliRunner().invoke(app, ["doctor"])
    assert result.exit_code == 0, result.output
    assert "times real time" in result.stdout
    assert result.stdout.endswith("all is well\n")
    looks = json.loads(CliRunner().invoke(app, ["doctor", "--json"]).stdout)
    assert {"roadgpt", "Python", "numba", "test drive"} <= {look["about"] for look in looks}
    assert all(look["is_fine"] for look in looks)
