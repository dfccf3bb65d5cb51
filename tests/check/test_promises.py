import pytest

from network.ruled import findings
from paper_roads import road_of, straight, turn
from roadgpt.brief.model import Brief, Clause, at_least, between, exactly
from roadgpt.road import Road, Segment, World

SEGMENTS = (straight(30, 5), turn(60, incline=5), straight(40, 5), turn(-50, incline=5), straight(30, 5))
LEFT_RIGHT = road_of(*SEGMENTS)


def said(brief: Brief, road=LEFT_RIGHT) -> list[str]:
    return [finding.sentence for finding in findings("promises", road, World(), brief)]


def clause(kind: str = "turn", count: int = 1, **promises) -> Clause:
    return Clause(kind=kind, count=exactly(count), **promises)


KEPT = [
    Brief(),
    Brief(turns=exactly(2), slope="up"),
    Brief(clauses=(clause(side="left"), clause(side="right"))),
    Brief(clauses=(clause(side="left"), clause("straight"), clause(side="right", slope="up"))),
    Brief(clauses=(Clause(kind="turn", count=at_least(1)),)),
    Brief(clauses=(Clause(kind="turn", count=at_least(1)), clause(side="right"))),
    Brief(clauses=(clause("s_bend", side="left"),)),
    Brief(left=exactly(1), right=exactly(1), alternating=True),
    Brief(starts=clause(side="left"), ends=clause(side="right")),
    Brief(ends=clause("straight")),
    Brief(clauses=(clause(degrees=exactly(60)), clause(degrees=exactly(50)))),
    Brief(clauses=(clause(radius=exactly(30)), clause(sharpness=None, radius=between(25, 35)))),
    Brief(length=exactly(165), climb=exactly(8), steepest=exactly(5)),
]
BROKEN = [
    (Brief(turns=exactly(3)), "asked for 3 turns, has 2"),
    (Brief(turns=exactly(1)), "asked for 1 turn, has 2"),
    (Brief(left=exactly(2)), "asked for 2 left turns, has 1"),
    (Brief(right=exactly(0)), "asked for 0 right turns, has 1"),
    (
        Brief(clauses=(clause(side="right"), clause(side="right"))),
        "turn 1 goes left, asked for right",
    ),
    (
        Brief(clauses=(clause("s_bend", side="right"),)),
        "turn 1 goes left, asked for right",
    ),
    (Brief(clauses=(clause(), clause("hairpin"))), "turn 2 turns 50 degrees, asked for 140 to 210"),
    (
        Brief(clauses=(clause(sharpness="gentle"), clause())),
        "turn 1 has a radius of 30.0 m, asked for 40 or more m",
    ),
    (
        Brief(clauses=(clause(length=exactly(80)), clause())),
        "m long, asked for 68 to 92 m",
    ),
    (
        Brief(clauses=(clause(), clause(slope="down"))),
        "turn 2 has a grade of 5.0 %, asked for -12 to -3 %",
    ),
    (
        Brief(clauses=(clause(), clause("straight", size="long"), clause())),
        "asked for a straight after turn 1: 60 or more m long",
    ),
    (
        Brief(clauses=(clause("straight", slope="flat"), clause(), clause())),
        "asked for a straight at the start: 10 or more m long, slope -1 to 1 %",
    ),
    (Brief(slope="down"), "asked for a road that falls all the way, has 5.0 % on average"),
    (
        Brief(slope="flat"),
        "asked for a road that is level all the way, has 5.0 % on average and 5.0 to 5.0 %",
    ),
    (Brief(slope="steeply_up"), "asked for a mean grade of 8 to 15 %, has 5.0 %"),
    (Brief(slope="nearly_flat"), "asked for a steepest place of 0 to 3.5 %, has 5.0 %"),
    (Brief(climb=exactly(20)), "asked for a climb of 17 to 23 m"),
    (Brief(length=exactly(500)), "asked for a length of 450 to 550 m"),
    (Brief(turning=exactly(300)), "asked for 270 to 330 degrees of turning in all, has 110"),
    (Brief(steepest=exactly(9)), "asked for a steepest place of 8 to 10 %, has 5.0 %"),
    (Brief(hills=at_least(2)), "asked for 2 or more changes between climbing and falling, has 0"),
    (Brief(starts=clause(side="right")), "turn 1 goes left, asked for right"),
    (Brief(ends=clause("hairpin")), "turn 2 turns 50 degrees, asked for 140 to 210"),
    (
        Brief(starts=clause("straight", size="long")),
        "asked to start with another straight than the one it has",
    ),
]


