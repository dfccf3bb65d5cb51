"""Gives a Brief the places that the actors of a scene need and its words leave open: lanes, turns, and
junctions, ramps and crosswalks that it does not name, behind its last road."""

from collections.abc import Iterator

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import OF_THE_WORDS, Brief, at_least, exactly
from roadgpt.brief.outline import outline
from roadgpt.brief.scene import Role, Scene
from roadgpt.brief.scene_junctions import LEAVING, comes_to_junction, met
from roadgpt.language.names import Way
from roadgpt.language.table import FLOWS


def with_places(brief: Brief, scene: Scene) -> Brief:
    """Returns the Brief with the places that a scene needs and that the Brief lacks, and with the lanes and
    turns that it needs. Raises BriefError if somebody cannot come to its first junction."""
    if brief.map is not None:
        return brief
    brief = _with_lanes(brief, scene)
    for place in _lacking(brief, scene):
        brief = _with_place(brief, place)
    first, *rest = brief.stretches or (brief,)
    most, turns = _most(scene, "turn"), sum(outline(each.as_stretch).turns.lo for each in (first, *rest))
    if turns < most <= span(first.turns).hi and first.has_free_shape:
        first = first.model_copy(update={"turns": at_least(most)})
        brief = brief.model_copy(update={"stretches": (first, *rest)}) if rest else first
    crossed = any(role.where == "crosswalk" for role in scene.actors)
    junctions = list(brief.junctions)
    plain = [n for n, place in enumerate(junctions) if place.kind not in (*LANE_KINDS, *RAMPS)]
    if plain and crossed and not any(place.crosswalk for place in junctions):
        junctions[plain[0]] = junctions[plain[0]].model_copy(update={"crosswalk": True})
    numbered = [n for n, place in enumerate(junctions) if place.kind not in LANE_KINDS]
    come: dict[int, list[Role]] = {}
    for role in filter(comes_to_junction, scene.actors if plain else ()):
        marks = [mark for mark in role.marks if mark.of == "junction"]
        named = [each.number - (each.number > 0) + (each.word == "after") for each in marks]
        there = [numbered[each] for each in named if -len(numbered) <= each < len(numbered)]
        come.setdefault((there or plain)[0], []).append(role)
    for n, roles in come.items():
        junctions[n] = met(junctions[n], roles, scene.turn if n == plain[0] else None, brief.left_hand)
    return brief.model_copy(update={"junctions": tuple(junctions)})


def _lacking(brief: Brief, scene: Scene) -> Iterator[JunctionClause]:
    kinds = [place.kind for place in brief.junctions]
    wheres = [role.where for role in scene.actors]
    if "ramp" in wheres and not any(each.kind == "merge" and each.take != "ramp" for each in brief.junctions):
        yield JunctionClause(kind="merge", take="main")
    if "roundabout" in wheres and "roundabout" not in kinds:
        yield JunctionClause(kind="roundabout", take="straight")
        kinds.append("roundabout")
    has_junction = any(kind not in (*LANE_KINDS, *RAMPS) for kind in kinds)
    leaving = [role for role in scene.actors if comes_to_junction(role) and role.where in LEAVING]
    sides = {each.side for role in leaving for each in role.actions if each.what == "turn_off"} - {None}
    if leaving and not has_junction and "diverge" not in kinds and len(sides) < 2:
        side: Way = "left" if sides == {"left"} or (not sides and brief.left_hand) else "right"
        yield JunctionClause(kind="t_junction", take="straight", ways=(side, "straight"), control="priority")
        has_junction = True
    is_met = any(map(comes_to_junction, scene.actors))
    if (is_met or scene.turn or "crosswalk" in wheres) and not has_junction:
        yield JunctionClause(kind="crossroads", take=scene.turn or (None if is_met else "straight"))
        kinds.append("crossroads")
    if _most(scene, "junction") and not any(kind not in LANE_KINDS for kind in kinds):
        yield JunctionClause(kind="crossroads", take="straight")


def _most(scene: Scene, of: str) -> int:
    """Returns how many turns or junctions a scene names."""
    marks = [mark for role in scene.actors for mark in role.marks]
    return max((abs(mark.number) for mark in marks if mark.of == of), default=0)


def _with_lanes(brief: Brief, scene: Scene) -> Brief:
    """Returns the Brief with both directions where somebody comes towards the tested car on a motorway, and
    with a second lane where somebody overtakes it on a one-way road, as far as the Brief leaves them open."""
    comes = any(role.where == "oncoming" for role in scene.actors) or scene.oncoming in FLOWS
    passes = any(
        role.where == "behind" and each.what == "overtake" for role in scene.actors for each in role.actions
    )
    first, *rest = brief.stretches or (brief,)
    if passes and first.against == exactly(0) and first.lanes is None:
        first = first.model_copy(update={"lanes": at_least(2)})
    roads, has_ramp = [first, *rest], any(place.kind in RAMPS for place in brief.junctions)
    if comes and not any(place.take == "ramp" for place in brief.junctions):
        main = {"take": "main"}  # ramps have no oncoming lanes
        places = [place.model_copy(update=main if place.kind in RAMPS else {}) for place in brief.junctions]
        brief = brief.model_copy(update={"junctions": tuple(places)})
        for n, road in enumerate(roads):
            if (road.motorway or has_ramp) and road.against is None:
                roads[n] = road.model_copy(update={"divided": True})
    return brief.model_copy(update={"stretches": tuple(roads)}) if rest else roads[0]


def _with_place(brief: Brief, place: JunctionClause) -> Brief:
    """Returns a Brief with a place behind its last road."""
    if brief.junctions:
        update = {"junctions": (*brief.junctions, place), "stretches": (*brief.stretches, Brief())}
        return brief.model_copy(update=update)
    whole = (*OF_THE_WORDS, "left_hand", "comes_from")
    fields = {name: getattr(brief, name) for name in whole}
    road = brief.model_copy(update={name: Brief.model_fields[name].default for name in whole})
    return Brief(**fields, junctions=(place,), stretches=(road, Brief()))
