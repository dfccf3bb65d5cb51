"""Words for the length of all roads of a map, which are not the distance between its junctions."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.plan import plan
from roadgpt.brief.sentence import sentence

WHOLE = "map crossroads x3 || len=2000"


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("a village with three crossroads and 2 km of streets", WHOLE),
        ("a village with three crossroads and a total length of 2 km", WHOLE),
        ("ein Dorf mit drei Kreuzungen und zwei Kilometern Straßen", WHOLE),
        ("ein Dorf mit drei Kreuzungen, Gesamtlänge 2 km", WHOLE),
        ("ein Dorf mit drei Kreuzungen, 2 km Straßennetz", WHOLE),
        ("un village de trois carrefours avec 2 km de rues", WHOLE),
        ("un pueblo con tres cruces y 2 km de calles", WHOLE),
        ("un paese con tre incroci e 2 km di strade", WHOLE),
        ("at most 900 m of road in a hamlet with three T-junctions", "map t_junction x3 || len=..900"),
        ("a grid of two by two blocks of 80 m", "map columns=2 rows=2 len=80"),
    ],
)
def test_the_length_of_all_roads_is_that_of_the_map(words: str, meant: str) -> None:
    assert plan(read(words)) == meant


def test_a_bound_is_said() -> None:
    found = read("at least 2 km of streets in a village with three crossroads")
    assert sentence(found).endswith("; at least 2000 metres of roads in all.")
