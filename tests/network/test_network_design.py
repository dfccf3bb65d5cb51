"""Designs with junctions: what is written is read, and what is wrong is said in one sentence."""

import copy
import json
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from network.changing import WORLD, built, design
from network.random_designs import random_design
from network.shared_laws import sentence_of
from roadgpt.errors import UsageError
from roadgpt.network import JunctionDesign, NetworkDesign, build_route, is_network_design, read_network_design
from roadgpt.network.arm_design import ArmDesign
from roadgpt.network.growing import controls_of
from roadgpt.road import CrossSection, World

ARMS = [{"angle": -90}, {"angle": 0}, {"angle": 90}]
GOOD = design(60.0, {"kind": "crossroads", "take": "left", "arms": ARMS}, 60.0)


def said(data: Any) -> str:
    return sentence_of(built, data)


def changed(**fields: Any) -> dict[str, Any]:
    """The good design with other fields of its junction; None for a field that is left out."""
    data = copy.deepcopy(GOOD)
    junction = {**data["junction1"], **fields}
    data["junction1"] = {key: value for key, value in junction.items() if value is not None}
    return data


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_what_is_written_is_read(seed: int) -> None:
    design_, _ = read_network_design(random_design(seed))
    written = json.loads(json.dumps(design_.to_json()))
    again, remarks = read_network_design(written)
    assert again == design_
    assert remarks == ()
    assert again.to_json() == design_.to_json()


def test_the_order_of_the_fields_is_no_matter() -> None:
    data = random_design(5)
    assert read_network_design(dict(reversed(data.items())))[0] == read_network_design(data)[0]


def test_junctions_that_are_not_numbered_as_they_follow() -> None:
    one = {key: value for key, value in GOOD.items() if key != "junction1"}
    _, remarks = read_network_design({**one, "junction2": GOOD["junction1"]})
    assert remarks == ("junctions are numbered 2 instead of 1, 2, 3, ...; they are taken in this order",)
    segment = GOOD["road_segment1"]
    turned = {
        **GOOD,
        "road_segment2": segment,
        "road_segment3": segment,
        "junction1": {"after": 2, "kind": "crossroads", "take": "left"},
        "junction2": {"after": 1, "kind": "t_junction", "take": "right"},
    }
    design, remarks = read_network_design(turned)
    assert [each.kind for each in design.junctions] == ["t_junction", "crossroads"]
    assert remarks == ("junctions are numbered 2, 1 instead of 1, 2, 3, ...; they are taken in this order",)


def test_what_is_a_network_design() -> None:
    assert is_network_design(GOOD)
    road = {key: value for key, value in GOOD.items() if key not in ("junction1", "lanes", "left_hand")}
    assert not is_network_design(road)
    assert is_network_design({**road, "left_hand": True})
    assert is_network_design({**road, "lanes": {"forward": 2, "backward": 2, "divided": True}})
    assert not is_network_design({**road, "left_hand": False})
    assert not is_network_design({"junctions": []})
    assert not is_network_design([1])


@pytest.mark.parametrize("name", ["after", "kind", "take"])
def test_a_missing_field(name: str) -> None:
    assert said(changed(**{name: None})) == f"junction 1 cannot be read: {name}: is missing; add it"


