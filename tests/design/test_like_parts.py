"""Turns and straights that must be alike are, as measured; roads where they are not are told."""

import pytest

from roadgpt.brief.outline import outline
from roadgpt.brief.plan import read_plan
from roadgpt.check.matching import complaints
from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.design import draft
from roadgpt.road import Design, Segment, World, build

WORLD = World()


def measured(line: str, seed: int) -> RoadMeasures:
    design = draft(read_plan(line), WORLD, seed=seed)
    assert isinstance(design, Design)
    return measure(build(design).sample().points)


def spread(numbers: list[float]) -> float:
    return max(numbers) / min(numbers)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("line", "turns", "degrees"),
    [
        ("turn x4 right | alike turning=180", 4, 45),
        ("turn x3 left; turn x2 right | alike", 5, None),
        ("hairpin up; hairpin down | alike", 2, None),
        ("| alike turns=3..", None, None),
        ("turn x6 | alike climb=-20", 6, None),
        ("turn x5 alternating | alike len=400", 5, None),
    ],
)
def test_turns_are_alike_and_evenly_spaced(
    line: str, turns: int | None, degrees: float | None, seed: int
) -> None:
    found = measured(line, seed)
    if turns is not None:
        assert len(found.turns) == turns
    assert max(t.degrees for t in found.turns) - min(t.degrees for t in found.turns) < 3
    assert spread([t.radius for t in found.turns]) < 1.1
    gaps = [straight.length for gap in found.gaps[1:-1] for straight in gap]
    assert len(gaps) == len(found.turns) - 1
    assert spread(gaps) < 1.2
    if degrees is not None:
        assert found.turns[0].degrees == pytest.approx(degrees, abs=3)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("line", "degrees"),
    [
        ("| alike turns=4 starts(turn left) len=600", None),
        ("| alike turns=6 starts(turn deg=90 r=50)", (80, 100)),
        ("turn x4; straight | alike len=600", None),
        ("straight; turn x4 | alike len=400", None),
        ("crest; turn x3; crest | alike", None),
        ("turn x4 deg=30..40 | alike turning=100..300", (30, 40)),
        ("turn x3 deg=..40 | alike turning=..200", (12, 40)),
        ("turn x5 | alike lefts=3 hills=2", None),
    ],
)
def test_other_wishes_are_met_by_like_turns(line: str, degrees: tuple[int, int] | None, seed: int) -> None:
    found = measured(line, seed)
    assert max(t.degrees for t in found.turns) - min(t.degrees for t in found.turns) < 3
    assert spread([t.radius for t in found.turns]) < 1.1
    assert degrees is None or degrees[0] <= found.turns[0].degrees <= degrees[1]
    gaps = [sum(straight.length for straight in gap) for gap in found.gaps[1:-1]]
    assert min(gaps) > 10
    assert spread(gaps) < 1.2


@pytest.mark.parametrize("seed", [1, 2])
def test_named_straights_are_equally_long(seed: int) -> None:
    found = measured("straight; hairpin; straight | alike len=400", seed)
    first, last = found.gaps[0][0].length, found.gaps[-1][-1].length
    assert spread([first, last]) < 1.1
    assert 340 <= found.length <= 460
    found = measured("straight len=91.4; turn left deg=70 r=40; straight flat | alike", seed)
    assert found.gaps[0][0].length == pytest.approx(91.4, rel=0.1)
    assert found.gaps[-1][-1].length == pytest.approx(91.4, rel=0.1)


def bend(side: int, degrees: float, radius: float) -> Segment:
    arc = radius * degrees * 0.0174532925
    return Segment(
        distance=arc + 3, direction="left" if side > 0 else "right", incline=0.0,
        turn_degrees=side * degrees, radius=radius, transition=3.0,
    )  # fmt: skip


def straight(metres: float) -> Segment:
    return Segment(distance=metres, direction="straight", incline=0.0)


@pytest.mark.parametrize(
    ("parts", "line", "says"),
    [
        ((60, 30.0, 60, 30.0, 40), "turn x2 | alike", ""),
        ((60, 30.0, 45, 30.0, 40), "turn x2 | alike", "they turn 45 to 60 degrees"),
        ((60, 30.0, 60, 50.0, 40), "turn x2 | alike", "their radii are 30 to 50 m"),
        ((60, 30.0, 45, 30.0, 40), "turn x2", ""),
        ((60, 30.0, 45, 30.0, 40), "turn x1.. | alike", "they turn 45 to 60 degrees"),
        ((60, 30.0, 60, 30.0, 40), "turn x1.. | alike", ""),
        ((60, 30.0, 60, 30.0, 90), "straight; turn; straight; turn | alike", "straights alike"),
        ((60, 30.0, 60, 30.0, 90), "turn x2 | alike", ""),
    ],
)
def test_a_road_whose_parts_differ_is_told(parts: tuple[float, ...], line: str, says: str) -> None:
    first, radius, second, other, between = parts
    bends = (bend(1, first, radius), straight(between), bend(-1, second, other))
    design = Design(
        starting_point=(60.0, 60.0, 0.0), theta=0.0, segments=(straight(40), *bends, straight(40))
    )
    found = measure(build(design).sample().points)
    told = [each.sentence for each in complaints(found, outline(read_plan(line)))]
    assert any(says in sentence for sentence in told) if says else told == []
