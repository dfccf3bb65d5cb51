"""Roads have what the scenes on them need and their words leave open; what excludes each other is said."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.scene_fit import fitted
from roadgpt.errors import BriefError
from roadgpt.road import World
from roadgpt.run import Setup, perform
from roadgpt.traffic.traffic import begin

SETUP = Setup(reader="plan", drives=False)


@pytest.mark.parametrize(
    "plan",
    [
        "crossroads right && car junction opposite: turn_across",
        "turn left | country && van oncoming in turn 1",
        "junction straight && car junction left v=50: cross",
        "t_junction straight && car junction right: cross",
        "crossroads && car junction right: cross",
        "crossroads priority others_stop && car junction right: run_sign",
        "straight 300 && car junction left: run_light",
        "straight 300 && car ramp: merge",
        "straight 300 && adult crosswalk left",
        "crossroads left && adult crosswalk left",
        "straight 300 && truck ahead: turn_off left",
        "straight 200 && car roundabout",
        "junction && van oncoming in turn 1",
        "| motorway && car oncoming",
        "| oneway && truck behind: overtake",
        "crossroads || left_hand && car junction left: cross",
        "junction left lights crosswalk && ego v=0; adult crosswalk: cross",
    ],
)
def test_a_road_has_what_its_scene_needs(plan: str) -> None:
    for seed in (1, 2):
        run = perform(read(plan, "plan", map_size=None), seed, World(), SETUP)
        assert run.outcome != "INVALID"
        assert run.road is not None
        # where somebody has no place, it raises SceneError
        assert begin(run.road, run.world, run.seed) is not None


@pytest.mark.parametrize(
    ("plan", "one", "other"),
    [
        ("crossroads right && car junction right: cross", "from the right, that crosses", "goes right"),
        ("crossroads left && car ahead: turn_off left", "turns off to the left", "goes left"),
        ("crossroads straight stop && car junction left: run_sign", "does not give way", "with stop"),
        ("crossroads left || left_hand && car junction left: cross", "from the left", "goes left"),
        ("straight 200 && car ahead: brake after turn 1", "after turn 1", "there are 0"),
    ],
)
def test_what_excludes_each_other_is_said(plan: str, one: str, other: str) -> None:
    with pytest.raises(BriefError, match=f"{one}.*{other}"):
        read(plan, "plan", map_size=None)


def test_words_at_a_junction_get_a_road_from_that_side() -> None:
    brief = read("At a junction we go straight on and a car comes from the left at 50 km/h.", map_size=None)
    (place,) = fitted(brief, brief.scene, 20.0).junctions
    assert (place.kind, place.take) == ("crossroads", "straight")


@pytest.mark.parametrize(("before", "whole"), [(100, 280), (200, 300)])
def test_the_length_of_a_route_with_a_lane_change_is_met(before: int, whole: int) -> None:
    brief = read(f"| lanes=2 len={before} // lane_change left || len={whole}", "plan", map_size=None)
    run = perform(brief, 1, World(), SETUP)
    assert run.road is not None
    assert run.road.length == pytest.approx(whole, rel=0.1)
    assert run.outcome != "INVALID"
