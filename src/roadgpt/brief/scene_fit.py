"""Asks of the road of a Brief what a scene needs, or refuses it if the Brief excludes that.

The tested car rolls at its speed for 4 s, then comes what happens, and then it can stop with 4 m/s2. Until
that happens, it needs no more than 6 m/s2 sideways."""

from collections.abc import Iterator, Mapping
from math import ceil, inf, pi

from roadgpt.brief.amount import Amount, at_least
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.scene import ACROSS, FLOWS, LEAVES, MOVING, USUAL_SPEEDS, Action, Role, Scene, Where
from roadgpt.errors import BriefError

ROLLS = 4.0  # s at speed before anything happens
STOPS, ASIDE = 4.0, 6.0  # m/s2: with which the tested car can stop, and that it can use sideways
SPARE = 10.0  # m, for where the tested car starts, and for its length
JUNCTION = 20.0  # m, across one
LANE = 3.5  # m from lane to lane
VERGE = 8.0  # m, from the lanes to who comes from beside them; with a median, and what starting costs
KMH = 3.6
NEEDS: Mapping[Where, str] = {
    "lane": "two lanes in its direction; write lanes=2",
    "far": "three lanes in its direction; write lanes=3",
    "oncoming": "an oncoming lane; write for example against=1",
    "ramp": "a ramp; write for example merge ramp",
    "junction": "a junction; write for example crossroads straight",
    "roundabout": "a roundabout; write for example roundabout exit=2",
    "crosswalk": "a crosswalk; write crosswalk behind a junction",
}
"""What somebody needs of the road where it is at first, and how to ask for it."""


def fitted(brief: Brief, scene: Scene, limit: float) -> Brief:
    """Returns the Brief together with what a scene needs of its road and the Brief leaves open; ``limit`` is
    the speed limit in m/s. Raises BriefError if the Brief excludes it. Where the scene does not say the speed
    of the tested car, the Brief excludes no length and no bend: the car then begins as fast as it can."""
    check_scene(scene, brief)
    needs = (scene.actors, scene.speed, scene.lane, scene.slippery, scene.turn)
    if brief.map is not None or not any(needs):
        return brief
    speed = _most(scene.speed) / KMH if scene.speed else limit
    before, stop = _until_stop(scene, speed, brief), speed**2 / 2 / STOPS
    lanes = scene.lanes_needed(brief.left_hand)
    if not brief.stretches:
        return _suited(brief, scene, lanes, speed, before, before + stop)
    places = [place for place in brief.junctions if place.kind not in (*LANE_KINDS, *RAMPS)]
    at_junction = bool(scene.turn) or any(role.where in ("junction", "roundabout") for role in scene.actors)
    first, *others = brief.stretches
    junctions = list(brief.junctions)
    if at_junction and places:
        before = until = ROLLS * speed + SPARE
        junctions[junctions.index(places[0])] = _with_way(places[0], scene)
    else:  # the car goes on straight where it can, and what is longer than the first road happens there
        until, before = before, before + stop
        is_open = not any(role.at for role in scene.actors)
        for n, (place, road) in enumerate(zip(brief.junctions, others, strict=True)):
            if is_open and place.take is None and place.kind in ("t_junction", "crossroads"):
                junctions[n] = place.model_copy(update={"take": "straight"})
            is_straight = junctions[n].take in ("straight", "main") and place.kind != "roundabout"
            if not (is_straight or place.kind in LANE_KINDS):
                break
            before -= min(_length(road).hi + JUNCTION, before)
    stretches = (_suited(first, scene, lanes, speed, until, before), *others)
    return brief.model_copy(update={"stretches": stretches, "junctions": tuple(junctions)})


def _until_stop(scene: Scene, speed: float, brief: Brief) -> float:
    """Returns how far the tested car comes until everything has happened, in metres."""
    lanes = [(road.lanes_text or "1+1").split("+") for road in brief.stretches or (brief,)]
    along, against = (max(map(int, each)) for each in zip(*lanes, strict=True))
    along = max(along, 1 + sum(scene.lanes_beside.values()))
    near, far = (LANE * (each - 0.5) + VERGE for each in (along, along + against))
    kerbs, roles = (None, "left" if brief.left_hand else "right"), scene.actors
    seconds = [ROLLS, *(_lasts(role, speed, near if role.side in kerbs else far) for role in roles)]
    named = [role.station for role in roles] + [each.station for role in roles for each in role.actions]
    named += [each.station for each in scene.slippery]
    named += [role.gap for role in roles if role.where == "oncoming"]
    return max(max(seconds) * speed, *map(_most, named), 0.0) + SPARE


