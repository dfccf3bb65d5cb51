"""Overlap, decided by area: a ribbon that lies nowhere over itself covers length times width (Weyl).

Shapely's union of fine quads measures what is covered; what is missing lies over something else.
"""

import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from network.ruled import findings
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, Site, World

WORLD = World(site=Site(map_size=1000))
GRAIN = 0.5  # m, of the quads
CURVED = 0.05  # m^2, what straight edges of quads miss of round ones, at most

hands = st.sampled_from([-1, 1])
pieces = st.builds(
    lambda length, radius, hand: Piece(length, hand / radius, hand / radius),
    st.floats(5, 70),
    st.one_of(st.floats(5, 40), st.just(1e9)),
    hands,
)


def covered(road: Road) -> float:
    s = np.linspace(0, road.length, int(road.length / GRAIN) + 2)
    left, right = road.at(s, 4.0)[:, :2], road.at(s, -4.0)[:, :2]
    quads = shapely.polygons(np.stack((left[:-1], left[1:], right[1:], right[:-1]), axis=1))
    return float(shapely.area(shapely.union_all(quads)))


@given(st.lists(pieces, min_size=2, max_size=6).map(tuple))
def test_a_road_overlaps_exactly_where_it_covers_less_than_its_length_times_its_width(
    pieces: tuple[Piece, ...],
) -> None:
    plan = PieceCurve(500.0, 500.0, 0.3, pieces)
    road = Road(plan, GradeProfile(0.0, (0.0, plan.length), (0.0, 0.0)))
    missing = road.length * WORLD.section.road_width - covered(road)
    assume(missing < CURVED or missing > 0.5)
    assert bool(findings("no_overlap", road, WORLD)) == (missing > CURVED)