@pytest.mark.parametrize(
    ("fields", "wanted"),
    [
        ({"kind": "motorway"}, "kind: is unknown; give 't_junction'"),
        ({"kind": "exit"}, "'roundabout', 'merge', 'diverge', 'lane_drop', 'lane_gain', 'lane_change'"),
        ({"kind": 3}, "kind: is unknown"),
        ({"kind": ["merge"]}, "kind: is unknown"),
        ({"take": "back"}, "take: is unknown; give 'left', 'right', 'straight' or the number of the exit"),
        ({"take": 0}, "take: is unknown; give 'left'"),
        ({"take": 1.5}, "take: is unknown; give 'left'"),
        ({"take": math.nan}, "take: is unknown; give 'left'"),
        ({"take": True}, "take: is not a number"),
        ({"kind": "roundabout", "take": 9}, "take 9 is more than the number of exits; give 1 to 4"),
        ({"take": 4}, "take 4 is more than the number of exits; give 1 to 3"),
        ({"after": True}, "after: is not a number"),
        ({"after": 0}, "after: is out of range; give 1 or more"),
        ({"after": 10**30}, "after: is out of range; give 2000 or less"),
        ({"after": 1.5}, "after: is not a whole number"),
        ({"after": 2}, "a junction stands after segment 2, and there are 2; add a segment behind it"),
        ({"kerb": 0.5}, "kerb: is out of range; give 1 or more"),
        ({"kerb": 1e308}, "kerb: is out of range; give 100 or less"),
        ({"kerb": math.nan}, "kerb: is not finite"),
        ({"kerb": math.inf}, "kerb: is not finite"),
        ({"kerb": "wide"}, "kerb: is not a number"),
        ({"kerb": True}, "kerb: is not a number"),
        ({"radius": 0}, "radius: is out of range"),
        ({"control": "maybe"}, "control: is unknown; give 'priority'"),
        ({"colour": "red"}, "colour: is not a field of a design; remove it"),
        ({"arms": ARMS[:2]}, "a crossroads has 3 arms besides the road of arrival, and 2 are given"),
        ({"arms": {"angle": 3}}, "arms: give a list"),
        ({"arms": [-90, 0, 90]}, "arm 1 of junction 1 cannot be read: give an object with angle"),
        ({"arms": [*ARMS[:2], {}]}, "angle: is missing; add it"),
        ({"arms": [*ARMS[:2], {"angle": False}]}, "angle: is not a number"),
        ({"arms": [*ARMS[:2], {"angle": math.nan}]}, "angle: is out of range"),
        ({"arms": [*ARMS[:2], {"angle": 180}]}, "angle: is out of range; give less than 180"),
        ({"arms": [*ARMS[:2], {"angle": 24.9}]}, "arms at 0 and 24.9 degrees are less than 25 degrees apart"),
        ({"arms": [*ARMS[:2], {"angle": 156}]}, "arms at 156 and 180 degrees are less than 25 degrees apart"),
        ({"arms": [{"angle": -156}, *ARMS[1:]]}, "arms at -180 and -156 degrees are less than 25"),
        ({"arms": [*ARMS[:2], {"angle": 90, "length": 30}]}, "so leave out length"),
        ({"arms": [{"angle": -90, "length": 0}, *ARMS[1:]]}, "length: is out of range"),
        ({"arms": [{"angle": -90, "length": 99_999}, *ARMS[1:]]}, "give one of up to 50 km"),
        ({"arms": [{"angle": -90, "control": "go"}, *ARMS[1:]]}, "control: is unknown"),
        ({"arms": [{"angle": a} for a in range(-160, 161, 40)]}, "arms: give a list of at most 7"),
        ({"kind": "roundabout", "take": 5}, "take 5 is more than the number of exits; give 1 to 4"),
        ({"kind": "roundabout", "take": 1, "radius": 1}, "is too small for its arms; give a radius of"),
        ({"kind": "t_junction", "arms": [{"angle": 30}, {"angle": 90}]}, "2 arms lead left; give the number"),
        ({"kind": "t_junction", "take": "right", "arms": ARMS[1:]}, "no arm leads right; give the number"),
    ],
)  # fmt: skip
def test_a_junction_that_is_wrong(fields: dict[str, Any], wanted: str) -> None:
    assert wanted in said(changed(**fields))


def test_arms_25_degrees_apart_are_built() -> None:
    route = built(changed(take=3, arms=[{"angle": 0}, {"angle": 25}, {"angle": 50}]))
    assert math.degrees(float(route.heading(route.length))) == pytest.approx(50)


@pytest.mark.parametrize("value", [None, 5, [], "x", True])
def test_a_junction_that_is_no_object(value: Any) -> None:
    wanted = "junction 1 cannot be read: give an object with after, kind and take"
    assert said({**GOOD, "junction1": value}) == wanted


