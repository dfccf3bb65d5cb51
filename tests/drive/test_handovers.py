"""A driver may let somebody else drive for a while: the Drive says when, the Verdict whose a failure is."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drive.test_driver_guard import VIEW
from roadgpt.campaign.traces import read_traces, trace_of, write_traces
from roadgpt.drive import COLUMNS, Box, Columns, Command, Drive, Handover, View, driver_of, simulate
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.drivers.reference import Reference
from roadgpt.road import Road, World
from roadgpt.verdict import Verdict, judge

WORLD = World()
STRAIGHT = Road.through([[0, 0], [50, 0], [100, 0]])

SHARES_THE_WAY = """
from roadgpt.drive.drivers.reference import Reference


class Hands(Reference):
    name = "hands"
    handed_to = None

    def steer(self, view):
        self.handed_to = "a person" if 20 <= view.s < 60 else None
        return super().steer(view)
"""


def by_hand(handovers: tuple[Handover, ...], t: list[float], ended: str = "goal") -> Drive:
    """A car that moves 10 m along STRAIGHT at every step of 20 ms, at these offsets from the centre line."""
    n = len(t)
    columns = {name: np.zeros(n) for name in COLUMNS}
    columns["time"], columns["s"] = 0.02 * np.arange(n), 5 + 10.0 * np.arange(n)
    columns["x"], columns["y"], columns["t"] = columns["s"], np.array(t), np.array(t)
    columns["speed"] = np.full(n, 10.0)
    columns["outside"] = np.array([float(abs(each + 2) > 2) for each in t])
    return Drive("tested", "paper", 0, Columns(columns), ended, Box(4.7, 1.86), handovers)  # type: ignore[arg-type]


def test_the_shares_of_the_way_and_who_drove_where() -> None:
    # of the 8 steps, those that begin at 0.04, 0.06 and 0.12 s
    drive = by_hand((Handover(0.04, 0.08, "reference"), Handover(0.12, 0.14, "chauffeur")), [-2.0] * 9)
    assert [drive.handed_to(step) for step in range(9)] == [
        None, None, None, "reference", "reference", None, None, "chauffeur", None,
    ]  # fmt: skip
    assert drive.shares == pytest.approx({"tested": 5 / 8, "reference": 2 / 8, "chauffeur": 1 / 8})
    verdict = judge(STRAIGHT, drive, WORLD)
    assert verdict.description.endswith(
        "; tested drove 62 % of the way and handed over to reference for 25 % and chauffeur for 12 %"
    )
    assert (verdict.own_share, verdict.handed_to) == (pytest.approx(5 / 8), None)


@pytest.mark.parametrize(
    ("handover", "whose"),
    [((0.0, 0.06), "reference"), ((0.04, 0.08), "reference"), ((0.0, 0.04), None), ((0.06, 0.08), None)],
)
def test_a_failure_is_of_whoever_drove_there(handover: tuple[float, float], whose: str | None) -> None:
    # the car is outside after its third step, which begins at 0.04 s
    drive = by_hand((Handover(*handover, "reference"),), [-2.0, -2.0, -2.0, 1.0, 1.0], "out_of_lane")
    verdict = judge(STRAIGHT, drive, WORLD)
    assert (verdict.outcome, verdict.at_time, verdict.handed_to) == ("FAIL", pytest.approx(0.06), whose)
    excuse = "; reference drove where the car failed, so the failure is not tested's"
    assert (excuse in verdict.description) == (whose is not None)
    assert Verdict.from_json(json.loads(json.dumps(verdict.to_json()))) == verdict


class Hands(Reference):
    name = "hands"
    handed_to: Any = None

    def steer(self, view: View) -> Command:
        self.handed_to = "a person" if 20 <= view.s < 60 else None
        return super().steer(view)


def test_in_the_simulator_and_in_a_process_of_its_own_the_same_is_recorded(tmp_path: Path) -> None:
    drive = simulate(STRAIGHT, WORLD, Hands())
    (only,) = drive.handovers
    at = {"start": np.searchsorted(drive["s"], 20), "end": np.searchsorted(drive["s"], 60)}
    assert only == (drive["time"][at["start"]], pytest.approx(drive["time"][at["end"]]), "a person")
    way = drive["s"][-1] - drive["s"][0]
    assert drive.shares["a person"] == pytest.approx(40 / way, abs=0.5 / way)
    (tmp_path / "hands.py").write_text(SHARES_THE_WAY)
    apart = simulate(STRAIGHT, WORLD, driver_of(f"{tmp_path / 'hands.py'}:Hands"))
    assert apart.to_bytes() == drive.to_bytes()


def test_files_keep_the_handovers(tmp_path: Path) -> None:
    drive = simulate(STRAIGHT, WORLD, Hands())
    (tmp_path / "drive.npz").write_bytes(drive.to_bytes())
    again = Drive.load(tmp_path / "drive.npz")
    assert again.handovers == drive.handovers
    assert again.to_bytes() == drive.to_bytes()
    name = write_traces(tmp_path, 1, [("c01", 1, trace_of(drive))])
    stored = read_traces(tmp_path / "traces" / name, "c01", 1)
    assert stored.handovers == drive.handovers
    assert stored.shares == pytest.approx(drive.shares, abs=1e-4)
    steps = range(len(drive))
    assert [stored.handed_to(step) for step in steps] == [drive.handed_to(step) for step in steps]


@pytest.mark.parametrize(
    ("name", "told"),
    [(7, "7"), ("two\nlines", r"'two\nlines'"), ("x" * 200, "x" * 117 + "..."), ("hands", None)],
)
def test_whatever_a_driver_names_is_a_short_text_of_one_line(name: Any, told: str | None) -> None:
    driver = Hands()
    driver.start(STRAIGHT, WORLD, 0)
    driver.steer = lambda view: Command(0.0)  # type: ignore[method-assign]
    driver.handed_to = name
    guard = DriverGuard(driver)
    guard.ask(VIEW)
    assert guard.handed_to == told
    assert [each.by for each in guard.handovers] == [told] * (told is not None)