@pytest.mark.parametrize("brief", KEPT)
def test_a_road_that_keeps_its_promises_passes(brief: Brief) -> None:
    assert said(brief) == []


@pytest.mark.parametrize(("brief", "sentence"), BROKEN)
def test_a_broken_promise_is_said(brief: Brief, sentence: str) -> None:
    assert any(sentence in found for found in said(brief)), said(brief)


def test_a_straight_road_may_not_bend_slightly() -> None:
    bent = road_of(straight(60), turn(8, 100), straight(60))
    assert "asked for a straight road, turns 8" in said(Brief(clauses=(clause("straight"),)), bent)[0]
    assert said(Brief(clauses=(clause("straight"),)), road_of(straight(120))) == []


def test_open_counts_are_shared_out_kindly() -> None:
    rights = [piece for _ in range(3) for piece in (straight(30), turn(-40))]
    road = road_of(*rights, straight(30), turn(50), straight(30))
    some_then_left = Brief(
        clauses=(Clause(kind="turn", count=at_least(2), side="right"), clause(side="left"))
    )
    assert said(some_then_left, road) == []
    then_right = Brief(clauses=(Clause(kind="turn", count=at_least(2), side="right"), clause(side="right")))
    assert said(then_right, road) == ["turn 4 goes left, asked for right"]


def test_several_straights_between_two_turns_are_found_in_their_order() -> None:
    road = road_of(
        straight(30), turn(60), straight(50, 6), straight(50, -6), straight(30), turn(60), straight(30)
    )
    up, down = clause("straight", slope="up"), clause("straight", slope="down")
    assert said(Brief(clauses=(clause(), up, down, clause())), road) == []
    assert "after turn 1" in said(Brief(clauses=(clause(), down, up, clause())), road)[0]


def test_one_straight_is_not_two_that_were_asked_for() -> None:
    def between_turns(*parts: Segment) -> Road:
        return road_of(straight(30), turn(60), *parts, turn(60), straight(30))

    level, gentle = clause("straight", slope="flat"), clause("straight", slope="nearly_flat")
    asked = Brief(clauses=(clause(), level, gentle, clause()))
    assert said(asked, between_turns(straight(50), straight(60, 8), straight(70))) == []
    (missed,) = said(asked, between_turns(straight(50), straight(60, 8)))
    assert "asked for a straight after turn 1" in missed


def test_a_finding_tells_the_place() -> None:
    asked = Brief(clauses=(clause(), clause(side="left")))
    (finding,) = findings("promises", LEFT_RIGHT, World(), asked)
    assert finding.s is not None
    assert 95 < finding.s < 130
    x, y, _ = LEFT_RIGHT.at(finding.s)
    assert (finding.x, finding.y) == pytest.approx((x, y))


RAMPS = road_of(straight(50, 0), straight(60, 8), straight(70, 4), straight(60, 8))


def ramp(metres: float, percent: float) -> Clause:
    return Clause(kind="straight", slope="up", length=exactly(metres), incline=exactly(percent))


def test_straights_that_go_the_same_way_are_told_apart_by_their_grades() -> None:
    assert not said(Brief(clauses=(ramp(60, 8), ramp(70, 4), ramp(60, 8))), RAMPS)


@pytest.mark.parametrize(
    "wanted",
    [
        (ramp(70, 4), ramp(60, 8), ramp(60, 4)),
        (ramp(60, 8), ramp(110, 4), ramp(60, 8)),
        (ramp(60, 8), ramp(70, 4), ramp(60, 8), ramp(60, 4)),
        (ramp(60, 8), ramp(70, 12)),
    ],
)
def test_other_grades_lengths_or_orders_of_such_straights_are_not(wanted: tuple[Clause, ...]) -> None:
    assert any("asked for a straight" in each for each in said(Brief(clauses=wanted), RAMPS))
