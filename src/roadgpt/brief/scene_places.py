"""Gives a Brief the places that the actors of a scene need and its words leave open: junctions, ramps and
crosswalks that it does not name, behind its last road, and at its first junction the arms, the way and the
signs with which those who come from another arm meet the tested car."""

from collections.abc import Iterator, Mapping, Sequence
from typing import get_args

from roadgpt.brief.amount import meets, span
from roadgpt.brief.junction_check import check_junction
from roadgpt.brief.junctions import (
    ARMS,
    LANE_KINDS,
    RAMPS,
    Control,
    JunctionClause,
    JunctionKind,
    Take,
    Way,
)
from roadgpt.brief.model import OF_THE_WORDS, Brief, at_least, exactly
from roadgpt.brief.outline import outline
from roadgpt.brief.scene import FLOWS, Role, Scene, What
from roadgpt.errors import BriefError

LR = ("left", "right")
MEETS: Mapping[What, Mapping[str, Sequence[str]]] = {
    "cross": {"straight": LR, "left": (*LR, "opposite"), "right": ("left",)},
    "run_light": {"straight": LR, "left": LR, "right": ("left",)},
    "run_sign": {"straight": LR, "left": LR, "right": ("left",)},
    "turn_in": {"straight": LR, "left": ("opposite",), "right": ("opposite",)},
    "turn_across": {"straight": ("opposite", "right"), "left": (*LR, "opposite"), "right": ("opposite",)},
}
"""The arms from which somebody meets the tested car in traffic on the right, by what it does and where the
car goes. Of traffic on the left, it is the mirror image."""
MIRRORED = {"left": "right", "right": "left"}
LEAVING = ("ahead", "behind", "lane", "far")


def with_places(brief: Brief, scene: Scene) -> Brief:
    """Returns the Brief with the places that a scene needs and that the Brief lacks, and with the lanes and
    turns that it needs. Raises BriefError if somebody cannot meet the tested car where that goes."""
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
    if plain:
        junctions[plain[0]] = _met(junctions[plain[0]], scene, brief.left_hand)
    return brief.model_copy(update={"junctions": tuple(junctions)})


def comes_to_junction(role: Role) -> bool:
    """Returns whether somebody comes from another arm of a junction, or leaves the road there."""
    does = {each.what for each in role.actions}
    is_along = role.where in LEAVING and "turn_off" in does
    return role.where == "junction" or is_along or (role.where == "oncoming" and "turn_across" in does)


def _lacking(brief: Brief, scene: Scene) -> Iterator[JunctionClause]:
    kinds = [place.kind for place in brief.junctions]
    wheres = [role.where for role in scene.actors]
    if "ramp" in wheres and not any(each.kind == "merge" and each.take != "ramp" for each in brief.junctions):
        yield JunctionClause(kind="merge", take="main")
    if "roundabout" in wheres and "roundabout" not in kinds:
        yield JunctionClause(kind="roundabout", take="straight")
        kinds.append("roundabout")
    has_junction = any(kind not in (*LANE_KINDS, *RAMPS) for kind in kinds)
    if leaving := [role for role in scene.actors if comes_to_junction(role) and role.where in LEAVING]:
        sides = {each.side for role in leaving for each in role.actions if each.what == "turn_off"} - {None}
        if not has_junction and "diverge" not in kinds and len(sides) < 2:
            side: Way = "left" if sides == {"left"} or (not sides and brief.left_hand) else "right"
            ways: tuple[Way, ...] = (side, "straight")
            yield JunctionClause(kind="t_junction", take="straight", ways=ways, control="priority")
            has_junction = True
    is_met = any(map(comes_to_junction, scene.actors))
    if (is_met or scene.turn or "crosswalk" in wheres) and not has_junction:
        yield JunctionClause(kind="crossroads", take=scene.turn or (None if is_met else "straight"))
        kinds.append("crossroads")
    if _most(scene, "junction") and not any(kind not in LANE_KINDS for kind in kinds):
        yield JunctionClause(kind="crossroads", take="straight")


def _most(scene: Scene, of: str) -> int:
    """Returns how many turns or junctions a scene names."""
    named = [mark for role in scene.actors for mark in (role.at, *(each.at for each in role.actions)) if mark]
    return max((abs(mark.number) for mark in named if mark.of == of), default=0)


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
    roads = (first, *rest)
    if comes and not any(place.take == "ramp" for place in brief.junctions):
        has_ramp = any(place.kind in RAMPS for place in brief.junctions)
        roads = tuple(
            each.model_copy(update={"divided": True})
            if (each.motorway or has_ramp) and each.against is None
            else each
            for each in roads
        )
    return brief.model_copy(update={"stretches": roads}) if rest else roads[0]


