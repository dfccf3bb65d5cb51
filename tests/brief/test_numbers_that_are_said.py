"""Numbers with a tolerance, slopes in degrees, and numbers below nothing."""

from math import degrees

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import reader_of
from roadgpt.brief.readers.model.negative_numbers import negative_number
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("4 +/- 1 turns", "3 to 5 turns"),
        ("4 turns plus or minus one", "3 to 5 turns"),
        ("five bends, give or take two, uphill", "3 to 7 bends , uphill"),
        ("6 hairpins (± 2)", "4 to 8 hairpins"),
        ("vier Kurven plus minus eine", "3 to 5 kurven"),
        ("a road of 300 m (plus or minus 10 %)", "a road of [unused1] metres to [unused2] metres"),
        ("60±5 m of straight", "[unused1] metres to [unused2] metres of straight"),
        ("jede 45 ± 5 Grad", "jede [unused1] degrees to [unused2] degrees"),
        ("radius 75 ± 0 m", "radius [unused1] metres"),
        ("five bends plus two hairpins", "5 bends plus 2 hairpins"),
        ("3 turns + 2 turns", "3 turns + 2 turns"),
    ],
)
def test_a_tolerance_makes_a_range(text: str, read: str) -> None:
    assert slotted(text).text == read


@pytest.mark.parametrize(
    ("text", "least", "most"),
    [
        ("a road of 300 m (plus or minus 10 %)", 270, 330),
        ("380 ± 20 m", 360, 400),
        ("0.4 km ± 20 m", 380, 420),
        ("0,4 km ± 0,1", 300, 500),
        ("each 30 degrees plus or minus 10", 20, 40),
        ("6 % ± 1 %", 5, 7),
        ("un radio de 40 m más o menos 5 m", 35, 45),
        ("a few hundred metres of straight road", 200, 500),
        ("several hundred yards of it", 274.3, 822.9),
        ("a few dozen metres further", 24, 60),
        ("nach ein paar hundert Metern", 200, 500),
        ("mehrere Hundert Meter", 300, 900),
        ("quelques centaines de mètres tout droit", 200, 500),
        ("unos cientos de metros", 200, 500),
        ("qualche centinaio di metri", 200, 500),
    ],
)
def test_a_measure_with_a_tolerance_has_two_ends_in_its_unit(text: str, least: float, most: float) -> None:
    found = slotted(text).slots
    assert [slot.value for slot in found] == pytest.approx([least, most], abs=0.1)
    assert len({slot.unit for slot in found}) == 1


def test_sets_of_other_things_than_measures_stay_words() -> None:
    assert slotted("a few hundred cars pass, then a left turn").slots[0].value == 100
    assert [slot.value for slot in slotted("a couple of hundred metres").slots] == [200]


def test_a_tolerance_in_a_change_request_is_left_out() -> None:
    """A change has one target."""
    assert [slot.value for slot in slotted("radius to 40 m ± 5 m", is_change=True).slots] == [40]


def test_a_range_that_no_slot_holds_is_an_unread_number() -> None:
    text = ", ".join(f"{60 + n} m" for n in range(11)) + ", 90 m ± 5 m"
    assert len(slotted(text).slots) == 11
    assert slotted(text).text.endswith("[unused20]")


@given(st.integers(2, 9), st.integers(1, 8), st.sampled_from(["± {}", "plus or minus {}", "give or take {}"]))
def test_any_tolerance_below_the_count(count: int, off: int, sign: str) -> None:
    if off < count:
        text = slotted(f"{count} turns {sign.format(off)}").text
        assert text == f"{count - off} to {count + off} turns"


@pytest.mark.parametrize(
    "text",
    [
        "a grade of {}°",
        "uphill at {} degrees",
        "a {} degree climb",
        "the slope is {} deg",
        "uphill at an angle of {} degrees through 3 bends",
        "eine Steigung von {} Grad",
        "una pendiente de {} grados",
    ],
)
@pytest.mark.parametrize("angle", [3, 5, 8])
def test_a_slope_in_degrees_is_the_tangent_in_percent(text: str, angle: int) -> None:
    from scipy.special import tandg

    (slot,) = slotted(text.format(angle)).slots
    assert slot.unit == "percent"
    assert slot.value == pytest.approx(100 * float(tandg(angle)), abs=0.051)
    assert degrees(slot.value / 100) == pytest.approx(angle, abs=0.1)  # for small angles both are alike


