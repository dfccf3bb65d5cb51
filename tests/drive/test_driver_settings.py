"""Settings of a driver reach its constructor, stand in every record, and open no door to strangers."""

import csv
from collections.abc import Iterator
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

import pytest

from command_line import invoke, roadgpt
from roadgpt import plugins, provenance
from roadgpt.campaign.folder_record import kept_run, run_again
from roadgpt.cli.options import drivers
from roadgpt.drive import Command, View
from roadgpt.drive.drivers.lane_centring import LaneCentring
from roadgpt.drive.loading import load_driver, needs_permission, require_permission
from roadgpt.errors import UsageError
from roadgpt.run import Setup, read_run

FILE = """
from roadgpt.drive import Command

class Mine:
    def __init__(
        self, pedal: "float | None" = 0.3, steps=2, waits: bool = False, word: str = "", road: object = None
    ):
        self.given = pedal, steps, waits, word
        self.pedal = pedal
    def steer(self, view):
        return Command(-0.2 * (view.t + 2) - view.heading, self.pedal, 0.0)
"""


class Installed:
    """Stands for a driver of another package."""

    def __init__(self, weights: str = "", gain: float = 1.0) -> None:
        self.weights, self.gain = weights, gain

    def steer(self, view: View) -> Command:
        """Drives straight on."""
        return Command(0.0)


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(FILE)
    own = EntryPoint("installed", f"{__name__}:Installed", "roadgpt.drivers")
    monkeypatch.setattr(
        plugins, "entry_points", lambda group: [*entry_points(group=group), *[own] * (group == own.group)]
    )
    plugins._registered.cache_clear()
    provenance.CODE.forget()
    yield tmp_path
    plugins._registered.cache_clear()
    provenance.CODE.forget()


def test_settings_have_the_types_that_the_constructor_names() -> None:
    given = load_driver("mine.py:Mine:pedal=1e-1, steps=5,waits=true,word=a:b=c").given
    assert given == (0.1, 5, True, "a:b=c")
    assert [*map(type, given)] == [float, int, bool, str]
    assert load_driver("mine.py:Mine:pedal=none").given == (None, 2, False, "")
    assert load_driver("mine.py:Mine").given == (0.3, 2, False, "")
    changed, usual = load_driver("lane_centring:lag=0.4,headway=2"), LaneCentring()
    assert (changed.lag, changed.headway, changed.sight) == (0.4, 2.0, usual.sight)
    assert load_driver("installed:gain=2").gain == 2.0


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("mine.py:Mine:pedals=1", "the driver mine.py:Mine has no setting 'pedals'; it has pedal, steps"),
        ("mine.py:Mine:road=1", "has no setting 'road'"),
        ("mine.py:Mine:pedal=hard", "the driver mine.py:Mine cannot have pedal=hard; give none or a number"),
        ("mine.py:Mine:pedal=nan", "give none or a number"),
        ("mine.py:Mine:steps=1.5", "cannot have steps=1.5; give a whole number"),
        ("mine.py:Mine:waits=1", "give true or false"),
        ("pure_pursuit:lag=1", "no setting 'lag'; it has risk, headway, nearest, wheelbase"),
        ("pure_pursuit:risk=1,2", "no setting '2'"),
        ("pure_porsuit:risk=1", "no driver called 'pure_porsuit'"),
    ],
)  # fmt: skip
def test_a_wrong_setting_is_one_sentence(spec: str, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        load_driver(spec)
    assert says in str(caught.value)


@pytest.mark.parametrize("spec", ["mine.py:Mine:pedals=1", "lane_centring:pedals=1"])
def test_a_wrong_setting_is_told_before_the_first_road_is_made(spec: str) -> None:
    result = invoke("run", "--plan", "straight 60", "--no-plot", "--driver", spec)
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.strip().splitlines()
    assert "has no setting 'pedals'; it has " in line


def test_drivers_are_separated_by_commas_as_are_settings() -> None:
    assert drivers("reference,robot:risk=0.5, headway=1,mine.py:Mine:pedal=1") == (
        "reference", "robot:risk=0.5, headway=1", f"{Path.cwd()}/mine.py:Mine:pedal=1",
    )  # fmt: skip


def test_settings_are_part_of_every_record(here: Path) -> None:
    slow, fast = (f"{here}/mine.py:Mine:pedal={pedal}" for pedal in (0.15, 0.4))
    words = ("campaign", "--plan", "straight 60", "-n", 1, "--seed", 3, "--out", "many", "-j", 2, "-q")
    roadgpt(*words, "--drivers", f"mine.py:Mine:pedal=0.15,{fast}", "--drivers", "reference:risk=0.4")
    with Path("many/cells.csv").open(newline="") as file:
        assert [row["driver"] for row in csv.DictReader(file)] == [slow, fast, "reference:risk=0.4"]
    runs = [kept_run(Path("many"), cell, 1) for cell in ("c01", "c02", "c03")]
    durations = [run.drive.duration for run in runs if run.drive]
    assert durations[0] > durations[1] + 0.5
    assert [run.request.setup.driver for run in runs] == [slow, fast, "reference:risk=0.4"]
    again, result = run_again(Path("many"), "c01", 1)
    assert again.drive is not None
    assert again.drive.duration == durations[0]
    assert result.outcome == again.outcome
    roadgpt("run", "--plan", "straight 60", "--seed", 3, "--out", "one", "--no-plot", "--driver", fast)
    run = read_run(Path("one/runs/0001"))
    assert run.drive is not None
    assert run.drive.duration == durations[1]
    changed = invoke("run", "--plan", "straight 60", "--seed", 3, "--out", "one", "-n", 2, "--driver", slow)
    assert changed.exit_code == 2
    assert "driver" in changed.stderr


def test_a_text_that_only_a_file_names_is_given_to_no_driver() -> None:
    """It may be the path of what the driver loads, in a folder of somebody else."""
    harmless, text = "installed:gain=2", "installed:weights=/theirs.pt"
    assert [needs_permission(each) for each in ("installed", harmless, text)] == [False, False, True]
    for spec in (harmless, text):
        assert Setup(driver=spec).came_with("run.json").driver == spec
    require_permission(harmless)
    with pytest.raises(UsageError, match=r"run\.json names the driver installed:weights=/theirs\.pt"):
        load_driver(text)
    assert drivers(text) == (text,)  # the user names it
    assert load_driver(text).weights == "/theirs.pt"
    Path("roadgpt.toml").write_text('[run]\ndriver = "lane_centring:lag=1"')
    refused = invoke("run", "a road")
    assert refused.exit_code == 2
    assert "say it yourself with the option" in refused.stderr
