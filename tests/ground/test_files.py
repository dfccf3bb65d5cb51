"""Heights of land in files: written ones are read back, and what is no land is refused in one sentence.

Second opinions: rasterio, PIL and NumPy read what is written here, and PROJ measures degrees."""

import json
import struct
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from numpy.typing import NDArray
from PIL import Image
from rasterio.transform import Affine
from rasterio.warp import transform

from roadgpt.errors import UsageError
from roadgpt.ground.files import read_ground, write_ground

Heights = NDArray[Any]
pytestmark = pytest.mark.filterwarnings("ignore:Use `@` matmul:PendingDeprecationWarning")  # in rasterio
CELL = 2.5
PLAIN = np.arange(20.0).reshape(4, 5)
ASC = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\n"


def hills(rows: int = 30, columns: int = 41) -> Heights:
    """Smooth heights of 180 to 320 m that differ everywhere, and in every direction."""
    i, j = np.arange(columns) / columns, np.arange(rows)[:, None] / rows
    return 250.0 + 40.0 * np.sin(7 * i + 3 * j) + 30.0 * np.cos(5 * j - 2 * i * i)


def north_up(x: float, y: float, cell: float) -> Affine:
    """The place of a picture whose north-west corner and square cells these are."""
    return Affine(cell, 0, x, 0, -cell, y)


def tiff(path: Path, heights: Heights, place: Affine, crs: str = "EPSG:25832", **more: Any) -> Path:
    """Writes a GeoTIFF with rasterio: the first row of ``heights`` is the first row of the file."""
    shape = dict(zip(("height", "width"), heights.shape, strict=True))
    with rasterio.open(
        path, "w", driver="GTiff", count=1, dtype=heights.dtype, crs=crs, transform=place, **shape, **more
    ) as file:
        file.write(heights, 1)
    return path


def refused(path: Path) -> str:
    """The sentence with which a file is refused."""
    with pytest.raises(UsageError) as caught:
        read_ground(path)
    said = str(caught.value)
    assert "\n" not in said
    assert 20 < len(said) < 400
    return said


@pytest.mark.parametrize("heights", [hills(), np.full((3, 2), 12.345), 4000.0 * hills() / 300 - 900])
def test_written_heights_are_read_back_within_the_resolution(heights: Heights, tmp_path: Path) -> None:
    finest = {
        ".png": max(0.001, float(np.ptp(heights)) / 65_535) / 2,
        ".asc": 0.0005,
        ".npy": float(np.spacing(np.float32(np.abs(heights).max()))),
    }
    for ending, step in finest.items():
        write_ground(heights, CELL, path := tmp_path / f"land{ending}")
        found = read_ground(path)
        assert (found.relief.x, found.relief.y, found.relief.cell) == (0.0, 0.0, CELL)
        assert np.abs(found.relief.heights - heights).max() <= step + 1e-9
        assert np.isnan(found.relief.water).all()
        assert found.startswith(f"{path}@")


def test_other_programs_read_the_same_heights_first_row_in_the_north(tmp_path: Path) -> None:
    for ending in (".png", ".asc", ".npy"):
        write_ground(hills(), CELL, tmp_path / f"land{ending}")
        if ending == ".png":
            said = json.loads((tmp_path / "land.json").read_text())
    levels = np.asarray(Image.open(tmp_path / "land.png"), float)
    assert said["lowest"] + said["step"] * levels[::-1] == pytest.approx(hills(), abs=0.002)
    assert np.loadtxt(tmp_path / "land.asc", skiprows=5)[::-1] == pytest.approx(hills(), abs=0.001)
    assert np.load(tmp_path / "land.npy") == pytest.approx(hills(), abs=0.001)
    with rasterio.open(tmp_path / "land.asc") as file:
        assert file.read(1)[::-1] == pytest.approx(hills(), abs=0.001)
        assert file.xy(file.height - 1, 0) == pytest.approx((0.0, 0.0))
        assert file.res == (CELL, CELL)


