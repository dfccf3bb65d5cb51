"""Rules of junctions: a network that passes and one that fails, with the place and the numbers it says."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from network.changing import (
    built,
    design,
    passing,
    raised,
    with_heights,
    with_junction,
    with_plan,
    with_road,
)
from network.ruled import findings, the_finding
from roadgpt.geometry import GradeProfile, Piece
from roadgpt.network import Connection, LaneLink, Network, build_route
from roadgpt.road import Profile, World, read_design
from roadgpt.road.profile import LaneStrip


def radius_of_points(points: np.ndarray) -> float:
    """The smallest radius of the circles through each three points (n, 2) that turn right."""
    a, b, c = points[:-2], points[1:-1], points[2:]
    cross = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    sides = [np.hypot(*(p - q).T) for p, q in ((a, b), (b, c), (a, c))]
    with np.errstate(divide="ignore"):
        radius = sides[0] * sides[1] * sides[2] / (2 * np.abs(cross))
    return float(radius[cross < 0].min())


class TestTightTurns:
    @pytest.mark.parametrize("kind", ["crossroads", "star", "roundabout"])
    def test_the_kerb_is_that_of_circles_through_its_points(self, kind: str) -> None:
        route = passing(kind, 1, kerb=2, radius=7)
        network = route.network
        first = route.legs[1].road
        road = network.road(first).road
        s = np.linspace(0, road.length, 4000)
        edge = road.at(s, network.road(first).profile.edges(s).right)[:, :2]
        least = radius_of_points(edge)
        found = the_finding("kerb_too_tight", route)
        assert least < 3
        assert float(re.search(r"radius of ([\d.]+) m", found.sentence)[1]) <= least + 0.06  # type: ignore[index]

    @pytest.mark.parametrize(("radius", "is_wrong"), [(7.01, False), (6.99, True)])
    def test_a_kerb_is_measured_on_its_edge(self, radius: float, is_wrong: bool) -> None:
        """A right turn along an arc, with a lane 4 m wide."""
        network = passing("crossroads").network
        junction = network.junctions[0]
        ends = [arm.end for arm in junction.arms]
        right = next(
            each for each in junction.connections if (each.incoming, each.outgoing) == (ends[0], ends[1])
        )
        damaged = with_road(
            network, right.road, lambda each: with_plan(each, pieces=(Piece(10.0, -1 / radius, -1 / radius),))
        )
        assert bool(findings("kerb_too_tight", damaged)) == is_wrong

    @pytest.mark.parametrize(("radius", "is_wrong"), [(7.01, False), (6.99, True)])
    @pytest.mark.parametrize("turn", [1, 0])
    def test_a_connection_is_measured_in_the_middle_of_its_lane(
        self, turn: int, radius: float, is_wrong: bool
    ) -> None:
        """With lanes 4 m wide, the middle is 2 m inside the reference line of a right turn."""
        network = passing("crossroads").network
        k = -1 / radius if turn else 1 / (radius - 4)
        number = network.junctions[0].connections[0].road
        damaged = with_road(network, number, lambda each: with_plan(each, pieces=(Piece(3.0, k, k),)))
        found = findings("connection_too_tight", damaged)
        assert bool(found) == is_wrong
        if is_wrong:
            assert "has a radius of 5.0 m in its middle, tighter than 5 m" in found[0].sentence


def tilted(network: Network, ax: float, ay: float) -> Network:
    """The network in a plane with these slopes along x and y."""
    for member in network.roads:
        road = member.road
        s = np.linspace(0, road.length, max(2, math.ceil(road.length / 0.1)))
        grade = ax * np.cos(road.heading(s)) + ay * np.sin(road.heading(s))
        x, y, z = road.at(0.0)
        heights = GradeProfile(z + ax * x + ay * y, tuple(s.tolist()), tuple(grade.tolist()))
        network = with_road(network, member.id, lambda each, own=heights: with_heights(each, own))  # type: ignore[misc]
    return network


class TestJunctionNotLevel:
    @pytest.mark.parametrize(("by", "is_wrong"), [(0.0005, False), (0.002, True)])
    def test_a_step(self, by: float, is_wrong: bool) -> None:
        network = passing("crossroads").network
        damaged = with_road(network, 1, lambda each: raised(each, by))
        assert bool(findings("junction_not_level", damaged)) == is_wrong
        if is_wrong:
            assert (
                "differ by 0.002 m where they are joined"
                in the_finding("junction_not_level", damaged).sentence
            )

    def test_a_junction_in_an_inclined_plane_passes(self) -> None:
        for kind in ("crossroads", "star", "t_junction"):
            assert findings("junction_not_level", tilted(passing(kind).network, 0.02, -0.01)) == ()

    def test_an_arm_of_another_grade(self) -> None:
        network = tilted(passing("crossroads").network, 0.02, 0.0)
        arm = next(
            arm
            for arm in network.junctions[0].arms
            if arm.end.contact == "start" and abs(arm.direction) < 0.1
        )
        z = network.road(arm.end.road).road.at(0.0)[2]
        level = GradeProfile(float(z), (0.0, 60.0), (0.0, 0.0))
        damaged = with_road(network, arm.end.road, lambda each: with_heights(each, level))
        assert "the grade of a road differs by" in the_finding("junction_not_level", damaged).sentence

    def test_a_hump_inside_a_junction(self) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].connections[1].road
        n = network.road(number).road.length
        hump = GradeProfile(0.0, (0.0, n / 4, n / 2, 3 * n / 4, n), (0.0, 0.1, 0.0, -0.1, 0.0))
        damaged = with_road(network, number, lambda each: with_heights(each, hump))
        assert "above or below a plane" in the_finding("junction_not_level", damaged).sentence


class TestLanesDoNotMatch:
    @pytest.mark.parametrize(("by", "is_wrong"), [(0.0009, False), (0.0011, True)])
    @pytest.mark.parametrize("axis", ["x", "y"])
    def test_a_connecting_road_beside_its_arm(self, axis: str, by: float, is_wrong: bool) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].connections[0].road
        plan = network.road(number).road.plan
        damaged = with_road(network, number, lambda each: with_plan(each, **{axis: getattr(plan, axis) + by}))
        assert bool(findings("lanes_do_not_match", damaged)) == is_wrong

    @pytest.mark.parametrize(("width", "is_wrong"), [(4.0009, False), (4.0011, True)])
    def test_a_width(self, width: float, is_wrong: bool) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].connections[0].road
        profile = Profile((), (LaneStrip("driving", width),), 0, "none")
        damaged = with_road(network, number, lambda each: replace(each, road=each.road.with_profile(profile)))
        assert bool(findings("lanes_do_not_match", damaged)) == is_wrong
        if is_wrong:
            assert "their edges are 0.001 m apart" in the_finding("lanes_do_not_match", damaged).sentence

    def test_a_kink(self) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].connections[0].road
        heading = network.road(number).road.plan.heading0  # type: ignore[attr-defined]
        damaged = with_road(network, number, lambda each: with_plan(each, heading0=heading + 0.002))
        assert findings("lanes_do_not_match", damaged)

    @pytest.mark.parametrize(
        ("lanes", "what"),
        [
            (LaneLink(-2, -1, -1), "has no lane -2"),
            (LaneLink(1, -1, -1), "has no lane 1"),
            (LaneLink(-1, -2, -1), "no lane -2 along"),
            (LaneLink(-1, -1, -3), "has no lane -3 that leads out of it"),
        ],
    )
    def test_a_lane_that_does_not_exist(self, lanes: LaneLink, what: str) -> None:
        network = passing("crossroads").network
        number = network.junctions[0].id
        damaged = with_junction(
            network,
            number,
            lambda each: replace(
                each, connections=(replace(each.connections[0], lanes=(lanes,)), *each.connections[1:])
            ),
        )
        assert what in the_finding("lanes_do_not_match", damaged).sentence


class TestUnreachable:
    def kept(self, network: Network, keep: object) -> Network:
        return with_junction(
            network,
            network.junctions[0].id,
            lambda each: replace(each, connections=tuple(filter(keep, each.connections))),  # type: ignore[arg-type]
        )

    def test_a_lane_without_a_way_on(self) -> None:
        network = passing("crossroads").network

        def keep(each: Connection) -> bool:
            return each.incoming.road != 1

        found = the_finding("unreachable", self.kept(network, keep))
        assert "lane -1 of road 1 leads into it and has no way on" in found.sentence
        assert "at the crossroads near" in found.sentence

    def test_a_lane_that_no_connection_reaches(self) -> None:
        network = passing("crossroads").network
        found = the_finding("unreachable", self.kept(network, lambda each: each.outgoing.road != 1))
        assert "no way leads to lane 1 of road 1" in found.sentence

    def test_a_road_apart(self) -> None:
        network = passing("crossroads").network
        alone = replace(with_plan(network.road(1), y=400.0), id=99)
        found = the_finding("unreachable", replace(network, roads=(*network.roads, alone)))
        assert found.sentence.startswith("on road 99, near (100, 400): the road meets no junction")
        assert findings("unreachable", Network((network.road(1),))) == ()


class TestRampTooShort:
    """Of lanes whose width is given, not measured: the taper of 60 m counts for 0.196 of its length."""

    @pytest.mark.parametrize("kind", ["merge", "diverge"])
    @pytest.mark.parametrize(
        ("length", "is_short"), [(10.0, True), (15.0, True), (18.0, False), (150.0, False)]
    )
    def test_the_lane_beside_a_ramp(self, kind: str, length: float, is_short: bool) -> None:
        lanes = {"forward": 2, "backward": 0}
        data = {
            "starting_point": [20, 60, 0],
            "theta": 0,
            "lanes": lanes,
            "road_segment1": {"distance": 80, "direction": "straight", "incline": 0, "turn_degrees": 0},
            "junction1": {"after": 1, "kind": kind, "take": "main", "length": length},
            "road_segment2": {"distance": 80, "direction": "straight", "incline": 0, "turn_degrees": 0},
        }
        network = build_route(read_design(data)[0], World()).network
        said = [each.sentence for each in findings("ramp_too_short", network)]
        assert len(said) == is_short
        assert all(f"is {length + 0.196 * 60:.0f} m long, shorter than 28 m" in each for each in said)


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
