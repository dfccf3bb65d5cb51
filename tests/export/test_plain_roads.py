"""Files of single roads have the bytes that they had before networks were built (sums of November 2026)."""

import hashlib
from pathlib import Path

import pytest

from roadgpt.export import save
from roadgpt.road import World, build, read_design


def segment(distance: float, direction: str, incline: float, turn_degrees: float) -> dict:
    return {"distance": distance, "direction": direction, "incline": incline, "turn_degrees": turn_degrees}


HILL = {
    "starting_point": [40, 60, 2],
    "theta": 20,
    "road_segment1": segment(50, "straight", 2, 0),
    "road_segment2": segment(40, "left", 2, 60),
    "road_segment3": segment(30, "straight", -3, 0),
    "road_segment4": segment(45, "right", 0, 70),
}
BEND = {
    "starting_point": [30, 125, 0],
    "theta": 0,
    "road_segment1": segment(80, "straight", 0, 0),
    "road_segment2": segment(60, "right", 5, 50),
}
SUMS = {
    "opendrive": ("{}.xodr", "ea213097c854", "f7e3c973196c"),
    "csv": ("{}.csv", "129d01dcf65a", "31687033dc68"),
    "geojson": ("{}.geojson", "43b695e90d7c", "398150dd4782"),
    "lanelet2": ("{}.osm", "3929ce5869c8", "e7ca1b78bf4e"),
    "sbft": ("{}.sbft.json", "42bd8fb3b1c7", "16f7e90a3181"),
    "openscenario": ("{}.xosc", "ee4ba49b8441", "030b62141c30"),
    "sumo": ("{}.edg.xml", "8cd3fd632183", "6ee250b302df"),
}


@pytest.mark.parametrize("format_", SUMS)
def test_a_plain_road_is_written_as_before(format_: str, tmp_path: Path) -> None:
    name, *sums = SUMS[format_]
    for stem, data, wanted in zip(("r0", "r1"), (HILL, BEND), sums, strict=True):
        design, _ = read_design(data)
        save(build(design), tmp_path, [format_], World(), stem)
        written = (tmp_path / name.format(stem)).read_bytes()
        assert hashlib.sha256(written).hexdigest().startswith(wanted)
