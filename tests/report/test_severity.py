"""A PASS that was outside its lane looks in no picture or page like one that was inside."""

import json
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from roadgpt.campaign.folder_record import open_record
from roadgpt.drive import Columns
from roadgpt.report import Drawing
from roadgpt.report.birds_eye import places_of, severities
from roadgpt.report.canvas import OUTCOMES, SEVERE, outcome_of
from roadgpt.report.chapters.validity import outside_sentences, outside_table, passed_tests
from roadgpt.report.overview import _thumbnail, overview
from roadgpt.report.view import scene
from roadgpt.road import Road, World
from roadgpt.run import Run, prove, write_run
from roadgpt.verdict import SEVERITIES, judge

STRAIGHT = Road.through([[40, 100], [90, 100], [140, 100]])
ASIDE = {
    "at most 10 % outside": 0.0,
    "partly outside": -1.7,
    "mostly outside": -2.5,
}  # m to the right of the lane's middle


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    """The same drive, once in its lane and twice beside it; the share is worked out on paper."""
    run = prove(STRAIGHT, 1, World().changed(oracle="thesis"))
    drive = run.drive
    assert drive is not None
    made = {}
    for index, (name, aside) in enumerate(ASIDE.items(), 1):
        right = -2.0 + aside - 0.93
        share = float(np.clip((-4.0 - right) / 1.86, 0, 1))
        columns = {**drive.columns, "t": drive["t"] + aside, "y": drive["y"] + aside}
        columns["outside"] = np.full(len(drive), share)
        moved = replace(drive, columns=Columns(columns))
        verdict = judge(STRAIGHT, moved, run.world)
        assert verdict.kept
        assert verdict.severity == name
        made[name] = replace(run, index=index, drive=moved, verdict=verdict, description=verdict.description)
    return made


def shares_of(path: Path, colours: Iterable[str]) -> list[float]:
    told = Image.open(path).convert("RGB").getcolors(1 << 24)
    assert told is not None
    counts, found = np.array([count for count, _ in told]), np.array([rgb for _, rgb in told])
    wanted = [np.round(255 * np.array(to_rgb(colour))) for colour in colours]
    alike = [np.abs(found - each).max(axis=1) <= 2 for each in wanted]
    return [float(counts[each].sum() / counts.sum()) for each in alike]


def test_every_picture_of_a_run_has_the_colour_of_how_far(runs: dict[str, Run], tmp_path: Path) -> None:
    for name, run in runs.items():
        assert OUTCOMES[outcome_of(run)] == SEVERE[run.verdict.severity]  # type: ignore[union-attr]
        Drawing().of_run(run, tmp_path)
        for picture in ("birds_eye.png", "height.png", "curvature_grade.png"):
            shares = shares_of(tmp_path / picture, [SEVERE[each] for each in SEVERITIES])
            assert SEVERITIES[int(np.argmax(shares))] == name, picture
        assert {*severities(run.drive)} == {name}


def test_the_place_where_most_was_outside_is_named(runs: dict[str, Run]) -> None:
    assert places_of(runs["at most 10 % outside"]) == []
    (place,) = places_of(runs["mostly outside"])
    verdict = runs["mostly outside"].verdict
    assert verdict is not None
    assert 1.43 <= verdict.beyond < 1.6  # the drive weaves, so its corners reach farther than on paper
    assert place.text == f"77 % of the car outside,\n{verdict.beyond:.2f} m beyond the marking"
    assert place.colour == SEVERE["mostly outside"]
    assert place.sign != "X"
    told = scene(runs["mostly outside"])
    assert told["outcome"] == "PASS (mostly outside)"
    assert told["colour"] == SEVERE["mostly outside"]
    assert told["places"][0]["colour"] == SEVERE["mostly outside"]


def test_the_overview_tells_them_apart(runs: dict[str, Run], tmp_path: Path) -> None:
    for run in runs.values():
        write_run(run, tmp_path)
    files = sorted(tmp_path.glob("test.*.json"))
    for file, run in zip(files, runs.values(), strict=True):
        entry = _thumbnail(file)
        assert run.verdict is not None
        assert entry.share == pytest.approx(run.verdict.max_oob)
        # the competition's own folders have no verdicts: then the records tell
        alone = tmp_path / "alone" / file.name
        alone.parent.mkdir(exist_ok=True)
        alone.write_text(json.dumps(json.loads(file.read_text())))
        assert _thumbnail(alone).graded == entry.graded == outcome_of(run)
    (page,) = overview(tmp_path)
    assert min(shares_of(page, SEVERE.values())) > 1e-4


def test_reports_count_them(runs: dict[str, Run], tmp_path: Path) -> None:
    worst = runs["mostly outside"]
    for run in (*runs.values(), replace(worst, index=4)):
        write_run(run, tmp_path / "all")
    write_run(runs["at most 10 % outside"], tmp_path / "one")
    with open_record(tmp_path / "all") as record, open_record(tmp_path / "one") as other:
        found, inside, both = (passed_tests(its) for its in ([record], [other], [record, other]))
    assert [(each.severity, each.tests) for each in found] == [*zip(SEVERITIES, (1, 1, 2), strict=True)]
    assert [each.tests for each in both] == [2, 1, 2]
    assert worst.verdict is not None
    (sentence,) = outside_sentences(found, worst.world)
    assert "partly outside its lane on 1 of 4 (25.0 %) and mostly outside on 2 of 4 (50.0 %)" in sentence
    assert "within the tolerance of 95 %" in sentence
    assert f"{worst.verdict.beyond:.2f} m beyond the marking" in sentence
    (table,) = outside_table(found)
    assert [row[1].value for row in table.rows] == [1, 1, 2]
    (whole,) = outside_sentences(inside, worst.world)
    assert "never outside its lane" in whole
    assert outside_sentences(passed_tests([]), worst.world) == outside_table(passed_tests([])) == []
