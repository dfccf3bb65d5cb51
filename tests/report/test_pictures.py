"""Pictures of Runs: what they say, where they mark it, and that the same Run gives the same bytes."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text

from roadgpt.check import Finding
from roadgpt.report import birds_eye, draw, drawing, height_profile, strip
from roadgpt.report.canvas import Header
from roadgpt.report.height import draw_heights
from roadgpt.report.text_width import fitted, inches
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
    hand = "left" if turn > 0 else "right"
    return Design(
        starting_point=(x, y, 0),
        theta=theta,
        segments=(
            Segment(distance=60, direction="straight", incline=incline),
            Segment(distance=45, direction=hand, incline=2, turn_degrees=turn),
            Segment(distance=50, direction="straight", incline=incline),
            Segment(distance=55, direction="right", incline=0, turn_degrees=-60),
        ),
    )


def named(run: Run, words: str = WORDS) -> Run:
    return replace(run, request=run.request.model_copy(update={"words": words}))


@pytest.fixture(scope="module")
def passed() -> Run:
    return named(prove(design(), 7))


@pytest.fixture(scope="module")
def failed(tmp_path_factory: pytest.TempPathFactory) -> Run:
    file = tmp_path_factory.mktemp("driver") / "never.py"
    file.write_text(NEVER)
    return named(prove(design(), 8, setup=Setup(driver=f"{file}:Never", keep_driving=True)))


@pytest.fixture(scope="module")
def invalid() -> Run:
    return named(prove(design(incline=18), 9))


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


def test_a_road_from_a_file_is_called_by_its_file_and_has_no_seed() -> None:
    run = replace(prove(design(), setup=Setup(drives=False)), source="my_road.json")
    for picture in (birds_eye, height_profile, strip):
        said = flat(picture(run))
        assert "my_road.json" in said
        assert "seed" not in said


def objected(at: tuple[float, ...], sentence: str) -> Run:
    """A road whose promises are broken at these stations."""
    run = named(prove(design(), 3, setup=Setup(drives=False)))
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


def test_the_border_s_name_is_not_written_under_the_road() -> None:
    points = [[20, 20], [100, 8], [180, -6], [230, -3]]
    run = prove(Road.through(points), setup=Setup(drives=False))
    figure = birds_eye(run)
    axes = figure.axes[0]
    (border,) = [text for text in axes.texts if text.get_text() == "border of the map"]
    figure.canvas.draw()
    box = border.get_window_extent()
    assert run.road is not None
    half = 4.0 + 3.0
    across = [run.road.at(np.linspace(0, run.length, 400), t)[:, :2] for t in np.linspace(-half, half, 15)]
    for x, y in axes.transData.transform(np.concatenate(across)):
        assert not box.contains(x, y)
    assert not any(box.overlaps(Text.get_window_extent(t)) for t in axes.texts if t is not border)


def test_every_climb_and_fall_has_its_slope() -> None:
    hills = [Segment(distance=36, direction="straight", incline=8 * (-1) ** i) for i in range(6)]
    hilly = Design(starting_point=(5, 60, 3), theta=0, segments=tuple(hills))
    axes = height_profile(prove(hilly, setup=Setup(drives=False))).axes[0]
    slopes = sorted(
        (text.get_position()[0], text.get_text()[0]) for text in axes.texts if "%" in text.get_text()
    )
    assert [sign for _, sign in slopes] == ["+", "−"] * 3
    assert all(36 * i <= x <= 36 * (i + 1) for i, (x, _) in enumerate(slopes))


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


def test_the_steepest_grade_is_told_though_no_stretch_has_it_all_along() -> None:
    run = prove(
        Road.through([[5 + 20 * i, 60, 30 + 12 * np.sin(i / 4)] for i in range(11)]),
        setup=Setup(drives=False),
    )
    (axes,) = height_profile(run).axes
    assert run.road is not None
    grades = run.road.grade(np.linspace(0, run.length, 5001))
    said = [text.get_text() for text in axes.texts]
    assert grades.max() == pytest.approx(0.15, abs=5e-4)
    assert grades.min() == pytest.approx(-0.12, abs=5e-4)
    assert {"+15 %", "−12 %"} <= set(said)


def test_a_level_road_can_be_seen_on_the_thesis_axes_and_its_names_lie_apart() -> None:
    run = prove(Road.through([[60, 60], [75, 60], [85, 60], [95, 65], [100, 85], [100, 110]]))
    assert run.findings
    figure = height_profile(run, "thesis")
    axes = figure.axes[0]
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)  # type: ignore[attr-defined]
    x, y = (int(v) for v in axes.transData.transform((30, 0)))
    column = pixels[pixels.shape[0] - y - 4 : pixels.shape[0] - y + 4, x]
    assert (
        np.abs(column - [0x4B, 0x55, 0x63]).max(axis=1) < 40
    ).sum() >= 4  # pixels: half of it would be two
    boxes = [Text.get_window_extent(text) for text in axes.texts]
    assert len(boxes) >= 2
    assert not any(box.overlaps(other) for i, box in enumerate(boxes) for other in boxes[:i])


def test_axes_have_names_and_units(passed: Run) -> None:
    for figure, named_axes in ((birds_eye(passed), 2), (height_profile(passed), 1), (strip(passed), 4)):
        labels = [axes.get_ylabel() for axes in figure.axes]
        assert len([label for label in labels if "," in label]) == len(labels) == named_axes
        assert any(", m" in axes.get_xlabel() for axes in figure.axes)


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


def test_an_invalid_road_is_drawn_with_the_place_of_the_finding(invalid: Run) -> None:
    places = [(f.x, f.y) for f in invalid.findings if f.x is not None]
    axes = birds_eye(invalid).axes[0]
    crosses = [tuple(line.get_xydata()[0]) for line in axes.lines if line.get_marker() == "X"]
    assert crosses[0] == pytest.approx(places[0])
    assert "too steep" in texts(birds_eye(invalid))
    assert invalid.drive is None


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
        (60, 8.0, 2),
        (200, 3.0, 5),
        (200, 20.0, 1),
        (900, 0.0, 20),
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


def test_a_large_exaggeration_is_written_out() -> None:
    axes = Figure().add_subplot(xlim=(0, 40_000), ylim=(0, 20))
    draw_heights(axes, np.array([0.0, 40_000.0]), np.array([3.0, 5.0]))
    across, up = per_metre(axes)
    said = re.search(r"exaggerated (\d+) x", axes.get_ylabel())
    assert said is not None
    assert int(said[1]) == pytest.approx(up / across, rel=0.05)
    assert up / across > 1000


def test_the_thesis_axes_say_their_exaggeration_too(passed: Run) -> None:
    (axes,) = height_profile(passed, "thesis").axes
    across, up = per_metre(axes)
    assert axes.get_ylabel().endswith(f"\n(exaggerated {up / across:.2g} x)")


def test_the_thesis_axes_are_roadgpt_s(passed: Run) -> None:
    axes = birds_eye(passed, "thesis").axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == ((0, 220), (0, 220))
    axes = height_profile(passed, "thesis").axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == ((0, 200), (0, 20))


def test_thesis_heights_below_zero_count_from_the_lowest_point() -> None:
    run = prove(design(incline=-9), setup=Setup(drives=False))
    axes = height_profile(run, "thesis").axes[0]
    heights = max((line.get_ydata() for line in axes.lines), key=len)
    assert min(heights) == pytest.approx(0)
    assert axes.get_ylabel().startswith("height above the lowest point, m\n")


def test_a_wide_road_lies_wholly_in_the_picture() -> None:
    run = prove(design(), world=World(section=CrossSection(lanes="4+4")), setup=Setup(drives=False))
    axes = birds_eye(run).axes[0]
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    shapes = [patch.get_path().vertices for patch in axes.patches]
    corners = np.concatenate([shape for shape in shapes if len(shape) > 100])
    assert x0 <= corners[:, 0].min() < corners[:, 0].max() <= x1
    assert y0 <= corners[:, 1].min() < corners[:, 1].max() <= y1


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


def test_the_same_run_gives_the_same_bytes_and_a_user_s_own_style_changes_nothing(
    passed: Run, tmp_path: Path
) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
    drawing().of_run(passed, tmp_path / "a")
    with rc_context({"font.size": 31, "axes.facecolor": "red", "savefig.bbox": "tight"}):
        draw(passed, tmp_path / "b")
    for name in NAMES:
        data = (tmp_path / "a" / name).read_bytes()
        assert data == (tmp_path / "b" / name).read_bytes()
        assert data.startswith(b"\x89PNG")
        assert b"Software" not in data
        assert b"tEXt" not in data
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == sorted(NAMES)


def test_a_run_without_a_road_has_no_picture(passed: Run, tmp_path: Path) -> None:
    assert draw(replace(passed, road=None, drive=None, verdict=None, outcome="ERROR"), tmp_path) == []
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "points",
    [[[10, 10], [31, 10]], [[-50, 30], [400, 30], [900, 800]], [[100, 100, 5], [103, 104, 9], [100, 108, 2]]],
)
def test_odd_roads_are_drawn_too(points: list[list[float]], tmp_path: Path) -> None:
    run = prove(Road.through(points), world=World(section=CrossSection(shoulder=0)))
    for scale in ("equal", "thesis"):
        assert [path.name for path in draw(run, tmp_path, scale)] == NAMES  # type: ignore[arg-type]


@settings(max_examples=60)
@given(st.text(max_size=400), st.floats(1, 9), st.integers(1, 3), st.booleans())
def test_text_is_fitted_whatever_it_is(text: str, width: float, lines: int, bold: bool) -> None:
    rows = fitted(text, width, 11, bold, lines).split("\n")
    assert len(rows) <= lines
    assert inches("\n".join(rows), 11, bold) <= width


def test_the_width_of_text_is_that_which_is_drawn() -> None:
    figure = Figure(dpi=100)
    renderer = FigureCanvasAgg(figure).get_renderer()
    for text in ("left its lane to the right after 78 m", "iiiill", "WWWW"):
        for bold in (False, True):
            drawn = figure.text(0, 0, text, size=20, weight="bold" if bold else "normal")
            width = drawn.get_window_extent(renderer).width / 100
            assert inches(text, 20, bold) == pytest.approx(width, rel=0.06)


def test_strange_words_are_no_formula_and_warn_of_nothing(passed: Run, tmp_path: Path) -> None:
    words = "a $road$ of \\alpha^2 with 道 turns \x00 and {braces} _" * 30
    strange = named(passed, words)
    assert "$road$" in Header.of(strange, 8).title
    assert "道" not in Header.of(strange, 8).title
    assert len(draw(strange, tmp_path)) == 3


def test_no_outcome_is_cut_off(failed: Run) -> None:
    """A reason with how often the road failed again is longer than two lines of a narrow picture."""
    reason = "it came into the 28 m curve at 17.3 m/s, which no tyre holds on this surface; " * 2
    said = f"{reason}fails every time (2 of 2 disturbed drives fail, 95 % interval 34 to 100 %)"
    header = Header.of(replace(failed, description=said), 6.5)
    assert " ".join(header.said.split("\n")) == said
    assert header.height > Header.of(failed, 6.5).height
