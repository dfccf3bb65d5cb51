"""The door to maps of other tools: what every reader must do, and that a new one is found by the ending."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from exported import ROADS
from roadgpt import plugins
from roadgpt.cli import app
from roadgpt.errors import PartError, UsageError
from roadgpt.network import ImportedMap, ImportedRoad, Network, NetworkRoad, read_map, read_road, read_source
from roadgpt.road import Profile, World

ROAD = ROADS["arcs"]
LANES = ROAD.with_profile(Profile.of(1, 1, 3.5, 1.0))
GRID = SimpleNamespace(
    count_roads=lambda path: int(path.read_text()),
    read_map=lambda path: ImportedMap(Network((NetworkRoad(7, LANES),)), {"a": (7,)}, ("no lights",)),
    read_road=lambda path, road: ImportedRoad(ROAD, road or "a", "", 3.5, 1.0, 20.0, None, ("one of two",)),
)


@pytest.fixture
def shelf(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[EntryPoint]]:
    """The readers of maps that are installed, to which others may be added."""
    there, ours = plugins.entry_points, [*plugins.entry_points("roadgpt.maps")]
    monkeypatch.setattr(
        plugins, "entry_points", lambda group: ours if group == "roadgpt.maps" else there(group)
    )
    plugins._registered.cache_clear()
    yield ours
    plugins._registered.cache_clear()


@pytest.mark.parametrize("name", plugins.names("maps"))
@pytest.mark.parametrize("content", [None, b"", b"hello", b"<a/>", b"\x00\xff"])
def test_a_reader_refuses_what_is_no_map_in_one_sentence_that_names_the_file(
    tmp_path: Path, name: str, content: bytes | None
) -> None:
    reader, path = plugins.find("maps", name), tmp_path / f"town.{name}"
    if content is not None:
        path.write_bytes(content)
    for read in (reader.read_map, reader.count_roads, lambda each: reader.read_road(each, None)):
        with pytest.raises(UsageError) as caught:
            read(path)
        assert str(caught.value).startswith(f"{path}: ")
        assert "\n" not in str(caught.value)


def test_a_reader_of_another_package_is_found_by_the_ending(shelf: list[EntryPoint], tmp_path: Path) -> None:
    shelf += [
        EntryPoint("net.xml", f"{__name__}:GRID", "roadgpt.maps"),
        EntryPoint("xml", "no:X", "roadgpt.maps"),
    ]
    one, two = tmp_path / "one.NET.xml", tmp_path / "two.net.xml"
    one.write_text("1")
    two.write_text("2")
    assert read_source(one)[1:] == (("one of two",), GRID.read_road(one, None).world_values, "a", "", False)
    assert read_road(one).length == ROAD.length
    whole = read_source(two)
    assert whole.remarks == ("no lights",)
    assert whole.world == {"limit_stated": False}
    assert read_map(one).roads == {"a": (7,)}
    assert World().changed(**read_source(one).world).limits.speed_limit == 20.0
    told = CliRunner().invoke(app, ["check", str(tmp_path)])
    assert "one.NET.xml" in told.output
    assert "left out" not in told.output
    said = CliRunner().invoke(app, ["run", "two.net.xml"])
    assert said.exit_code == 2
    assert "two.net.xml is the name of a file, not a description" in said.output


def test_xml_with_an_ending_of_nobody_is_given_to_the_reader_of_opendrive(tmp_path: Path) -> None:
    path = tmp_path / "town.osm"
    path.write_text('<osm version="0.6"/>')
    with pytest.raises(UsageError, match="not OpenDRIVE, but a file of Lanelet2 or OpenStreetMap"):
        read_source(path)


def test_a_map_without_a_reader_is_refused_in_one_sentence(shelf: list[EntryPoint], tmp_path: Path) -> None:
    path = tmp_path / "town.xodr"
    path.write_text("<OpenDRIVE/>")
    shelf[:] = [EntryPoint("net.xml", f"{__name__}:GRID", "roadgpt.maps")]
    with pytest.raises(PartError, match=r"no map called 'xodr'; there are: net\.xml"):
        read_source(path)
