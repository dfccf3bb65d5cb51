"""Gives a Brief the places that the actors of a scene need and its words leave open: lanes, turns, and
junctions, ramps and crosswalks that it does not name, behind its last road; and of a junction at which others
meet the tested car the arms, the way and the signs. Finds what a scene needs and a Brief excludes."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import inf
from typing import Any, get_args

from roadgpt.brief.amount import meets, span
from roadgpt.brief.junctions import ARMS, LANE_KINDS, RAMPS, SIGNS, JunctionClause
from roadgpt.brief.model import OF_THE_WORDS, Brief, at_least, exactly
from roadgpt.brief.outline import outline
from roadgpt.brief.scene import LEAVES, Action, Role, Scene
from roadgpt.errors import BriefError
from roadgpt.language.names import Control, JunctionKind, Take, Way, Where
from roadgpt.language.table import FLOWS, MANEUVERS

AROUND = ("back", "right", "straight", "left")
"""The arms of a crossroads, from that of the tested car on against the clock."""
TWO_WAYS: tuple[tuple[Way, ...], ...] = (("left", "right"), ("left", "straight"), ("right", "straight"))
"""The ways on at a T-junction; where one turns, the own road usually ends."""
LEAVING = ("ahead", "behind", "lane", "far")


def comes_to_junction(role: Role) -> bool:
    """Returns whether somebody comes from another arm of a junction, or leaves the road there."""
    is_along = role.where in LEAVING and any(each.what == "turn_off" for each in role.actions)
    return role.where == "junction" or is_along or (role.where == "oncoming" and role.goes == "turn_across")


def met(place: JunctionClause, roles: Sequence[Role], turn: Way | None, left_hand: bool) -> JunctionClause:
    """Returns what is asked of a junction to which others come: of what its words leave open, that with which
    most of them meet the tested car. Raises BriefError if somebody cannot come there at all."""
    told = place.take or turn
    is_clear = (told or "").endswith(turn or "") and told not in ("back", "ramp", "main")
    if place.kind == "roundabout" or not is_clear:
        return place
    found = possible = list(_possible(place.model_copy(update=_signs(place, roles)), told))
    if not found:
        return place
    for n, role in enumerate(roles):
        alone = [each for each in possible if max(_meets(role, each, left_hand))]
        if not (found := [each for each in found if each in alone]):
            on = f" that leads {' and '.join(place.ways)}" if place.ways else ""
            beside = f", and a road for '{roles[n - 1]}' beside it" if alone else ""
            raise BriefError(
                f"there is no road for '{role}' at a {place.name}{on} where the tested car goes"
                f" {told or 'on'}{beside}; change one of them"
            )
    return max(found, key=lambda each: sum(min(_meets(role, each, left_hand)) for role in roles))


def _signs(place: JunctionClause, roles: Sequence[Role]) -> dict[str, Any]:
    """Returns the signs or lights of a junction at which somebody disregards those of its own."""
    control, all_way = place.control, place.all_way
    for role in roles:
        whats = {each.what for each in role.actions}
        runs = "run_light" in whats
        if not runs and ("run_sign" not in whats or role.side == "opposite"):
            continue
        control = control or ("lights" if runs else "priority")
        if (control == "lights") != runs:
            needs = "lights" if runs else "a sign, or none"
            has = f"the junction has {SIGNS[control]}"
            raise BriefError(f"'{role}' needs {needs}, and {has}; change one of them")
        all_way |= control in ("stop", "yield")
    return {"control": control, "all_way": all_way}


def _possible(place: JunctionClause, told: Take | None) -> Iterator[JunctionClause]:
    """Yields the junctions that the words about one can mean, by its kind, the way taken and the ways on."""
    from roadgpt.brief.junction_check import faults_of_junction

    kinds: tuple[JunctionKind, ...] = (place.kind,)
    if place.kind == "junction":
        kinds = ("t_junction", "crossroads", "star") if place.ways else ("crossroads", "t_junction", "star")
    for kind, take in product(kinds, (told,) if told else (None, *get_args(Way))):
        for ways in TWO_WAYS if kind == "t_junction" and not place.ways else (place.ways,):
            out = tuple(each for each in ways if each not in place.only_in)
            asked = place.model_copy(update={"kind": kind, "take": take, "ways": out})
            if meets(place.arms, ARMS[kind]) and not any(faults_of_junction(asked)):
                yield asked


def _meets(role: Role, place: JunctionClause, left_hand: bool) -> list[int]:
    """Returns for each way on of the tested car whether somebody meets it (2), only comes there (1), or
    cannot come there (0)."""
    every: tuple[str, ...] = get_args(Way)
    arms = {"y_junction": every[:2], "t_junction": (*place.ways, *place.only_in)}.get(place.kind, every)
    out = [each for each in place.ways or arms if each not in place.only_in]
    into = [each for each in arms if each not in place.only_out]
    return [
        max((1 + _cross(("back", way), path, left_hand) for path in _paths(role, way, into, out)), default=0)
        for way in ([place.take.rpartition("_")[2]] if place.take else out)
    ]


def _paths(role: Role, way: str, into: Sequence[str], out: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yields the arms from which and to which somebody can come, where the tested car goes one way on."""
    sides = {each.side for each in role.actions if each.what == "turn_off"} - {None}
    if role.where in LEAVING:
        yield from (("back", each) for each in out if (each in sides if sides else each != way))
        return
    side = "straight" if role.side == "opposite" or role.where == "oncoming" else role.side
    is_open = side is None or (role.where == "oncoming" and side not in into)
    for begin in (each for each in into if is_open or each == side):
        ends, on = [each for each in ("back", *out) if each != begin], AROUND[AROUND.index(begin) - 2]
        if role.goes == "turn_in":
            ends = [way] * (way != begin)
        elif role.goes == "turn_across":
            ends = [each for each in ends if (each in sides if sides else each != on)]
        elif on in ends:
            ends = [on]
        yield from ((begin, end) for end in ends)


