"""Change requests as they are typed: each is read like one that is put plainly."""

from dataclasses import replace

import pytest

from roadgpt.design.edit.reading import read_request
from roadgpt.design.edit.request import Change, Place, Target
from roadgpt.errors import EditError


def plainly(words: str) -> list[Change]:
    """The changes of a request, without the words themselves."""
    return [
        replace(c, words="", target=_bare(c.target), place=_place(c.place))
        for c in read_request(words).changes
    ]


def _bare(target: Target | None) -> Target | None:
    if target is None:
        return None
    return replace(target, words="", is_definite=True, place=_place(target.place))


def _place(place: Place | None) -> Place | None:
    return place and replace(place, target=_bare(place.target), other=_bare(place.other))


@pytest.mark.parametrize(
    ("typed", "plain"),
    [
        ("make turn 4 (the last one) a hairpin", "make turn 4 a hairpin"),
        ("make the second turn 80 m long instead of 60", "make the second turn 80 m long"),
        ("the third turn should bend left instead of right", "make the third turn a left turn"),
        ("have the end go uphill rather than downhill", "make the end uphill"),
        ("add a hairpin instead of the second turn", "make the second turn a hairpin"),
        ("instead of the second turn, add a hairpin", "make the second turn a hairpin"),
        ("swap out the second turn for a hairpin", "make the second turn a hairpin"),
        ("extend the first straight from 60 to 80 m", "extend the first straight to 80 m"),
        ("change turn 2 from a left to a right", "make turn 2 a right turn"),
        ("take 10 degrees off the first turn", "make the first turn gentler by 10 degrees"),
        ("add 20 m to the first straight", "make the first straight longer by 20 m"),
        ("turn 1 +15 degrees", "turn 1 sharper by 15 degrees"),
        ("turn 1 -15 degrees", "turn 1 gentler by 15 degrees"),
        ("shrink the second turn to 25 degrees", "make the second turn gentler, to 25 degrees"),
        ("the second turn should turn 10 degrees less", "make the second turn gentler by 10 degrees"),
        ("follow the first turn with a hairpin", "add a hairpin after the first turn"),
        ("the first turn should be followed by a hairpin", "add a hairpin after the first turn"),
        ("add a left-right at the end", "add a left s-bend at the end"),
        ("put a hairpin in the middle of the road", "add a hairpin in the middle"),
        ("the road should have a hairpin at the end", "add a hairpin at the end"),
        ("the road should end flat", "make the end flat"),
        ("the first straight is 108 m, make it 60 m", "make the first straight 60 m"),
        ("the bend with the smallest radius 20 degrees gentler", "the sharpest turn 20 degrees gentler"),
        ("remove the slope from turn 1", "make turn 1 flat"),
        ("set the grade of the last straight to +5%", "make the last straight uphill at 5 %"),
        ("no slope over 3 %", "cap the slope at 3 %"),
        ("every turn no sharper than 80 degrees", "limit every turn to 80 degrees"),
        ("flatten the second straight, it's too steep", "flatten the second straight"),
        ("make the second turn tighter, with a radius of 20 m", "make the second turn have a radius of 20 m"),
        ("increase turn 2's radius to 25 m", "increase the radius of turn 2 to 25 m"),
        ("make the raod flat", "make the road flat"),
        ("the first turn should be much, much sharper", "the first turn much sharper"),
        ("shorten the first straight by a quarter", "make the first straight 0.75 times as long"),
        ("quiero que la segunda curva sea más cerrada", "make the second turn tighter"),
        (
            "supprime le deuxième virage et adoucis le dernier",
            "remove the second turn and soften the last turn",
        ),
        ("turn 4 should be 20 degrees sharper than now", "turn 4 sharper by 20 degrees"),
        ("la strada dovrebbe essere in piano", "make the road flat"),
        ("the straight in between 20 % longer", "the straight between the turns 20 % longer"),
        ("please have turn 2 tightened so that its radius is 18 m", "tighten turn 2 to a radius of 18 m"),
        ("separate the turns by 40 m", "separate the two turns by 40 m"),
        (
            "the first turn gentler and the one after it sharper",
            "first turn gentler, the turn after it sharper",
        ),
        ("i want turn one to be 20° less", "make turn 1 gentler by 20 degrees"),
    ],
)
def test_typed_wishes_are_read_like_plain_ones(typed: str, plain: str) -> None:
    assert plainly(typed) == plainly(plain)


def test_bounds_are_read_as_bounds() -> None:
    (change,) = read_request("cap the slope at 6 %").changes
    assert (change.what, change.to, change.bound) == ("slope", 6.0, -1)
    (change,) = read_request("no turn tighter than 30 m radius").changes
    assert (change.what, change.to, change.bound) == ("radius", 30.0, 1)


def test_how_many_turns_is_no_change() -> None:
    with pytest.raises(EditError, match="leaves open which"):
        read_request("no more than three turns")


def test_between_two_is_between_the_first_and_the_last() -> None:
    (change,) = read_request("add a right turn between the two lefts").changes
    assert change.place is not None
    assert change.place.target is not None
    assert change.place.other is not None
    assert (change.place.target.numbers, change.place.other.numbers) == ((1,), (-1,))


def test_an_unknown_thing_is_not_taken_for_the_whole_road() -> None:
    with pytest.raises(EditError, match="kerb"):
        read_request("make the kerb longer")