def test_a_png_has_16_bits_and_a_world_file_with_cell_and_north_west_corner(tmp_path: Path) -> None:
    write_ground(hills(), CELL, tmp_path / "land.png")
    raw = (tmp_path / "land.png").read_bytes()
    assert raw[16:26] == struct.pack(">IIBB", 41, 30, 16, 0)  # width, height, bits, grey
    lines = [float(line) for line in (tmp_path / "land.pgw").read_text().splitlines()]
    assert lines == [CELL, 0.0, 0.0, -CELL, 0.0, 29 * CELL]  # the middle of the first pixel
    with rasterio.open(tmp_path / "land.png") as file:
        assert file.xy(0, 0) == pytest.approx((0.0, 29 * CELL))
        assert file.xy(29, 40) == pytest.approx((40 * CELL, 0.0))


def test_a_projected_geotiff_has_its_first_row_in_the_south(tmp_path: Path) -> None:
    heights = hills().astype(np.float32)
    path = tiff(tmp_path / "land.tif", heights, north_up(500_000, 5_200_000, 10))
    relief = read_ground(path).relief
    assert relief.cell == 10.0
    assert relief.heights[0].tolist() == heights[-1].tolist()
    rng = np.random.default_rng(1)
    x, y = 10.0 * rng.integers(0, 41, 50), 10.0 * rng.integers(0, 30, 50)
    with rasterio.open(path) as file:
        left, bottom = file.bounds.left + 5, file.bounds.bottom + 5
        there = [float(each[0]) for each in file.sample(zip(left + x, bottom + y, strict=True))]
    assert relief.at(x, y) == pytest.approx(there, abs=1e-4)


def test_a_geotiff_whose_first_row_lies_in_the_south_is_not_turned_over(tmp_path: Path) -> None:
    heights = hills().astype(np.float32)
    path = tiff(tmp_path / "land.tif", heights, Affine(10, 0, 500_000, 0, 10, 5_200_000))
    assert read_ground(path).relief.heights[0].tolist() == heights[0].tolist()


def test_degrees_at_47_north_become_square_metres(tmp_path: Path) -> None:
    second, rows, columns = 1 / 3600, 81, 61
    lon, lat = 9 + second * np.arange(columns), 47 + second * np.arange(rows)
    heights = (100 + 4000 * (lon - 9) + 9000 * (lat[:, None] - 47)).astype(np.float32)
    corner = north_up(9 - second / 2, lat[-1] + second / 2, second)
    relief = read_ground(tiff(tmp_path / "land.tif", heights[::-1], corner, "EPSG:4326")).relief
    east, north = map(np.array, transform("EPSG:4326", "EPSG:32632", [9, lon[-1], 9], [47, 47, lat[-1]]))
    wide, high = (east[1] - east[0]) / 0.9996, (north[2] - north[0]) / 0.9996
    assert relief.size[0] == pytest.approx(wide, rel=0.003)
    assert high * 1.003 > relief.size[1] > high * 0.997 - relief.cell
    assert relief.cell == pytest.approx(wide / (columns - 1), rel=0.003)  # the shorter side of a cell
    share = np.random.default_rng(2).uniform(0.02, 0.95, (2, 40))
    there = 100 + 4000 * share[0] * (lon[-1] - 9) + 9000 * share[1] * (lat[-1] - 47)
    assert relief.at(share[0] * wide, share[1] * high) == pytest.approx(there, abs=1.0)


@pytest.mark.parametrize("kind", ["int16", "float32"])
def test_a_geotiff_may_declare_voids_and_must_not_have_them(kind: str, tmp_path: Path) -> None:
    heights = PLAIN.astype(kind)
    path = tiff(tmp_path / "whole.tif", heights, north_up(0, 40, 10), nodata=-9999)
    assert read_ground(path).relief.heights.tolist() == PLAIN[::-1].tolist()
    heights[1, 2:4] = -9999
    path = tiff(tmp_path / "holes.tif", heights, north_up(0, 40, 10), nodata=-9999)
    assert "2 points without a height" in refused(path)


