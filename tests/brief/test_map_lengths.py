"""Words for the length of all roads of a map, which are not the distance between its junctions."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.map_lengths import with_whole_length
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.sentence import sentence

SPACED, WHOLE = "map crossroads x3 len=2000", "map crossroads x3 || len=2000"


@pytest.mark.parametrize(
    "words",
    [
        "a village with three crossroads and 2 km of streets",
        "three crossroads, 2000 metres of road",
        "three crossroads; the roads are 2 km long in all",
        "a village with three crossroads and a total length of 2 km",
        "ein Dorf mit drei Kreuzungen und zwei Kilometern Straßen",
        "ein Dorf mit drei Kreuzungen, Gesamtlänge 2 km",
        "ein Dorf mit drei Kreuzungen, 2 km Straßennetz",
        "un village de trois carrefours avec 2 km de rues",
        "un pueblo con tres cruces y 2 km de calles",
        "un paese con tre incroci e 2 km di strade",
    ],
)
@pytest.mark.parametrize("written", [SPACED, "map crossroads x3"])
def test_the_length_of_all_roads_is_that_of_the_map(words: str, written: str) -> None:
    assert plan(with_whole_length(read_plan(written), slotted(words))) == WHOLE


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("three crossroads, 200 m of road between them", "map crossroads x3 len=200"),
        ("three crossroads 200 m apart", "map crossroads x3 len=200"),
        ("a grid of two by two blocks of 80 m", "map columns=2 rows=2 len=80"),
        ("turn left at the crossroads, 2 km of road", "crossroads left // | len=2000"),
        ("three crossroads, 2 km of streets, no, 3 km of streets", "map crossroads x3 len=2000"),
    ],
)
def test_other_lengths_stay(words: str, written: str) -> None:
    assert with_whole_length(read_plan(written), slotted(words)) == read_plan(written)


def test_bounds_and_a_distance_of_its_own_are_kept() -> None:
    words = "at least 2 km of streets in a village with three crossroads, 150 m apart"
    found = with_whole_length(read_plan("map crossroads x3 len=150"), slotted(words))
    assert plan(found) == "map crossroads x3 len=150 || len=2000.."
    assert sentence(found).endswith("; at least 2000 metres of roads in all.")
