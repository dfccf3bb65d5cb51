"""Side roads lie where the words say, exits as far behind as they say, and kinds are as many as counted."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.plan_choice import brief_of
from roadgpt.brief.readers.model.slots import slotted


def corrected(line: str, words: str) -> str:
    return plan(brief_of(line, slotted(words), words))


PASSED = "t_junction straight"
ON_THE_RIGHT = "t_junction straight ways=right+straight"


@pytest.mark.parametrize(
    ("words", "line", "expected"),
    [
        ("past a side road, a T-junction on the right", PASSED, ON_THE_RIGHT),
        ("I pass a side road on my right-hand side", PASSED, ON_THE_RIGHT),
        ("an einer Nebenstraße rechts vorbei", PASSED, ON_THE_RIGHT),
        ("je passe devant une rue latérale à droite", PASSED, ON_THE_RIGHT),
        ("pass a side road on the right, then one on the left", f"{PASSED} // {PASSED}",
         f"{ON_THE_RIGHT} // t_junction straight ways=left+straight"),
        ("past a side road on the right, another follows", f"{PASSED} // {PASSED}", None),
        ("straight over the T-junction, right after the bend", f"turn // {PASSED}", None),
        ("straight on at the tee, I have the right of way", PASSED, None),
        ("past the T-junction, then a bend to the right", f"{PASSED} // turn right", None),
        ("traffic on the left; past a T-junction", f"{PASSED} || left_hand", None),
    ],
)  # fmt: skip
def test_a_side_road_that_is_passed_lies_on_the_side_that_is_named(
    words: str, line: str, expected: str | None
) -> None:
    assert corrected(line, words) == plan(read_plan(expected or line))


@pytest.mark.parametrize(
    ("line", "last"),
    [
        ("junction straight ways=right+straight // junction right", "junction right ways=right+straight"),
        ("junction straight ways=left+straight // junction straight ways=left+straight // junction left",
         "junction left ways=left+straight"),
        ("junction straight ways=left+straight // junction right", "junction right"),
        ("junction straight // junction right", "junction right"),
        ("junction straight ways=right+straight // crossroads right", "crossroads right"),
        ("t_junction straight ways=right+straight // junction right", "junction right"),
    ],
)  # fmt: skip
def test_the_street_that_is_taken_leaves_the_road_as_those_do_that_were_passed(line: str, last: str) -> None:
    assert corrected(line, "drive past some streets and take the next").split(" // ")[-1] == last


@pytest.mark.parametrize(
    ("words", "line", "expected"),
    [
        ("turn right off the main road", "t_junction right", "t_junction right ways=right+straight"),
        ("at a tee off the main road to the left", "t_junction left", "t_junction left ways=left+straight"),
        ("links von der Hauptstraße ab", "t_junction left", "t_junction left ways=left+straight"),
        ("quittez la rue principale à gauche", "t_junction left", "t_junction left ways=left+straight"),
        ("deja la vía principal a la derecha", "t_junction right", "t_junction right ways=right+straight"),
        ("lascio la strada principale a destra", "t_junction right", "t_junction right ways=right+straight"),
        ("don't turn right off the main road, take the T-junction left", "t_junction left", None),
        ("right off the main road", "crossroads right", None),
        ("turn right onto the main road", "t_junction right", None),
    ],
)  # fmt: skip
def test_the_road_that_is_left_goes_straight_on(words: str, line: str, expected: str | None) -> None:
    assert corrected(line, words) == plan(read_plan(expected or line))


def test_the_numbered_street_may_be_followed_by_other_junctions() -> None:
    passed, taken = (f"t_junction {take} ways=left+straight" for take in ("straight", "left"))
    words = "pass a side road on the left, turn into the second one, then right at the crossroads"
    assert (
        corrected(f"{passed} // {passed} // crossroads right", words)
        == f"{passed} // {taken} // crossroads right"
    )
    further = f"{passed} // {passed} // junction left"
    assert corrected(further, words) == further


@pytest.mark.parametrize(
    ("words", "read", "sides"),
    [
        ("pass three side roads: the first on the left, the second on the right, the third again on the left",
         ("right", "left"), ("left", "right", "left")),
        ("past three side streets: the second of them is on the left, the others on the right",
         ("right", "left", "left"), ("right", "left", "right")),
        ("vorbei an 3 Seitenstraßen, die erste links, die anderen rechts",
         ("right", "right", "right"), ("left", "right", "right")),
        ("devant deux rues latérales, la première à droite, la seconde à gauche",
         ("left", "left"), ("right", "left")),
        ("three side roads, the first on the left", ("right", "right", "right"), None),
        ("two side roads, the third on the left, the others on the right", ("right", "right"), None),
        ("one side road, the first on the left", ("right", "right"), None),
        ("two side roads, the first on the left, the second on the right, no, on the left",
         ("right", "right"), None),
    ],
)  # fmt: skip
def test_side_roads_are_on_the_sides_that_their_places_tell(
    words: str, read: tuple[str, ...], sides: tuple[str, ...] | None
) -> None:
    def line(each: tuple[str, ...]) -> str:
        return " // ".join(f"t_junction straight ways={side}+straight" for side in each)

    assert corrected(line(read), words) == line(sides or read)


@pytest.mark.parametrize(
    ("words", "last"),
    [
        ("three side streets on the left, turn into the third", "left"),
        ("drei Seitenstraßen links, nimm die dritte", "left"),
        ("three side streets on the left, turn into the last", "left"),
        ("three side streets on the left, turn into the second", "straight"),
        ("three side streets on the left, then take the third exit", "straight"),
        ("three side streets on the left, straight past all", "straight"),
    ],
)
def test_the_numbered_street_is_taken(words: str, last: str) -> None:
    line = " // ".join(["t_junction straight ways=left+straight"] * 3)
    assert corrected(line, words) == " // ".join(
        [*line.split(" // ")[:2], f"t_junction {last} ways=left+straight"]
    )


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            "onto the motorway, off again at the next exit, 500 m after the entry",
            "merge ramp // | len=500 motorway // diverge ramp",
        ),
        ("join, then the exit 400 m after the entry", "merge ramp // | len=400 // diverge ramp"),
    ],
)
def test_the_distance_to_an_exit_is_no_deceleration_lane(words: str, expected: str) -> None:
    assert plan(read(words)) == plan(read_plan(expected))


@pytest.mark.parametrize(
    ("words", "line", "expected"),
    [
        ("out of a side street, turn right onto the main road, then a roundabout",
         "junction right // roundabout", "t_junction right // roundabout"),
        ("aus einer Nebenstraße nach links, dann ein Kreisverkehr",
         "junction left // roundabout", "t_junction left // roundabout"),
        ("past a side street, then right at the junction", "junction right", None),
        ("out of a side street, straight over the junction", "junction straight", None),
    ],
)  # fmt: skip
def test_a_side_street_ends_at_a_t_junction(words: str, line: str, expected: str | None) -> None:
    assert corrected(line, words) == plan(read_plan(expected or line))
