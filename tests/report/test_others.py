"""Pictures show the others on the road where they were, and enlarge a contact."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from roadgpt.geometry.boxes import corners
from roadgpt.report import birds_eye
from roadgpt.report.canvas import encoded
from roadgpt.report.others import COLOURS, _corners_at, moment_of, step_at
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
    main, inset = boxes(figure), boxes(figure, 1)
    for state, actor in zip(states, actors, strict=True):
        if actor.kind != "adult":  # who is drawn larger
            assert is_drawn(corners(state[:2], state[3], np.array(actor.size)), main)
    assert is_drawn(corners(states[0, :2], states[0, 3], np.array(actors[0].size)), inset)
    assert not is_drawn(corners(states[1, :2], states[1, 3], np.array(actors[1].size)), inset)
    outlines = [patch.get_xy()[:-1] for patch in figure.axes[0].patches if isinstance(patch, Polygon)]
    round_ones = [each for each in outlines if len(each) > 8 and np.ptp(each, axis=0).max() < 15]
    assert [each.mean(axis=0) for each in round_ones] == [pytest.approx(states[2][:2], abs=0.01)]


def test_the_inset_shows_the_two_that_touch_and_names_them(crash: Run) -> None:
    figure = birds_eye(crash)
    own, other = boxes(figure, 1)
    assert own[:, 0].max() == pytest.approx(other[:, 0].min(), abs=0.01)  # front to rear
    (x0, x1), (y0, y1) = figure.axes[1].get_xlim(), figure.axes[1].get_ylim()
    for box in (own, other):
        assert (box > (x0, y0)).all()
        assert (box < (x1, y1)).all()
    said = {text.get_text() for text in figure.axes[1].texts}
    assert {"tested car\n43 km/h", "van 1\n7 km/h"} <= said
    label = f"contact with van 1, {crash.verdict.at_s:.0f} m"  # type: ignore[union-attr]
    assert label in {text.get_text() for text in figure.axes[0].texts}


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


def test_without_a_contact_there_is_no_inset_and_without_others_nothing_else() -> None:
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


def test_a_contact_at_the_very_beginning_is_drawn_where_the_car_started(crash: Run) -> None:
    """There is no step before the first one; the car is then drawn where it was, or on its way back."""
    assert crash.drive is not None
    first, second = crash.drive.corners(0), crash.drive.corners(1)
    assert _corners_at(crash, 0.0) == pytest.approx(first)
    assert _corners_at(crash, float(crash.drive["time"][1])) == pytest.approx(second)
    early = _corners_at(crash, -0.001)
    assert np.abs(early - first).max() < np.abs(second - first).max()
    assert [step_at(crash, time) for time in (-1.0, 0.0, 1e6)] == [0, 0, len(crash.drive) - 1]
