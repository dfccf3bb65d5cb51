"""``roadgpt import``: the command that it prints works when it is typed."""

import json
import math
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.cli import app
from roadgpt.cli.commands.import_ import _on_a_map
from roadgpt.network import read_road
from roadgpt.plugins import find
from roadgpt.road import read_opendrive

LANES = """<lanes><laneSection s="0"><left>
<lane id="1" type="driving"><width sOffset="0" a="{width}"/></lane></left><right>
<lane id="-1" type="driving"><width sOffset="0" a="{width}"/></lane></right></laneSection></lanes>"""


def file(folder: Path, line: str, rest: str = "", width: float = 3.5) -> Path:
    path = folder / "town.xodr"
    lanes = LANES.format(width=width)
    path.write_text(
        f'<OpenDRIVE><road id="5" length="1"><planView>{line}</planView>{rest}{lanes}</road></OpenDRIVE>'
    )
    return path


def element(x: float, y: float, heading: float, length: float, shape: str = "<line/>", s: float = 0) -> str:
    return f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">{shape}</geometry>'


def invoke(*words: str) -> Result:
    result = CliRunner().invoke(app, list(words), prog_name="roadgpt")
    assert "Traceback" not in result.output
    assert result.exit_code in (0, 2), result.output
    return result


def typed(path: Path) -> tuple[dict[str, object], str]:
    """The row of the command that ``import`` prints, and what ``import`` told on the way."""
    result = invoke("import", str(path), "--out", str(path.with_suffix(".json")))
    assert result.exit_code == 0, result.output
    command = shlex.split(re.findall(r"drive it: roadgpt (drive .*)$", result.stdout, re.M)[0])
    return json.loads(invoke(*command, "--json").stdout.splitlines()[-1]), result.stderr


@pytest.mark.parametrize("y", [0.0, 2.0, 3.4, 4.2, 247.0, 250.0, -0.01])
def test_a_road_whose_lane_would_leave_the_map_is_moved(tmp_path: Path, y: float) -> None:
    """Its centre line is on the map, the edge of a lane is not, or not by as much as the rule wants."""
    row, told = typed(file(tmp_path, element(20, y, 0, 100)))
    assert row["findings"] == []
    assert row["test_outcome"] == "PASS"
    assert "into the middle of the map" in told


def test_a_road_on_the_map_keeps_its_place(tmp_path: Path) -> None:
    row, told = typed(file(tmp_path, element(20, 30, 0, 100)))
    assert (row["test_outcome"], row["findings"]) == ("PASS", [])
    assert "moved" not in told
    assert read_road(tmp_path / "town.json").at(0.0)[:2] == pytest.approx([20, 30])


@given(
    st.floats(-1e7, 1e7), st.floats(-1e7, 1e7), st.floats(-3.2, 3.2), st.floats(25, 3_000),
    st.floats(2, 10), st.floats(-0.01, 0.01),
)  # fmt: skip
@settings(max_examples=40, deadline=None)
def test_placing_and_the_rule_have_one_measure(
    tmp_path_factory: pytest.TempPathFactory,
    x: float,
    y: float,
    heading: float,
    length: float,
    width: float,
    bend: float,
) -> None:
    folder = tmp_path_factory.mktemp("place")
    arc = f'<arc curvature="{bend!r}"/>'
    road, world, _ = _on_a_map(read_opendrive(file(folder, element(x, y, heading, length, arc), width=width)))
    assert find("rules", "inside_map")(road, None, world) == ()
    t = np.array([-world.section.lane_width, world.section.lane_width])[:, None]
    edges = road.at(np.linspace(0, road.length, 5_000), t)[..., :2]
    assert edges.min() > 0
    assert edges.max() < world.site.map_size


def test_a_map_far_away_and_deep_down_is_brought_here(tmp_path: Path) -> None:
    heights = '<elevationProfile><elevation s="0" a="-412.5" b="0.02" c="0" d="0"/></elevationProfile>'
    row, told = typed(file(tmp_path, element(691_000.25, 5_335_900.5, 1.1, 120), heights))
    assert (row["test_outcome"], row["findings"]) == ("PASS", [])
    assert "it is lifted by 412.5 m: its lowest place was below the ground of the map" in told


def test_a_road_too_large_for_any_map_is_driven_where_it_is(tmp_path: Path) -> None:
    result = invoke(
        "import", str(file(tmp_path, element(0, 0, 0, 12_000))), "--out", str(tmp_path / "a.json")
    )
    assert "12040 m wide, too large for a map; its place is kept" in result.stderr


LOOP = element(0, 0, 0, 2.2 * math.pi * 40, '<arc curvature="0.025"/>')
HOOK = element(0, 0, 0, 60) + element(60, 0, 0, math.pi * 6, f'<arc curvature="{1 / 6!r}"/>', 60.0)


@pytest.mark.parametrize(
    ("line", "finding"),
    [(LOOP, "overlaps itself at s ="), (HOOK, "tighter than"), (element(0, 0, 0, 12), "longer than 20 m")],
    ids=["loop", "hook", "short"],
)
def test_what_the_rules_say_stands_beside_the_verdict(tmp_path: Path, line: str, finding: str) -> None:
    row, _ = typed(file(tmp_path, line))
    assert row["test_outcome"] in ("PASS", "FAIL")
    assert any(finding in sentence for sentence in row["findings"])  # type: ignore[attr-defined]
    assert row["validation_message"] == row["findings"][0]  # type: ignore[index]


def test_a_road_of_a_few_metres_is_invalid_in_a_sentence(tmp_path: Path) -> None:
    row, _ = typed(file(tmp_path, element(0, 0, 0, 7)))
    assert row["test_outcome"] == "INVALID"
    assert str(row["description"]).startswith(
        "the road is 7.0 m long, too short to be driven: a car starts 2.5"
    )
