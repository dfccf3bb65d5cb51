"""Pictures of Runs: what they say, where they mark it, and that the same Run gives the same bytes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text

from road_parts import design_of, named
from roadgpt.check import Finding
from roadgpt.report import birds_eye, draw, height_profile, strip
from roadgpt.report.canvas import Header, fitted, inches
from roadgpt.road import CrossSection, Design, Road, Segment, World
from roadgpt.run import Run, Setup, prove

NEVER = """
from roadgpt.drive import Command

class Never:
    name = "never"

    def steer(self, view):
        return Command(0.0, 0.6, 0.0)
"""
WORDS = "an uphill road with 2 turns"
NAMES = ["birds_eye.png", "height.png", "curvature_grade.png"]


def design(x: float = 60, y: float = 60, theta: float = 20, incline: float = 5, turn: float = 65) -> Design:
    parts = (60, 0, incline), (45, turn, 2), (50, 0, incline), (55, -60, 0)
    return design_of(*parts, start=(x, y, 0), theta=theta)


@pytest.fixture(scope="module")
def passed() -> Run:
    return named(prove(design(), 7), WORDS)


@pytest.fixture(scope="module")
def failed(tmp_path_factory: pytest.TempPathFactory) -> Run:
    file = tmp_path_factory.mktemp("driver") / "never.py"
    file.write_text(NEVER)
    return named(prove(design(), 8, setup=Setup(driver=f"{file}:Never", keep_driving=True)), WORDS)


@pytest.fixture(scope="module")
def invalid() -> Run:
    return named(prove(design(incline=18), 9), WORDS)


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_text().strip()]


def flat(figure: Figure) -> str:
    return " ".join(" ".join(texts(figure)).split())


@pytest.mark.parametrize("picture", [birds_eye, height_profile, strip])
def test_every_picture_tells_words_outcome_and_seed(picture, passed: Run, failed: Run, invalid: Run) -> None:  # type: ignore[no-untyped-def]
    for run in (passed, failed, invalid):
        said = flat(picture(run))
        assert WORDS in said
        assert run.outcome in said
        assert run.description in said
        assert f"seed {run.request.seed}, road {run.index}" in said


def objected(at: tuple[float, ...], sentence: str) -> Run:
    """A road whose promises are broken at these stations."""
    run = named(prove(design(), 3, setup=Setup(drives=False)), WORDS)
    assert run.road is not None
    places = [run.road.at(s) for s in at]
    findings = tuple(
        Finding("promises", sentence, s, float(x), float(y)) for s, (x, y, _) in zip(at, places, strict=True)
    )
    return replace(run, findings=findings, outcome="INVALID", description=sentence)


@pytest.mark.parametrize("at", [(0.0,), (0.0, 208.0), (30.0, 60.0, 100.0)])
def test_a_broken_promise_is_told_in_its_own_words_beside_all_lines(at: tuple[float, ...]) -> None:
    sentence = "turn 1 has a radius of 93.1 m, asked for 0 to 30 m"
    figure = birds_eye(objected(at, sentence))
    axes = figure.axes[0]
    notes = [note for note in axes.texts if isinstance(note, Annotation)]
    said = [" ".join(note.get_text().split()) for note in notes]
    assert said.count(sentence) == len(at)
    assert not any("promises" in text for text in texts(figure))
    figure.canvas.draw()
    boxes = [Text.get_window_extent(note).padded(-2) for note in notes]
    for i, note in enumerate(notes):
        ends = axes.transData.transform([note.xy, note.xyann])
        line = np.linspace(*ends, 200)
        for j, box in enumerate(boxes):
            assert i == j or not any(box.contains(x, y) for x, y in line), (said[i], said[j])
    for picture in (height_profile, strip):
        assert sentence in texts(picture(objected(at, sentence)))


def test_grades_crests_and_sags_are_those_of_the_road() -> None:
    inclines = (6.5, 6.5, 6.5, -4.0, -4.0, -4.0, 5.0, 5.0, 5.0)
    parts = [Segment(distance=80, direction="straight", incline=incline) for incline in inclines]
    hill = Design(starting_point=(5, 60, 3), theta=0, segments=tuple(parts))
    run = prove(hill, world=World().changed(map_size=1000.0), setup=Setup(drives=False))
    (axes,) = height_profile(run).axes
    assert run.road is not None
    s = np.arange(0.0, run.length, 0.01)
    z = run.road.at(s)[:, 2]
    top, low = int(z[:40_000].argmax()), 20_000 + int(z[20_000:].argmin())
    said = {text.get_text(): text for text in axes.texts}
    labels = [f"crest, {z[top]:.0f} m", f"sag, {z[low]:.0f} m", "+6.5 %", "−4 %", "+5 %"]
    assert set(labels) == set(said)
    for label, at, align in zip(labels, (s[top], s[low]), ("bottom", "top"), strict=False):
        assert said[label].get_position()[0] == pytest.approx(at, abs=1.0)
        assert said[label].get_va() == align
    for label in labels[2:]:
        at = said[label].get_position()[0]
        assert 100 * run.road.grade(np.array([at]))[0] == pytest.approx(
            float(label[:-2].replace("−", "-")), abs=0.05
        )
    height_profile(run).canvas.draw()
    boxes = [Text.get_window_extent(text) for text in axes.texts]
    assert not any(box.overlaps(other) for i, box in enumerate(boxes) for other in boxes[:i])


def test_the_driven_path_is_coloured_by_its_speed(passed: Run) -> None:
    axes = birds_eye(passed).axes[0]
    (line,) = [c for c in axes.findobj(LineCollection) if c.get_array() is not None]
    assert passed.drive is not None
    ends = np.array([segment[0] for segment in line.get_segments()])
    track = np.stack([passed.drive["x"], passed.drive["y"]], axis=-1)
    nearest = np.linalg.norm(ends[:, None] - track[None], axis=-1)
    assert nearest.min(axis=1).max() < 1e-9
    shown = passed.drive["speed"][nearest.argmin(axis=1)] * 3.6
    assert np.abs(line.get_array() - shown).max() < 3  # km/h, of a stretch against its start


def test_the_place_where_the_car_left_its_lane_is_marked_and_named(failed: Run) -> None:
    assert failed.verdict is not None
    assert failed.verdict.at_xy is not None
    axes = birds_eye(failed).axes[0]
    crosses = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "X"]
    assert np.array(crosses) == pytest.approx(np.array([failed.verdict.at_xy]))
    assert f"left its lane\nto the {failed.verdict.side}" in texts(birds_eye(failed))
    for figure in (height_profile(failed), strip(failed)):
        assert f"left its lane to the {failed.verdict.side}" in texts(figure)


def per_metre(axes: Axes) -> tuple[float, float]:
    """Pixels of a metre along the axes and up."""
    across, up = axes.transData.transform((1, 1)) - axes.transData.transform((0, 0))
    return float(across), float(up)


def test_the_view_from_above_shows_a_metre_as_a_metre(passed: Run) -> None:
    figure = birds_eye(passed)
    figure.canvas.draw()
    across, up = per_metre(figure.axes[0])
    assert across == pytest.approx(up, rel=1e-9)


@pytest.mark.parametrize(
    ("length", "grade", "times"),
    [
        (60, 0.0, 5),
        (200, 20.0, 1),
        (900, 1.0, 20),
        (2000, 9.0, 2),
    ],
)
def test_the_axis_says_how_many_times_the_height_is_drawn_exaggerated(
    length: float, grade: float, times: int
) -> None:
    pieces = max(1, length // 100)
    part = Segment(distance=length / pieces, direction="straight", incline=grade)
    road = Design(starting_point=(9, 60, 5), theta=0, segments=(part,) * int(pieces))
    run = prove(road, world=World().changed(map_size=3000.0), setup=Setup(drives=False))
    (axes,) = height_profile(run).axes
    across, up = per_metre(axes)
    assert up / across == pytest.approx(times, rel=1e-9)
    said = "height, m" if times == 1 else f"height, m\n(exaggerated {times} x)"
    assert axes.get_ylabel() == said
    assert run.road is not None
    drawn = max((line.get_xydata() for line in axes.lines), key=len)
    assert drawn[:, 1] == pytest.approx(run.road.at(drawn[:, 0])[:, 2])


def test_the_thesis_axes_are_roadgpt_s(passed: Run) -> None:
    axes = birds_eye(passed, "thesis").axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == ((0, 220), (0, 220))
    axes = height_profile(passed, "thesis").axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == ((0, 200), (0, 20))


def test_the_road_is_drawn_to_scale(passed: Run) -> None:
    axes = birds_eye(passed).axes[0]
    assert passed.road is not None
    widths = []
    for patch in axes.patches:
        outline = patch.get_path().vertices
        if len(outline) > 100:
            s, t = passed.road.locate(*outline.T)
            inner = (s > 1) & (s < passed.length - 1)
            widths.append(np.ptp(t[inner]))
    assert sorted(widths) == pytest.approx([8.0, 14.0], abs=0.01)  # carriageway; with 3 m of verge


@settings(max_examples=5, deadline=None)
@given(
    st.floats(0, 360),
    st.floats(-70, 70).filter(lambda turn: abs(turn) > 5),
    st.floats(20, 200),
    st.floats(20, 200),
)
def test_labels_lie_inside_and_apart(theta: float, turn: float, x: float, y: float) -> None:
    run = prove(design(x, y, theta, turn=turn), setup=Setup(drives=False))
    figure = birds_eye(run)
    figure.canvas.draw()
    axes = figure.axes[0]
    notes = [note for note in axes.texts if isinstance(note, Annotation)]
    assert {"start", "end"} <= {note.get_text() for note in notes}
    boxes = [Text.get_window_extent(note) for note in notes]
    frame = axes.get_window_extent()
    for i, box in enumerate(boxes):
        assert frame.x0 <= box.x0
        assert box.x1 <= frame.x1
        assert frame.y0 <= box.y0
        assert box.y1 <= frame.y1
        assert not any(box.overlaps(other) for other in boxes[:i])


def test_a_run_without_a_road_has_no_picture(passed: Run, tmp_path: Path) -> None:
    assert draw(replace(passed, road=None, drive=None, verdict=None, outcome="ERROR"), tmp_path) == []
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "points",
    [[[10, 10], [31, 10]], [[-50, 30], [400, 30], [900, 800]], [[100, 100, 5], [103, 104, 9], [100, 108, 2]]],
)
def test_odd_roads_are_drawn_too(points: list[list[float]], tmp_path: Path) -> None:
    run = prove(Road.through(points), world=World(section=CrossSection(shoulder=0)))
    scale = "thesis" if len(points) == 2 else "equal"
    assert [path.name for path in draw(run, tmp_path, scale)] == NAMES


@settings(max_examples=60)
@given(st.text(max_size=400), st.floats(1, 9), st.integers(1, 3), st.booleans())
def test_text_is_fitted_whatever_it_is(text: str, width: float, lines: int, bold: bool) -> None:
    rows = fitted(text, width, 11, bold, lines).split("\n")
    assert len(rows) <= lines
    assert inches("\n".join(rows), 11, bold) <= width


def test_strange_words_are_no_formula_and_warn_of_nothing(passed: Run, tmp_path: Path) -> None:
    words = "a $road$ of \\alpha^2 with 道 turns \x00 and {braces} _" * 30
    strange = named(passed, words)
    assert "$road$" in Header.of(strange, 8).title
    assert "道" not in Header.of(strange, 8).title
    assert len(draw(strange, tmp_path)) == 3
