"""A driver from the user's own file: it is loaded, or one sentence says what is wrong with it."""

import sys
from pathlib import Path

import pytest

from drive.slippery_bicycle import SlipperyBicycle
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.loading import load_driver
from roadgpt.errors import PartError, UsageError
from roadgpt.road import Road, World

GOOD = """
from dataclasses import dataclass
from roadgpt.drive import Command
from neighbour import PEDAL

@dataclass
class MyDriver:
    gain: float = 0.2
    def steer(self, view):
        return Command(-self.gain * (view.t + 2), PEDAL, 0.0)

class Other:
    pass
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "neighbour.py").write_text("PEDAL = 0.2\n")
    (tmp_path / "mine.py").write_text(GOOD)
    return tmp_path


def test_a_class_of_a_file_drives(folder: Path) -> None:
    driver = load_driver(f"{folder}/mine.py:MyDriver")
    assert driver.gain == 0.2
    road = Road.through([[0, 0], [50, 0], [100, 0]])
    assert SlipperyBicycle().simulate(road, World(), driver, 0).ended == "goal"
    assert str(folder) not in sys.path
    sys.modules.pop("neighbour", None)


def test_a_name_of_the_shelf_drives() -> None:
    assert isinstance(load_driver("reference"), Reference)
    with pytest.raises(PartError, match="no driver called 'refrence'; there are: beamng_like"):
        load_driver("refrence")


def test_each_load_reads_the_file_anew(folder: Path) -> None:
    file = folder / "fresh.py"
    for number in (1, 22):
        file.write_text(f"class D:\n    number = {number}\n    def steer(self, view): ...\n")
        assert load_driver(f"{file}:D").number == number


@pytest.mark.parametrize(
    ("text", "spec", "says"),
    [
        (None, "none.py:D", r"there is no file .*none\.py: check the path of your driver"),
        (GOOD, "f.py:Mine", r"f\.py has no class 'Mine'; it has MyDriver, Other"),
        (GOOD, "f.py", r"say which class of .*f\.py drives, like .*f\.py:MyDriver; it has MyDriver, Other"),
        ("x = 1\n", "f.py", r"say which class of .*f\.py drives, like .*f\.py:MyDriver; it has none"),
        (GOOD, "f.py:Other", r"f\.py:Other has no method steer\(self, view\): add it"),
        ("x = 1\n", "f.py:x", r"f\.py:x has no method steer\(self, view\): add it"),
        ("class D:\n  def steer(self, v:\n    pass\n", "f.py:D", r"f\.py, line 2: .*; correct the file"),
        ("import nothing_of_that_name\n", "f.py:D", r"f\.py, line 1: ModuleNotFoundError: No module named"),
        ("\n\n1 / 0\n", "f.py:D", r"f\.py, line 3: ZeroDivisionError: division by zero; correct the file"),
        ("def f():\n    1 / 0\n\nf()\n", "f.py:D", r"f\.py, line 2: ZeroDivisionError"),
        ("raise SystemExit(3)\n", "f.py:D", r"f\.py, line 1: SystemExit: 3; correct the file"),
        (
            "class D:\n  def __init__(self, a): ...\n  def steer(self, view): ...\n",
            "f.py:D",
            r"f\.py:D cannot be made without arguments: TypeError: .*'a'; give its parameters defaults",
        ),
        (
            "class D:\n  def __init__(self): open('none at all')\n  def steer(self, view): ...\n",
            "f.py:D",
            r"f\.py:D cannot be made without arguments: FileNotFoundError",
        ),
        ("class D:\n  def steer(self): ...\n", "f.py:D", r"steer must take one argument, the view"),
        (
            "class D:\n  def steer(self, view, more): ...\n",
            "f.py:D",
            r"steer must take one argument, the view",
        ),
        ("class D:\n  steer = 3\n", "f.py:D", r"has no method steer\(self, view\): add it"),
    ],
)
def test_every_mistake_is_one_sentence(folder: Path, text: str | None, spec: str, says: str) -> None:
    if text is not None:
        (folder / "f.py").write_text(text)
    with pytest.raises(UsageError, match=says) as caught:
        load_driver(f"{folder}/{spec}")
    assert "\n" not in str(caught.value)
    sys.modules.pop("neighbour", None)


def test_a_file_that_cannot_be_run_leaves_nothing_behind(folder: Path) -> None:
    before, paths = set(sys.modules), list(sys.path)
    (folder / "broken.py").write_text("import neighbour\n1 / 0\n")
    with pytest.raises(UsageError):
        load_driver(f"{folder}/broken.py:D")
    assert set(sys.modules) - before == {"neighbour"}
    assert sys.path == paths
    del sys.modules["neighbour"]
