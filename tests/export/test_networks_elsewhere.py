"""Which formats hold junctions: opendrive does; csv and geojson hold the route; all others refuse."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import shapely

from roadgpt import plugins
from roadgpt.errors import ExportError
from roadgpt.export import exporter_of, save
from roadgpt.network import Route, build_route
from roadgpt.road import World, read_design
from roadgpt_formats.georeference import degrees

HOLD = {
    "gltf",
    "heightmap",
    "opendrive",
    "opendrive17",
    "csv",
    "geojson",
    "openscenario",
    "commonroad",
    "lanelet2",
}
WORLD = World()
RADIUS = 15.0  # m, of the central island in the design below


def route() -> Route:
    """Returns a route straight on through a roundabout."""
    design = {
        "starting_point": [100, 100, 0],
        "theta": 0,
        "road_segment1": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
        "junction1": {"after": 1, "kind": "roundabout", "take": "straight", "radius": RADIUS},
        "road_segment2": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
    }
    return build_route(read_design(design)[0], WORLD).on_ground()


ROUTE = route()


@pytest.mark.parametrize("format_", sorted(set(plugins.names("exporters")) - HOLD))
def test_a_format_for_single_roads_refuses_a_network_in_one_sentence(tmp_path: Path, format_: str) -> None:
    with pytest.raises(ExportError, match=rf"^{format_} cannot hold junctions yet; opendrive can\b[^.]*$"):
        save(ROUTE, tmp_path / "new", ["csv", format_], WORLD)
    assert not (tmp_path / "new").exists()  # nor the format that could


@pytest.mark.parametrize("format_", sorted(HOLD))
def test_the_others_write_it(tmp_path: Path, format_: str) -> None:
    assert getattr(exporter_of(format_), "holds_junctions", False)
    assert all(path.stat().st_size for path in save(ROUTE, tmp_path, [format_], WORLD))


def test_a_table_follows_the_route(tmp_path: Path) -> None:
    (file,) = save(ROUTE, tmp_path, ["csv"], WORLD)
    with file.open(newline="") as handle:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(handle)]
    assert rows[-1]["s_m"] == pytest.approx(ROUTE.length, abs=1e-5)
    # half-way, on the right of the centre as traffic goes round counter-clockwise
    nearest = min(np.hypot(row["x_m"] - CENTRE[0], row["y_m"] - CENTRE[1]) for row in rows)
    assert nearest == pytest.approx(RADIUS, abs=0.01)
    assert min(row["y_m"] for row in rows) < 100 - RADIUS + 0.1


# The road is 40 m long, from its contact 9 m of approach and 5 m of ring lead to the island.
CENTRE = (100 + 40 + 9 + 5 + RADIUS, 100.0)


def test_a_map_shows_the_paved_area_with_its_island(tmp_path: Path) -> None:
    (file,) = save(ROUTE, tmp_path, ["geojson"], WORLD)
    features = json.loads(file.read_text())["features"]
    assert [each["properties"]["name"] for each in features] == ["centre line", "paved area"]
    outline, *holes = features[1]["geometry"]["coordinates"]
    assert all(ring[0] == ring[-1] for ring in (outline, *holes))
    area = shapely.Polygon(outline, holes)
    assert area.is_valid
    paved = shapely.transform(ROUTE.network.paved, lambda at: np.column_stack(degrees(*at.T)))
    assert shapely.symmetric_difference(area, paved).area < 1e-5 * paved.area
    line = np.array(features[0]["geometry"]["coordinates"])
    middle = ROUTE.at(np.linspace(0.0, ROUTE.length, len(line)))
    assert line == pytest.approx(np.column_stack([*degrees(*middle[:, :2].T), middle[:, 2]]), abs=2e-9)
    assert shapely.LinearRing(outline).is_ccw
    assert not any(shapely.LinearRing(ring).is_ccw for ring in holes)
    x, y = np.array([CENTRE[0], CENTRE[0] + RADIUS + 2.5]), np.array([CENTRE[1], CENTRE[1]])
    at = np.column_stack(degrees(x, y))
    assert not area.contains(shapely.Point(at[0]))  # the island
    assert area.contains(shapely.Point(at[1]))  # the ring, on the far side
