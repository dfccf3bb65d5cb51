"""Designs with junctions: what is written is read, and what is wrong is said in one sentence."""

import copy
import json
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from network.changing import built, design
from network.random_designs import random_design, random_lanes_design
from network.shared_laws import sentence_of
from roadgpt.campaign.record import design_of, design_text
from roadgpt.errors import UsageError
from roadgpt.network import build_route
from roadgpt.network.growing import controls_of
from roadgpt.road import CrossSection, Design, World, build, read_design
from roadgpt.road.design import ArmDesign, JunctionDesign, LanesDesign, is_design
from tables import rows

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


@given(st.sampled_from([random_design, random_lanes_design]), st.integers(0, 10_000), st.booleans())
@settings(max_examples=24, deadline=None)
def test_what_is_written_is_read(draw: Any, seed: int, left_hand: bool) -> None:
    design_, _ = read_design({**draw(seed), "left_hand": left_hand})
    written = json.loads(json.dumps(design_.to_json()))
    again, remarks = read_design(written)
    assert again == design_
    assert remarks == ()
    assert again.to_json() == design_.to_json()


def test_junctions_that_are_not_numbered_as_they_follow() -> None:
    one = {key: value for key, value in GOOD.items() if key != "junction1"}
    _, remarks = read_design({**one, "junction2": GOOD["junction1"]})
    assert remarks == ("junctions are numbered 2 instead of 1, 2, 3, ...; they are taken in this order",)
    segment = GOOD["road_segment1"]
    turned = {
        **GOOD,
        "road_segment2": segment,
        "road_segment3": segment,
        "junction1": {"after": 2, "kind": "crossroads", "take": "left"},
        "junction2": {"after": 1, "kind": "t_junction", "take": "right"},
    }
    design, remarks = read_design(turned)
    assert [each.kind for each in design.junctions] == ["t_junction", "crossroads"]
    assert remarks == ("junctions are numbered 2, 1 instead of 1, 2, 3, ...; they are taken in this order",)


def test_what_is_a_plain_road() -> None:
    def is_plain(data: dict[str, Any]) -> bool:
        assert is_design(data)
        return read_design(data)[0].is_plain

    assert not is_plain(GOOD)
    road = {key: value for key, value in GOOD.items() if key not in ("junction1", "lanes", "left_hand")}
    assert is_plain(road)
    assert not is_plain({**road, "left_hand": True})
    assert not is_plain({**road, "lanes": {"forward": 2, "backward": 2, "divided": True}})
    assert is_plain({**road, "left_hand": False, "lanes": None})
    assert is_design({"junction1": {}})
    assert not is_design({"junctions": []})
    assert not is_design([1])


STORED = (
    '{"starting_point":[10.0,20.0,0.0],"theta":0.0,"segments":'
    '[{"distance":60.0,"direction":"straight","incline":0.0,"turn_degrees":0.0}]}',
    '{"starting_point":[10.0,20.0,0.0],"theta":0.0,"segments":'
    '[{"distance":60.0,"direction":"straight"},{"distance":30.0,"direction":"straight"}],"junctions":'
    '[{"after":1,"kind":"merge","take":"main","length":130.0,"taper":60.0}],"left_hand":false}',
    '{"nodes":[{"at":[0.0,0.0,0.0],"kind":"end"},{"at":[90.0,0.0,0.0],"kind":"end"}],"roads":[[1,2]],'
    '"route":[1,2],"lanes":{"width":3.5},"left_hand":true}',
)
"""Designs as the databases of campaigns hold them, also from when there were three kinds of designs."""


@pytest.mark.parametrize("text", STORED)
def test_stored_designs_of_all_kinds_are_read(text: str) -> None:
    found = design_of(text)
    assert found is not None
    assert found.is_map == ("nodes" in text)
    assert design_of(design_text(found)) == found
    assert read_design(found.to_json())[0] == found
    assert found.mirrored(40.0).mirrored(40.0) == found
    assert (design_text(found) == text) == found.is_plain


def test_a_design_is_a_row_of_segments_or_a_map() -> None:
    road, _, over_map = (design_of(text) for text in STORED)
    assert road is not None
    assert over_map is not None
    for wrong in (
        {**dict(road), "nodes": over_map.nodes, "roads": over_map.roads},
        {**dict(road), "segments": ()},
        {**dict(road), "route": (1, 2)},
        {**dict(over_map), "roads": ()},
        {**dict(over_map), "lanes": LanesDesign(width=3.5, forward=2)},
    ):
        with pytest.raises(ValidationError):
            Design(**wrong)


@pytest.mark.parametrize("text", STORED[1:])
def test_only_a_plain_road_is_built_without_a_network(text: str) -> None:
    found = design_of(text)
    assert found is not None
    with pytest.raises(UsageError, match="built by build_route"):
        build(found)


@pytest.mark.parametrize("name", ["after", "kind", "take"])
def test_a_missing_field(name: str) -> None:
    assert said(changed(**{name: None})) == f"junction 1 cannot be read: {name}: is missing; add it"


@pytest.mark.parametrize(
    ("fields", "wanted"),
    rows(__file__, "a_junction_that_is_wrong"),
)  # fmt: skip
def test_a_junction_that_is_wrong(fields: dict[str, Any], wanted: str) -> None:
    assert wanted in said(changed(**fields))


@pytest.mark.parametrize(
    ("lanes", "wanted"),
    rows(__file__, "lanes_that_are_wrong"),
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


def test_a_world_with_other_lanes_is_refused() -> None:
    with pytest.raises(UsageError, match="leave out --lanes, --bank"):
        build_route(read_design(GOOD)[0], World(section=CrossSection(lanes="2+1", bank="auto")))


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
