"""Maps with few dead ends, carved out of grids: counted on the nodes and roads of their designs."""

from collections import Counter

import pytest

from roadgpt.brief.map_plan import read_map
from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.design.carved_draft import can_be_carved
from roadgpt.design.room import world_for
from roadgpt.network import MapDesign
from roadgpt.road import World


def connected(design: MapDesign) -> bool:
    reached, ahead = set[int](), [1]
    while ahead:
        node = ahead.pop()
        if node not in reached:
            reached.add(node)
            ahead += design.neighbours[node]
    return len(reached) == len(design.nodes)


@pytest.mark.parametrize(
    ("line", "kinds", "ends", "signs"),
    [
        ("map roundabout x3; crossroads x2 dead_ends=0", {"roundabout": 3, "crossroads": 2}, 0, {}),
        (
            "map crossroads x3 lights; roundabout x2 dead_ends=0",
            {"roundabout": 2, "crossroads": 3},
            0,
            {"lights": 3},
        ),
        ("map t_junction x4; roundabout x2 dead_ends=0", {"t_junction": 4, "roundabout": 2}, 0, {}),
        ("map t_junction x6 dead_ends=0 stop", {"t_junction": 6}, 0, {"stop": 6}),
        ("map t_junction x4; crossroads x2 dead_ends=0", {"t_junction": 4, "crossroads": 2}, 0, {}),
        ("map crossroads x4 dead_ends=2", {"crossroads": 4}, 2, {}),
        ("map t_junction x3; roundabout x2 dead_ends=1", {"t_junction": 3, "roundabout": 2}, 1, {}),
        ("map t_junction x2 dead_ends=0", {"t_junction": 2}, 0, {}),
    ],
)
def test_maps_have_the_junctions_and_dead_ends_that_are_asked_for(
    line: str, kinds: dict[str, int], ends: int, signs: dict[str, int]
) -> None:
    brief = read_plan(line)
    world = world_for(brief, World())
    designs = [draft(brief, world, seed=seed) for seed in range(4)]
    for design in designs:
        assert isinstance(design, MapDesign)
        arms = [len(design.neighbours[n]) for n in range(1, len(design.nodes) + 1)]
        nodes = list(zip(design.nodes, arms, strict=True))
        assert Counter(node.kind for node, count in nodes if count > 2) == kinds
        assert arms.count(1) == ends
        assert all(count == 4 for node, count in nodes if node.kind == "crossroads")
        assert all(count == 3 for node, count in nodes if node.kind == "t_junction")
        found = Counter(node.control for node in design.nodes if node.is_junction)
        assert {sign: found[sign] for sign in signs} == signs
        assert connected(design)
    assert (
        len({tuple(node.at for node in design.nodes) for design in designs if isinstance(design, MapDesign)})
        == 4
    )


@pytest.mark.parametrize(
    ("line", "can_be"),
    [
        ("map t_junction x4 dead_ends=0", True),
        ("map t_junction x4 dead_ends=3", True),
        ("map t_junction x4 dead_ends=4", False),  # arms that are joined at random leave so many
        ("map t_junction x4", False),
        ("map t_junction x4 blocks=2", False),
        ("map star; t_junction dead_ends=0", False),  # five arms are no crossing of a grid
        ("map y_junction x2 dead_ends=0", False),
    ],
)
def test_only_maps_of_three_or_four_arms_and_few_dead_ends_are_carved(line: str, can_be: bool) -> None:
    assert can_be_carved(read_map(line)) == can_be