def _cross(one: tuple[str, str], other: tuple[str, str], left_hand: bool) -> bool:
    """Returns whether two paths, each from an arm to an arm, cross, become one or begin as one."""
    if one[0] == other[0] or one[1] == other[1]:
        return one != other
    low, high, *its = (
        2 * AROUND.index(arm) + ((n == 0) != left_hand) for path in (one, other) for n, arm in enumerate(path)
    )
    low, high = min(low, high), max(low, high)
    return (low < its[0] < high) != (low < its[1] < high)


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
    junctions = list(brief.junctions)
    plain = [n for n, place in enumerate(junctions) if place.kind not in (*LANE_KINDS, *RAMPS)]
    if (
        plain
        and _needs_crosswalk(scene)
        and not any(place.crosswalk or place.kind == "crosswalk" for place in junctions)
    ):
        junctions[plain[0]] = junctions[plain[0]].model_copy(update={"crosswalk": True})
    for (control, *fits), why in _controls(scene) if plain else ():
        if not {junctions[n].control for n in plain} & {control, *fits}:
            first_open = next((n for n in plain if junctions[n].control is None), None)
            if first_open is None:
                raise BriefError(
                    f"{why}, and no junction of the road has {control}; write {control} there instead of "
                    f"{junctions[plain[0]].control}"
                )
            junctions[first_open] = junctions[first_open].model_copy(update={"control": control})
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
    if (is_met or scene.turn or [*_controls(scene)]) and not has_junction:
        yield JunctionClause(kind="crossroads", take=scene.turn or (None if is_met else "straight"))
        kinds.append("crossroads")
    elif _needs_crosswalk(scene) and not has_junction and "crosswalk" not in kinds:
        yield JunctionClause(kind="crosswalk")
    if _most(scene, "junction") and not any(kind not in LANE_KINDS for kind in kinds):
        yield JunctionClause(kind="crossroads", take="straight")


def _needs_crosswalk(scene: Scene) -> bool:
    return any(role.where == "crosswalk" for role in scene.actors) or _most(scene, "crosswalk") > 0


def _controls(scene: Scene) -> Iterator[tuple[tuple[Control, ...], object]]:
    """Yields the signs or lights of which the first junctions need one, and why."""
    if scene.lights:
        yield ("lights",), scene.lights
    if any(each.what == "run_sign" for each in scene.actions):
        yield ("yield", "stop"), f"the tested car {MANEUVERS['run_sign'].said}"


def _most(scene: Scene, of: str) -> int:
    """Returns how many turns or junctions a scene names."""
    return max((abs(mark.number) for mark in scene.marks if mark.of == of), default=0)


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
    acting: tuple[Role | Action, ...] = (*scene.actors, *scene.actions)
    for who, marks in ((each, each.marks) for each in acting):
        for mark in marks:
            if mark.number > (count := counts.get(mark.of, inf)):
                yield f"'{who}' needs {mark.of} {mark.number}, and there are {count:g}; change one of them"
    if scene.lane and abs(scene.lane) > along:
        yield f"the tested car's lane={scene.lane} needs more lanes; write lanes={abs(scene.lane)}"
    inner, outer = scene.lanes_in_and_out(brief.left_hand)
    if scene.lane and (outer > scene.lane - 1 if scene.lane > 0 else inner > -scene.lane - 1):
        yield f"there is no lane beside the tested car's lane={scene.lane} for those who are there; change it"
    if 2 <= along < (least := scene.lanes_needed(brief.left_hand)):
        yield f"the scene needs {least} lanes in the direction of the tested car; write lanes={least}"