def _most(amount: Amount | None) -> float:
    return 0.0 if amount is None else amount.hi or amount.lo or 0.0


def _lasts(role: Role, speed: float, across: float) -> float:
    """Returns after how many seconds what somebody does has happened; ``across`` is how many metres who comes
    from beside the road has to go if nothing is said."""
    usual = speed if role.faster or role.kind not in USUAL_SPEEDS else USUAL_SPEEDS[role.kind] / KMH
    own = _most(role.speed) / KMH if role.speed else max(usual + _most(role.faster) / KMH, 0.0)
    own *= role.kind in MOVING
    closing = speed + own if role.where == "oncoming" else speed - own
    gap = _most(role.gap) or _most(role.lead) or _most(role.headway) * speed
    meets = gap / closing if closing > 1.0 and role.where in ("ahead", "lane", "far", "oncoming") else 0.0
    if role.where in ACROSS and own > 0:
        own = span(role.speed).lo / KMH if role.speed and role.speed.lo else own
        rates = [abs(_most(each.accel)) for each in role.actions if each.accel]
        walks = (_most(role.away) or across) / own + sum(own / 2 / rate for rate in rates if rate)
        meets = max(ROLLS + 2.0, walks + 1.0)  # they are never there sooner
    lasts, now = max((_most(each.time) for each in role.actions), default=0.0) or ROLLS, own
    for action in role.actions:
        seconds, now = _takes(action, now)
        lasts += seconds
    return max(meets, lasts)


def _takes(action: Action, speed: float) -> tuple[float, float]:
    """Returns how long an action lasts in seconds, and the speed at its end."""
    seconds = _most(action.duration)
    if action.what in ("brake", "stop", "speed"):
        to = _most(action.to) / KMH
        return seconds or abs(to - speed) / (_most(action.decel) or abs(_most(action.accel)) or 3.0), to
    if action.what in ("drift", "cut_in", "cut_out", "change_lane"):
        seconds = seconds or pi / 2 * (_most(action.shift) or LANE) / (_most(action.lateral) or 1.0)
    return seconds, speed


def _with_way(place: JunctionClause, scene: Scene) -> JunctionClause:
    lights = any(each.what == "run_light" for role in scene.actors for each in role.actions)
    if scene.turn and place.take and not place.take.endswith(scene.turn):
        raise BriefError(
            f"the tested car goes {scene.turn} at the junction, and the words say {place.take}; change one of"
            " them"
        )
    if lights and place.control not in (None, "lights"):
        raise BriefError(
            f"who runs a red light needs lights, and the junction has {place.control}; write lights"
        )
    return place.model_copy(
        update={"take": place.take or scene.turn, "control": "lights" if lights else place.control}
    )


def _suited(road: Brief, scene: Scene, lanes: int, speed: float, straight: float, metres: float) -> Brief:
    """Asks of a road for lanes, a length in metres, and bends that are wide, or begin after a straight."""
    road = _drivable(road, straight, speed, scene.speed is not None)
    if lanes > 1 and span(road.lanes).lo < lanes <= span(road.lanes).hi:
        road = road.model_copy(update={"lanes": Amount(lo=lanes, hi=road.lanes and road.lanes.hi)})
    have, metres = _length(road), float(ceil(metres / 10) * 10)
    if have.hi < metres and scene.speed is not None:
        raise BriefError(
            f"at {KMH * speed:.0f} km/h the scene needs {metres:.0f} m of road to begin, to happen and to"
            f" stop, and {have.hi:g} m are asked for; ask for a longer road, or for a slower car"
        )
    if have.lo >= metres or have.hi < metres:
        return road
    return road.model_copy(update={"length": Amount(lo=metres, hi=road.length and road.length.hi)})


def _length(road: Brief) -> Range:
    """Returns the lengths that a road can have by what is asked of it, in metres."""
    if road.length is not None:
        return span(road.length)
    spans = [span(each.length) for each in road.clauses for _ in range(int(span(each.count).lo))]
    is_whole = bool(spans) and all(each.kind == "straight" for each in road.clauses)
    return Range(
        sum(max(each.lo, 0.0) for each in spans), sum(each.hi for each in spans) if is_whole else inf
    )