def png(colour: int = 0, width: int = 8, most: int | None = None, cut: int = 0) -> bytes:
    """A PNG of 8 x 8 grey or coloured points; ``most`` of its data are said to be there, and are."""
    data = zlib.compress(bytes((1 + 8 * {0: 2, 2: 6}[colour]) * 8))[: -cut or None]
    head = struct.pack(">IIBBBBB", width, width, 16, colour, 0, 0, 0)
    chunks = [(b"IHDR", head, None), (b"IDAT", data, most), (b"IEND", b"", None)]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body) if said is None else said)
        + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body, said in chunks
    )  # fmt: skip


def npy(table: Any) -> Callable[[Path], None]:
    """Writes an array as NumPy does."""
    return partial(np.save, arr=np.array(table))


SAID = '{"cell": 5.0, "lowest": 0.0, "step": 1.0}'
WRITES: dict[str, tuple[str, Any, str | None, str]] = {
    "wrong ending": ("land.txt", "1 2\n3 4\n", None, ".png, .asc, .npy"),
    "png without json": ("land.png", png(), None, '"lowest"'),
    "npy without json": ("land.npy", npy(PLAIN), None, '"cell"'),
    "json without cell": ("land.npy", npy(PLAIN), "{}", "cell"),
    "json with null": ("land.npy", npy(PLAIN), '{"cell": null}', "cannot be read"),
    "json of a list": ("land.npy", npy(PLAIN), "[1]", "cannot be read"),
    "json too deep": ("land.npy", npy(PLAIN), "[" * 100_000, "cannot be read"),
    "no size of cells": ("land.npy", npy(PLAIN), '{"cell": 0}', "cells of 0 m"),
    "cells of a league": ("land.npy", npy(PLAIN), '{"cell": 4828}', "cells up to 1000 m"),
    "cells in degrees": ("land.npy", npy(PLAIN), '{"cell": 0.0002778}', "in degrees"),
    "asc in degrees": (
        "land.asc",
        ASC.replace("size 5", "size 0.0083333") + "1 2 3\n4 5 6\n",
        None,
        "degrees",
    ),
    "colours": ("land.png", png(colour=2), SAID, "colours"),
    "truncated png": ("land.png", png()[:45], SAID, "cannot be read"),
    "png without its end": ("land.png", png(cut=9), SAID, "cannot be read"),
    "png with a wrong length": ("land.png", png(most=3), SAID, "cannot be read"),
    "bomb of points": ("land.png", png(width=30_000), SAID, "cannot be read"),
    "truncated npy": ("land.npy", b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'", SAID, "cannot be read"),
    "unclosed npy": ("land.npy", b"\x93NUMPY\x01\x00\x10\x00{'descr': '<f8'(", SAID, "cannot be read"),
    "empty npy": ("land.npy", b"", SAID, "cannot be read"),
    "zip as npy": ("land.npy", b"PK\x03\x04 and no more", SAID, "cannot be read"),
    "npy of names": ("land.npy", npy([["a", "b"], ["c", "d"]]), SAID, "cannot be read"),
    "npy of records": ("land.npy", npy(np.zeros((3, 3), "f8,f8")), SAID, "cannot be read"),
    "one row": ("land.npy", npy([[1.0, 2.0, 3.0]]), SAID, "no table of 2 x 2"),
    "nan": ("land.npy", npy([[1.0, np.nan], [2.0, 3.0]]), SAID, "1 points without a height"),
    "infinite": ("land.npy", npy([[1.0, np.inf], [-np.inf, 3.0]]), SAID, "2 points without a height"),
    "voids of srtm": ("land.npy", npy(np.int16([[1, -32768], [2, 3]])), SAID, "1 points without a height"),
    "voids in asc": ("land.asc", ASC + "NODATA_value -9\n1 2 3\n4 5 -9\n", None, "1 points without"),
    "asc without its end": ("land.asc", ASC + "1 2 3\n4 5\n", None, "cannot be read"),
    "asc without a head": ("land.asc", "1 2 3\n4 5 6\n", None, "cannot be read"),
    "asc without end": ("land.asc", ASC.replace("nrows 2", "nrows inf") + "1 2 3\n", None, "land.asc"),
    "asc of nothing": ("land.asc", ASC, None, "cannot be read"),
    "asc for giants": ("land.asc", ASC.replace("nrows 2", "nrows 1e15") + "1 2 3\n", None, "2 x 2"),
    "no tiff": ("land.tif", b"II*\x00 and no more", None, "cannot be read"),
}


@pytest.mark.parametrize(("name", "content", "beside", "said"), WRITES.values(), ids=WRITES)
def test_what_is_no_land_is_refused(
    name: str, content: Any, beside: str | None, said: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    if callable(content):
        content(path)
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    if beside is not None:
        path.with_suffix(".json").write_text(beside)
    assert said in refused(path)


def test_a_geotiff_without_an_area_is_refused(tmp_path: Path) -> None:
    refused(tiff(tmp_path / "land.tif", np.zeros((4, 5), np.float32), Affine(10, 0, 0, 0, 0, 10)))


def test_a_geotiff_of_one_giant_tile_and_other_formats_under_its_name_are_refused(tmp_path: Path) -> None:
    path, tile = tmp_path / "land.tif", {"tiled": True, "blockxsize": 8192, "blockysize": 8192}
    with rasterio.open(
        path, "w", "GTiff", 64, 64, 1, dtype="uint8", transform=north_up(0, 0, 5), sparse_ok=True, **tile
    ):
        pass
    assert path.stat().st_size < 10_000
    assert "2 x 2 to 16,000,000" in refused(path)
    tiff(tmp_path / "real.tif", hills(30, 30), north_up(0, 0, 5))
    names = '<SourceFilename relativeToVRT="1">real.tif</SourceFilename><SourceBand>1</SourceBand>'
    band = f'<VRTRasterBand dataType="Float32" band="1"><SimpleSource>{names}</SimpleSource></VRTRasterBand>'
    path.write_text(f'<VRTDataset rasterXSize="30" rasterYSize="30">{band}</VRTDataset>')
    assert "cannot be read" in refused(path)


def test_a_grid_whose_projection_is_in_degrees_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "land.asc"
    path.write_text(ASC + "1 2 3\n4 5 6\n")
    path.with_suffix(".prj").write_text('PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84"]]')
    assert read_ground(path).relief.cell == 5.0
    path.with_suffix(".prj").write_text('GEOGCS["WGS 84",DATUM["WGS_1984"]]')
    assert "in degrees, as land.prj says" in refused(path)


def test_a_truncated_geotiff_a_missing_file_and_an_unknown_ending_are_refused(tmp_path: Path) -> None:
    path = tiff(tmp_path / "land.tif", hills(300, 300), north_up(0, 0, 5))
    path.write_bytes(path.read_bytes()[:20_000])
    assert "cannot be read" in refused(path)
    for name in ("none.png", "none.asc", "none.npy", "none.tif"):
        assert "No such file" in refused(tmp_path / name)
    with pytest.raises(UsageError, match=r"\.jpg'; give a \.png, \.asc or \.npy"):
        write_ground(PLAIN, CELL, tmp_path / "land.jpg")
    assert not (tmp_path / "land.jpg").exists()


class Armed:
    """Makes a file when it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.mark,)


def test_pickled_objects_are_refused_and_never_executed(tmp_path: Path) -> None:
    path, mark = tmp_path / "land.npy", tmp_path / "executed"
    np.save(path, np.array([[Armed(mark)] * 2] * 2, object), allow_pickle=True)
    path.with_suffix(".json").write_text(SAID)
    assert "cannot be read" in refused(path)
    assert not mark.exists()
    np.load(path, allow_pickle=True)
    assert mark.exists()  # it is armed
