"""What every exporter promises, and what ``save`` promises for all of them."""

from pathlib import Path

import pytest

from exported import ROADS, WORLD, contents, drive
from roadgpt import plugins
from roadgpt.errors import ExportError, PartError
from roadgpt.export import Exporter, exporter_of, save

FORMATS = plugins.names("exporters")


@pytest.mark.parametrize("format_", FORMATS)
def test_the_same_road_gives_the_same_bytes_wherever_it_is_written(tmp_path: Path, format_: str) -> None:
    part = exporter_of(format_)
    assert isinstance(part, Exporter)
    assert part.name == format_
    for road, poses in ((ROADS["short"], None), (ROADS["arcs"], drive(ROADS["arcs"]))):
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


def test_formats_are_written_in_their_order_and_once(tmp_path: Path) -> None:
    written = save(ROADS["arcs"], tmp_path, ["csv", "opendrive", "csv"], WORLD)
    names = ["road.csv", "road.route.json", "road.xodr"]
    assert [path.name for path in written] == names
    assert sorted(path.name for path in tmp_path.iterdir()) == names


def test_no_file_is_written_where_one_format_is_unknown(tmp_path: Path) -> None:
    with pytest.raises(PartError, match=r"no exporter called 'gpx'; there are: .*opendrive"):
        save(ROADS["arcs"], tmp_path / "new", ["csv", "gpx"], WORLD)
    assert not (tmp_path / "new").exists()


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
