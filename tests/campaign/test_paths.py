"""Drivers named by relative paths are found again, wherever the next command is given."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt import plugins
from roadgpt.campaign.folder_record import run_again
from roadgpt.campaign.plan import read_plan
from roadgpt.campaign.record import Record
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.drive.loading import load_driver, permit
from roadgpt.errors import UsageError

DRIVER = """
from roadgpt.drive.drivers.pure_pursuit import PurePursuit
class Mine(PurePursuit):
    name = 'mine'
"""


@pytest.fixture
def there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a driver and a plan, and a command that is given elsewhere."""
    (tmp_path / "there" / "plans").mkdir(parents=True)
    (tmp_path / "there" / "mine.py").write_text(DRIVER)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    return tmp_path / "there"


def test_a_path_in_a_plan_begins_at_the_plan(there: Path) -> None:
    (there / "plans" / "plan.toml").write_text(
        'prompts = "a road"\ntests = 1\nreader = "model:mine"\n'
        'drivers = ["../mine.py:Mine", "beamng_like", "/opt/other.py:Other"]\n'
        '[chat]\nrecord = "said"\nmodel = "m"\n'
    )
    relative = Path("..") / "there" / "plans" / "plan.toml"
    written = read_plan(relative)
    own, shelf, absolute = written.plan.drivers
    plans = Path.cwd() / relative.parent
    assert written.chat == {"record": str(plans / "said"), "model": "m"}
    assert written.plan.reader == f"model:{plans / 'mine'}"
    assert (shelf, absolute) == ("beamng_like", "/opt/other.py:Other")
    assert Path(own.rpartition(":")[0]).is_absolute()
    with pytest.raises(UsageError, match=r"plan\.toml names the driver"):
        load_driver(own)
    permit(own)
    assert type(load_driver(own)).__name__ == "Mine"


def test_a_campaign_with_a_relative_driver_is_resumed_from_anywhere(
    there: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(there)
    words = ["campaign", "turn x2", "-n", "1", "--reader", "plan", "--driver", "mine.py:Mine"]
    with monkeypatch.context() as patch:
        patch.setattr("roadgpt.campaign.lifecycle.work", lambda *_: iter(()))  # as if it was stopped at once
        begun = CliRunner().invoke(app, [*words, "--out", "c", "--json"])
    assert begun.exit_code == 0, begun.output
    assert json.loads(begun.stdout)["done"] == 0
    monkeypatch.chdir(there.parent / "elsewhere")
    monkeypatch.setattr("roadgpt.campaign.lifecycle.WorkerSetup", _Nobody)
    find = plugins.find
    monkeypatch.setattr(
        plugins, "find", lambda shelf, name: InProcess if name == "inline" else find(shelf, name)
    )
    done = CliRunner().invoke(app, ["resume", str(there / "c"), "--executor", "inline", "--json"])
    assert done.exit_code == 0, done.output
    with Record.opened(there / "c") as record:
        assert [result.outcome in ("PASS", "FAIL") for result in record.results()] == [True]
    run, _ = run_again(there / "c", "c01", 1)
    assert run.drive is not None
    assert run.drive.driver == "mine"


class _Nobody:
    """Prepares nobody."""

    def __init__(self, setups: object) -> None: ...
