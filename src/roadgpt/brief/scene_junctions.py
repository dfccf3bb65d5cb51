"""Finds the junction at which others meet the tested car: the arms, the way and the signs that words about it
leave open."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, get_args

from roadgpt.brief.amount import meets
from roadgpt.brief.junction_check import faults_of_junction
from roadgpt.brief.junctions import ARMS, SIGNS, JunctionClause
from roadgpt.brief.scene import Role
from roadgpt.errors import BriefError
from roadgpt.language.names import JunctionKind, Take, Way

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