@pytest.mark.parametrize(
    ("lanes", "wanted"),
    [
        (5, "give an object with forward, backward and width"),
        ({"width": 1.9}, "width: is out of range; give 2 or more"),
        ({"width": True}, "width: is not a number"),
        ({"width": math.nan}, "width: is not finite"),
        ({"forward": 5}, "forward: is out of range; give 4 or less"),
        ({"forward": 0}, "forward: is out of range; give 1 or more"),
        ({"backward": -1}, "backward: is out of range; give 0 or more"),
        ({"centre": "dotted"}, "centre: is unknown"),
        ({"edge": "double"}, "edge: is unknown; give 'solid', 'broken' or 'none'"),
        ({"wide": 3}, "wide: is not a field"),
    ],
)
def test_lanes_that_are_wrong(lanes: Any, wanted: str) -> None:
    sentence = said({**GOOD, "lanes": lanes})
    assert sentence.startswith("the lanes of the design cannot be read: ")
    assert wanted in sentence


@pytest.mark.parametrize(
    ("fields", "wanted"),
    [
        ({"junction2": GOOD["junction1"]}, "two junctions stand after segment 1; put a segment between them"),
        ({"junctionx": GOOD["junction1"]}, "has a field 'junctionx' that is unknown"),
        ({"starting_point": [1, 2]}, "starting_point.2: is missing"),
        ({"starting_point": [True, 2, 3]}, "starting_point: is not a number"),
        ({"starting_point": [1e300, 2, 3]}, "beyond 25,000,000; give smaller numbers"),
        ({"theta": 1e300}, "beyond 25,000,000; give smaller numbers"),
        ({"theta": math.nan}, "theta: is not finite"),
        ({"road_segment1": {"distance": 60_000, "direction": "straight"}}, ""),
    ],
)
def test_a_design_that_is_wrong(fields: dict[str, Any], wanted: str) -> None:
    assert wanted in said({**GOOD, **fields})


def test_too_many_junctions() -> None:
    many = design(*[part for _ in range(101) for part in (30.0, {"kind": "t_junction", "take": 1})], 30.0)
    assert said(many) == "the design has 101 junctions; give 100 at most"


def test_nothing_stands_behind_a_way_back() -> None:
    back = {"kind": "roundabout", "take": 4}
    for behind in ((), ({"kind": "crossroads", "take": 2}, 40.0)):
        sentence = said(design(60.0, back, 30.0, *behind))
        assert sentence.startswith("the roundabout after segment 1 leads back on the road of arrival")
    assert built(design(60.0, back)).legs[-1] == (1, 1)


def test_a_world_with_other_lanes_is_refused() -> None:
    with pytest.raises(UsageError, match="leave out --lanes, --bank"):
        build_route(read_network_design(GOOD)[0], World(section=CrossSection(lanes="2+1", bank="auto")))


def test_the_lanes_are_those_of_the_design_or_else_of_the_world() -> None:
    wide = World(section=CrossSection(lane_width=3.1, shoulder=1.0))
    without = {key: value for key, value in GOOD.items() if key != "lanes"}
    for data, width in ((GOOD, 4.0), (without, 3.1), ({**GOOD, "lanes": {}}, 4.0)):
        profile = build_route(read_network_design(data)[0], wide).network.road(1).profile
        assert [lane.width for lane in profile.right] == [width, 1.0]


