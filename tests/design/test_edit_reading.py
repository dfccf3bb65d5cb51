"""The reader of change requests: what is to be changed, where, and by how much."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.design.edit.reading import read_request
from roadgpt.design.edit.request import Change, Target
from roadgpt.design.edit.vocabulary import ORDINALS, WORDS
from roadgpt.errors import EditError


def one(words: str) -> Change:
    """The only change of a request."""
    (change,) = read_request(words).changes
    return change


def target(words: str) -> Target:
    """What the only change of a request is about."""
    found = one(words).target
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("words", "numbers"),
    [
        ("make the second turn sharper", (2,)),
        ("make the 2nd bend sharper", (2,)),
        ("make turn 2 sharper", (2,)),
        ("make turn two sharper", (2,)),
        ("make the last curve sharper", (-1,)),
        ("make the second to last corner sharper", (-2,)),
        ("make the last two turns sharper", (-1, -2)),
        ("make the first and the third turn sharper", (1, 3)),
        ("make turns 2 to 4 sharper", (2, 3, 4)),
        ("make turns 2-4 sharper", (2, 3, 4)),
        ("make turns 1, 3 and 5 sharper", (1, 3, 5)),
        ("make all turns sharper", ()),
    ],
)
def test_turns_are_counted(words: str, numbers: tuple[int, ...]) -> None:
    found = target(words)
    assert (found.noun, found.numbers) == ("turn", numbers)
    assert (one(words).what, one(words).more) == ("angle", 1)


@pytest.mark.parametrize(
    ("words", "field", "value"),
    [
        ("make the second left turn sharper", "side", "left"),
        ("make the hairpin gentler", "kind", "hairpin"),
        ("make the sharpest turn gentler", "most", ("sharp", 1)),
        ("make the longest straight shorter", "most", ("long", 1)),
        ("make the middle turn sharper", "middle", True),
        ("make every turn sharper", "every", True),
        ("make the end downhill", "noun", "end"),
        ("level the start", "noun", "start"),
        ("make the whole road uphill", "noun", "road"),
        ("make the second half uphill", "half", 2),
        ("make the 90 degree turn sharper", "degrees", 90.0),
        ("make the uphill straight longer", "way", "up"),
    ],
)
def test_places_have_names(words: str, field: str, value: object) -> None:
    assert getattr(target(words), field) == value


def test_a_place_may_be_named_by_another_one() -> None:
    found = target("make the straight after the second turn level")
    assert found.noun == "straight"
    assert found.place is not None
    assert found.place.how == "after"
    assert found.place.target is not None
    assert found.place.target.numbers == (2,)
    between = target("remove the straight between turns 2 and 3").place
    assert between is not None
    assert between.target is not None
    assert between.other is not None
    assert (between.target.numbers, between.other.numbers) == ((2,), (3,))


@pytest.mark.parametrize(
    ("words", "what", "field", "value"),
    [
        ("make the second turn sharper by 20 degrees", "angle", "by", 20),
        ("make the second turn 20 degrees sharper", "angle", "by", 20),
        ("make the second turn 90°", "angle", "to", 90),
        ("sharpen turn 2 to 70 degrees", "angle", "to", 70),
        ("make the second turn twice as sharp", "angle", "times", 2),
        ("make the second turn gentler with a radius of 40 m", "radius", "to", 40),
        ("double the radius of the second turn", "radius", "times", 2),
        ("widen the second bend to 40 m", "radius", "to", 40),
        ("increase the radius of turn 2 by 5 metres", "radius", "by", 5),
        ("make the second straight longer by 50 m", "length", "by", 50),
        ("make the second straight 50 m longer", "length", "by", 50),
        ("make the second straight 50 m long", "length", "to", 50),
        ("shorten the second straight to 50 m", "length", "to", 50),
        ("make the second straight twice as long", "length", "times", 2),
        ("halve the second straight", "length", "times", 0.5),
        ("cut the second straight in half", "length", "times", 0.5),
        ("make the road 100 ft longer", "length", "by", 30.48),
        ("make the second turn steeper by 3 %", "slope", "by", 3),
        ("make the second turn uphill at 8 %", "slope", "to", 8),
        ("make the end downhill", "slope", "way", "down"),
        ("level the second straight", "slope", "way", "flat"),
        ("make the second turn a left turn", "side", "side", "left"),
        ("make the second turn go right", "side", "side", "right"),
        ("flip the second turn", "side", "side", None),
        ("turn the second bend into a hairpin", "shape", "kind", "hairpin"),
        ("turn the second right into a left", "side", "side", "left"),
        ("give the second turn a bigger radius", "radius", "more", 1),
        ("the second turn needs a bigger radius, 60 m", "radius", "to", 60),
        ("make the road shorter, 300 m in total", "length", "to", 300),
        ("tighten the second turn to half its radius", "radius", "times", 0.5),
        ("stretch the second straight by half", "length", "times", 1.5),
        ("double the distance between turns 2 and 3", "length", "times", 2),
        ("make the 40 m straight longer", "length", "more", 1),
        ("insert a 40 m straight between turns 2 and 3", "add", "length", 40),
        ("put 50 m of straight road before the second turn", "add", "length", 50),
        ("make the second turn gentle", "shape", "sharpness", "gentle"),
    ],
)
def test_amounts(words: str, what: str, field: str, value: object) -> None:
    change = one(words)
    assert change.what == what
    assert getattr(change, field) == value


def test_something_new_stands_where_it_was_said() -> None:
    place = one("insert a 40 m straight between turns 2 and 3").place
    assert place is not None
    assert place.how == "between"
    assert place.target is not None
    assert place.target.numbers == (2,)


def test_what_is_to_stay_is_left_alone() -> None:
    assert target("make turns 1 and 3 sharper but leave turn 2 alone").but is None
    for words in ("make all turns sharper but leave turn 2 alone", "make all turns sharper, keep the second"):
        but = target(words).but
        assert but is not None
        assert but.numbers == (2,)
    several = target("make all turns sharper but leave the first and the third as they are").but
    assert several is not None
    assert several.numbers == (1, 3)


def test_that_turn_is_the_one_that_was_spoken_of() -> None:
    _, second = read_request(
        "extend the straight before the last turn by 30 m and make that turn tighter"
    ).changes
    assert second.target is not None
    assert (second.target.noun, second.target.numbers) == ("turn", (-1,))
    assert target("make that hairpin 120 degrees").kind == "hairpin"


def test_several_changes_at_once() -> None:
    changes = read_request(
        "make the first and the last turn sharper, the second gentler and the end uphill"
    ).changes
    assert [change.what for change in changes] == ["angle", "angle", "slope"]
    assert [change.target and change.target.numbers for change in changes] == [(1, -1), (2,), ()]
    assert [change.more for change in changes[:2]] == [1, -1]


def test_what_is_too_gentle_is_to_be_sharper() -> None:
    change = one("the second turn is too gentle, make it sharper")
    assert (change.what, change.more) == ("angle", 1)
    assert change.target is not None
    assert change.target.numbers == (2,)
    assert (one("the road is too long").what, one("the road is too long").more) == ("length", -1)


@pytest.mark.parametrize("words", ["add a 90° left at the end", "append a 90 degree left-hander"])
def test_a_turn_may_be_called_by_its_side(words: str) -> None:
    assert (one(words).what, one(words).side, one(words).degrees) == ("add", "left", 90)


def test_what_is_left_out_is_taken_from_before() -> None:
    first, second = read_request(
        "make the first straight 20 m longer and the second one 10 m shorter"
    ).changes
    assert first.target is not None
    assert second.target is not None
    assert (second.target.noun, second.target.numbers, second.by, second.more) == ("straight", (2,), 10, -1)
    longer = read_request("make the second turn sharper, then make it steeper").changes[1]
    assert longer.target is not None
    assert longer.target.numbers == (2,)


def test_something_new_has_a_shape_and_a_place() -> None:
    change = one("add a sharp right turn of 90 degrees after the second turn")
    assert (change.what, change.side, change.sharpness, change.degrees) == ("add", "right", "sharp", 90)
    assert change.place is not None
    assert change.place.how == "after"
    added = read_request("add a hairpin at the start, to the left").changes[0]
    assert added.kind == "hairpin"
    assert added.place is not None
    assert added.place.how == "start"


@pytest.mark.parametrize(
    "words",
    [
        "mach die zweite Kurve schärfer und das Ende bergab",
        "mach die 2. Kurve schärfer und das Ende bergab",
        "rends le deuxième virage plus prononcé et la fin en descente",
        "haz la segunda curva más pronunciada y el final cuesta abajo",
        "rendi la seconda curva più accentuata e la fine in discesa",
    ],
)
def test_five_languages_say_the_same(words: str) -> None:
    first, second = read_request(words).changes
    wanted = read_request("make the second turn sharper and the end downhill").changes
    assert first.target is not None
    assert second.target is not None
    assert (first.what, first.more, first.target.numbers) == ("angle", 1, (2,))
    assert (second.what, second.way, second.target.noun) == (wanted[1].what, wanted[1].way, "end")


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        ("", "no change was asked for"),
        ("   ", "no change was asked for"),
        ("paint the road blue", "'paint', 'blue'"),
        ("make the second turn spicier", "'spicier'"),
        ("make the second turn", "is not said"),
        ("don't make the second turn sharper", "not understood"),
        ("make the second turn sharper or gentler", "'or'"),
        ("remove the road", "no road"),
        ("remove a turn", "say: remove the second turn"),
        ("42", "no change"),
        ("reverse the road", "say: mirror the road"),
        ("make turn 2 as sharp as turn 4", "say a number"),
        ("make a turn sharper", "which one is meant"),
        ("a flat road with 3 turns", "describes a new road"),
        ("rotate the road by 90 degrees", "'rotate'"),
        ("speed up", "'speed'"),
        ("make turn 2 sharper than turn 1", "'than'"),
        ("make turn 1 sharper turn 2 gentler", "put a comma"),
        ("raise the start by 5 m", "metres of height"),
        ("make the last straight climb 10 m", "metres of height"),
        ("swap the first and the last turn", "cannot change places"),
        ("make the third straight twice as long as the second", "say a number"),
        ("make the road wider", "make all turns wider"),
        ("make the turns left, right, left", "left and right"),
        ("merge the last two turns, make the first one sharper", "'merge'"),
        ("x" * 3000, "too long"),
    ],
)
def test_what_is_no_change_is_refused_with_advice(words: str, advice: str) -> None:
    with pytest.raises(EditError, match=advice) as caught:
        read_request(words)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300


def test_words_that_are_not_understood_are_told() -> None:
    assert read_request("make the second turn sharper pronto").unused == ("pronto",)


KNOWN = sorted({word for listed in WORDS.values() for word in listed.split() if word != "|"})


@given(st.lists(st.sampled_from([*KNOWN, "2", "40 m", "90 degrees", "8 %", ",", "-", "blue"]), max_size=14))
def test_any_row_of_words_is_read_or_refused(words: list[str]) -> None:
    with suppress(EditError):
        assert read_request(" ".join(words)).changes


@given(st.text(max_size=60))
def test_any_text_is_read_or_refused(words: str) -> None:
    with suppress(EditError):
        assert read_request(words).changes


def test_every_ordinal_of_every_language_counts() -> None:
    for number, listed in ORDINALS.items():
        for word in listed.split("|")[0].split():
            if word != "final":  # 'the final' alone is the end
                assert target(f"make the {word} turn sharper").numbers == (number,), word
