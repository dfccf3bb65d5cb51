"""Finds what a scene needs of its road and a Brief excludes."""

from collections.abc import Iterator, Mapping
from math import inf

from roadgpt.brief.junctions import LANE_KINDS
from roadgpt.brief.model import Brief, span
from roadgpt.brief.outline import outline
from roadgpt.brief.scene import LEAVES, Scene
from roadgpt.brief.scene_places import with_places
from roadgpt.errors import BriefError
from roadgpt.language.names import Where
from roadgpt.language.table import FLOWS

NEEDS: Mapping[Where, str] = {
    "lane": "two lanes in its direction; write lanes=2",
    "far": "three lanes in its direction; write lanes=3",
    "oncoming": "an oncoming lane; write for example against=1",
}
"""What somebody needs of the lanes where it is at first, and how to ask for it."""


def check_scene(scene: Scene, brief: Brief) -> None:
    """Raises BriefError if a scene needs what the Brief excludes; what the Brief leaves open is no fault."""
    if scene != Scene() and (fault := next(_faults(scene, with_places(brief, scene)), "")):
        raise BriefError(fault)


def _faults(scene: Scene, brief: Brief) -> Iterator[str]:
    roads = brief.stretches or (brief,)
    along = 1 if brief.map is not None else max(span(road.lanes).hi for road in roads)
    is_one_way = all((road.lanes_text or "1+1").endswith("+0") for road in roads)
    has = {"lane": along >= 2, "far": along >= 3, "oncoming": not is_one_way}
    counts: dict[str, float] = {}
    if brief.map is None:
        places = [place for place in brief.junctions if place.kind not in LANE_KINDS]
        turns = sum(outline(road.as_stretch).turns.hi for road in roads)
        counts = {"junction": len(places), "turn": turns}
    lacks = {name: need for name, need in NEEDS.items() if not has[name]}
    if brief.map is not None:
        one = "; the roads of a map have one"
        lacks = {name: need.partition(";")[0] + one for name, need in lacks.items()}
    if scene.oncoming in FLOWS and is_one_way:
        yield f"oncoming traffic needs {lacks['oncoming']}"
    for role in scene.actors:
        # who cuts in or overtakes can also come along the oncoming lane
        passes = role.where == "lane" and role.actions and role.actions[0].what in ("cut_in", "overtake")
        if (need := lacks.get(role.where)) and (is_one_way or not passes):
            yield f"'{role}' needs {need}"
        leaves = role.where in ("ahead", "behind") and any(each.what in LEAVES for each in role.actions)
        if leaves and along < 2:
            yield f"'{role}' needs {lacks['lane']}"
        for mark in role.marks:
            if mark.number > (count := counts.get(mark.of, inf)):
                yield f"'{role}' needs {mark.of} {mark.number}, and there are {count:g}; change one of them"
    if scene.lane and abs(scene.lane) > along:
        yield f"the tested car's lane={scene.lane} needs more lanes; write lanes={abs(scene.lane)}"
    inner, outer = scene.lanes_in_and_out(brief.left_hand)
    if scene.lane and (outer > scene.lane - 1 if scene.lane > 0 else inner > -scene.lane - 1):
        yield f"there is no lane beside the tested car's lane={scene.lane} for those who are there; change it"
    if 2 <= along < (least := scene.lanes_needed(brief.left_hand)):
        yield f"the scene needs {least} lanes in the direction of the tested car; write lanes={least}"
