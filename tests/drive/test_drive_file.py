"""A Drive is a value: read-only columns, one file, the same bytes for the same content."""

import contextlib
import io
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.errors import UsageError


def a_drive(seed: int = 7) -> Drive:
    rng = np.random.default_rng(seed)
    columns = Columns({name: rng.normal(size=50) for name in COLUMNS})
    return Drive("tester", "mujoco", seed, columns, "goal", Box(4.7, 1.86, -0.1, 0.55))


def test_a_saved_drive_comes_back(tmp_path):
    drive = a_drive()
    (tmp_path / "drive.npz").write_bytes(drive.to_bytes())
    back = Drive.load(tmp_path / "drive.npz")
    assert (back.driver, back.simulator, back.seed, back.ended) == ("tester", "mujoco", 7, "goal")
    assert back.car == drive.car
    assert list(back.columns) == list(COLUMNS)
    for name in COLUMNS:
        np.testing.assert_array_equal(back[name], drive[name])


def test_a_file_of_earlier_days_is_still_a_drive(tmp_path):
    """Version 2, written by hand; of the car it has what its first files had."""
    header = {"format": 2, "driver": "mine", "simulator": "mujoco", "seed": 5, "ended": "goal"}
    header["car"] = {"length": 4.7, "width": 1.86}
    columns = {name: np.arange(3.0) for name in COLUMNS}
    np.savez(tmp_path / "drive.npz", header=np.array(json.dumps(header)), **columns)
    back = Drive.load(tmp_path / "drive.npz")
    assert (back.driver, back.seed, back.ended, back.car) == ("mine", 5, "goal", Box(4.7, 1.86))
    np.testing.assert_array_equal(back["speed"], [0.0, 1.0, 2.0])


def test_columns_cannot_be_written_and_do_not_share_memory():
    source = np.zeros(3)
    columns = Columns({"x": source})
    source[0] = 5.0
    assert columns["x"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        columns["x"][0] = 1.0


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04 broken"])
def test_a_file_that_is_no_drive_is_told_so(tmp_path, content):
    (tmp_path / "bad.npz").write_bytes(content)
    with pytest.raises(UsageError, match="not a drive"):
        Drive.load(tmp_path / "bad.npz")


def rewritten(tmp_path, change):
    """The file of a drive whose parts, header and columns, were changed."""
    with np.load(io.BytesIO(a_drive().to_bytes())) as archive:
        parts = {name: archive[name] for name in archive.files}
    parts["header"] = json.loads(str(parts["header"]))
    change(parts)
    if isinstance(parts.get("header"), dict):
        parts["header"] = np.array(json.dumps(parts["header"]))
    np.savez(tmp_path / "drive.npz", **parts)
    return tmp_path / "drive.npz"


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda parts: parts["header"].pop("driver"), "driver"),
        (lambda parts: parts["header"].pop("format"), "format"),
        (lambda parts: parts["header"].update(format=1), "its format is 1"),
        (lambda parts: parts["header"].update(ended="bored"), "no drive ends with 'bored'"),
        (lambda parts: parts["header"].update(car={"colour": 2.0}), "colour"),
        (lambda parts: parts["header"].update(car=[1, 2]), "list"),
        (lambda parts: parts.update(header=np.array("[1, 2]")), "list"),
        (lambda parts: parts.update(header=np.array("{")), "Expecting property name"),
        (lambda parts: parts.pop("header"), "header"),
        (lambda parts: parts.pop("yaw_rate"), "columns missing or unknown: yaw_rate"),
        (lambda parts: parts.update(taste=np.zeros(50)), "columns missing or unknown: taste"),
        (lambda parts: parts.update(x=np.zeros(49)), "of one length"),
        (lambda parts: parts.update(x=np.zeros((50, 2))), "a list of numbers"),
        (lambda parts: parts.update(x=np.array(["left"] * 50)), "left"),
        (lambda parts: parts.update({name: np.zeros(0) for name in COLUMNS}), "not empty"),
    ],
)
def test_a_drive_with_a_part_missing_or_wrong_is_told_so(tmp_path, change, why):
    path = rewritten(tmp_path, change)
    with pytest.raises(UsageError, match=rf"not a drive .*{why}.*: drive the road again"):
        Drive.load(path)
    assert len(Drive.load(rewritten(tmp_path, lambda parts: None))) == 50


WHOLE = a_drive().to_bytes()


@given(at=st.integers(0, len(WHOLE) - 1), length=st.integers(1, 40), fill=st.integers(0, 255), data=st.data())
def test_a_damaged_file_costs_one_error(tmp_path_factory, at, length, fill, data):
    damaged = bytearray(WHOLE)
    damaged[at : at + length] = bytes([fill]) * len(damaged[at : at + length])
    if data.draw(st.booleans()):
        del damaged[at:]
    path = tmp_path_factory.mktemp("damaged") / "drive.npz"
    path.write_bytes(damaged)
    with contextlib.suppress(UsageError):  # where only a date or a name in passing was hit, it is still whole
        assert len(Drive.load(path)) == 50


@pytest.mark.parametrize("method", [9, 14, 97])  # deflate64, lzma, wavpack
def test_a_damaged_stream_or_an_unknown_compression_is_told_so(tmp_path, method):
    damaged = bytearray(WHOLE)
    for mark, place in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        at = damaged.index(mark) + place
        damaged[at : at + 2] = method.to_bytes(2, "little")
    (tmp_path / "bad.npz").write_bytes(damaged)
    with pytest.raises(UsageError, match="not a drive"):
        Drive.load(tmp_path / "bad.npz")
    broken = bytearray(WHOLE)
    at = broken.index(b"header.npy") + len("header.npy")
    broken[at : at + 40] = b"\xff" * 40  # zlib: invalid block type
    (tmp_path / "bad.npz").write_bytes(broken)
    with pytest.raises(UsageError, match="not a drive"):
        Drive.load(tmp_path / "bad.npz")


def test_corners_are_the_box_turned_and_moved():
    still = {name: np.zeros(1) for name in COLUMNS}
    columns = Columns(still | {"x": np.array([10.0]), "y": np.array([5.0]), "heading": np.array([np.pi / 2])})
    drive = Drive("d", "mujoco", 0, columns, "goal", Box(4.0, 2.0, 0.5))
    # Facing +y: the front is 2.5 m up, the rear 1.5 m down, one metre to either side.
    expected = [[11.0, 3.5], [11.0, 7.5], [9.0, 7.5], [9.0, 3.5]]
    np.testing.assert_allclose(drive.corners(0), expected, atol=1e-12)
