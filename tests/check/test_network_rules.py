"""Rules of networks: a network that passes and one that fails, with the place and the numbers it says."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from network.changing import (
    beside,
    built,
    design,
    passing,
    with_plan,
    with_road,
)
from network.ruled import findings, the_finding
from roadgpt import plugins
from roadgpt.geometry import Piece
from roadgpt.network import Network
from roadgpt.road import Limits, Profile, World
from roadgpt.road.profile import Lane

KINDS = ("t_junction", "y_junction", "crossroads", "star", "roundabout")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rule", plugins.names("network_rules"))
def test_usual_junctions_pass_every_rule(rule: str, kind: str) -> None:
    assert findings(rule, passing(kind)) == ()
    assert findings(rule, passing(kind).network) == ()


class TestFiniteNetwork:
    def test_a_place_that_is_no_number(self) -> None:
        network = passing("crossroads").network
        found = the_finding("finite", with_road(network, 1, lambda each: with_plan(each, x=math.nan)))
        assert found.sentence == "on road 1: x is not a number"
        assert found.stops

    def test_a_connecting_road_counts_and_so_does_a_width(self) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].connections[0].road
        narrow = Profile((), (Lane("driving", math.nan),), 0, "none")
        damaged = with_road(
            network, number, lambda each: replace(each, road=replace(each.road, profile=narrow, _sampled={}))
        )
        assert f"on road {number}, near" in the_finding("finite", damaged).sentence
        assert "the width of a lane is not a number" in the_finding("finite", damaged).sentence


class TestTooShortRoute:
    def test_a_route_that_is_too_short(self) -> None:
        route = built(design(6.0, {"kind": "t_junction", "take": 1, "kerb": 1}, 9.0, width=2.0))
        assert route.length < 40
        world = World(limits=Limits(min_length=route.length + 0.01))
        wanted = f"the road is {route.length:.1f} m long, and a road is longer than {route.length + 0.01:g} m"
        assert the_finding("too_short", route, world).sentence == wanted
        assert findings("too_short", route, World(limits=Limits(min_length=route.length - 0.01))) == ()

    @pytest.mark.parametrize(
        ("lengths", "wanted"), [((4.8, 60.0), "give it 4.85 m"), ((60.0, 7.9), "give it 8 m")]
    )
    def test_the_first_and_the_last_road_hold_the_start_and_the_goal(
        self, lengths: tuple[float, float], wanted: str
    ) -> None:
        junction = {"kind": "t_junction", "take": 1}
        assert wanted in the_finding("too_short", built(design(lengths[0], junction, lengths[1]))).sentence
        assert findings("too_short", built(design(lengths[0] + 0.2, junction, lengths[1] + 0.2))) == ()

    @pytest.mark.parametrize(("length", "count"), [(4.69, 1), (4.71, 0)])
    def test_a_side_arm_holds_a_car(self, length: float, count: int) -> None:
        route = passing("t_junction", "left", arms=[{"angle": 90}, {"angle": -90, "length": length}])
        found = findings("too_short", route)
        assert len(found) == count
        assert all("too short for a car" in each.sentence and each.s is None for each in found)


class TestLeavesMap:
    def test_the_side_arm_that_leaves_is_named(self) -> None:
        route = passing(
            "crossroads", "straight", arms=[{"angle": 90, "length": 300}, {"angle": 0}, {"angle": -90}]
        )
        ends = {each.id: each.road.at(each.road.length)[1] for each in route.network.plain_roads}
        number, top = max(ends.items(), key=lambda row: row[1])
        found = the_finding("leaves_map", route)
        assert f"road {number} leaves the map by {top - 500:.1f} m at y = 500" in found.sentence
        assert "the map runs from 0 to 500 m" in found.sentence
        assert found.y == pytest.approx(top, abs=0.01)
        assert found.s is None

    def test_on_the_route_the_station_is_given(self) -> None:
        """Straight on, and 30 m beyond the border."""
        route = built(
            design(60.0, {"kind": "crossroads", "take": "straight"}, 100.0, start=(350.0, 250.0, 0.0))
        )
        assert route.at(route.length)[0] > 510
        found = the_finding("leaves_map", route)
        assert found.s == pytest.approx(route.length, abs=0.01)
        assert (found.x, abs((found.y or 0) - 250)) == pytest.approx((route.at(route.length)[0], 4), abs=0.01)

    @pytest.mark.parametrize(("y", "count"), [(4.02, 0), (3.99, 1)])
    def test_half_the_road_counts(self, y: float, count: int) -> None:
        """Straight on through a T whose third road leads away from the border; the road is 8 m wide."""
        arms = [{"angle": 0}, {"angle": 90}]
        junction = {"kind": "t_junction", "take": "straight", "arms": arms}
        route = built(design(60.0, junction, 60.0, start=(50.0, y, 0.0)))
        assert bool(findings("leaves_map", route)) == bool(count)


class TestRulesOfSingleRoads:
    def test_below_the_floor(self) -> None:
        junction = {"kind": "t_junction", "take": 1}
        assert findings("below_floor", built(design(60.0, junction, 60.0, start=(100, 250, -27.9)))) == ()
        found = findings("below_floor", built(design(60.0, junction, 60.0, start=(100, 250, -28.1))))
        assert "height -28.1 m is below the ground at -28 m" in found[0].sentence

    def test_too_steep_names_the_station_on_the_route(self) -> None:
        steep = {"distance": 80, "incline": 16}
        route = built(design(60.0, {"kind": "t_junction", "take": 1}, steep))
        found = the_finding("too_steep", route)
        assert "grade 16.0 % uphill" in found.sentence
        assert found.s is not None
        assert found.s > route.starts[2]
        assert route.at(found.s)[:2] == pytest.approx((found.x, found.y), abs=1e-6)
        assert (
            findings(
                "too_steep",
                built(design(60.0, {"kind": "t_junction", "take": 1}, {**steep, "incline": 14.9})),
            )
            == ()
        )

    def test_too_tight_outside_junctions_only(self) -> None:
        bend = {"distance": 20, "direction": "left", "turn_degrees": 70}
        route = built(design(60.0, {"kind": "t_junction", "take": 1}, bend, 40.0))
        found = the_finding("too_tight", route)
        assert "is tighter than 14.33 m" in found.sentence
        k = np.abs(route.network.road(route.legs[2].road).road.curvature(np.linspace(0, 20, 2001))).max()
        assert f"radius {1 / k:.1f} m" in found.sentence
        turns = np.abs(route.curvature(np.linspace(0, route.length, 2001))).max()
        assert turns > 1 / 14  # of the turn inside the junction
        assert findings("too_tight", passing("t_junction", 1)) == ()
        assert findings("too_tight", passing("roundabout", 1, radius=8)) == ()

    def test_too_abrupt_on_the_route(self) -> None:
        crest = ({"distance": 60, "incline": 10}, {"distance": 60, "incline": -10, "vertical_radius": 20})
        junction = {"kind": "crossroads", "take": 2}
        found = the_finding("too_abrupt", built(design(*crest, junction, 60.0)))
        assert "vertical radius of the crest is 20.0 m" in found.sentence
        gentle = (crest[0], {**crest[1], "vertical_radius": 200})
        assert findings("too_abrupt", built(design(*gentle, junction, 60.0))) == ()


class TestRingTooSmall:
    @pytest.mark.parametrize(("radius", "is_small"), [(1.51, False), (1.49, True)])
    def test_the_outer_diameter_is_measured_on_the_ring(self, radius: float, is_small: bool) -> None:
        """The ring of an island of 16 m is 5 m wide: 13 m outside is a radius of 1.5 m inside."""
        network = passing("roundabout").network
        (ring,) = network.roundabouts
        for number in ring.ring:
            network = with_road(
                network,
                number,
                lambda each: with_plan(
                    each, pieces=(Piece(each.road.length * radius / 16, 1 / radius, 1 / radius),)
                ),
            )
        said = [each.sentence for each in findings("ring_too_small", network)]
        assert any(f"outer diameter of {2 * (radius + 5):.1f} m" in each for each in said) == is_small

    def test_mouths_that_overlap(self) -> None:
        """One mouth is turned around the centre onto its neighbour."""
        network = passing("roundabout").network
        (ring,) = network.roundabouts
        x, y, _ = ring.centre
        angle = -math.radians(60)
        for each in network.junction(ring.junctions[1]).connections:
            plan = network.road(each.road).road.plan
            dx, dy = plan.x - x, plan.y - y  # type: ignore[attr-defined]
            cos, sin = math.cos(angle), math.sin(angle)
            network = with_road(
                network,
                each.road,
                lambda member, at=(x + cos * dx - sin * dy, y + sin * dx + cos * dy), h=plan.heading0: (
                    with_plan(  # type: ignore[attr-defined,misc]
                        member, x=at[0], y=at[1], heading0=h + angle
                    )
                ),
            )
        assert "the mouths of two arms overlap" in the_finding("ring_too_small", network).sentence


class TestArmsTooClose:
    @pytest.mark.parametrize(("length", "count"), [(4.6, 1), (4.8, 0)])
    def test_two_junctions_with_less_than_a_car_between_them(self, length: float, count: int) -> None:
        junction = {"kind": "t_junction", "take": "straight", "arms": [{"angle": 0}, {"angle": -90}]}
        other = {**junction, "arms": [{"angle": 0}, {"angle": 90}]}
        found = findings("arms_too_close", built(design(60.0, junction, length, other, 60.0)))
        assert len(found) == count
        for each in found:
            assert "the T-junction near" in each.sentence
            assert (
                "is only 4.6 m away along the road between them, less than the 4.7 m of a car"
                in each.sentence
            )

    def test_an_arm_that_begins_too_near_the_node(self) -> None:
        """At right angles, the edges of roads 8 m wide meet 4 m from the node; a kerb of r needs r more."""
        network = passing("crossroads").network
        x, y, _ = network.junctions[0].node
        first = network.road(1)
        for room, what in ((1.02, None), (0.98, "only a kerb of 1.0 m fits"), (-0.5, "no kerb fits")):
            longer = x - 4.0 - room - first.road.plan.x  # type: ignore[attr-defined]
            damaged = with_road(
                network,
                1,
                lambda each, to=longer: with_plan(each, pieces=(Piece(to),)),  # type: ignore[misc]
            )
            said = [each.sentence for each in findings("arms_too_close", damaged)]
            if what is None:
                assert not said
            else:
                assert len(said) == 2  # the arms on both sides of it
                assert all(what in each and f"near ({x:.0f}, {y:.0f})" in each for each in said)
                assert any("180 and 270 degrees" in each for each in said)


class TestConflictingOverlap:
    def test_a_route_that_crosses_an_arm(self) -> None:
        """Left at the crossroads, then around to the left across the arm that goes straight on."""
        turns = [{"distance": 30, "direction": "right", "turn_degrees": -70} for _ in range(3)]
        arms = [{"angle": 90}, {"angle": 0, "length": 100}, {"angle": -90}]
        route = built(design(60.0, {"kind": "crossroads", "take": "left", "arms": arms}, 20.0, *turns, 60.0))
        straight = next(arm.end.road for arm in route.network.junctions[0].arms if abs(arm.direction) < 0.01)
        last = route.legs[-1].road
        found = the_finding("conflicting_overlap", route)
        assert f"road {min(straight, last)} and road {max(straight, last)} overlap" in found.sentence
        assert found.s is not None
        assert found.s > route.starts[2]
        assert abs(found.y - 250) < 4  # type: ignore[operator]

    @pytest.mark.parametrize(("apart", "is_wrong"), [(7.95, True), (8.05, False)])
    def test_roads_side_by_side(self, apart: float, is_wrong: bool) -> None:
        """Two roads 8 m wide that look the same way."""
        network = passing("t_junction", "straight", arms=[{"angle": 0}, {"angle": 90, "length": 5}]).network
        both = beside(network, 200.0, 0.0)
        assert findings("conflicting_overlap", both) == ()
        alone = Network((network.road(1), replace(with_plan(network.road(1), y=250 + apart), id=2)))
        assert bool(findings("conflicting_overlap", alone)) == is_wrong

    def test_a_road_that_crosses_itself(self) -> None:
        loop = [{"distance": 40, "direction": "left", "turn_degrees": 70} for _ in range(4)]
        route = built(design(40.0, *loop, 80.0, {"kind": "t_junction", "take": 1}, 40.0))
        found = the_finding("conflicting_overlap", route)
        assert re.search(r"the road overlaps itself at s = \d+ m", found.sentence)