@pytest.mark.parametrize(
    ("kind", "angles"),
    [
        ("t_junction", [-90, 90]),
        ("y_junction", [-60, 60]),
        ("crossroads", [-90, 0, 90]),
        ("star", [-108, -36, 36, 108]),
        ("roundabout", [-90, 0, 90]),
    ],
)
def test_the_usual_arms(kind: Any, angles: list[float]) -> None:
    junction = JunctionDesign(after=1, kind=kind, take=1)
    assert [arm.angle for arm in junction.all_arms] == angles
    route = built(design(60.0, {"kind": kind, "take": 1}, 60.0))
    first = route.network.nodes[0][1]
    directions = (
        [arm.direction for arm in first[0].arms]
        if kind != "roundabout"
        else [each.arms[0].direction for each in first]
    )
    found = sorted((math.degrees(each) + 180) % 360 - 180 for each in directions[1:])
    assert found == pytest.approx(angles, abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "angles", "take", "index"),
    [
        ("t_junction", (), "left", 1),
        ("t_junction", (), "right", 0),
        ("t_junction", (0, 90), "straight", 0),
        ("t_junction", (-90, 20), "straight", 1),
        ("t_junction", (-26, 90), "right", 0),
        ("y_junction", (), "left", 1),
        ("y_junction", (), "right", 0),
        ("y_junction", (-10, 40), "right", 0),  # in a fork the rightmost arm is on the right
        ("y_junction", (-40, 10), "left", 1),
        ("y_junction", (-40, 10), "straight", 1),
        ("crossroads", (), "left", 2),
        ("crossroads", (), "straight", 1),
        ("crossroads", (), "right", 0),
        ("crossroads", (), 3, 2),
        ("star", (), 1, 0),
        ("star", (), 4, 3),
        ("star", (-120, -60, 0, 60), "straight", 2),
        ("star", (-120, -60, 0, 60), "left", 3),
        ("roundabout", (), 1, 0),
        ("roundabout", (), "left", 2),
        ("roundabout", (), 4, None),
        ("roundabout", (-60, 60), 3, None),
    ],
)
def test_the_arm_that_is_taken(kind: Any, angles: tuple[float, ...], take: Any, index: int | None) -> None:
    arms = tuple(ArmDesign(angle=angle) for angle in angles)
    assert JunctionDesign(after=1, kind=kind, take=take, arms=arms).taken == index


@pytest.mark.parametrize(
    ("kind", "take"), [("star", "left"), ("star", "right"), ("star", "straight"), ("t_junction", "straight")]
)
def test_an_arm_that_is_not_clear(kind: Any, take: Any) -> None:
    with pytest.raises(UsageError, match="give the number of the exit as take"):
        _ = JunctionDesign(after=1, kind=kind, take=take).taken


def test_arms_are_sorted_from_the_right() -> None:
    arms = tuple(ArmDesign(angle=angle) for angle in (90, -90, 0))
    assert [arm.angle for arm in JunctionDesign(after=1, kind="crossroads", take=1, arms=arms).all_arms] == [
        -90,
        0,
        90,
    ]


CONTROLS = [
    ("crossroads", "none", ("none", "none", "none", "none")),
    ("crossroads", "lights", ("lights", "lights", "lights", "lights")),
    ("crossroads", "priority", ("priority", "yield", "priority", "yield")),
    ("crossroads", "yield", ("yield", "priority", "yield", "priority")),
    ("crossroads", "stop", ("stop", "priority", "stop", "priority")),
    ("t_junction", "yield", ("yield", "priority", "priority")),
    ("t_junction", "priority", ("priority", "priority", "yield")),
    ("star", "stop", ("stop", "stop", "priority", "priority", "priority")),
    ("roundabout", "none", ("yield", "yield", "yield", "yield")),
    ("roundabout", "stop", ("stop", "yield", "yield", "yield")),
    ("roundabout", "priority", ("yield", "yield", "yield", "yield")),
    ("roundabout", "lights", ("lights", "lights", "lights", "lights")),
]


@pytest.mark.parametrize(("kind", "control", "wanted"), CONTROLS)
def test_the_signs_of_all_arms(kind: Any, control: Any, wanted: tuple[str, ...]) -> None:
    """Arms from the right; the route takes the first one. A star has no arm opposite within 40 degrees but
    those at 36 degrees on both sides, of which the right one counts.
    """
    junction = JunctionDesign(after=1, kind=kind, take=1, control=control)
    if kind == "star":
        wanted = ("stop", "priority", "stop", "priority", "priority")
    assert controls_of(junction) == wanted


def test_an_arm_may_have_a_sign_of_its_own() -> None:
    arms = (ArmDesign(angle=-90, control="stop"), ArmDesign(angle=90))
    junction = JunctionDesign(after=1, kind="t_junction", take="left", control="yield", arms=arms)
    assert controls_of(junction) == ("yield", "stop", "priority")


