"""Where routes leave junctions: exits of roundabouts with a direction, T-junctions at which the road ends."""

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import measured_junctions
from roadgpt.design import draft
from roadgpt.errors import BriefError
from roadgpt.network import build_route
from roadgpt.road import World

WORLD = World()


def measured(plan: str, seed: int):
    """The first junction of a route, as measured on its geometry."""
    return measured_junctions(build_route(draft(read_plan(plan), WORLD, seed=seed), WORLD))[0]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("take", "number", "degrees"),
    [("right", 1, (-180, -25)), ("straight", 2, (-25, 25)), ("left", 2, (25, 180)), ("left", 3, (25, 180))],
)
def test_an_exit_with_a_direction_has_both(
    take: str, number: int, degrees: tuple[float, float], seed: int
) -> None:
    found = measured(f"roundabout {take} exit={number}", seed)
    assert found.exit == number
    assert degrees[0] <= found.turn <= degrees[1]


def test_the_exit_that_leads_back_is_the_last() -> None:
    assert measured("roundabout back exit=3", 1).arms == 3
    with pytest.raises(BriefError, match="no roundabout can be built as"):
        draft(read_plan("roundabout back exit=2 arms=4"), WORLD, seed=1)


@pytest.mark.parametrize(
    ("plan", "ways"),
    [
        ("crossroads straight in=right", {"left", "straight"}),
        ("crossroads straight in=left", {"right", "straight"}),
        ("crossroads right in=left out=straight", {"right", "straight"}),
        ("crossroads straight out=left", {"left", "right", "straight"}),
        ("t_junction left in=right", {"left"}),
    ],
)
def test_nobody_leaves_by_an_arm_that_leads_to_the_junction(plan: str, ways: set[str]) -> None:
    assert {*measured(plan, 1).ways_on} == ways


@pytest.mark.parametrize("take", ["left", "right"])
def test_the_road_ends_at_a_t_junction_where_one_turns(take: str) -> None:
    assert all({*measured(f"t_junction {take}", seed).sides} == {"left", "right"} for seed in range(8))


def test_a_priority_road_may_go_on_at_a_t_junction() -> None:
    sides = [measured("t_junction left priority", seed).sides for seed in range(8)]
    assert any("straight" in each for each in sides)
