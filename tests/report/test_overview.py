"""The page of all roads, read from the competition's files."""

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from roadgpt.errors import UsageError
from roadgpt.report import overview
from roadgpt.report.overview import Thumbnail, page_of, pages
from roadgpt.road import World
from roadgpt.run import Request, Setup
from roadgpt.run.card import CARD, Card

OUTCOMES = ["PASS", "FAIL", "INVALID", "ERROR", None]


def test_file(number: int) -> dict[str, object]:
    """As the competition's tools write it: [x, y] points, and fields left out."""
    outcome = OUTCOMES[number % 5]
    angle = np.linspace(0, 2, 60) + number
    points = np.stack([100 + 60 * np.cos(angle), 100 + 60 * np.sin(angle)], axis=-1)
    record = [1.0, [130.0, 90.0, 0.0], *[0] * 10, outcome == "FAIL", 0, 0, 0, 0]
    test = {"id": number, "is_valid": outcome != "INVALID", "interpolated_points": points.tolist()}
    if outcome not in ("INVALID", None):
        test |= {"test_outcome": outcome, "execution_data": [record]}
    return test


test_file.__test__ = False  # type: ignore[attr-defined]


def campaign(folder: Path, count: int) -> None:
    for number in range(1, count + 1):
        (folder / f"test.{number:04d}.json").write_text(json.dumps(test_file(number)))


@pytest.mark.parametrize(("count", "pages"), [(1, 1), (7, 1), (101, 2)])
def test_a_page_holds_a_hundred_roads(tmp_path: Path, count: int, pages: int) -> None:
    campaign(tmp_path, count)
    drawn = overview(tmp_path)
    assert [path.name for path in drawn] == ["overview.png", "overview-2.png"][:pages]
    first = drawn[0].read_bytes()
    overview(tmp_path)
    assert drawn[0].read_bytes() == first


def test_every_road_lies_on_its_own_map_to_scale() -> None:
    square = np.array([[0.0, 0.0], [250.0, 0.0], [250.0, 250.0], [0.0, 250.0]])
    entries = [Thumbnail(i, "FAIL", square, (125.0, 125.0)) for i in range(1, 8)]
    figure = page_of(entries, ("squares", "seed 1"), "", 250.0)
    axes = figure.axes[0]
    lines = [segment for c in axes.findobj(LineCollection) for segment in c.get_segments()]
    assert len(lines) == 7
    sizes = np.array([np.ptp(line, axis=0) for line in lines])
    assert sizes == pytest.approx(np.full((7, 2), sizes[0, 0]))
    corners = {tuple(np.round(line.min(axis=0), 6)) for line in lines}
    assert len(corners) == 7
    crosses = np.array([line.get_xydata()[0] for line in axes.lines if line.get_marker() == "X"])
    assert crosses == pytest.approx(np.array([line.mean(axis=0) for line in lines]))
    # north is up: the page's y grows downwards, so the first point, south-west, has the largest y
    assert lines[0][0, 1] == lines[0][:, 1].max()


def test_the_page_counts_outcomes_in_words(tmp_path: Path) -> None:
    campaign(tmp_path, 5)
    world, setup = World().changed(map_size=200.0, oracle="sbft"), Setup(driver="beamng_like")
    request = Request(words="a $strange$ road", seed=4, world=world, setup=setup)
    (tmp_path / CARD).write_text(Card(request=request, roads=5, is_finished=True).model_dump_json())
    assert overview(tmp_path)
    (drawn,) = pages(tmp_path)
    about = {text.get_text() for text in drawn.axes[0].texts}
    assert any("seed 4, driver beamng_like, oracle sbft" in text for text in about), about
    entries = [Thumbnail(1, "PASS", np.empty((0, 2)), None)]
    figure = page_of(entries, ("words", "seed 4"), "page 2 of 3", 200.0)
    said = [text.get_text() for text in figure.axes[0].texts]
    assert {"1 PASS", "words", "PASS"} <= set(said)
    assert any("seed 4" in text and "page 2 of 3" in text for text in said)


def test_the_page_says_what_its_signs_mean() -> None:
    line = np.array([[10.0, 20.0], [30.0, 40.0]])

    def said(entries: list[Thumbnail]) -> set[str]:
        return {text.get_text() for text in page_of(entries, ("", ""), "", 200.0).axes[0].texts}

    kept, failed = Thumbnail(1, "PASS", line, None), Thumbnail(2, "FAIL", line, (20.0, 30.0))
    assert {"start", "where the car failed"} <= said([kept, failed])
    assert "where the car failed" not in said([kept, kept])
    assert "start" not in said([Thumbnail(1, "ERROR", np.empty((0, 2)), None)])


def test_no_tests_no_page(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"holds no test\.0001\.json"):
        overview(tmp_path)
    (tmp_path / "test.0001.json").write_text("{")
    with pytest.raises(UsageError, match="cannot be read"):
        overview(tmp_path)


def test_an_outcome_of_another_tool_is_shown_as_it_is(tmp_path: Path) -> None:
    test = test_file(1) | {"test_outcome": "NOT_EXECUTED"}
    (tmp_path / "test.0001.json").write_text(json.dumps(test))
    assert overview(tmp_path)
    entries = [Thumbnail(1, "NOT_EXECUTED", np.array([[1.0, 2.0], [30.0, 40.0]]), None)] * 2
    said = [text.get_text() for text in page_of(entries, ("", ""), "", 200.0).axes[0].texts]
    assert said.count("NOT_EXECUTED") == 2
    assert "2 NOT_EXECUTED" in said


def test_the_cross_marks_the_first_record_outside(tmp_path: Path) -> None:
    """The competition's record has is_oob in the 13th place, and the position in the second."""
    from roadgpt.report.overview import _thumbnail

    records = [[i / 10, [10.0 * i, 5.0, 1.0], *[0] * 10, i >= 3, 0, 0, 0, 0] for i in range(6)]
    path = tmp_path / "test.0002.json"
    path.write_text(json.dumps(test_file(1) | {"test_outcome": "FAIL", "execution_data": records}))
    assert _thumbnail(path).failed_at == (30.0, 5.0)
