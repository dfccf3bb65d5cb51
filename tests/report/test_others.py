"""Pictures show the others on the road where they were, and enlarge a contact."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from roadgpt.geometry.boxes import corners
from roadgpt.report import birds_eye
from roadgpt.report.canvas import encoded
from roadgpt.report.moments import moments
from roadgpt.report.others import COLOURS, moment_of
from roadgpt.report.view import _closest
from roadgpt.road import Road, World
from roadgpt.run import Request, Run, Setup
from roadgpt.traffic.actor import STEP
from roadgpt.verdict import judge
from staged import among, driven, straight, tracks

ROAD = World().lay(Road.through([[x, 100] for x in range(20, 181, 20)]))


def run_with(**others: object) -> Run:
    drive = driven(straight(30, 98, 0, 12), 6.0, ROAD)
    if others:
        drive = among(drive, tracks(6.0, **others))  # type: ignore[arg-type]
    verdict = judge(ROAD, drive, World())
    request = Request(words="others", world=World(), seed=1, setup=Setup())
    return Run(
        request=request, index=1, seed=1, road=ROAD, drive=drive, verdict=verdict, outcome=verdict.outcome,
        description=verdict.description,
    )  # fmt: skip


@pytest.fixture(scope="module")
def crash() -> Run:
    return run_with(
        van_1=("van", straight(70, 97.5, 0, 2)),
        bus_1=("bus", straight(160, 102, np.pi, 10)),
        adult_1=("adult", straight(60, 92, 0, 0)),
    )


def boxes(figure: Figure, number: int = 0) -> list[np.ndarray]:
    """The outlines of boxes on axes, each (4, 2)."""
    outlines = [patch.get_xy() for patch in figure.axes[number].patches if isinstance(patch, Polygon)]
    return [each[:4] for each in outlines if len(each) == 5 and np.ptp(each, axis=0).max() < 15]


def is_drawn(box: np.ndarray, drawn: list[np.ndarray]) -> bool:
    return any(np.allclose(box, each, atol=0.02) for each in drawn)


def test_everybody_is_drawn_where_he_was_at_the_contact(crash: Run) -> None:
    assert crash.drive is not None
    assert crash.drive.others is not None
    assert crash.verdict is not None
    assert crash.verdict.cause == "collision"
    time = moment_of(crash)
    assert time == crash.verdict.at_time
    figure = birds_eye(crash)
    states, actors = crash.drive.others.at(time), crash.drive.others.actors
    main = boxes(figure)
    for state, actor in zip(states, actors, strict=True):
        if actor.kind != "adult":  # who is drawn larger
            assert is_drawn(corners(state[:2], state[3], np.array(actor.size)), main)
    outlines = [patch.get_xy()[:-1] for patch in figure.axes[0].patches if isinstance(patch, Polygon)]
    round_ones = [each for each in outlines if len(each) > 8 and np.ptp(each, axis=0).max() < 15]
    assert [each.mean(axis=0) for each in round_ones] == [pytest.approx(states[2][:2], abs=0.01)]


def test_the_moments_show_the_two_that_touch_and_how_fast_they_were(crash: Run) -> None:
    """The tested car drives at 12 m/s and the van at 2 m/s, 40 m ahead: what they do is known by hand."""
    assert crash.verdict is not None
    assert crash.verdict.at_time is not None
    figure = moments(crash)
    assert figure is not None
    *views, gaps, collision, speeds = figure.axes
    titles = [axes.get_title() for axes in views]
    at = [title.startswith("contact") for title in titles].index(True)
    assert titles[at] == f"contact, {crash.verdict.at_time:.1f} s"
    assert titles[-1] == "end, 6.0 s"
    drawn, (x0, x1) = boxes(figure, at), views[at].get_xlim()
    inside = [box for box in drawn if x0 < box[:, 0].mean() < x1]
    fronts = sorted((box[:, 0].min(), box[:, 0].max()) for box in inside[-2:])
    assert fronts[0][1] == pytest.approx(fronts[1][0], abs=0.03)  # front to rear
    by_name = {
        line.get_label(): np.array(line.get_data())
        for axes in (gaps, collision, speeds)
        for line in axes.lines
    }
    assert by_name["tested car"][1][10] == pytest.approx(43.2, abs=0.2)
    assert by_name["van 1"][1][10] == pytest.approx(7.2, abs=0.1)
    gap = by_name["gap in the lane"]
    assert gap[1][0] - gap[1][10] == pytest.approx(10.0, abs=0.1)  # 10 m/s of difference for a second
    ttc = by_name["time to collision"]
    assert ttc[1][10] == pytest.approx(crash.verdict.at_time - ttc[0][10], abs=0.03)
    assert [boxes(figure, n) for n in range(at)]


def test_the_closest_moment_is_one_of_them() -> None:
    passing = run_with(bus_1=("bus", straight(90, 103, np.pi, 10)))
    figure = moments(passing)
    assert figure is not None
    titles = [axes.get_title() for axes in figure.axes]
    (closest,) = [title for title in titles if title.startswith("closest")]
    assert float(closest.split()[1]) == pytest.approx(60 / 22, abs=0.8)  # they are side by side
    assert moments(run_with()) is None


def test_the_key_names_the_kinds_that_are_there(crash: Run) -> None:
    said = {text.get_text() for text in birds_eye(crash).texts}
    assert {"tested car", "car, van", "truck, bus", "person"} <= said
    assert "two wheels" not in said
    assert len({*COLOURS.values()}) == len(COLOURS)


def test_trails_lead_to_their_boxes_and_fade(crash: Run) -> None:
    assert crash.drive is not None
    assert crash.drive.others is not None
    time = moment_of(crash)
    state = crash.drive.others.at(time)[1]
    found = 0
    for lines in figure_lines(birds_eye(crash)):
        if np.allclose(lines.get_segments()[-1][-1], state[:2], atol=2.1):
            alphas = lines.get_colors()[:, 3]
            found += len(alphas) > 3 and bool((np.diff(alphas) > 0).all())
    assert found == 1


def figure_lines(figure: Figure) -> list:  # type: ignore[type-arg]
    return [
        each for each in figure.axes[0].collections if hasattr(each, "get_segments") and each.get_segments()
    ]


def test_without_others_there_is_nothing_else() -> None:
    alone = run_with()
    passed = run_with(bus_1=("bus", straight(160, 102, np.pi, 10)))
    assert passed.verdict is not None
    assert passed.verdict.kept
    assert moment_of(passed) == 6.0
    assert len(birds_eye(passed).axes) == len(birds_eye(alone).axes)
    assert passed.drive is not None
    without = replace(passed, drive=replace(passed.drive, others=None))
    assert encoded(birds_eye(without), "png") == encoded(birds_eye(alone), "png")


def test_somebody_who_left_is_not_drawn() -> None:
    crash = run_with(van_1=("van", straight(70, 97.5, 0, 2)), bus_1=("bus", straight(160, 102, np.pi, 10)))
    assert crash.drive is not None
    others = crash.drive.others
    assert others is not None
    gone = others.states.copy()
    gone[10:, 1] = np.nan
    left = replace(crash, drive=among(crash.drive, replace(others, states=gone)))
    assert len(boxes(birds_eye(left))) == len(boxes(birds_eye(crash))) - 1


def test_the_page_names_whom_the_car_is_about_to_touch_and_where_it_touched_him(crash: Run) -> None:
    """A third of a second before the contact nobody else is nearer in time."""
    assert crash.verdict is not None
    assert crash.drive is not None
    assert crash.drive.others is not None
    told = _closest(crash)
    (hit,) = [each for each in crash.verdict.incidents or () if each.contact]
    sample = int(hit.at_time / STEP) - 3
    names = [each.name for each in crash.drive.others.actors]
    assert names[told["near"]["who"][sample]].startswith("van")
    assert 0.0 < told["near"]["conflict"][sample] < 0.7
    (place,) = told["contacts"]
    assert place["time"] == pytest.approx(hit.at_time, abs=2e-3)
    assert (place["x"], place["y"]) == pytest.approx(hit.contact.xy, abs=0.02)
