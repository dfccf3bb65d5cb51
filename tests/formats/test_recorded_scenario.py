"""Recordings in OpenSCENARIO: what a file says of others is what is replayed, or it is said what is not."""

import math
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.errors import UsageError
from roadgpt.run import Setup
from roadgpt.run.versions import versions_of
from roadgpt.traffic import STEP
from roadgpt.traffic.recording import Recording, read_recording


def read(folder: Path, text: str) -> Recording:
    (folder / "others.xosc").write_text(text)
    return read_recording(folder / "others.xosc")


def scene(entities: str, init: str = "", acts: str = "") -> str:
    return (
        '<OpenSCENARIO><RoadNetwork><LogicFile filepath="/dev/zero"/></RoadNetwork>'
        f"<Entities>{entities}</Entities><Storyboard><Init><Actions>{init}</Actions></Init>"
        f"<Story name='s'>{acts}</Story></Storyboard></OpenSCENARIO>"
    )


def entity(name: str, category: str = "truck", body: str = "Vehicle") -> str:
    key = {"Vehicle": "vehicleCategory", "Pedestrian": "pedestrianCategory"}.get(body, "miscObjectCategory")
    return (
        f'<ScenarioObject name="{name}"><{body} name="" {key}="{category}"><BoundingBox>'
        '<Center x="3" y="0.5" z="1"/><Dimensions length="8" width="2.5" height="3"/></BoundingBox>'
        f"</{body}></ScenarioObject>"
    )


def teleport(name: str, place: str) -> str:
    return (
        f'<Private entityRef="{name}"><PrivateAction><TeleportAction><Position>{place}</Position>'
        "</TeleportAction></PrivateAction></Private>"
    )


def at(seconds: float) -> str:
    return (
        "<StartTrigger><ConditionGroup><Condition delay='0'><ByValueCondition><SimulationTimeCondition "
        f'value="{seconds}" rule="greaterThan"/></ByValueCondition></Condition></ConditionGroup>'
        "</StartTrigger>"
    )


def act(name: str, action: str, seconds: float) -> str:
    return (
        f'<Act><ManeuverGroup><Actors><EntityRef entityRef="{name}"/></Actors><Maneuver><Event>'
        f"<Action>{action}</Action>{at(seconds)}</Event></Maneuver></ManeuverGroup>{at(0)}</Act>"
    )


def follow(poses: np.ndarray, timing: str) -> str:
    vertices = "".join(
        f'<Vertex time="{t}"><Position><WorldPosition x="{x}" y="{y}" z="{z}" h="{h}"/></Position></Vertex>'
        for t, x, y, z, h in poses.tolist()
    )
    return (
        "<PrivateAction><RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory><Shape><Polyline>"
        f"{vertices}</Polyline></Shape></Trajectory></TrajectoryRef><TimeReference><Timing {timing}/>"
        "</TimeReference></FollowTrajectoryAction></RoutingAction></PrivateAction>"
    )


@pytest.mark.parametrize("timing", ["absolute", "relative"])
def test_a_trajectory_is_that_of_the_rear_axle(tmp_path: Path, timing: str) -> None:
    """A truck whose rear axle goes round a circle, from 2 s on, in doubled time."""
    angle = np.linspace(0, 2, 41)
    poses = np.column_stack([angle, 30 * np.sin(angle), 30 - 30 * np.cos(angle), angle, angle])
    start = 2.0 if timing == "absolute" else 0.0
    said = f'domainAbsoluteRelative="{timing}" scale="2" offset="{start}"'
    text = scene(entity("t"), "", act("t", follow(poses, said), 2.0))
    tracks = read(tmp_path, text).on(ROADS["arcs"], WORLD)
    assert tracks.actors[0].kind == "truck"
    assert tuple(tracks.actors[0].size) == (8, 2.5, 3)
    assert len(tracks) == 61
    assert np.isnan(tracks.states[:20]).all()
    for sample in range(20, 61):
        turn = (sample * STEP - 2) / 2
        x, y, z, heading, speed = tracks.states[sample, 0]
        c, s = math.cos(turn), math.sin(turn)
        assert (x, y) == pytest.approx((30 * s + 3 * c - 0.5 * s, 30 - 30 * c + 3 * s + 0.5 * c), abs=0.02)
        assert (z, heading, speed) == pytest.approx((turn, turn, 15), abs=0.05)


def test_what_is_not_understood_is_left_out_by_name(tmp_path: Path) -> None:
    here = '<WorldPosition x="1" y="2"/>'
    change = "<PrivateAction><LateralAction><LaneChangeAction/></LateralAction></PrivateAction>"
    catalogue = (
        '<ScenarioObject name="listed"><CatalogReference catalogName="c" entryName="e"/></ScenarioObject>'
    )
    names = ("Ego", "stands", "lane", "nowhere", "changes", "parameter")
    text = scene(
        "".join(map(entity, names))
        + catalogue
        + entity("rails", "tram")
        + entity("dog", "animal", "Pedestrian"),
        teleport("stands", here)
        + teleport("lane", '<LanePosition roadId="1" laneId="1" s="0"/>')
        + teleport("changes", here)
        + teleport("dog", here)
        + teleport("parameter", '<WorldPosition x="$x" y="2"/>'),
        act("changes", change, 1.0),
    )
    found = read(tmp_path, text)
    assert [actor.name for actor in found.actors] == ["stands", "dog"]
    (tested, left_out) = found.remarks
    assert "it is the tested car: Ego" in tested
    for said in (
        "lane (a LanePosition)",
        "nowhere (without a place)",
        "changes (LaneChangeAction)",
        "parameter (x of its WorldPosition is '$x')",
        "listed (its body is in a catalogue)",
    ):
        assert said in left_out
    assert "and 1 more" in left_out


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("<a", "not well-formed XML"),
        ("<OpenDRIVE/>", "not an OpenSCENARIO 1 scenario"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><OpenSCENARIO/>', "declares a document type"),
        (scene(entity("lost")), "left out, because not understood: lost (without a place)"),
    ],
)
def test_a_wrong_scenario_costs_one_sentence(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(UsageError) as error:
        read(tmp_path, text)
    assert why in str(error.value)


def test_a_test_with_such_a_recording_records_what_read_it() -> None:
    """Tables are read by RoadGPT itself."""
    said = [versions_of([Setup(tracks=f"others.{ending}")])["plug-ins"] for ending in ("xosc", "csv")]
    assert ["roadgpt_formats" in each for each in said] == [True, False]
