"""The rule about roads in land: room for bridges and tunnels, and no wall that would be a dam.

The second opinion is arithmetic: margins along straight roads, and slopes of 1:2 between two legs."""

import math

import numpy as np
import pytest

from network.changing import built, design
from network.ruled import all_findings
from roadgpt import plugins
from roadgpt.check import RULE_SETS, Finding, inspect
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.ground.files import named
from roadgpt.ground.relief import Relief
from roadgpt.network import Route
from roadgpt.road import Road, World

RIM = 7.0  # m from the centre line
SHORTEST, MARGIN = 12.0, 8.0  # m, of a bridge, and of road before and behind it
LEG = 60.0


def straight(length: float, height: float = 10.0) -> Road:
    return Road(PieceCurve(50.0, 100.0, 0.0, (Piece(length),)), GradeProfile.level(length, height))


def hairpin(apart: float, rise: float, side: float = 1.0) -> Road:
    """A level leg to the east, a half-circle that climbs, and a level leg back."""
    radius = apart / 2
    turn = math.pi * radius
    pieces = Piece(LEG), Piece(turn, side / radius, side / radius), Piece(LEG)
    stations = (0.0, LEG, LEG + turn / 2, LEG + turn, 2 * LEG + turn)
    grades = (0.0, 0.0, 2 * rise / turn, 0.0, 0.0)
    return Road(PieceCurve(100.0, 100.0, 0.0, pieces), GradeProfile(10.0, stations, grades))


def plane(height: float) -> World:
    heights = np.full((31, 31), height)
    relief = Relief(0.0, 0.0, 10.0, heights, np.full_like(heights, np.nan), np.empty((0, 3)))
    return World().changed(ground=named("x.npy", relief))


def found(road: Road, world: World) -> tuple[Finding, ...]:
    return all_findings("not_in_land", road, world)


def sentences(road: Road, scene: str, world: World | None = None) -> list[str]:
    return [each.sentence for each in found(road, (world or World()).changed(scene=scene))]


@pytest.mark.parametrize("road", [straight(40.0), hairpin(16.0, 20.0)], ids=["short", "hairpin"])
def test_without_land_nothing_is_checked(road: Road) -> None:
    assert found(road, World()) == ()
    assert found(road, World().changed(scene="fog 60")) == ()
    assert bool(found(road, World().changed(ground="flat"))) == (road.length > 100.0)


@pytest.mark.parametrize("ground", ["", "flat", "hilly:3", "mountain:2"])
@pytest.mark.parametrize(
    "scene",
    [
        "bridge x2",
        "bridge x2; tunnel x2",
        "ridge through; tunnel len=70",
        "valley across; bridge",
        "lake left",
    ],
)
def test_a_road_with_room_has_nothing_to_be_told(scene: str, ground: str) -> None:
    assert sentences(straight(400.0), scene, World().changed(ground=ground, map_size=600)) == []


@pytest.mark.parametrize(
    ("length", "scene", "asked", "built"),
    [
        (40.0, "tunnel x2", "2 tunnels", 1),
        (40.0, "bridge x2", "2 bridges", 1),
        (2 * MARGIN + SHORTEST - 0.5, "tunnel", "1 tunnel", 0),
        (2 * MARGIN + SHORTEST - 0.5, "valley across; bridge", "1 bridge", 0),
        (2 * MARGIN + SHORTEST - 0.5, "bridge x2", "2 bridges", 0),
        (3 * MARGIN + 2 * SHORTEST + 8.0, "bridge x3", "3 bridges", 2),
    ],
)
def test_what_has_no_room_is_counted_in_one_sentence(
    length: float, scene: str, asked: str, built: int
) -> None:
    (finding,) = found(straight(length), World().changed(scene=scene))
    assert finding.rule == "not_in_land"
    assert finding.sentence == f"asked for {asked}, has room for {built}"
    assert not finding.stops


def test_each_kind_is_counted_by_itself() -> None:
    first, second = sentences(straight(20.0), "tunnel; bridge x2")
    assert first == "asked for 2 bridges, has room for 0"
    assert second == "asked for 1 tunnel, has room for 0"
    assert sentences(straight(2 * MARGIN + SHORTEST + 0.5), "tunnel") == []
    assert sentences(straight(20.0), "river across") == []  # a bridge that nobody named


