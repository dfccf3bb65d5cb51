"""Reads and writes heights of land: 16-bit PNG with its world file, ESRI ASCII grids (.asc), NumPy arrays
(.npy) and, with rasterio, GeoTIFF. The south-west corner of a file is the point (0, 0) of the map.

A PNG has no unit, and a NumPy array no size of its cells: a file of the same name with the ending .json says
them, as in {"cell": 1.0, "lowest": 312.4, "step": 0.01}, in metres."""

import hashlib
import io
import json
import math
import zlib
from pathlib import Path
from tokenize import TokenError
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.ground.given import BESIDE, GivenGround
from roadgpt.ground.relief import Relief
from roadgpt.reading import arrays_in, opened, read_json, read_text

MOST = 16_000_000  # heights in a file
UNPACKED = 8 * MOST + 1_000_000  # bytes
LEAST_CELL, LARGEST_CELL, HIGHEST = 0.05, 1000.0, 20_000.0  # m; 0.05 degrees are 5.6 km
UNREADABLE = (  # what the libraries raise that read files, if those are broken
    OSError, EOFError, ValueError, LookupError, TypeError, ArithmeticError, MemoryError, RecursionError,
    SyntaxError, BadZipFile, zlib.error, TokenError, Image.DecompressionBombError,
)  # fmt: skip
DEGREE = 111_320.0  # m of a degree of latitude, and of longitude at the equator
LEVELS = 65_535  # of 16 bits
NO_DATA = -32_768.0  # the height of voids in files of SRTM


def named(path: str, relief: Relief) -> GivenGround:
    """Returns the name of land with these heights, which it carries."""
    data = np.ascontiguousarray(relief.heights).tobytes() + repr(relief.cell).encode()
    return GivenGround.named(f"{path}@{hashlib.sha256(data).hexdigest()[:12]}", relief)


def save_ground(ground: GivenGround) -> bytes:
    """Returns the heights of given land as the content of a file ``BESIDE``."""
    data = io.BytesIO()
    np.savez_compressed(data, heights=ground.relief.heights, cell=ground.relief.cell)
    return data.getvalue()


def attached(name: str, folder: Path) -> GivenGround:
    """Returns the given land of this name with the heights that a folder holds; raises UsageError if they are
    not there, or not those."""
    path = folder / BESIDE
    try:
        data = arrays_in(path, "land", UNPACKED, ("heights", "cell"), UNPACKED)
        made = named(name.rpartition("@")[0], _relief(data["heights"], float(data["cell"]), path))
    except UNREADABLE as error:
        raise UsageError(f"the land '{name}' is missing: {path}: {_why(error)}; copy it there") from error
    if made != name:
        raise UsageError(f"{path} holds other land than '{name}'; copy the right one there")
    return made


def read_ground(path: Path) -> GivenGround:
    """Returns the land in a file; raises UsageError if it cannot be read."""
    if (reader := READERS.get(path.suffix.lower())) is None:
        raise UsageError(f"{path} is no land that can be read; give one of {', '.join(READERS)}")
    try:
        opened(path, 2 * UNPACKED, "land").close()
        return named(str(path), reader(path))
    except UNREADABLE as error:
        raise UsageError(f"the land in {path} cannot be read: {_why(error)}") from error


def _why(error: BaseException) -> str:
    return getattr(error, "strerror", None) or (str(error) or type(error).__name__).splitlines()[0][:160]


def _relief(heights: NDArray[Any], cell: float, path: Path) -> Relief:
    """Returns land with its first row in the south."""
    if np.asarray(heights).dtype.kind not in "iuf":
        raise ValueError("it holds no numbers that can be heights")
    table = np.array(heights, np.float64)
    if table.ndim != 2 or min(table.shape) < 2 or table.size > MOST:
        raise UsageError(f"{path} has no table of 2 x 2 to {MOST:,} heights")
    if not 0 < cell <= LARGEST_CELL:
        raise UsageError(f"{path} has cells of {cell:g} m; give land with cells up to {LARGEST_CELL:g} m")
    if cell < LEAST_CELL:
        raise UsageError(f"{path} has cells of {cell:.2g} m, so it is in degrees; convert it to metres first")
    lost = ~(np.abs(table) <= HIGHEST) | (table == NO_DATA)
    if lost.any():
        raise UsageError(
            f"{path} has {lost.sum():,} points without a height, voids or beyond {HIGHEST:,.0f} m; fill them"
        )
    return Relief(0.0, 0.0, cell, table, np.full(table.shape, np.nan), np.empty((0, 3)))


def _said_beside(path: Path, *names: str) -> list[float]:
    beside = path.with_suffix(".json")
    if not beside.is_file():
        example = json.dumps({**dict.fromkeys(names, 0.01), "cell": 1.0})
        raise UsageError(f"{path} does not say its metres; write into {beside.name} beside it: {example}")
    said = read_json(beside)
    return [float(said[name]) for name in names]


def _png(path: Path) -> Relief:
    with Image.open(path, formats=("PNG",)) as image:
        if image.mode not in ("I;16", "I;16B", "I", "L"):
            raise UsageError(f"{path} is a picture in colours; give a grey one with 16 bits")
        if image.width * image.height > MOST:
            raise UsageError(f"{path} has no table of 2 x 2 to {MOST:,} heights")
        levels = np.asarray(image, np.float64)[::-1]
    cell, lowest, step = _said_beside(path, "cell", "lowest", "step")
    return _relief(lowest + step * levels, cell, path)


