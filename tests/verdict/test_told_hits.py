"""A contact that the scene tells and that never came is said in one sentence, by whoever drove."""

from dataclasses import replace

import pytest
import shapely

from boxed import corners
from roadgpt.run import Run, Setup, perform
from roadgpt.verdict import judge

CUTS_IN = "straight 400 | lanes=2 && ego v=50; van lane left v=40 hits=front impact=20: cut_in"


@pytest.fixture(scope="module")
def avoided() -> Run:
    return perform(CUTS_IN, seed=3, setup=Setup(driver="lane_centring", reader="plan"))


def test_a_told_contact_that_the_driver_avoids_is_a_pass_that_says_so(avoided: Run) -> None:
    assert avoided.verdict is not None
    assert avoided.outcome == "PASS"
    assert "van 1 hits the tested car's front: the tested driver avoided that" in avoided.description
    (event,) = [each for each in avoided.verdict.events or () if each.what.startswith("hits ")]
    assert (event.who, event.time, event.why) == ("van 1", None, "the tested driver avoided that")
    (told,) = [each for each in avoided.verdict.to_json()["events"] if each["what"] == event.what]
    assert told["why"]


def test_the_robot_avoids_nobody_so_it_did_not_happen(avoided: Run) -> None:
    assert avoided.drive is not None
    assert avoided.road is not None
    found = judge(avoided.road, replace(avoided.drive, driver="robot"), avoided.world)
    assert found.outcome == "INVALID"
    assert found.description.startswith("did not happen: van 1 hits the tested car's front")


def test_how_far_the_script_steers_out_of_the_lane_is_told() -> None:
    words = "straight 500 && ego v=50: drift left shift=2.2 lat=0.5, release"
    run = perform(words, seed=3, setup=Setup(driver="reference", reader="plan"))
    assert run.drive is not None
    most = 100 * float(run.drive["outside"].max())
    assert f"steered it out of its lane, with up to {most:.0f} % of it outside" in run.description


def test_a_told_contact_that_comes_is_an_event_with_its_time() -> None:
    run = perform(CUTS_IN, seed=3, setup=Setup(driver="robot", reader="plan"))
    assert run.verdict is not None
    assert run.drive is not None
    assert run.drive.others is not None
    (event,) = [each for each in run.verdict.events or () if each.what == "hits the tested car's front"]
    assert event.time is not None
    assert "never happened" not in run.description

    def apart(time: float) -> float:
        step = round(50 * time)
        (state,), (actor,) = run.drive.others.at(run.drive["time"][step]), run.drive.others.actors
        own = shapely.Polygon(run.drive.corners(step))
        return float(own.distance(shapely.Polygon(corners(state, actor.size[:2]))))

    assert apart(event.time - 0.5) > 0.05
    assert apart(event.time + 0.04) == 0.0