def _drivable(road: Brief, metres: float, speed: float, is_said: bool) -> Brief:
    """Asks for bends that the tested car can drive at its speed, or else for a straight before them."""
    radius, metres = float(ceil(speed**2 / ASIDE)), float(ceil(metres))
    turns = [each for each in road.clauses if each.kind not in STRAIGHT]
    has_straight = bool(road.clauses) and road.clauses[0].kind == "straight"
    lengths = span(road.clauses[0].length) if has_straight else Range(0.0)
    if lengths.lo >= metres or (road.clauses and not turns) or span(road.turns).hi == 0:
        return road
    if road.radius is None and road.sharpness is None and not road.hard:
        wide = {"radius": at_least(radius)}
        clauses = [
            each.model_copy(
                update=wide if each.kind == "turn" and not (each.radius or each.sharpness) else {}
            )
            for each in road.clauses
        ]
        road = road.model_copy(update={"clauses": tuple(clauses)} if turns else wide)
    found = outline(road)
    least = found.each_turn.radius
    radii = [each.feature.radius for each in found.groups if each.feature.kind == "turn"] or [least]
    if all(each and max(each.lo, (least or each).lo) >= radius * 0.98 for each in radii):
        return road
    straight = Clause(kind="straight", length=at_least(metres))
    if lengths.hi < metres or (road.starts and road.starts.kind != "straight"):
        if not is_said:
            return road
        raise BriefError(
            f"at {KMH * speed:.0f} km/h the tested car needs {metres:.0f} m before bends of less than"
            f" {radius:.0f} m radius, and the words leave less; ask for wider bends, or for a slower car"
        )
    if not road.clauses:
        return road.model_copy(update={"starts": straight})
    rest = road.clauses[1:] if has_straight else road.clauses
    return road.model_copy(update={"clauses": (straight, *rest), "starts": None})


def check_scene(scene: Scene, brief: Brief) -> None:
    """Raises BriefError if a scene needs what the Brief excludes; what the Brief leaves open is no fault."""
    if scene != Scene() and (fault := next(_faults(scene, brief), "")):
        raise BriefError(fault)


def _faults(scene: Scene, brief: Brief) -> Iterator[str]:
    roads = brief.stretches or (brief,)
    along = max(span(road.lanes).hi for road in roads)
    is_one_way = all((road.lanes_text or "1+1").endswith("+0") for road in roads)
    has = {"lane": along >= 2, "far": along >= 3, "oncoming": not is_one_way}
    counts: dict[str, float] = {}
    if brief.map is None:
        places = [place for place in brief.junctions if place.kind not in LANE_KINDS]
        kinds = {place.kind for place in places}
        has |= {"ramp": bool(kinds & {*RAMPS}), "junction": bool(kinds - {*RAMPS})}
        has |= {"roundabout": "roundabout" in kinds, "crosswalk": any(place.crosswalk for place in places)}
        turns = sum(outline(road.as_stretch).turns.hi for road in roads)
        counts = {"junction": len(places), "turn": turns}
    lacks = {name: need for name, need in NEEDS.items() if not has.get(name, True)}
    if scene.turn and "junction" in lacks:
        yield f"the tested car that goes {scene.turn} at a junction needs {lacks['junction']}"
    if scene.oncoming in FLOWS and is_one_way:
        yield f"oncoming traffic needs {lacks['oncoming']}"
    for role in scene.actors:
        # who cuts in or overtakes can also come along the oncoming lane
        passes = role.where == "lane" and role.actions and role.actions[0].what in ("cut_in", "overtake")
        if (need := lacks.get(role.where)) and (is_one_way or not passes):
            yield f"'{role}' needs {need}"
        leaves = role.where in ("ahead", "behind") and any(each.what in LEAVES for each in role.actions)
        if leaves and along < 2:
            yield f"'{role}' needs {NEEDS['lane']}"
        for mark in filter(None, (role.at, *(action.at for action in role.actions))):
            if mark.number > (count := counts.get(mark.of, inf)):
                yield f"'{role}' needs {mark.of} {mark.number}, and there are {count:g}; change one of them"
    if scene.lane and abs(scene.lane) > along:
        yield f"the tested car's lane={scene.lane} needs more lanes; write lanes={abs(scene.lane)}"
    inner, outer = scene.lanes_in_and_out(brief.left_hand)
    if scene.lane and (outer > scene.lane - 1 if scene.lane > 0 else inner > -scene.lane - 1):
        yield f"there is no lane beside the tested car's lane={scene.lane} for those who are there; change it"
    if 2 <= along < (least := scene.lanes_needed(brief.left_hand)):
        yield f"the scene needs {least} lanes in the direction of the tested car; write lanes={least}"