def _with_place(brief: Brief, place: JunctionClause) -> Brief:
    """Returns a Brief with a place behind its last road."""
    if brief.junctions:
        update = {"junctions": (*brief.junctions, place), "stretches": (*brief.stretches, Brief())}
        return brief.model_copy(update=update)
    whole = (*OF_THE_WORDS, "left_hand", "comes_from")
    fields = {name: getattr(brief, name) for name in whole}
    road = brief.model_copy(update={name: Brief.model_fields[name].default for name in whole})
    return Brief(**fields, junctions=(place,), stretches=(road, Brief()))


def _met(place: JunctionClause, scene: Scene, left_hand: bool) -> JunctionClause:
    """Returns what is asked of a junction at which somebody meets the tested car."""
    roles = [role for role in scene.actors if comes_to_junction(role)]
    told = scene.turn or (place.take or "").rpartition("_")[2] or None
    is_clear = not (scene.turn and place.take) or place.take.endswith(scene.turn)
    if not roles or not is_clear or place.kind == "roundabout" or told in ("back", "ramp", "main"):
        return place
    takes: list[Take] = [place.take or told] if told else [None, "straight", "left", "right"]  # type: ignore[list-item]
    for take in takes:
        asked = _with_arms(place, take, roles, left_hand)
        if asked is not None:
            return asked
    role = next(each for each in roles if not told or _with_arms(place, takes[0], [each], left_hand) is None)
    where = f"goes {told}" if told else "goes on"
    raise BriefError(
        f"'{role}' cannot meet a tested car that {where} at a {place.name}{_signs(place)}; change one of them"
    )


def _signs(place: JunctionClause) -> str:
    return f" with {place.control}" if place.control not in (None, "none") else ""


def _with_arms(
    place: JunctionClause, take: Take | None, roles: Sequence[Role], left_hand: bool
) -> JunctionClause | None:
    """Returns a junction at which the tested car goes one way, or any, and all these meet it; None if there
    is none. A T-junction gets its two ways on, and a junction of an open kind becomes a crossroads if it can.
    """
    arms, control = set[str](), place.control
    ways = [take.rpartition("_")[2]] if take else ["straight", "left", "right"]
    for role in roles:
        what: What = next((each.what for each in role.actions if each.what in MEETS), "cross")
        if role.where in LEAVING:
            sides = {each.side for each in role.actions if each.what == "turn_off"} - {None}
            if sides & {*ways}:
                return None
            arms.update(map(str, sides))
            continue
        side = "opposite" if role.where == "oncoming" else str(role.side or "")
        is_fork = what == "turn_in" and place.kind == "y_junction"
        possible = [_from("cross" if is_fork else what, way, left_hand) for way in ways]
        if any((side not in each) if side else not each for each in possible):
            return None
        side = side or possible[0][0]
        arms.add(side)
        if what == "turn_across" and side == "opposite" and ways == ["straight"]:
            arms.add("left" if left_hand else "right")
        if what == "run_sign":
            gives_way = (
                "right" if left_hand else "left"
            )  # where nothing stands, to who comes from the other side
            if control not in (None, "priority") and (control != "none" or side != gives_way):
                return None
            control = control or "priority"
        if what == "run_light":
            if control not in (None, "lights"):
                raise BriefError(
                    f"who runs a red light needs lights, and the junction has {control}; write lights"
                )
            control = "lights"
    arms = {"straight" if arm == "opposite" else arm for arm in arms}
    return _of_kind(place, take, arms | ({*ways} if take else set()), control)


def _from(what: What, way: str, left_hand: bool) -> list[str]:
    if not left_hand:
        return list(MEETS[what][way])
    return [MIRRORED.get(side, side) for side in MEETS[what][MIRRORED.get(way, way)]]


def _of_kind(
    place: JunctionClause, take: Take | None, arms: set[str], control: Control | None
) -> JunctionClause | None:
    asked = place.model_copy(update={"take": take, "control": control})
    if place.kind == "junction" and not place.ways and (take is None or take in get_args(Way)):
        kinds: tuple[JunctionKind, ...] = ("crossroads", "t_junction")
        fit = [kind for kind in kinds if meets(place.arms, ARMS[kind])]
        found = (_of_kind(asked.model_copy(update={"kind": kind}), take, arms, control) for kind in fit)
        return next((each for each in found if each is not None), None if fit else asked)
    if place.kind == "y_junction" and "straight" in arms:
        return None
    if place.kind == "t_junction" and not place.ways:
        more = [each for each in (MIRRORED.get(str(take)), "straight", "left", "right") if each]
        ways = list(dict.fromkeys([*sorted(arms), *more]))[: max(len(arms), 2)]
        asked = asked.model_copy(update={"ways": tuple(sorted(ways, key=get_args(Way).index))})
    elif place.kind == "t_junction" and not arms <= {*place.ways}:
        return None
    try:
        check_junction(asked)
    except BriefError:
        return None
    return asked