def test_a_design_says_what_it_is() -> None:
    made, _ = read_network_design(GOOD)
    assert isinstance(made, NetworkDesign)
    assert repr(made) == "NetworkDesign(120 m of road, junctions: crossroads)"
    assert [len(stretch) for stretch in made.stretches] == [1, 1]
    assert built(GOOD, WORLD).network.nodes[0][0] == "crossroads"


def with_lanes(*parts: dict[str, Any], **lanes: Any) -> dict[str, Any]:
    """A design of roads of 100 m with these places between them; the lanes of the first road are given."""
    data = design(*[each for part in parts for each in (100.0, part)], 100.0)
    return {**data, "lanes": lanes}


RAMP = {"kind": "merge", "take": "ramp"}


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (with_lanes({"kind": "lane_drop"}, forward=1), "a lane_drop leaves 0 lanes, and a road has 1 to 4"),
        (with_lanes({"kind": "lane_gain"}, forward=4), "a lane_gain leaves 5 lanes, and a road has 1 to 4"),
        (with_lanes({"kind": "lane_change"}, forward=1), "cannot change to the right on road 2: there is no"),
        (with_lanes({"kind": "lane_change", "side": "left"}, forward=1), "cannot change to the left"),
        (
            with_lanes(*[{"kind": "lane_change", "side": "left"}] * 2, forward=2),
            "cannot change to the left on road 3: there is no lane",
        ),
        (with_lanes(RAMP, forward=1, backward=1), "the ramp, which has one lane and no oncoming traffic"),
        (with_lanes(RAMP, forward=2, backward=0), "the ramp, which has one lane and no oncoming traffic"),
        (
            with_lanes(
                {"kind": "diverge", "take": "ramp", "lanes": {"forward": 2, "backward": 0}}, forward=2
            ),
            "the ramp, which has one lane and no oncoming traffic",
        ),
        (with_lanes({"kind": "merge"}, forward=2), "junction 1 cannot be read: take: is missing"),
        (with_lanes({"kind": "merge", "take": "left"}, forward=2), "junction 1 cannot be read: take"),
        (with_lanes({**RAMP, "length": 5}, forward=1, backward=0), "junction 1 cannot be read: length"),
        (with_lanes({**RAMP, "length": True}, forward=1, backward=0), "junction 1"),
        (with_lanes({**RAMP, "arms": []}, forward=1, backward=0), "junction 1 cannot be read: arms"),
        (with_lanes({**RAMP, "lanes": {"forward": 0}}, forward=1, backward=0), "lanes.forward"),
        (with_lanes({**RAMP, "lanes": 2}, forward=1, backward=0), "the lanes of junction 1 cannot be read"),
        (with_lanes({"kind": "lane_drop", "side": "middle"}, forward=2), "junction 1 cannot be read: side"),
        (with_lanes({"kind": "roundabout", "take": 2}, forward=2), "a roundabout with one lane joins roads"),
        (with_lanes({"kind": "roundabout", "take": 2, "ring_lanes": 3}, forward=3), "ring_lanes"),
        (with_lanes({"kind": "crossroads", "take": 1}, forward=5), "the lanes of the design cannot be read"),
        (with_lanes({"kind": "crossroads", "take": 1}, forward=0), "the lanes of the design cannot be read"),
        (
            with_lanes({"kind": "crossroads", "take": 1}, backward=-1),
            "the lanes of the design cannot be read",
        ),
        (
            with_lanes({"kind": "crossroads", "take": 1}, centre="wavy"),
            "the lanes of the design cannot be read",
        ),
        (with_lanes({"kind": "crossroads", "take": 1}, forward=True), "the lanes of the design"),
        (with_lanes({"kind": "crossroads", "take": 1}, width=1.5), "the lanes of the design cannot be read"),
    ],
)
def test_lanes_that_cannot_be_are_refused_in_one_sentence(data: dict[str, Any], sentence: str) -> None:
    assert sentence in said(data)
