"""The page of all roads, read from the competition's files."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.transforms import Bbox

from roadgpt.brief import Brief
from roadgpt.campaign.model import Cell
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Store
from roadgpt.errors import UsageError
from roadgpt.report import overview
from roadgpt.report.overview import Thumbnail, _thumbnail, page_of, pages
from roadgpt.road import World
from roadgpt.run import Request, Setup

OUTCOMES = ["PASS", "FAIL", "INVALID", "NOT TESTED", "ERROR", None]


def test_file(number: int) -> dict[str, object]:
    """As the competition's tools write it: [x, y] points, and fields left out."""
    outcome = OUTCOMES[number % 6]
    angle = np.linspace(0, 2, 60) + number
    points = np.stack([100 + 60 * np.cos(angle), 100 + 60 * np.sin(angle)], axis=-1)
    record = [1.0, [130.0, 90.0, 0.0], *[0] * 10, outcome == "FAIL", 0, 0, 0, 0]
    test = {"id": number, "is_valid": outcome != "INVALID", "interpolated_points": points.tolist()}
    if outcome not in ("INVALID", None):
        test |= {"test_outcome": outcome, "execution_data": [record]}
    return test


test_file.__test__ = False  # type: ignore[attr-defined]


@pytest.mark.parametrize(("outcome", "share"), [("PASS", 0.3), ("FAIL", 0.9), ("ERROR", 0.9)])
def test_at_the_goal_a_car_that_passed_is_no_longer_outside(
    outcome: str, share: float, tmp_path: Path
) -> None:
    """The competition's records end with one beyond the end of the road; without another one, none counts."""
    records = [[0.1 * n, [100.0, 90.0, 0.0], *[0] * 14, at] for n, at in enumerate((0.0, 0.3, 0.1, 0.9))]
    test = {"id": 1, "is_valid": True, "interpolated_points": [[0, 0], [9, 9]], "test_outcome": outcome}
    for name, data, told in (("all", records, share), ("one", records[-1:], None if share < 0.9 else share)):
        (tmp_path / f"{name}.json").write_text(json.dumps({**test, "execution_data": data}))
        assert _thumbnail(tmp_path / f"{name}.json").share == told


def campaign(folder: Path, count: int) -> None:
    for number in range(1, count + 1):
        (folder / f"test.{number:04d}.json").write_text(json.dumps(test_file(number)))


@pytest.mark.parametrize(("count", "pages"), [(7, 1), (101, 2)])
def test_a_page_holds_a_hundred_roads(tmp_path: Path, count: int, pages: int) -> None:
    campaign(tmp_path, count)
    drawn = overview(tmp_path)
    assert [path.name for path in drawn] == ["overview.png", "overview-2.png"][:pages]
    if pages == 1:
        first = drawn[0].read_bytes()
        overview(tmp_path)
        assert drawn[0].read_bytes() == first


def tiles(axes: Axes) -> list[Bbox]:
    """The maps of a page, in rows, in the units of the page."""
    return [patch.get_bbox() for patch in axes.patches if isinstance(patch, Rectangle)]


def inside(tile: Bbox, line: Line2D) -> bool:
    return all(tile.contains(x, y) for x, y in line.get_xydata())


