"""A Drive is a value: read-only columns, one file, the same bytes for the same content."""

import pickle

import numpy as np
import pytest

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.errors import UsageError


def a_drive(seed: int = 7) -> Drive:
    rng = np.random.default_rng(seed)
    columns = Columns({name: rng.normal(size=50) for name in COLUMNS})
    return Drive("tester", "mujoco", seed, columns, "goal", Box(4.7, 1.86, -0.1))


def test_a_saved_drive_comes_back(tmp_path):
    drive = a_drive()
    drive.save(tmp_path / "drive.npz")
    back = Drive.load(tmp_path / "drive.npz")
    assert (back.driver, back.simulator, back.seed, back.ended) == ("tester", "mujoco", 7, "goal")
    assert back.car == drive.car
    assert list(back.columns) == list(COLUMNS)
    for name in COLUMNS:
        np.testing.assert_array_equal(back[name], drive[name])
    assert [p.name for p in tmp_path.iterdir()] == ["drive.npz"]


def test_same_content_same_bytes_and_other_content_other_bytes():
    assert a_drive().to_bytes() == a_drive().to_bytes()
    assert a_drive(7).to_bytes() != a_drive(8).to_bytes()


def test_numpy_alone_can_read_it(tmp_path):
    drive = a_drive()
    drive.save(tmp_path / "drive.npz")
    with np.load(tmp_path / "drive.npz") as archive:
        np.testing.assert_array_equal(archive["x"], drive["x"])


def test_columns_cannot_be_written_and_do_not_share_memory():
    source = np.zeros(3)
    columns = Columns({"x": source})
    source[0] = 5.0
    assert columns["x"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        columns["x"][0] = 1.0


def test_a_drive_can_go_to_another_process():
    back = pickle.loads(pickle.dumps(a_drive()))
    np.testing.assert_array_equal(back["x"], a_drive()["x"])
    with pytest.raises(ValueError, match="read-only"):
        back["x"][0] = 1.0


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04 broken"])
def test_a_file_that_is_no_drive_is_told_so(tmp_path, content):
    (tmp_path / "bad.npz").write_bytes(content)
    with pytest.raises(UsageError, match="not a drive"):
        Drive.load(tmp_path / "bad.npz")


def test_an_array_file_and_a_missing_file_are_told_so(tmp_path):
    np.save(tmp_path / "array.npy", np.zeros(3))
    with pytest.raises(UsageError, match="not a drive"):
        Drive.load(tmp_path / "array.npy")
    with pytest.raises(UsageError, match="no drive at"):
        Drive.load(tmp_path / "missing.npz")


def test_corners_are_the_box_turned_and_moved():
    still = {name: np.zeros(1) for name in COLUMNS}
    columns = Columns(still | {"x": np.array([10.0]), "y": np.array([5.0]), "heading": np.array([np.pi / 2])})
    drive = Drive("d", "mujoco", 0, columns, "goal", Box(4.0, 2.0, 0.5))
    # Facing +y: the front is 2.5 m up, the rear 1.5 m down, one metre to either side.
    expected = [[11.0, 3.5], [11.0, 7.5], [9.0, 7.5], [9.0, 3.5]]
    np.testing.assert_allclose(drive.corners(0), expected, atol=1e-12)