@pytest.mark.parametrize(
    "text",
    [
        "turn left 30 degrees uphill",
        "climbs 30 degrees to the left",
        "downhill, 45 degrees left",
        "an uphill bend of 40 degrees",
        "climbing through a 30 degree bend",
        "a climb with a 40 degree left",
    ],
)
def test_an_angle_of_a_turn_stays_an_angle(text: str) -> None:
    assert [slot.unit for slot in slotted(text).slots] == ["degrees"]


@pytest.mark.parametrize(
    ("text", "below"),
    [
        ("a road with minus three turns", "minus three turns"),
        ("a road with -3 turns", "minus 3 turns"),
        ("a straight of -50 m, then a left", "minus 50 m"),
        ("negative 50 metres of straight", "minus 50 metres"),
        ("a left with a radius of minus 30 m", "minus 30 m"),
        ("falls at minus 5 percent", None),
        ("ends at minus 8 m of height", None),
        ("40 m straight - 3 turns - hairpin", None),
        ("four turns, plus or minus 1", None),
        ("- 3 turns\n- uphill", None),
    ],
)
def test_what_cannot_be_negative_is_found(text: str, below: str | None) -> None:
    assert negative_number(slotted(text)) == below


def test_a_negative_number_of_turns_is_refused_with_its_words() -> None:
    with pytest.raises(BriefError, match="'minus four bends'"):
        reader_of("model").read("I need a road with minus four bends, please.")


@pytest.mark.parametrize(
    "text", ["two million bends", "Bend left by a million degrees", "ochocientas horquillas"]
)
def test_absurd_numbers_in_words_are_refused(text: str) -> None:
    with pytest.raises(BriefError):
        reader_of("model").read(text)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a left of 90 gon and a right of 100 gon", [(81, "degrees"), (90, "degrees")]),
        ("falling at 40 ‰", [(4, "percent")]),
        ("Gefälle 50 Promille", [(5, "percent")]),
        ("a mile and a half of road", [(2414, "metres")]),
        ("leave it after 1/2 km", [(500, "metres")]),
        ("3/4 of a mile of straight", [(1207, "metres")]),
        ("1 1/2 miles", [(2414, "metres")]),
        ("1½ km", [(1500, "metres")]),
        ("1 and 1/2 miles of road", [(2414, "metres")]),
        ("1-1/2 miles", [(2414, "metres")]),
        ("20 1/2 feet wide", [(6.2, "metres")]),
        ("0.3 of a mile", [(482.8, "metres")]),
        ("2/3 of a mile, then ⅓ mile", [(1072.9, "metres"), (536.4, "metres")]),
        ("after turn 2 1/2 mile of straight", [(804.7, "metres")]),
        ("2 1/4-mile straights", [(402.3, "metres")]),
        ("a crest halfway, creux à mi-parcours", []),
        ("turn 1", []),
        ("lose 2", []),
        ("une courbe à mi-chemin", []),
        ("la curva 2 mi sembra troppo stretta", []),
        ("due mi bastano per la strada", []),
        ("¾ of a mile", [(1207, "metres")]),
        ("turn left in 0.5 mi", [(804.7, "metres")]),
        ("an eighth of a mile", [(201.2, "metres")]),
        ("quarter of kilometre", [(250, "metres")]),
        ("séparés par une trentaine de mètres", [(30, "metres")]),
        ("una ventina di gradi a destra", [(20, "degrees")]),
        ("un centinaio di metri", [(100, "metres")]),
    ],
)
def test_units_of_surveyors_and_parts_of_units(text: str, values: list[tuple[float, str]]) -> None:
    assert [(slot.value, slot.unit) for slot in slotted(text).slots] == values


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("right, radius of 40, 5 % downhill", ["", "percent"]),
        ("R = 60, 45 degrees", ["", "degrees"]),
        ("R=65 and 135 deg", ["", "degrees"]),
        ("L90 - 40 m", ["", "metres"]),
        ("straight 60, 45 degrees left", ["", "degrees"]),
        ("40, 50 and 60 m", ["metres", "metres", "metres"]),
        ("between 40 and 60 m", ["metres", "metres"]),
        ("40 to 60 degrees", ["degrees", "degrees"]),
    ],
)
def test_a_number_takes_the_unit_of_the_next_one_only_in_a_list_of_alike(text: str, units: list[str]) -> None:
    assert [slot.unit for slot in slotted(text).slots] == units
