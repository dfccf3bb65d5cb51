"""Distances that the words count from the start of a route."""

import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.from_start import with_distances_from_start

TWO = "| len=150 // crossroads straight // | len=350 // t_junction right // | len=50"
APART = "| len=150 // crossroads straight // | len=200 // t_junction right // | len=50"


@pytest.mark.parametrize(
    "words",
    [
        "crossroads at 150 m, T-junction at 350 m, both from the start. The route ends 50 m after the T",
        "distances counted from the start: 150 m a crossroads, 350 m a T-junction; 50 m on it ends",
        "straight over the crossroads at 150 m and right at the T-junction at 350 m from the start",
        "bei 150 m geradeaus über die Kreuzung, bei 350 m nach dem Start rechts an der Einmündung",
        "un carrefour à 150 m du départ, puis un croisement en T à 350 m du départ",
        "cruce a 150 m y cruce en T a 350 m desde la salida",
        "incrocio a 150 m dalla partenza, a 350 m dalla partenza un incrocio a T",
        "a crossroads at 150 m, straight over, and a T-junction at 350 m, right",
        "Kreuzung bei 150 m und Einmündung bei 350 m; die Straße endet 50 m dahinter",
    ],
)
def test_they_become_the_lengths_of_the_roads_between(words: str) -> None:
    assert plan(with_distances_from_start(read_plan(TWO), words)) == APART


def test_places_of_lanes_that_end_count_from_the_start() -> None:
    said = "| lanes=3 len=200 // lane_drop // | lanes=2 len=500 // lane_drop // | lanes=1"
    words = "the lanes drop from three to two at 200 m and from two to one at 500 m"
    assert plan(with_distances_from_start(read_plan(said), words)) == said.replace("500", "300")


@pytest.mark.parametrize(
    "words",
    [
        "150 m from the start a crossroads, 350 m further on a T-junction",
        "at 150 m a crossroads, then 350 m to the T-junction, straight on from start to finish",
        "150 m nach dem Start eine Kreuzung, die zweite 350 m nach der ersten",
        "à 150 m du départ un carrefour, 350 m plus loin un T",
        "45 m, glorieta (2.ª salida), 95 m de enlace, glorieta; cuestión de distancias",
        "un incrocio a 150 m dalla partenza, a 350 m dal primo il secondo",
        "a crossroads after 150 m and a T-junction after 350 m",
        "at 150 m a crossroads and at 350 m after that a T-junction",
        "un carrefour à 150 m, un T à 350 m",
    ],
)
def test_distances_from_one_junction_to_the_next_stay(words: str) -> None:
    assert plan(with_distances_from_start(read_plan(TWO), words)) == TWO


@pytest.mark.parametrize(
    "line",
    [
        "| len=350 // crossroads straight // | len=150 // t_junction right",
        "crossroads straight // | len=350 // t_junction right",
        "| len=100..200 // crossroads straight // | len=350 // t_junction right",
        "straight len=350",
    ],
)
def test_what_cannot_be_counted_from_the_start_stays(line: str) -> None:
    brief = read_plan(line)
    assert with_distances_from_start(brief, "all distances from the start") == brief
