"""What every exporter promises, and what ``save`` promises for all of them."""

from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD, contents, drive
from roadgpt import plugins
from roadgpt.errors import ExportError, PartError, UsageError
from roadgpt.export import Exporter, Poses, exporter_of, save
from roadgpt.road import CrossSection, World

FORMATS = plugins.names("exporters")


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("name", ["arcs", "spline", "short"])
def test_the_same_road_gives_the_same_bytes_wherever_it_is_written(
    tmp_path: Path, format_: str, name: str
) -> None:
    part = exporter_of(format_)
    assert isinstance(part, Exporter)
    assert part.name == format_
    road = ROADS[name]
    for poses in (None, drive(road)):
        written = [
            save(road, tmp_path / str(i) / "deep er", [format_], WORLD, "a road", poses) for i in (1, 2)
        ]
        assert written[0][0].parent / f"a road{part.suffix}" in written[0]
        assert all(path.name.startswith("a road") and path.exists() for path in written[0])
        one, other = contents(tmp_path / "1" / "deep er"), contents(tmp_path / "2" / "deep er")
        assert one == other
        assert {name.split("/")[0] for name in one} >= {path.name for path in written[0]}
        assert all(one.values())
        assert not any(str(tmp_path).encode() in data for data in one.values())


@pytest.mark.parametrize("format_", FORMATS)
def test_a_wider_world_is_another_file(tmp_path: Path, format_: str) -> None:
    if format_ == "sbft":  # holds the centre line, whatever lies beside it
        return
    for width in (3.0, 3.5):
        save(ROADS["arcs"], tmp_path / str(width), [format_], World(section=CrossSection(lane_width=width)))
    assert contents(tmp_path / "3.0") != contents(tmp_path / "3.5")


def test_formats_are_written_in_their_order_and_once(tmp_path: Path) -> None:
    written = save(ROADS["arcs"], tmp_path, ["csv", "opendrive", "csv"], WORLD)
    names = ["road.csv", "road.route.json", "road.xodr"]
    assert [path.name for path in written] == names
    assert sorted(path.name for path in tmp_path.iterdir()) == names


def test_no_file_is_written_where_one_format_is_unknown(tmp_path: Path) -> None:
    with pytest.raises(PartError, match=r"no exporter called 'gpx'; there are: .*opendrive"):
        save(ROADS["arcs"], tmp_path / "new", ["csv", "gpx"], WORLD)
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("name", ["", "a/b", "..", "/tmp"])
def test_a_name_is_a_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(UsageError, match="give a name without a folder"):
        save(ROADS["arcs"], tmp_path, ["csv"], WORLD, name)


def test_what_a_part_wrote_before_it_failed_is_not_left_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Failing:
        name, suffix = "failing", ".x"

        def save(self, road: object, path: Path, world: object, poses: object = None) -> None:
            path.write_text("half")
            raise ExportError("no")

    monkeypatch.setattr(plugins, "find", lambda shelf, name: Failing)
    (tmp_path / "road.x").write_text("before")
    with pytest.raises(ExportError, match="no"):
        save(ROADS["arcs"], tmp_path, ["failing"], WORLD)
    assert contents(tmp_path) == {"road.x": b"before"}


def test_a_folder_that_is_a_file_is_told_of(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ExportError, match=r"cannot write into .*file: .*; name another folder"):
        save(ROADS["arcs"], tmp_path / "file", ["csv"], WORLD)


def test_poses_are_of_one_length_finite_and_in_time() -> None:
    good = {name: np.array([0.0, 1.0]) for name in Poses.__dataclass_fields__}
    assert len(Poses.of({**good, "steer": np.zeros(7)})) == 2
    for bad in (
        {"x": np.zeros(3)},
        {"speed": np.zeros(1)},
        {"time": np.array([0.0, 1.0, 2.0])},
        {name: np.zeros(1) for name in good},
        {name: np.zeros((2, 2)) for name in good},
        {"z": np.array([0.0, np.nan])},
        {"time": np.array([1.0, 1.0])},
    ):
        with pytest.raises(UsageError, match="poses cannot be exported"):
            Poses.of({**good, **bad})
    with pytest.raises(UsageError, match="have no pitch, roll"):
        Poses.of({name: value for name, value in good.items() if name not in ("pitch", "roll")})
