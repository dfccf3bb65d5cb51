"""A driver from the user's own file: it is loaded, or one sentence says what is wrong with it."""

import sys
from pathlib import Path

import pytest

from drive.slippery_bicycle import SlipperyBicycle
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.loading import load_driver
from roadgpt.errors import PartError, UsageError
from roadgpt.road import Road, World
from tables import rows

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


@pytest.mark.parametrize(
    ("text", "spec", "says"),
    rows(__file__, "every_mistake_is_one_sentence"),
)
def test_every_mistake_is_one_sentence(folder: Path, text: str | None, spec: str, says: str) -> None:
    if text is not None:
        (folder / "f.py").write_text(text)
    with pytest.raises(UsageError, match=says) as caught:
        load_driver(f"{folder}/{spec}")
    assert "\n" not in str(caught.value)
    sys.modules.pop("neighbour", None)