def _npy(path: Path) -> Relief:
    table = np.load(path, allow_pickle=False)
    (cell,) = _said_beside(path, "cell")
    return _relief(table, cell, path)


def _asc(path: Path) -> Relief:
    with path.open(encoding="ascii", errors="strict") as lines:
        header: dict[str, float] = {}
        while len(header) < 6:
            place = lines.tell()
            words = lines.readline().split()
            if len(words) != 2 or not words[0][0].isalpha():
                lines.seek(place)
                break
            header[words[0].lower()] = float(words[1])
        rows, columns = int(header["nrows"]), int(header["ncols"])
        if not 4 <= rows * columns <= MOST:
            raise UsageError(f"{path} has no table of 2 x 2 to {MOST:,} heights")
        table = np.array(lines.read().split(), np.float64).reshape(rows, columns)[::-1]
    plan = path.with_suffix(".prj")
    if plan.is_file() and read_text(plan, encoding="latin-1").lstrip().upper().startswith(("GEOGC", "GEODC")):
        raise UsageError(f"{path} is in degrees, as {plan.name} says; convert it to metres first")
    table = np.where(table == header.get("nodata_value", math.nan), math.nan, table)
    return _relief(table, header["cellsize"], path)


def _tiff(path: Path) -> Relief:
    try:
        import rasterio
    except ImportError as error:
        raise UsageError('GeoTIFF needs rasterio: pip install "roadgpt[ground]"') from error
    try:
        with rasterio.open(path, driver="GTiff") as data:  # others may name further files
            if max(data.width * data.height, *map(math.prod, data.block_shapes)) > MOST:
                raise UsageError(f"{path} has no table of 2 x 2 to {MOST:,} heights")
            if data.transform.b or data.transform.d:
                raise UsageError(f"{path} is turned against the map; give land whose rows lie west to east")
            if data.crs and data.crs.is_projected and not math.isclose(data.crs.linear_units_factor[1], 1.0):
                raise UsageError(f"{path} is in {data.crs.linear_units}, not in metres; convert it first")
            table = data.read(1, masked=True).astype(np.float64).filled(math.nan)
            if not (data.crs and data.transform.e > 0):  # the first row lies in the north
                table = table[::-1]
            wide, high = abs(data.transform.a), abs(data.transform.e)
            is_geographic = bool(data.crs and data.crs.is_geographic)
            middle = (data.bounds.bottom + data.bounds.top) / 2
    except rasterio.errors.RasterioError as error:
        raise ValueError(str(error)) from error
    if is_geographic:
        wide, high = wide * DEGREE * math.cos(math.radians(middle)), high * DEGREE
    return _square(table, wide, high, path)


READERS = {".png": _png, ".asc": _asc, ".npy": _npy, ".tif": _tiff, ".tiff": _tiff}


def _square(table: Array, wide: float, high: float, path: Path) -> Relief:
    """Returns land with square cells, the smaller of both sides."""
    if math.isclose(wide, high, rel_tol=1e-6):
        return _relief(table, wide, path)
    cell, (rows, columns) = min(wide, high), table.shape
    if (columns * wide / cell) * (rows * high / cell) > MOST:
        raise UsageError(f"{path} has cells of {wide:g} m x {high:g} m; give land with square cells")
    x = np.arange(0.0, (columns - 1) * wide + 1e-9, cell) / wide
    y = np.arange(0.0, (rows - 1) * high + 1e-9, cell) / high
    i, j = np.minimum(x.astype(int), columns - 2), np.minimum(y.astype(int), rows - 2)
    u, v = x - i, (y - j)[:, None]
    across = table[:, i] * (1 - u) + table[:, i + 1] * u
    return _relief(across[j] * (1 - v) + across[j + 1] * v, cell, path)


def write_ground(heights: Array, cell: float, path: Path, corner: tuple[float, float] = (0.0, 0.0)) -> None:
    """Writes heights ``(rows, columns)``, the first row in the south, as the ending of the file asks: .png
    with its world file and .json, .asc, or .npy with its .json. ``corner`` is the place of the first height
    of the first row in metres. Raises UsageError for other endings."""
    lowest = float(heights.min())
    if heights.size > MOST:
        raise UsageError(f"{heights.size:,} heights are more than {MOST:,}; make the cells larger")
    suffix = path.suffix.lower()
    if suffix == ".png":
        step = max(float(np.ptp(heights)) / LEVELS, 0.001)
        levels = np.rint((heights[::-1] - lowest) / step).astype(np.uint16)
        Image.fromarray(levels).save(path)
        west, north = corner[0], corner[1] + (len(heights) - 1) * cell
        lines = (f"{value!r}\n" for value in (cell, 0.0, 0.0, -cell, west, north))
        path.with_suffix(".pgw").write_text("".join(lines), encoding="ascii")
        _say(path, cell=cell, lowest=lowest, step=step)
    elif suffix == ".asc":
        rows, columns = heights.shape
        head = f"ncols {columns}\nnrows {rows}\nxllcenter {corner[0]!r}\nyllcenter {corner[1]!r}\n"
        head += f"cellsize {cell!r}"
        np.savetxt(path, heights[::-1], fmt="%.3f", header=head, comments="", encoding="ascii")
    elif suffix == ".npy":
        np.save(path, heights.astype(np.float32))
        _say(path, cell=cell)
    else:
        raise UsageError(f"land is not written as '{path.suffix}'; give a .png, .asc or .npy")


def _say(path: Path, **said: float) -> None:
    path.with_suffix(".json").write_text(json.dumps(said) + "\n", encoding="utf-8")
