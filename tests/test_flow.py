"""Words in, a folder out: the whole flow with the parts that are installed, as a user meets it."""

import json
import math
import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from roadgpt.campaign import campaign
from roadgpt.cli import app
from roadgpt.cli.summary import text_lines
from roadgpt.report import Drawing
from roadgpt.run import Setup, read_run

WORDS = "an uphill road with 3 turns"
PICTURES = {"birds_eye.png", "height.png", "curvature_grade.png"}


def roadgpt(cwd: Path, *arguments: str) -> list[dict[str, Any]]:
    """Call the command line in a folder; gives back its JSON lines."""
    command = [sys.executable, "-c", "from roadgpt.cli import main; main()", *arguments, "--json"]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def in_this_process(cwd: Path, *arguments: str) -> list[dict[str, Any]]:
    """The same without another process, which takes seconds to start."""
    before = Path.cwd()
    os.chdir(cwd)
    try:
        done = CliRunner().invoke(app, [*arguments, "--json"], prog_name="roadgpt")
    finally:
        os.chdir(before)
    assert done.exit_code == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[dict[str, Any]]]:
    home = tmp_path_factory.mktemp("home")
    return home, roadgpt(home, "run", WORDS, "-n", "2", "--seed", "7")


def folder_of(home: Path) -> Path:
    return home / "roadgpt-runs" / "an-uphill-road-with-3-turns-7"


def turns_of(points: np.ndarray) -> int:
    """Stretches of one hand, counted on the file's points; gentler than 1/300 per metre is straight."""
    step = np.diff(points[:, :2], axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    bend = np.convolve(np.diff(heading), np.ones(5) / 5, mode="same")
    hand = np.where(np.abs(bend) > 1 / 300, np.sign(bend), 0)
    starts = np.flatnonzero(np.diff(hand, prepend=0) != 0)
    return sum(
        hand[a] != 0 and abs(bend[a:b].sum()) > math.radians(10)
        for a, b in zip(starts, [*starts[1:], len(hand)], strict=True)
    )


def test_words_become_a_folder(made: tuple[Path, list[dict[str, Any]]]) -> None:
    home, lines = made
    folder = folder_of(home)
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "campaign.lock",
        "campaign.sqlite",
        "results.csv",
        "cells.csv",
        "test.0001.json",
        "test.0002.json",
        "generation_stats.csv",
        "oob_stats.csv",
        "experiment_description.csv",
        "overview.png",
        "runs",
    }
    for number, line in enumerate(lines, 1):
        assert Path(line["file"]).name == f"test.{number:04d}.json"
        run = folder / "runs" / f"{number:04d}"
        assert {path.name for path in run.iterdir()} >= PICTURES | {
            "brief.json",
            "design.json",
            "road.json",
            "drive.npz",
            "verdict.json",
            "run.json",
        }


def test_the_roads_keep_what_the_words_promise(made: tuple[Path, list[dict[str, Any]]]) -> None:
    home, lines = made
    assert len(lines) == 2
    for line in lines:
        test = json.loads((home / line["file"]).read_text())
        points = np.array(test["interpolated_points"])
        assert test["is_valid"] is line["is_valid"] is True
        assert turns_of(points) == 3
        assert (points[20:, 2] - points[:-20, 2]).min() > -0.2  # no 20 m that descend
        assert (points[-1, 2] - points[0, 2]) / line["length_m"] > 0.01
        assert test["test_outcome"] == line["test_outcome"] in ("PASS", "FAIL")
        assert max(record[16] for record in test["execution_data"]) <= line["max_oob"] + 1e-3


def test_the_lines_that_show_prints_make_the_same_again(
    made: tuple[Path, list[dict[str, Any]]], tmp_path: Path
) -> None:
    home, lines = made
    run = folder_of(home) / "runs" / "0002"
    said = [*text_lines(run)]
    (again,) = [line.split(maxsplit=1)[1] for line in said if line.strip().startswith("again ")]
    (drive,) = [line.split(maxsplit=1)[1] for line in said if line.strip().startswith("or ")]
    program, *arguments = shlex.split(again)
    assert program == "roadgpt"
    in_this_process(tmp_path, *arguments, "--no-plot")
    for name in ("brief.json", "design.json", "road.json", "drive.npz", "verdict.json", "run.json"):
        assert (folder_of(tmp_path) / "runs" / "0002" / name).read_bytes() == (run / name).read_bytes()
    (redriven,) = in_this_process(home, *shlex.split(drive)[1:])
    for key in ("test_outcome", "max_oob", "margin_m", "length_m"):
        assert redriven[key] == lines[1][key]


def test_the_three_prompts_of_roadgpt_s_evaluation(tmp_path: Path) -> None:
    prompts = (
        "a road",
        WORDS,
        "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
    )
    for number, words in enumerate(prompts):
        out = tmp_path / str(number)
        draw = Drawing("thesis") if words == WORDS else None
        runs = list(campaign(words, 2, 1, out=out, draw=draw))
        assert [run.is_valid for run in runs] == [True, True]
        assert {run.outcome for run in runs} <= {"PASS", "FAIL"}
        assert read_run(out / "test.0002.json").verdict == runs[1].verdict
    assert sum(run.road is not None and turns_of(run.road.centreline()) == 3 for run in runs) == 2


@pytest.mark.parametrize("words", [WORDS, "4 switchbacks downhill"])
def test_roadgpts_spline_keeps_the_words_too(tmp_path: Path, words: str) -> None:
    setup = Setup(drives=False, geometry="spline")
    runs = list(campaign(words, 2, seed=5, setup=setup, out=tmp_path / "spline"))
    assert [run.outcome for run in runs] == ["VALID"] * 2
    for run in runs:
        assert run.road is not None
        assert run.road.nodes is not None
        assert turns_of(run.road.centreline()) == (3 if words == WORDS else 4)
