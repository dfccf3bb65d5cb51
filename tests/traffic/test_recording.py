"""Recordings: what a file says of others is what is replayed, or it is said what is not."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import interp1d

from exported import ROADS, WORLD
from roadgpt.errors import UsageError
from roadgpt.traffic import STEP
from roadgpt.traffic.recording import Recording, read_recording

HEADER = "time,id,kind,x,y,heading,speed"
ROW = "0,a,car,1,2,0.5,3"


def read(folder: Path, text: str, name: str = "others.csv") -> Recording:
    (folder / name).write_text(text)
    return read_recording(folder / name)


def test_between_rows_in_any_order_everybody_moves_evenly(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    made = {}
    for name, first in (("one", 0.35), ("two", 2.0)):
        time = first + np.cumsum(rng.uniform(0.02, 0.4, 30))
        made[name] = np.column_stack(
            [time, np.cumsum(rng.normal(size=(30, 2)), axis=0), 0.1 * time, time + 3]
        )
    rows = [[r[0], name, "van", *r[1:], 5.5] for name, own in made.items() for r in own.tolist()]
    with (tmp_path / "others.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*HEADER.split(","), "length"])
        writer.writerows(rng.permutation(np.array(rows, object)).tolist())
    recording = read_recording(tmp_path / "others.csv")
    tracks = recording.on(ROADS["arcs"], WORLD)
    assert recording.remarks == ()
    for number, actor in enumerate(tracks.actors):
        own = made[actor.name]
        assert (actor.kind, actor.size.length) == ("van", 5.5)
        line = interp1d(own[:, 0], own[:, 1:], axis=0, bounds_error=False)  # NaN outside
        for sample, state in enumerate(tracks.states[:, number]):
            np.testing.assert_allclose(state[[0, 1, 3, 4]], line(sample * STEP), atol=6e-4)


def test_heights_are_those_of_the_road_and_who_stands_stays(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    x, y, z = road.at(100.0, 3.0)
    text = f"{HEADER}\n1,still,adult,{x},{y},0,0\n1,gone,dog?,0,0,0,9\n".replace("dog?", "animal")
    tracks = read(tmp_path, f"{text}1.5,gone,animal,4,0,0,9\n").on(road, WORLD)
    assert len(tracks) == 16
    np.testing.assert_allclose(tracks.states[:, 0], [[x, y, z, 0, 0]] * 16, atol=1e-3)
    assert np.isnan(tracks.states[:10, 1]).all()
    assert not np.isnan(tracks.states[10:, 1]).any()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "does not name the columns time, id, kind"),
        ("time,id,kind,x,y,speed\n", "columns heading"),
        (f"{HEADER}\n0,a,tank,1,2,0,3", "row 2: kind is 'tank'; give 'car', 'van'"),
        (f"{HEADER}\n{ROW}\n1,a,bus,1,2,0,3", "row 3: a is a bus and was a car"),
        (f"{HEADER}\n{ROW}\n0.0,a,car,1,2,0,3", "a has two rows at 0 s"),
        (f"{HEADER}\n0,a,car,nan,2,0,3", "row 2: x is 'nan'"),
        (f"{HEADER}\n0,a,car,1,2,0", "row 2: speed is ''"),
        (f"{HEADER}\n0,,car,1,2,0,3", "row 2: id is ''; give a text that is not empty"),
        (f"{HEADER},length\n{ROW},-1", "row 2: length is '-1'; give more than 0"),
        (
            f"{HEADER}\n0,Ego,car,1,2,0,3",
            "nobody in it can be replayed; not replayed, because it is the tested car: Ego",
        ),
        (f"{HEADER}\n{ROW}\n1e6,a,car,1,2,0,3", "too many"),
    ],
)
def test_a_wrong_table_costs_one_sentence(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(UsageError) as error:
        read(tmp_path, text)
    assert why in str(error.value)
    assert str(tmp_path / "others.csv") in str(error.value)


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
    tracks = read(tmp_path, text, "others.xosc").on(ROADS["arcs"], WORLD)
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
    found = read(tmp_path, text, "others.xosc")
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
        read(tmp_path, text, "others.xosc")
    assert why in str(error.value)


def test_other_files_and_missing_ones_are_told_so(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"give a table \(\.csv\) or an OpenSCENARIO file"):
        read(tmp_path, "", "others.json")
    with pytest.raises(UsageError, match=r"cannot be read \(No such file"):
        read_recording(tmp_path / "missing.csv")