def test_every_road_fills_its_own_map_which_says_its_scale() -> None:
    rng = np.random.default_rng(4)
    extents = [(240.0, 180.0), (60.0, 200.0), (9000.0, 4000.0), (35.0, 3.0), (900.0, 2000.0), (150.0, 150.0)]
    entries = []
    for number, extent in enumerate(extents, 1):
        points = np.concatenate([[[0, 0], [1, 1]], rng.random((40, 2))]) * extent + rng.random(2) * 500
        entries.append(Thumbnail(number, "FAIL", points, tuple(points[7])))
    axes = page_of(entries, ("roads", "seed 1"), "").axes[0]
    for entry, tile in zip(entries, tiles(axes), strict=True):
        lines = [line for line in axes.lines if inside(tile, line)]
        (road,) = [line.get_xydata() for line in lines if len(line.get_xydata()) == 42]
        (cross,) = [line.get_xydata()[0] for line in lines if line.get_marker() == "X"]
        (bar,) = [line.get_xydata() for line in lines if len(line.get_xydata()) == 2]
        (said,) = [text for text in axes.texts if tile.contains(*text.get_position())]
        amount, unit = said.get_text().split()
        per_metre = np.ptp(bar[:, 0]) / (float(amount) * {"m": 1, "km": 1000}[unit])
        # north is up, though y of the page grows downwards; and one scale holds both ways
        shape = (entry.points - entry.points[0]) * [1, -1] * per_metre
        assert road - road[0] == pytest.approx(shape)
        assert cross == pytest.approx(road[7])
        filled = np.ptp(road, axis=0) / [tile.width - 0.2, tile.height - 0.32]
        assert filled.max() == pytest.approx(1)
        assert road[:, 1].max() < bar[0, 1] - 0.1


def test_the_colour_along_a_road_is_that_of_the_record_on_the_scale(tmp_path: Path) -> None:
    """The competition's record has the distance from the edge of the lane in the 16th place, in metres."""
    distances = [2.0, 1.0, 0.5, -0.5, -1.0, -3.0]
    records = [[i / 10, [100.0 + 10 * i, 50.0, 1.0], *[0] * 13, each, 0] for i, each in enumerate(distances)]
    test = test_file(1) | {"test_outcome": "PASS", "execution_data": records}
    (tmp_path / "test.0001.json").write_text(json.dumps(test))
    (figure,) = pages(tmp_path)
    page, scale = figure.axes
    figure.canvas.draw()
    (path,) = [each for each in page.collections if isinstance(each, LineCollection)]
    shown = np.array(distances)
    assert np.asarray(path.get_array()) == pytest.approx((shown[1:] + shown[:-1]) / 2)
    ends = np.array([(piece[0, 0], piece[1, 0]) for piece in path.get_segments()])
    assert ends[1:, 0] == pytest.approx(ends[:-1, 1])
    ticks = dict(zip((text.get_text() for text in scale.get_xticklabels()), scale.get_xticks(), strict=True))
    assert ticks == {"1 m outside its lane": -1, "at the edge": 0, "1 m inside": 1}
    (bar,) = [each for each in scale.collections if isinstance(each, QuadMesh)]
    for value in (-0.9, 0.0, 0.75):
        assert path.cmap(path.norm(value)) == bar.cmap(bar.norm(value))
    assert len({path.cmap(path.norm(value)) for value in (-1, 0, 1)}) == 3
    assert path.cmap(path.norm(2.0)) == path.cmap(path.norm(1.0))


def test_the_page_counts_outcomes_in_words(tmp_path: Path) -> None:
    campaign(tmp_path, 5)
    world, setup = World().changed(map_size=200.0, oracle="sbft"), Setup(driver="beamng_like")
    request = Request(words="a $strange$ road", seed=4, world=world, setup=setup)
    cell = Cell("", request, Brief(words=request.words), "words", None, keeps_runs=True)
    Store.new(tmp_path, Plan.of(request, 5).model_dump_json(), [cell], {"beamng_like": {}}).close()
    assert overview(tmp_path)
    (drawn,) = pages(tmp_path)
    about = {text.get_text() for text in drawn.axes[0].texts}
    assert any("seed 4, driver beamng_like, oracle sbft" in text for text in about), about
    entries = [Thumbnail(1, "PASS", np.empty((0, 2)), None)]
    figure = page_of(entries, ("words", "seed 4"), "page 2 of 3")
    said = [text.get_text() for text in figure.axes[0].texts]
    assert {"1 PASS", "words", "PASS"} <= set(said)
    assert any("seed 4" in text and "page 2 of 3" in text for text in said)


def test_no_tests_no_page(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"holds no test\.0001\.json"):
        overview(tmp_path)
    (tmp_path / "test.0001.json").write_text("{")
    with pytest.raises(UsageError, match="cannot be read"):
        overview(tmp_path)
