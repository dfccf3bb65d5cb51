"""Two roads one above the other: on the same scales, on either's axes."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from roadgpt.cli import app
from roadgpt.report.pair import pair
from roadgpt.road import Road, World
from roadgpt.road.world import oracle_limits
from roadgpt.run import Setup, prove

LONG = [[20, 20, 0], [60, 30, 2], [100, 60, 4], [110, 110, 7], [150, 140, 30], [210, 200, 40]]
SHORT = [[20, 20, 0], [60, 30, 2], [100, 60, 4]]


def run_of(points: list[list[float]]) -> object:
    return prove(Road.through(points), setup=Setup(drives=False))


def test_both_roads_have_the_same_scales() -> None:
    figure = pair(run_of(LONG), run_of(SHORT))  # type: ignore[arg-type]
    above, beside, above2, beside2 = figure.axes
    assert np.ptp(above.get_xlim()) == pytest.approx(np.ptp(above2.get_xlim()))
    assert np.ptp(above.get_xlim()) == pytest.approx(np.ptp(above.get_ylim()))
    assert beside.get_xlim() == beside2.get_xlim()
    assert np.ptp(beside.get_ylim()) == pytest.approx(np.ptp(beside2.get_ylim()))
    assert above.get_position().y0 > above2.get_position().y1


def test_of_drivers_that_are_judged_by_their_tyres_the_distance_from_failing_is_drawn() -> None:
    """Not the share of the car outside, which stays 0 until a tyre has long passed the marking."""
    world = World().changed(**oracle_limits("departure"))
    road = Road.through([[20, 20, 0], [60, 30, 0], [100, 60, 0], [110, 110, 0]])
    run = prove(road, 1, world, Setup(driver="lane_centring"))
    assert run.verdict is not None
    figure = pair(run, run, drivers=("one", "other"))
    beside = figure.axes[1]
    assert max(np.asarray(beside.lines[0].get_ydata())) == pytest.approx(-run.verdict.margin, abs=1e-6)
    assert "FAIL above 0 m" in [text.get_text() for text in beside.texts]
    assert beside.get_ylabel().endswith(", m")


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import json

    monkeypatch.chdir(tmp_path)
    for name, points in (("a.json", LONG), ("b.json", SHORT)):
        Path(name).write_text(json.dumps(points))
    result = CliRunner().invoke(app, ["compare", "a.json", "b.json"])
    assert result.exit_code == 0, result.output
    assert "number of turns" in result.output
    assert Path("compared.png").read_bytes()[:4] == b"\x89PNG"
    again = CliRunner().invoke(app, ["compare", "a.json", "a.json", "--json", "--out", "pictures/same.png"])
    assert json.loads(again.stdout)["duplicate"] is True
    wrong = CliRunner().invoke(app, ["compare", "a.json", "none.json"])
    assert wrong.exit_code == 2
