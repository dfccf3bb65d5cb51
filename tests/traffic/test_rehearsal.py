"""Scenes on roads that are hardly long enough for them, and at junctions: with a car that keeps its lane and
its speed, everything that is told happens."""

import pytest

from roadgpt.run import Setup, perform
from roadgpt.traffic.actor import Size
from roadgpt.traffic.rehearsal import rehearsed

CAR = Size(4.7, 1.86, 1.4)


@pytest.mark.parametrize(
    ("plan", "happens"),
    [
        ("straight 150 && car oncoming: drift left", ["car 1 drifts"]),
        ("straight 150 && car oncoming: drift right", ["car 1 drifts"]),
        ("straight 60 && truck oncoming: wrong_way", ["truck 1 drives the wrong way"]),
        ("straight 100 && car oncoming x3: drift", [f"car {n} drifts" for n in (1, 2, 3)]),
        ("straight | lanes=1 against=1 && car oncoming; car oncoming: overtake", ["car 2 overtakes"]),
        ("straight 150 | lanes=1 against=1 && car oncoming; car oncoming: overtake", ["car 2 overtakes"]),
        ("straight 80 && car behind: overtake", ["car 1 overtakes"]),
        ("straight 80 | lanes=2 && car lane left: cut_in", ["car 1 cuts in"]),
        ("crossroads left lights && car junction left: run_light", ["car 1 runs the red light"]),
    ],
)
def test_what_a_scene_tells_happens(plan: str, happens: list[str]) -> None:
    for seed in (1, 2):
        run = perform(plan, seed, setup=Setup(reader="plan", drives=False))
        assert run.road is not None
        others = rehearsed(run.world.lay(run.road), run.world, run.seed, CAR, 0.0)
        assert others is not None
        assert [*others.happened] == happens


@pytest.mark.parametrize("side", ["right", "left"])
def test_who_runs_a_light_comes_into_the_way_of_a_car_that_goes_straight_on(side: str) -> None:
    """Also where the arm leads to the left and to the right only."""
    plan = f"t_junction straight ways={side}+straight lights && car junction {side}: run_light"
    for seed in (1, 2):
        verdict = perform(plan, seed, setup=Setup(reader="plan", driver="robot")).verdict
        assert verdict is not None
        assert verdict.cause == "collision", verdict.description
