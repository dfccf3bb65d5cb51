"""esmini plays our scenarios without a window, to the end and without a complaint, where it is at hand."""

import re
import subprocess
from pathlib import Path

import pytest

from exported import ROADS, WORLD, among_others, drive, program
from roadgpt.export import save

# what it says where it has no models to draw
HARMLESS = re.compile(
    r"scene graph|3D model|model_ids|traffic sign|georeference|geo reference", re.IGNORECASE
)


def played(esmini: str, scenario: Path) -> tuple[float, list[str]]:
    """How many seconds were played, and what was complained of."""
    log = scenario.with_suffix(".log")
    play = [esmini, "--osc", str(scenario), "--headless", "--fixed_timestep", "0.05", "--disable_stdout"]
    subprocess.run([*play, "--logfile_path", str(log)], timeout=120, capture_output=True, check=True)
    said = log.read_text(errors="replace").splitlines()
    times = [float(time.group(1)) for line in said if (time := re.match(r"\[([\d.]+)\]", line))]
    return max(times, default=0.0), [x for x in said if "[error]" in x and not HARMLESS.search(x)]


@pytest.mark.parametrize("name", ["arcs", "spline"])
def test_esmini_plays_the_scenario_and_the_recorded_drive(tmp_path: Path, name: str) -> None:
    esmini = program("esmini")
    road, poses = ROADS[name], drive(ROADS[name])
    save(road, tmp_path, ["openscenario"], WORLD, poses=poses)
    seconds, complaints = played(esmini, tmp_path / "road.xosc")
    assert complaints == []
    assert road.length / WORLD.limits.speed_limit < seconds < 60  # the end is reached before patience is
    seconds, complaints = played(esmini, tmp_path / "road.drive.xosc")
    assert complaints == []
    assert seconds == pytest.approx(poses.time[-1], abs=0.2)


def test_esmini_plays_a_drive_among_others_to_the_end(tmp_path: Path) -> None:
    esmini, (poses, _) = program("esmini"), among_others()
    save(ROADS["arcs"], tmp_path, ["openscenario"], WORLD, poses=poses)
    seconds, complaints = played(esmini, tmp_path / "road.drive.xosc")
    assert complaints == []
    assert seconds == pytest.approx(poses.time[-1], abs=0.2)
