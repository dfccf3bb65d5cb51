"""Pictures and page of a route mark everything that the car did wrong, and the cause of the failure most."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text

from roadgpt.network import made_from
from roadgpt.report import birds_eye, view
from roadgpt.report.birds_eye import minor_places_of, places_of
from roadgpt.road import World, read_design
from roadgpt.run import Run, Setup, prove
from roadgpt.verdict import Incident

NO_STOP = """
import math
from roadgpt.drive import Command

class NoStop:
    name = "no stop"

    def steer(self, view):
        ahead = min(view.s + 6, view.road.length)
        x, y, _ = view.road.at(ahead, view.world.profile_of(view.road).middle(ahead))
        bearing = math.atan2(y - view.y, x - view.x) - view.heading
        wanted = math.atan2(math.sin(bearing), math.cos(bearing))
        pedal = 0.3 * (20 / 3.6 - view.speed)
        return Command(steer=0.8 * wanted, throttle=max(pedal, 0), brake=max(-pedal, 0))
"""
KINDS = ("out of lane", "wrong turn", "wrong way", "off road", "stop line")
WORDS = ("left its lane", "took a wrong turn", "drove the wrong way", "a wheel off the road", "did not stop")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A car that passes three stop signs, about 85 m from each other, without a stop."""
    straight = {"distance": 50, "direction": "straight", "incline": 0, "turn_degrees": 0}
    data: dict[str, object] = {"starting_point": [20, 100, 0], "theta": 0}
    for n in (1, 2, 3):
        data[f"road_segment{n}"] = straight
        data[f"junction{n}"] = {"after": n, "kind": "crossroads", "take": "straight", "control": "stop"}
    data["road_segment4"] = straight
    file = tmp_path_factory.mktemp("driver") / "no_stop.py"
    file.write_text(NO_STOP)
    world = World().changed(map_size=500)
    route = made_from(read_design(data)[0], world)
    run = prove(route, 7, world, setup=Setup(driver=f"{file}:NoStop"))
    assert run.verdict is not None
    assert run.verdict.counts == {"stop line": 3}
    return run


def at(run: Run, kind: str, s: float) -> Incident:
    """An incident where the car was ``s`` metres after the start."""
    drive = run.drive
    assert drive is not None
    step = int(np.argmin(np.abs(drive["s"] - s)))
    x, y, time = (float(drive[name][step]) for name in ("x", "y", "time"))
    return Incident(kind, float(drive["s"][step]), (x, y), time)  # type: ignore[arg-type]


def beside(run: Run, *more: Incident) -> Run:
    """The run with more incidents."""
    assert run.verdict is not None
    every = sorted((*(run.verdict.incidents or ()), *more), key=lambda each: each.at_time)
    return replace(run, verdict=replace(run.verdict, incidents=tuple(every)))


def crowd(run: Run) -> Run:
    """One incident of each kind within 2 m, after 100 m, and a wheel that leaves the road every 8 m."""
    some = [at(run, kind, 100 + 0.4 * n) for n, kind in enumerate(KINDS)]
    return beside(run, *some, *(at(run, "off road", s) for s in (140, 148, 156, 164, 190)))


def crosses(figure: Figure) -> list[tuple[float, float, float, float]]:
    """Place, size and layer of every cross of a bird's-eye view."""
    lines = [line for line in figure.axes[0].lines if line.get_marker() == "X"]
    return [(*line.get_xydata()[0], line.get_markersize(), line.get_zorder()) for line in lines]


def labels(figure: Figure) -> list[Annotation]:
    return [text for text in figure.axes[0].texts if isinstance(text, Annotation)]


def test_every_missed_stop_is_marked_and_named_and_the_first_one_is_largest(run: Run) -> None:
    assert run.verdict is not None
    assert run.verdict.incidents is not None
    figure = birds_eye(run)
    drawn = sorted(crosses(figure))
    np.testing.assert_allclose([each[:2] for each in drawn], [each.at_xy for each in run.verdict.incidents])
    cause, *others = drawn
    assert all(cause[2] > 1.3 * size and cause[3] > layer for _, _, size, layer in others)
    named = {text.get_text(): text for text in labels(figure)}
    stations = [f"did not stop, {each.at_s:.0f} m" for each in run.verdict.incidents]
    assert set(named) == {*stations, "start", "end"}
    assert all(named[stations[0]].get_fontsize() > named[other].get_fontsize() for other in stations[1:])


@pytest.mark.parametrize(("clusters", "left_out"), [((), False), ((160, 180, 200, 220, 240), True)])
def test_labels_of_incidents_lie_apart_and_those_without_room_are_counted(
    run: Run, clusters: tuple[float, ...], left_out: bool
) -> None:
    made = beside(crowd(run), *(at(run, kind, s + n) for s in clusters for n, kind in enumerate(KINDS)))
    figure = birds_eye(made)
    places = minor_places_of(made)
    assert len(crosses(figure)) == 1 + len(places)
    notes = labels(figure)
    said = [text.get_text() for text in notes]
    for words in WORDS:
        assert any(text.startswith(f"{words}, 10") for text in said), words
    missing = [place.text for place in places if place.text and place.text not in said]
    assert bool(missing) == left_out
    note = f"no room for {len(missing)} labels of black crosses"
    assert (note in said) == left_out
    notes = [text for text in notes if text.get_text() != note]
    figure.canvas.draw()
    boxes = [Text.get_window_extent(note) for note in notes]
    frame = figure.axes[0].get_window_extent()
    assert all(frame.x0 <= box.x0 and box.x1 <= frame.x1 for box in boxes)
    assert all(frame.y0 <= box.y0 and box.y1 <= frame.y1 for box in boxes)
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


def test_the_cause_is_marked_once_also_where_it_lies_between_two_control_steps(run: Run) -> None:
    assert run.verdict is not None
    first, *others = run.verdict.incidents or ()
    between = replace(first, at_time=first.at_time - 0.013)
    made = replace(run, verdict=replace(run.verdict, incidents=(between, *others)))
    assert [each.s for each in minor_places_of(made)] == [each.at_s for each in others]


def test_incidents_of_one_kind_one_after_another_share_a_label(run: Run) -> None:
    places = [each for each in minor_places_of(crowd(run)) if "off the road" in each.text or not each.text]
    assert [each.text for each in places] == [
        f"{WORDS[3]}, 101 m", f"{WORDS[3]}\n4 times, 140 to 164 m", "", "", "", f"{WORDS[3]}, 190 m",
    ]  # fmt: skip
    assert [each.s for each in places[1:5]] == pytest.approx([140, 148, 156, 164], abs=0.1)


def test_a_drive_that_passed_has_marks_too(run: Run) -> None:
    assert run.verdict is not None
    passed = replace(run.verdict, outcome="PASS", cause=None, at_s=None, at_xy=None, at_time=None)
    passed = replace(passed, incidents=(at(run, "off road", 30),))
    kept = replace(run, outcome="PASS", verdict=passed)
    assert places_of(kept) == []
    assert "a wheel off the road, 30 m" in [text.get_text() for text in labels(birds_eye(kept))]
    assert [place["text"] for place in view.scene(kept)["places"]] == ["a wheel off the road, 30 m"]
