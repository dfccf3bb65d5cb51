"""Maps with few dead ends, carved out of grids: counted on the nodes and roads of their designs."""

from collections import Counter

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.road import Design, World
from tables import rows


def connected(design: Design) -> bool:
    reached, ahead = set[int](), [1]
    while ahead:
        node = ahead.pop()
        if node not in reached:
            reached.add(node)
            ahead += [n for road in design.roads if node in road for n in road]
    return len(reached) == len(design.nodes)


@pytest.mark.parametrize(
    ("line", "kinds", "ends", "signs"),
    rows(__file__, "maps_have_the_junctions_and_dead_ends_that_are_asked_for"),
)
def test_maps_have_the_junctions_and_dead_ends_that_are_asked_for(
    line: str, kinds: dict[str, int], ends: int, signs: dict[str, int]
) -> None:
    brief = read_plan(line)
    world = world_for(brief, World())
    design = draft(brief, world, seed=1)
    arms = [sum(n in road for road in design.roads) for n in range(1, len(design.nodes) + 1)]
    nodes = list(zip(design.nodes, arms, strict=True))
    assert Counter(node.kind for node, count in nodes if count > 2) == kinds
    assert arms.count(1) == ends
    assert all(count == 4 for node, count in nodes if node.kind == "crossroads")
    assert all(count == 3 for node, count in nodes if node.kind == "t_junction")
    found = Counter(node.control for node in design.nodes if node.is_junction)
    assert {sign: found[sign] for sign in signs} == signs
    assert connected(design)


def test_two_seeds_give_two_maps() -> None:
    brief = read_plan("map crossroads x2; t_junction x2")
    one, other = (draft(brief, world_for(brief, World()), seed=seed) for seed in range(2))
    assert [node.at for node in one.nodes] != [node.at for node in other.nodes]
