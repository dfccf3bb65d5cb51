"""Figures that are said as a multiple of an earlier one are computed, unless the words leave a choice."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.multiples import tells_a_difference
from roadgpt.brief.readers.model.slots import slotted

SAID = [
    ("40 m straight, a left, then a straight twice as long", [40, 80], "metres"),
    ("40 m straight, a left, then a straight three times as long", [40, 120], "metres"),
    ("a straight of 90 m, a right turn, then a third straight half the length", [90, 45], "metres"),
    ("a left of 35 degrees, then a right that turns twice as far", [35, 70], "degrees"),
    ("uphill at 8 %, then a bend, then down half as steeply", [8, 4], "percent"),
    ("50 m geradeaus, Linkskurve, danach eine doppelt so lange Gerade", [50, 100], "metres"),
    ("30 Grad nach links, dann dreimal so weit nach rechts", [30, 90], "degrees"),
    ("60 m tout droit, un virage, puis une ligne droite deux fois plus longue", [60, 120], "metres"),
    ("una recta de 50 m, una curva y una recta el doble de larga", [50, 100], "metres"),
    ("un rettilineo di 40 m, una curva e un rettilineo lungo il doppio", [40, 80], "metres"),
    ("two rights, the first of 30 m radius, the second of twice that", [30, 60], "metres"),
    ("left, right; radius 40 m everywhere but at the last, which gets half of that", [40, 20], "metres"),
    ("two lefts, the first with a radius of 60 m, the second with half the radius", [60, 30], "metres"),
    ("left on 35 m, right on double that radius", [35, 70], "metres"),
    ("30 m straight, a left (radius around 15 m), a right with twice that radius", [30, 15, 30], "metres"),
    ("deux courbes, la première de 30 m de rayon, la seconde de rayon double", [30, 60], "metres"),
    ("une courbe de 30 m de rayon, puis une de rayon deux fois plus grand", [30, 60], "metres"),
    ("eine Kurve mit 30 m Radius, dann eine mit dem doppelten Radius", [30, 60], "metres"),
    ("una curva con raggio 30 m, poi una con il doppio del raggio", [30, 60], "metres"),
    ("una curva de radio 40 m y otra con la mitad de radio", [40, 20], "metres"),
    ("a left of 45 degrees, then a right of twice that", [45, 90], "degrees"),
    ("a turn of 40 degrees, another of twice that, another of half that", [40, 80, 40], "degrees"),
    ("a bend of radius 20 m, then one with three times that radius", [20, 60], "metres"),
    ("Kurve links Radius 40 m, Kurve rechts halber Radius", [40, 20], "metres"),
    ("una curva de radio 30 m y otra del doble de radio", [30, 60], "metres"),
    ("una curva de 120 grados y otra con la mitad de grados", [120, 60], "degrees"),
    ("a left of 80 degrees, then a right of half the degrees", [80, 40], "degrees"),
    ("a left of 50 degrees, the second turns 40 degrees further than the first", [50, 90], "degrees"),
    ("the first turns by 50 degrees, the second by 40 degrees more than that", [50, 90], "degrees"),
    ("eine Gerade von 30 m, Kurve, dann eine Gerade, 20 m länger als die erste", [30, 50], "metres"),
    ("un virage de 60 degrés, puis un de 20 degrés de moins que le premier", [60, 40], "degrees"),
    ("un rettilineo di 40 m, una curva, e un rettilineo 10 m più lungo", [40, 10], "metres"),
    ("left 50 degrees, right 70 degrees, left 40 degrees more than the first", [50, 70, 90], "degrees"),
    ("left 50 degrees, right 70 degrees, left 40 degrees more than that", [50, 70, 110], "degrees"),
    ("a sinistra di 90 gradi, la seconda ha 30 gradi in meno.", [90, 60], "degrees"),
    ("a left of 50 degrees, then 30 degrees more to the right", [50, 30], "degrees"),
    ("una recta de 50 m, una curva y una recta de 15 m más que la primera", [50, 65], "metres"),
    ("uphill at 12 %? No, too much, half of it", [12, 6], "percent"),
]
LEFT_ALONE = [
    "six turns of 30 degrees, twice as many lefts as rights",  # a count
    "a straight of 40 m, a left, then one twice as long, that is 80 m",  # the figure is said
    "a straight of 40 m, a left, then one that is not twice as long",  # denied
    "40 m straight, a left, 60 m straight, a right, then a straight twice as long",  # of which one?
    "a left, then a straight twice as long as the one of 35 m",  # said later
    "a left with a radius of R25, then a right half as far",  # nothing to double but a radius
    "a hill twice as steep",
    "a left with a radius of 30 m, one with a radius of 50 m, then a right with half the radius",
    "a 40 m straight, 60 m uphill, then half of that",
    "the whole road is 300 m, the first part half of that",
    "a straight of 60 m, a bend of 90 degrees, then a straight half the length of the road",
    "a 100 m straight, a right with a radius of 30 m, then a left twice as large",
    "a road of 150 m with two straights, one twice as long as the other",
    "the road is 200 m long, and half the length goes uphill",
    "a straight of 40 m, a left, then a straight twice as long as the bend",
]


@pytest.mark.parametrize(("text", "values", "unit"), SAID)
def test_a_multiple_becomes_its_figure(text: str, values: list[float], unit: str) -> None:
    slots = slotted(text).slots
    assert [slot.value for slot in slots] == values
    assert {slot.unit for slot in slots} == {unit}


@pytest.mark.parametrize("text", LEFT_ALONE)
def test_what_leaves_a_choice_stays_as_it_is(text: str) -> None:
    found = slotted(text)
    said = {float(word) for word in "".join(c if c.isdecimal() else " " for c in text).split()}
    assert {slot.value for slot in found.slots} <= said
    assert any(word in found.text for word in ("twice", "half"))


def test_change_requests_have_multiples_of_their_own() -> None:
    assert slotted("after 40 m make it twice as long", is_change=True).text.endswith("twice as long")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("a 40 metre straight, a left turn, and then a straight three times as long",
         "straight len=40; turn left; straight len=120"),
        ("the first curve turns 40 degrees to the left, the second twice as much to the right",
         "turn left deg=40; turn right deg=80"),
        ("un rettilineo di 40 m, una curva a sinistra e un rettilineo lungo il doppio",
         "straight len=40; turn left; straight len=80"),
    ],
)  # fmt: skip
def test_the_reader_copies_the_figure(text: str, wanted: str) -> None:
    assert plan(read(text)) == wanted


@pytest.mark.parametrize(
    ("words", "tells"),
    [
        ("straights of 50 m and 70 m, the third 40 m longer than the first", True),
        ("the first turns by 50 degrees, the second by 40 degrees more than that", False),  # 90 degrees
        ("die zweite Gerade 20 m länger als die erste", True),
        ("deux virages, le second de 20 degrés de plus que le premier", True),
        ("a straight of more than 40 m", False),
        ("40 m more, then a bend", False),
    ],
)
def test_a_difference_that_is_not_computed_is_noticed(words: str, tells: bool) -> None:
    assert tells_a_difference(slotted(words).text) == tells