@pytest.mark.parametrize(
    ("scene", "height", "is_told"),
    [
        ("bridge", 9.0, True),
        ("bridge", 10.0, True),
        ("bridge", 5.0, False),
        ("tunnel", 15.0, True),
        ("tunnel", 5.0, True),
        ("tunnel", 20.0, False),
    ],
)
def test_given_land_leaves_room_or_not(scene: str, height: float, is_told: bool) -> None:
    """The road is 10 m high; a bridge needs 2 m under it and a tunnel 7 m above the road."""
    expected = [f"asked for 1 {scene}, has room for 0"] if is_told else []
    assert sentences(straight(150.0), scene, plane(height)) == expected


@pytest.mark.parametrize("is_cut", [True, False])
def test_earth_on_a_bridge_is_told(is_cut: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plane rises to the north, 4 m above the left rim; in the middle of the bridge it lies 3 m below."""
    x = np.arange(31) * 10.0
    heights = 7.0 + np.outer(x - 100.0, np.ones(31))
    land = named("x.npy", Relief(0.0, 0.0, 10.0, heights, np.full_like(heights, np.nan), np.empty((0, 3))))
    if not is_cut:
        monkeypatch.setattr("roadgpt.network.surface.UNDER", -3.0)
    told = sentences(straight(150.0 + is_cut), "bridge", World().changed(ground=land))
    assert len(told) == (not is_cut)
    assert is_cut or told[0].endswith("earth stands 3.0 m above the deck of a bridge")


def route() -> Route:
    """Two roads of 40 m on the way through a roundabout."""
    return built(design(40.0, {"kind": "roundabout", "take": "straight"}, 40.0)).on_ground()


@pytest.mark.parametrize(("scene", "said"), [("tunnel x2", ""), ("tunnel x3", "has room for 2")])
def test_on_a_route_each_road_outside_junctions_has_room_for_one(scene: str, said: str) -> None:
    """Two of 12 m and 8 m between them do not fit into the 24 m between the margins."""
    told = sentences(route(), scene)
    assert bool(told) == bool(said)
    assert all(each == f"asked for 3 tunnels, {said}" for each in told)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("ground", ["flat", "rolling:2", "hilly:5"])
@pytest.mark.parametrize(
    ("apart", "rise"), [(16.0, 20.0), (16.0, 15.0), (16.0, 17.0), (20.0, 20.0), (26.0, 20.0), (26.0, 25.0)]
)
def test_between_legs_of_a_hairpin_stands_what_the_slope_leaves_over(
    apart: float, rise: float, ground: str, side: float
) -> None:
    """From the lower rim the land rises by 1:2; at the higher rim stands a wall."""
    high = rise - (apart - 2 * RIM) / 2
    told = found(hairpin(apart, rise, side), World().changed(ground=ground))
    if high < 15.0:
        assert told == ()
        return
    (finding,) = told
    assert f"a wall of {high:.0f} m stands" in finding.sentence
    assert finding.sentence.endswith("15 m is the most")
    assert finding.s is None
    assert finding.x is not None
    assert finding.y is not None
    assert 100.0 <= finding.x <= 100.0 + LEG + 1.0
    assert finding.y == pytest.approx(100.0 + side * (apart - RIM), abs=0.2)  # at the rim of the higher leg
    assert f"at ({finding.x:.0f}, {finding.y:.0f})" in finding.sentence


def test_the_strict_rules_hold_it_and_say_it_with_the_others() -> None:
    assert "not_in_land" in RULE_SETS["strict"]
    assert "not_in_land" not in RULE_SETS["sbft"]
    assert "not_in_land" in plugins.names("rules")
    road, world = hairpin(16.0, 20.0), World().changed(ground="flat")
    strict, sbft = ({each.rule for each in inspect(road, None, world, rules)} for rules in ("strict", "sbft"))
    assert {"not_in_land", "too_steep"} <= strict
    assert "not_in_land" not in sbft
    assert "not_in_land" not in {each.rule for each in inspect(road, None, World())}
    level = hairpin(40.0, 0.0), world
    assert inspect(level[0], None, level[1]) == ()


@pytest.mark.parametrize(
    ("apart", "rise"), [(12.0, 4.0), (13.5, 2.0), (12.0, -4.0), (12.0, 0.0), (12.0, 0.2)]
)
def test_legs_whose_verges_overlap_are_told_by_their_step(apart: float, rise: float) -> None:
    """The rims lie 7 m from each line, so those of legs up to 14 m apart overlap."""
    told = found(hairpin(apart, rise), World().changed(ground="flat"))
    if abs(rise) < 0.3:
        assert told == ()
        return
    (finding,) = told
    assert finding.sentence.endswith(f"two parts of the road meet with a step of {abs(rise):.1f} m")
    assert finding.x is not None
    assert finding.y is not None
    assert 100.0 + apart - RIM - 0.1 <= finding.y <= 100.0 + RIM + 0.1
