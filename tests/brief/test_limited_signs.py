"""Signs that words limit to some junctions of a map: they are counted, or the reading is doubtful."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.map_signs import has_unlimited_signs, with_counted_signs
from roadgpt.brief.readers.model.slots import slotted


@pytest.mark.parametrize(
    ("words", "written", "right"),
    [
        (
            "six junctions, no stop signs except at two of them",
            "map junction x6 stop",
            "map junction x2 stop; junction x4",
        ),
        (
            "fünf Kreuzungen, keine Ampeln außer an einer Kreuzung",
            "map crossroads x5 lights",
            "map crossroads lights; crossroads x4",
        ),
        (
            "six junctions, every junction but two signalised",
            "map junction x6 lights",
            "map junction x4 lights; junction x2",
        ),
    ],
)
def test_exceptions_are_counted(words: str, written: str, right: str) -> None:
    assert plan(with_counted_signs(read_plan(written), slotted(words))) == right


@pytest.mark.parametrize(
    ("words", "is_limited"),
    [
        ("a grid of two by two blocks, no lights except at the one in the middle", True),
        ("four crossroads, only the big one has lights", True),
        ("stop signs at half of the junctions", True),
        ("Ampeln nur in der Mitte", True),
        ("die Hälfte der Kreuzungen mit Ampel", True),
        ("des feux seulement au milieu", True),
        ("la moitié des carrefours avec des feux", True),
        ("semáforos solo en el centro", True),
        ("semafori solo al centro", True),
        ("four crossroads with lights", False),
        ("nur Kreuzungen, alle mit Ampel", False),
        ("a grid with no lights but stop signs", False),
        ("six plain crossroads, and signals at all six", False),
    ],
)
def test_a_limit_that_the_plan_lacks_is_a_doubt(words: str, is_limited: bool) -> None:
    brief = read_plan("map columns=2 rows=2 lights")
    assert has_unlimited_signs(brief, slotted(words)) == is_limited


def test_a_limit_that_the_plan_has_is_none() -> None:
    text = slotted("lights only at two junctions")
    assert not has_unlimited_signs(read_plan("map columns=2 rows=2; junction x2 lights"), text)
