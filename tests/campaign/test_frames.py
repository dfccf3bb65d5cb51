"""Tests and drives as DataFrames are what pandas itself reads from the files."""

import sys
from pathlib import Path

import numpy as np
import pytest

import roadgpt
from command_line import roadgpt as command
from roadgpt.campaign.folder_record import kept_run
from roadgpt.drive.drive import COLUMNS
from roadgpt.errors import UsageError

WORDS = ("turn x2", "--reader", "plan", "--seed", 7, "--driver", "beamng_like", "--friction", 0.3)


@pytest.mark.usefixtures("no_workers")
def test_tests_are_the_rows_of_the_table(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    command("campaign", *WORDS, "-n", 3, "--out", tmp_path / "c")
    frame, table = roadgpt.to_frame(tmp_path / "c"), pandas.read_csv(tmp_path / "c" / "results.csv")
    assert len(frame) == 3
    both = (each.replace("", np.nan).fillna(np.nan) for each in (frame, table))
    pandas.testing.assert_frame_equal(*both, check_dtype=False, rtol=1e-6)
    command("run", *WORDS, "-n", 2, "--no-plot", "--out", tmp_path / "r")
    own = roadgpt.to_frame(str(tmp_path / "r"))
    assert list(own["test"]) == [1, 2]
    assert list(own["outcome"]) == ["FAIL", "FAIL"]
    drive = kept_run(tmp_path / "c", "c01", 1).drive
    assert drive is not None
    steps = drive.to_frame()
    assert list(steps.columns) == list(COLUMNS)
    assert len(steps) == len(drive)
    assert all((steps[name].to_numpy() == drive[name]).all() for name in COLUMNS)


def test_without_pandas_it_is_said_how_to_install_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(UsageError, match=r"needs the package 'pandas'; install it with: .*pip install"):
        roadgpt.to_frame(tmp_path)
