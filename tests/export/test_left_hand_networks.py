"""OpenDRIVE files of networks with traffic on the left: mirror images of those with traffic on the right."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from network.mirrored import in_mirror
from network.random_designs import random_design, random_lanes_design
from outside_judge import networks_referee
from roadgpt.export import save
from roadgpt.network import build_route
from roadgpt.road import World, read_design

FLIPPED = {
    "geometry": ("y", "hdg"), "arc": ("curvature",), "spiral": ("curvStart", "curvEnd"), "signal": ("t",),
    "object": ("t",), "cornerLocal": ("v",), "laneOffset": ("a", "b", "c", "d"), "lane": ("id",),
    "predecessor": ("id",), "successor": ("id",), "laneLink": ("from", "to"),
}  # fmt: skip
"""The attributes whose sign a mirror changes."""


def trees(data: dict[str, Any], folder: Path, format_: str) -> list[ET.Element]:
    """The files of a design with traffic on the left, and of the mirrored one with traffic on the right."""
    found = []
    for name, own in (("left", {**data, "left_hand": True}), ("right", in_mirror(data))):
        written = save(build_route(read_design(own)[0], World()), folder, [format_], World(), name)
        (file,) = (path for path in written if path.suffix == ".xodr")
        found.append(ET.parse(file).getroot())
    return found


def rows(tree: ET.Element, is_mirrored: bool) -> list[tuple[str, ...]]:
    """What a file says of its roads and connections, in any order within each road and junction."""
    found = []
    for top in tree:
        if top.tag not in ("road", "junction"):
            continue
        for element in top.iter():
            if element.tag in ("segment", "validity", "boundary", "left", "right"):
                continue
            values = dict(element.attrib)
            if element.tag in ("signal", "object", "control"):
                values.pop("id", None)  # signals are numbered from arm to arm
                values.pop("signalId", None)
            if element.tag == "road":
                assert values.pop("rule") == ("LHT" if is_mirrored else "RHT")
            if is_mirrored and values.get("name") == "arrow":
                values["subtype"] = in_a_mirror(values["subtype"])
            for name in FLIPPED.get(element.tag, ()) if is_mirrored else ():
                if name in values:
                    values[name] = repr(0.0 - float(values[name]))
            found.append(
                (top.tag, top.attrib["id"], element.tag, *map(str, sorted(map(plain, values.items()))))
            )
    return sorted(found)


def in_a_mirror(subtype: str) -> str:
    """The name of an arrow with left and right exchanged; the left one is always named first."""
    if "Left" in subtype and "Right" in subtype:
        return subtype
    return subtype.replace("Left", "?").replace("Right", "Left").replace("?", "Right")


def plain(item: tuple[str, str]) -> tuple[str, object]:
    try:
        return item[0], round(float(item[1]), 6) + 0.0
    except ValueError:
        return item


def segments(tree: ET.Element, junction: str) -> list[tuple[Any, ...]]:
    (found,) = (each for each in tree.iter("junction") if each.attrib["id"] == junction)
    return [tuple(each.attrib.values()) for each in found.iter("segment")]


@pytest.mark.parametrize("format_", ["opendrive", "opendrive17"])
@pytest.mark.parametrize("seed", range(2))
def test_a_file_is_the_mirror_image(tmp_path: Path, format_: str, seed: int) -> None:
    for draw in (random_design, random_lanes_design):
        left, right = trees(draw(seed), tmp_path, format_)
        assert rows(left, is_mirrored=True) == rows(right, is_mirrored=False)


@pytest.mark.parametrize("seed", range(2))
def test_signs_hold_for_the_lanes_that_see_them_and_boundaries_go_round_the_other_way(
    tmp_path: Path, seed: int
) -> None:
    left, right = trees(random_design(seed), tmp_path, "opendrive")
    for one, two in zip(left.iter("validity"), right.iter("validity"), strict=True):
        ids = [int(one.attrib[name]) for name in ("fromLane", "toLane")]
        assert ids == sorted(ids)
        assert [-int(two.attrib[name]) for name in ("toLane", "fromLane")] == ids
    for junction in right.iter("junction"):
        own, other = (segments(tree, junction.attrib["id"]) for tree in (left, right))
        assert len(own) == len(other) > 0
        for mine, theirs in zip(own, reversed(other), strict=True):
            assert mine[:2] == theirs[:2]
            if mine[0] == "joint":
                assert mine[2] == theirs[2]
                assert [int(mine[3]), int(mine[4])] == [-int(theirs[4]), -int(theirs[3])]
            else:
                assert int(mine[2]) == -int(theirs[2])
                assert mine[3:] == theirs[:2:-1]


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    return networks_referee()


@pytest.mark.parametrize("draw", [random_design, random_lanes_design])
@pytest.mark.parametrize("seed", range(3))
def test_a_judge_reads_traffic_on_the_left(tmp_path: Path, referee: ModuleType, draw: Any, seed: int) -> None:
    found = []
    for name, own in (("left", {**draw(seed), "left_hand": True}), ("right", in_mirror(draw(seed)))):
        save(build_route(read_design(own)[0], World()), tmp_path, ["opendrive"], World(), name)
        legs = json.loads((tmp_path / f"{name}.route.json").read_text())["route"]
        found.append(referee.measure(str(tmp_path / f"{name}.xodr"), legs))
    left, right = found
    assert (left["breaks"], left["faults"]) == ([], [])
    other = {"left": "right", "right": "left"}
    for one, two in zip(left["junctions"], right["junctions"], strict=True):
        for key in ("kinds", "exit", "control", "right_way", "hand", "after", "side", "take"):
            mine, theirs = one.get(key), two.get(key)
            if key in ("side", "take"):
                theirs = other.get(theirs, theirs)
            if key == "hand" and theirs is not None:
                theirs = {"ccw": "cw"}[theirs]
            assert mine == pytest.approx(theirs) if isinstance(mine, float) else mine == theirs, key
