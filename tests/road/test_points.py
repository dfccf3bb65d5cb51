"""Points of other tools: every shape gives the road that the plain list gives."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt.network import read_road
from roadgpt.road import Road

PLAN = [[60.0, 100.0], [80.0, 100.0], [110.0, 112.0], [140.0, 130.0]]
HEIGHTS = [0.0, 1.5, 2.0, 4.25]
SPACE = [[x, y, z] for (x, y), z in zip(PLAN, HEIGHTS, strict=True)]
LEVEL = [[x, y, -28, 10] for x, y in PLAN]
BANK = [[x, y, z, 8.0] for x, y, z in SPACE]

FLAT_FILES: dict[str, Any] = {
    "scissor.json": {"test_id": "7", "test_outcome": "FAIL", "road_points": PLAN, "simulation_data": []},
    "scissor_wide.json": {"road_points": LEVEL, "interpolated_road_points": LEVEL},
    "interpolated.json": {"interpolated_road_points": LEVEL},
    "asfault.json": LEVEL,
    "nodes.json": {"nodes": LEVEL},
    "seed.json": {"name": "Road1", "m1": {"control_nodes": PLAN, "sample_nodes": LEVEL}, "seed": {}},
    "sensodat.json": [
        {"_id": {"$oid": "1"}, "road_points": [{"x": x, "y": y} for x, y in PLAN], "meta_data": {}}
    ],
    "numbered.json": [
        {"sequenceNumber": i, "x": PLAN[i][0], "y": PLAN[i][1]} for i in (2, 0, 3, 1)
    ],
    "head.csv": "x,y\n" + "".join(f"{x},{y}\n" for x, y in PLAN),
    "other_order.csv": "name,Y_m,X_m\n" + "".join(f"p,{y},{x}\n" for x, y in PLAN),
    "no_head.csv": "".join(f"{x},{y}\n" for x, y in PLAN),
    "bom.csv": "\ufeffx,y\r\n" + "".join(f"{x},{y}\r\n" for x, y in PLAN),
    "german.csv": "# Straße\nx;y\n" + "".join(f"{x};{y}\n".replace(".", ",") for x, y in PLAN),
    "tabs.tsv": "x\ty\n\n" + "".join(f"{x}\t{y}\n" for x, y in PLAN),
    "spaces.csv": "".join(f"{x}   {y}\n" for x, y in PLAN),
    "width.csv": "".join(f"{x},{y},-28,8\n" for x, y in PLAN),
}  # fmt: skip
HILLY_FILES: dict[str, Any] = {
    "wide.json": BANK,
    "dictionaries.json": {"points": [{"x": x, "y": y, "z": z} for x, y, z in SPACE]},
    "height.csv": "elevation,x,y\n" + "".join(f"{z},{x},{y}\n" for x, y, z in SPACE),
    "three.csv": "".join(f"{x},{y},{z}\n" for x, y, z in SPACE),
}
UNREADABLE = {
    "many.json": ([{"road_points": PLAN}, {"road_points": PLAN}], "holds 2 roads"),
    "model.json": ({"model": {"nodes": {}}}, "it holds no road"),
    "network.json": ({"network": {"nodes": {}}}, "the network cannot be read: 'roads' is missing"),
    "earth.csv": ("lat,lon\n48.1,11.5\n48.2,11.6\n", "in metres"),
    "names.csv": ("a,b\n1,2\n3,4\n", "there are: a, b"),
    "words.csv": ("x,y\n1,2\n3,four\n5,6\n", "row 3 .*'four'"),
    "short.csv": ("x,y\n1,2\n3\n", "row 3"),
    "infinite.csv": ("x,y\n1,2\n3,inf\n", "'inf'"),
    "columns.csv": ("1,2,3,4,5\n1,2,3,4,5\n", "5 columns and no header"),
    "empty.csv": ("\n\n", "is empty"),
    "lonely.csv": ("x,y\n1,2\n", "two points"),
    "binary.csv": ("\x00\x01,\x02", "table"),
}


def written(folder: Path, name: str, content: Any) -> Path:
    path = folder / name
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


def same(one: Road, other: Road) -> None:
    s = np.linspace(0, min(one.length, other.length), 50)
    assert one.length == pytest.approx(other.length, abs=1e-9)
    np.testing.assert_allclose(one.at(s), other.at(s), atol=1e-9)


@pytest.mark.parametrize("name", FLAT_FILES)
def test_flat_roads(name: str, tmp_path: Path) -> None:
    same(read_road(written(tmp_path, name, FLAT_FILES[name])), Road.through(PLAN))


@pytest.mark.parametrize("name", HILLY_FILES)
def test_roads_with_heights(name: str, tmp_path: Path) -> None:
    same(read_road(written(tmp_path, name, HILLY_FILES[name])), Road.through(SPACE))


@pytest.mark.parametrize("name", UNREADABLE)
def test_what_holds_no_road_is_told_of(name: str, tmp_path: Path) -> None:
    content, said = UNREADABLE[name]
    with pytest.raises(UsageError, match=said):
        read_road(written(tmp_path, name, content))


@pytest.mark.parametrize("name", ["scissor_wide.json", "head.csv"])
def test_every_command_takes_them(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, name, FLAT_FILES[name])
    for words in (
        ["check", name],
        ["drive", name],
        ["export", name, "--to", "opendrive"],
        ["view", name, "--format", "png"],
    ):
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, f"{words}: {result.output}"
    assert list(tmp_path.glob("exports/*.xodr"))
    assert list(tmp_path.glob("plots/*/birds_eye.png"))
