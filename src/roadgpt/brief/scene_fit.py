"""Refuses a scene that needs what the road of a Brief is said not to have."""

from collections.abc import Iterator
from math import inf

from roadgpt.brief.junctions import LANE_KINDS, RAMPS
from roadgpt.brief.model import Brief, span
from roadgpt.brief.outline import outline
from roadgpt.brief.scene import FLOWS, Scene
from roadgpt.errors import BriefError


def check_scene(scene: Scene, brief: Brief) -> None:
    """Raises BriefError if a scene needs what the Brief excludes; what the Brief leaves open is no fault."""
    if scene != Scene() and (fault := next(_faults(scene, brief), "")):
        raise BriefError(fault)


def _faults(scene: Scene, brief: Brief) -> Iterator[str]:
    roads = brief.stretches or (brief,)
    along = max(span(road.lanes).hi for road in roads)
    is_one_way = all((road.lanes_text or "1+1").endswith("+0") for road in roads)
    lacks = {
        "lane": "two lanes in its direction; write lanes=2" if along < 2 else "",
        "far": "three lanes in its direction; write lanes=3" if along < 3 else "",
        "oncoming": "an oncoming lane; write for example against=1" if is_one_way else "",
    }
    counts: dict[str, float] = {}
    if brief.map is None:
        places = [place for place in brief.junctions if place.kind not in LANE_KINDS]
        kinds = {place.kind for place in places}
        has_crosswalk = any(place.crosswalk for place in places)
        lacks |= {
            "ramp": "" if kinds & {*RAMPS} else "a ramp; write for example merge ramp",
            "junction": "" if kinds - {*RAMPS} else "a junction; write for example crossroads straight",
            "roundabout": ""
            if "roundabout" in kinds
            else "a roundabout; write for example roundabout exit=2",
            "crosswalk": "" if has_crosswalk else "a crosswalk; write crosswalk behind a junction",
        }
        turns = sum(outline(road.as_stretch).turns.hi for road in roads)
        counts = {"junction": len(places), "turn": turns}
    if scene.oncoming in FLOWS and lacks["oncoming"]:
        yield f"oncoming traffic needs {lacks['oncoming']}"
    for role in scene.actors:
        # who cuts in or overtakes can also come along the oncoming lane
        passes = role.where == "lane" and role.actions and role.actions[0].what in ("cut_in", "overtake")
        if (need := lacks.get(role.where)) and (is_one_way or not passes):
            yield f"'{role}' needs {need}"
        for mark in filter(None, (role.at, *(action.at for action in role.actions))):
            if mark.number > (count := counts.get(mark.of, inf)):
                yield f"'{role}' needs {mark.of} {mark.number}, and there are {count:g}; change one of them"
