"""`roadgpt ground`, and --ground of the commands that make and drive roads."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import invoke, roadgpt
from roadgpt.road import World
from roadgpt.run import read_run

SMALL = ("--size", "400", "--cell", "8")
RUN = ("--reader", "plan", "--no-drive", "--no-plot", "--seed", "1")
SUMMARY = re.compile(
    r"(\d+) m x (\d+) m, a height every ([\d.]+) m: (-?[\d.]+) to (-?[\d.]+) m, mean slope (\d+) %"
)


def heights(path: str) -> np.ndarray:
    """The heights of a file with the first row in the south, read by PIL or NumPy."""
    if path.endswith(".npy"):
        return np.load(path).astype(float)
    if path.endswith(".asc"):
        return np.loadtxt(path, skiprows=5)[::-1]
    said = json.loads(Path(path).with_suffix(".json").read_text())
    return said["lowest"] + said["step"] * np.asarray(Image.open(path), float)[::-1]


def refused(*words: object, status: int = 2) -> str:
    """The one sentence with which a command refuses what it was asked for; before it, the usage may stand."""
    done = invoke(*words)
    assert done.exit_code == status, done.output
    assert done.stdout == ""
    *usage, line = done.stderr.strip().splitlines()
    assert line.startswith("Error: " if usage else "roadgpt: ")
    assert not usage or usage[0].startswith("Usage: ")
    assert len(line) < 500
    return line


def slope(table: np.ndarray, cell: float) -> float:
    return float(np.hypot(*np.gradient(table, cell)).mean())


@pytest.mark.parametrize("name", ["land.png", "other.asc", "other.npy"])
def test_it_makes_land_and_says_in_one_line_what_it_is_like(name: str) -> None:
    where = () if name == "land.png" else ("--out", name)
    done = roadgpt("ground", "a valley between two ridges", *SMALL, "--seed", 3, *where)
    summary, file = done.stdout.splitlines()
    assert (file, done.stderr) == (name, "")
    found = SUMMARY.fullmatch(summary)
    assert found is not None
    table = heights(name)
    assert table.shape == (51, 51)
    assert list(map(float, found.groups()[:3])) == [400, 400, 8]
    assert list(map(float, found.groups()[3:5])) == pytest.approx([table.min(), table.max()], abs=0.1)
    assert float(found[6]) == pytest.approx(100 * slope(table, 8.0), abs=0.6)
    low, high = table[20:31].mean(), table[[2, -3]].mean()
    assert high - low > 20.0  # the valley leads through the middle, from west to east


def test_the_seed_decides() -> None:
    for name, seed in (("one", 5), ("same", 5), ("other", 6)):
        roadgpt("ground", "hilly land", *SMALL, "--seed", seed, "--out", f"{name}.png")
    one, same, other = (Path(f"{name}.png").read_bytes() for name in ("one", "same", "other"))
    assert one == same
    assert one != other
    assert np.abs(heights("one.png") - heights("other.png")).max() > 1.0
    roadgpt("ground", "hilly land", *SMALL, "--out", "usual.png")
    roadgpt("ground", "hilly land", *SMALL, "--seed", 0, "--out", "zero.png")
    assert Path("usual.png").read_bytes() == Path("zero.png").read_bytes()


def test_the_words_decide() -> None:
    steep = {}
    for kind in ("flat", "rolling", "hilly", "mountain"):
        steep[kind] = json.loads(roadgpt("ground", kind, *SMALL, "--json").stdout)["mean_slope"]
    assert [*steep.values()] == sorted(steep.values())
    assert steep["mountain"] > 5 * steep["flat"]


def test_json_is_one_object_and_names_words_that_were_not_used() -> None:
    done = roadgpt("ground", "hilly land with a volcano", *SMALL, "--json", "--out", "x.npy")
    told = json.loads(done.stdout)
    assert done.stdout.count("\n") == 1
    table = heights("x.npy")
    assert told == {
        "file": "x.npy", "width": 400.0, "height": 400.0, "cell": 8.0,
        "lowest": pytest.approx(table.min(), abs=0.001), "highest": pytest.approx(table.max(), abs=0.001),
        "mean_slope": pytest.approx(slope(table, 8.0), rel=1e-3), "unused": ["volcano"],
    }  # fmt: skip
    loud = roadgpt("ground", "hilly land with a volcano", *SMALL, "--out", "x.npy")
    assert "not used: 'volcano'" in loud.stderr
    assert loud.stdout.count("\n") == 2


@pytest.mark.parametrize(("first", "second"), [("png", "asc"), ("asc", "npy"), ("npy", "png")])
def test_files_are_converted(first: str, second: str) -> None:
    roadgpt("ground", "hilly land with a lake", *SMALL, "--out", f"a.{first}")
    only = roadgpt("ground", f"a.{first}").stdout
    assert SUMMARY.fullmatch(only.strip())
    done = roadgpt("ground", f"a.{first}", "--out", f"b.{second}")
    assert done.stdout.splitlines() == [only.strip(), f"b.{second}"]
    assert heights(f"b.{second}") == pytest.approx(heights(f"a.{first}"), abs=0.005)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("asdf", "qwer"), "'asdf qwer' names no land"),
        (("none.png",), "No such file"),
        (("hilly", "--out", "land.jpg"), "give a .png, .asc or .npy"),
        (("hilly", "--out", "land"), "give a .png, .asc or .npy"),
        (("hilly", "--size", "50"), "50 is not possible"),
        (("hilly", "--cell", "0.1"), "0.1 is not possible"),
        (("none.png", "--size", "500"), "leave out --size"),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_sentence(words: tuple[str, ...], said: str) -> None:
    assert said in refused("ground", *words)
    assert not [*Path().iterdir()]


def test_a_folder_that_is_not_there_is_named() -> None:
    assert "cannot write no/x.png" in refused("ground", "flat", *SMALL, "--out", "no/x.png", status=1)


def test_what_it_writes_can_be_read_or_is_not_written() -> None:
    """Files have 16 million heights at most: 4,000 x 4,000, and not 4,021 x 4,021."""
    done = invoke("ground", "flat", "--size", "2010", "--cell", "0.5", "--out", "fine.npy")
    if done.exit_code == 0:
        roadgpt("ground", "fine.npy")
    assert Path("fine.npy").exists() == (done.exit_code == 0)


def test_roads_are_laid_on_land_from_a_file() -> None:
    roadgpt("ground", "rolling land", *SMALL, "--seed", 2)
    roadgpt("run", "straight 100", *RUN, "-n", "2", "--ground", "land.png", "--out", "here")
    assert [str(path) for path in Path("here").rglob("*.npz")] == ["here/ground.npz"]
    table = heights("land.png")
    for number in ("0001", "0002"):
        run = read_run(Path("here", "runs", number))
        assert run.outcome == "VALID"
        assert run.world.site.ground.startswith("land.png@")
        assert run.world.site.ground.relief.heights == pytest.approx(table, abs=1e-6)
        assert run.road is not None
        x, y, z = run.road.at(np.linspace(0.0, run.length, 30), 0.0).T
        near = table[np.rint(y / 8).astype(int), np.rint(x / 8).astype(int)]
        assert np.abs(z - near).mean() < 2.0
    Path("land.png").unlink()
    assert roadgpt("check", "here/runs/0001").exit_code == 0  # its folder has the heights


def test_an_option_may_repeat_the_digest_and_refuses_another() -> None:
    roadgpt("ground", "rolling land", *SMALL)
    roadgpt("run", "straight 100", *RUN, "--ground", "land.png", "--out", "here")
    name = read_run(Path("here", "runs", "0001")).world.site.ground
    roadgpt("run", "straight 100", *RUN, "--ground", name, "--out", "again")
    roadgpt("ground", "rolling land", *SMALL, "--seed", 1)
    assert "holds other land" in refused("run", "straight 100", *RUN, "--ground", name)


@pytest.mark.parametrize(
    ("ground", "said"),
    [
        ("nonsense", "give flat, rolling, hilly, mountain"),
        ("hilly:x", "give flat, rolling, hilly, mountain"),
        ("none.png", "No such file"),
        ("none.jpg", "give one of .png"),
        ("none.png@0123456789ab", "No such file"),
    ],
)
def test_land_that_is_not_there_is_refused_before_anything_is_made(ground: str, said: str) -> None:
    line = refused("run", "straight 100", *RUN, "--ground", ground)
    assert said in line
    assert not [*Path().iterdir()]


@pytest.mark.parametrize("name", ["land.npy", "a@b/land.npy", "./land.npy", "LAND.NPY"])
def test_a_settings_file_of_the_folder_cannot_name_a_file_of_heights(name: str) -> None:
    place = Path(name)
    place.parent.mkdir(exist_ok=True)
    roadgpt("ground", "flat", *SMALL, "--out", str(place.with_suffix(".npy")))
    place.with_suffix(".npy").rename(place)
    Path("roadgpt.toml").write_text(f'[world]\nground = "{name}"\n')
    line = refused("run", "straight 100", *RUN)
    assert "roadgpt.toml" in line
    assert "say it yourself with the option" in line
    Path("roadgpt.toml").write_text('[world]\nground = "hilly:3"\n')
    roadgpt("run", "straight 100", *RUN, "--out", "here")
    assert read_run(Path("here", "runs", "0001")).world.site.ground == "hilly:3"
    assert World().site.ground == ""


def test_land_smaller_than_any_map_is_refused() -> None:
    Path("small.asc").write_text("ncols 9\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 5\n" + "1 " * 81)
    assert "is 40 m wide; give land of 50 m or more" in refused(
        "run", "2 turns", "--ground", "small.asc", *RUN
    )
