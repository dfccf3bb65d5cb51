"""Asks of the road of a Brief what a scene needs, or refuses it if the Brief excludes that.

The tested car rolls at its speed for 4 s, then comes what happens, and then it can stop with 4 m/s2, or with
what a slippery surface gives, if there is room. Until that happens, it needs no more than 6 m/s2 sideways.
Where the words leave the bends open and there is room, they are those of a road that is designed for the
greatest speed of the scene, so that nobody slows down for them."""

from collections.abc import Sequence
from math import ceil, inf, pi

from roadgpt.brief.amount import Amount, at_least
from roadgpt.brief.beside import friction_of
from roadgpt.brief.design_speed import FASTEST, SLOWEST, limits_at
from roadgpt.brief.feasible import is_possible
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.scene import HEAD_ON, LEAVES, MOST_MORE, Action, Role, Scene
from roadgpt.brief.scene_places import check_scene, comes_to_junction, with_places
from roadgpt.brief.words import LENGTH_SLACK, MOTORWAY_RADIUS, ROAD_LENGTH_SLACK
from roadgpt.errors import BriefError
from roadgpt.language.table import ACROSS, MOVING, SIZES, USUAL_SPEEDS

ROLLS = 4.0  # s at speed before anything happens
STOPS, ASIDE = 4.0, 6.0  # m/s2: with which the tested car can stop, and that it can use sideways
G = 9.81  # m/s2
SPARE = 10.0  # m, for where the tested car starts, and for its length
JUNCTION = 20.0  # m, across one
LANE = 3.5  # m from lane to lane
FOR_FLOW = 250.0  # m of road, so that traffic can be seen to flow
SHORT, LONG = 7.0, 14.0  # m of a row for each who stands in it
UNCOVERED = 70.0  # m, to who is uncovered behind somebody that leaves the lane
VERGE = 8.0  # m, from the lanes to who comes from beside them; with a median, and what starting costs
LANES_OF_MOTORWAY = 2
STANDS = ("wait", "stop", "creep")  # what takes the tested car hardly any road after it has come to that
WIDEST = 250.0  # m, the radius of bends that are asked for, at most, so that everybody calls them bends
KMH = 3.6


def fitted(brief: Brief, scene: Scene, limit: float, map_size: float | None = None) -> Brief:
    """Returns the Brief together with what a scene needs of its road and the Brief leaves open; ``limit`` is
    the speed limit in m/s, ``map_size`` the side in metres of a map that is given. Raises BriefError if the
    Brief excludes it. Where the scene does not say the speed of the tested car, the Brief excludes no length
    and no bend: the car then begins as fast as it can."""
    brief = with_places(brief, scene)
    check_scene(scene, brief)
    needs = (
        scene.actors, scene.actions, scene.has_flow, scene.speed, scene.lane, scene.slippery, scene.turn,
        scene.signal, scene.roadworks,
    )  # fmt: skip
    if brief.map is not None or not any(needs):
        return brief
    speed = _most(scene.speed) / KMH if scene.speed else limit
    before, stop = _until_stop(scene, speed, limit, brief) + _most(scene.station), speed**2 / 2 / STOPS
    lanes = scene.lanes_needed(brief.left_hand)
    if not brief.stretches:
        grip = G * (friction_of((*scene.surfaces, *brief.beside)) or 1.0)
        slides = before + speed**2 / 2 / min(STOPS, grip)
        side, far = map_size or brief.map_size, max(_until_met(scene, speed), slides)
        suited = _suited(brief, scene, lanes, speed, before, before + stop, side, far)
        return _surely_as_long(suited, _told(scene, speed, limit) + _most(scene.station) + SPARE)
    places = [each for each in brief.junctions if each.kind not in (*LANE_KINDS, *RAMPS)]
    crosses = any(role.where == "crosswalk" for role in scene.actors)
    places = places or [each for each in brief.junctions if each.kind == "crosswalk" and crosses]
    at_junction = bool(scene.turn) or any(
        comes_to_junction(role) or role.where in ("roundabout", "crosswalk") for role in scene.actors
    )
    first, *others = brief.stretches
    behind = before - ROLLS * speed - JUNCTION  # what may be needed of the road behind a junction
    junctions = list(brief.junctions)
    if at_junction and places:
        before = until = before if crosses else ROLLS * speed + SPARE
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
    acts = [*scene.actions, *(each for role in scene.actors for each in role.actions)]
    late = [each for each in acts if each.time or each.distance]
    if late or any(role.where in ("crossing", "beside") for role in scene.actors):
        others[0] = _as_long(others[0], min(behind, _length(others[0]).hi))
    stretches = (_suited(first, scene, lanes, speed, until, before), *others)
    return brief.model_copy(update={"stretches": stretches, "junctions": tuple(junctions)})


def _until_stop(scene: Scene, speed: float, limit: float, brief: Brief) -> float:
    """Returns how far the tested car comes until everything has happened, in metres."""
    lanes = [(road.lanes_text or "1+1").split("+") for road in brief.stretches or (brief,)]
    along, against = (max(map(int, each)) for each in zip(*lanes, strict=True))
    along = max(along, 1 + sum(scene.lanes_beside.values()))
    near, far = (LANE * (each - 0.5) + VERGE for each in (along, along + against))
    kerbs, roles = (None, "left" if brief.left_hand else "right"), scene.actors
    seconds = [ROLLS, *(_lasts(role, speed, near if role.side in kerbs else far) for role in roles)]
    moves = [each for each in scene.actions if each.what not in STANDS]
    seconds.append(_ends(moves, speed))
    gaps = [role.gap for role in roles if role.where == "oncoming"]
    longest = max(_length(road).hi for road in brief.stretches or (brief,))
    least = FOR_FLOW if scene.has_flow and longest > FOR_FLOW + SPARE + speed**2 / 2 / STOPS else 0.0
    return (
        max(max(seconds) * speed, _told(scene, speed, limit), *map(_most, gaps), least)
        + sum(map(_row, roles))
        + SPARE
    )


def _told(scene: Scene, speed: float, limit: float) -> float:
    """Returns the last of the places along the road that a scene tells, in metres."""
    acts = [each for role in scene.actors for each in role.actions]
    every = (*scene.actions, *acts, *scene.slippery, *scene.actors)
    ends = [_most(getattr(each, name, None)) for each in every for name in ("station", "distance")]
    for each in scene.roadworks:
        first = _most(each.station) or ROLLS * speed
        ends.append(each.stations(first, _most(each.length), LANE, limit)[-1])
    return max(ends, default=0.0)


def _until_met(scene: Scene, speed: float) -> float:
    """Returns from how far somebody comes towards the tested car who gets into its lane, in metres: as far as
    they drive until the car has rolled and that has happened. A shorter road will do."""
    found = [0.0]
    for role in scene.actors:
        whats = [each.what for each in role.actions[:1]]
        if role.where == "oncoming" and whats and whats[0] in HEAD_ON and not role.gap and not role.station:
            own = _most(role.speed) / KMH if role.speed else speed
            found.append((speed + own) * (ROLLS + 1.0 + pi / 2 * LANE) + SPARE)  # sideways with 1 m/s
    return max(found)


def _row(role: Role) -> float:
    """Returns how many metres several alike in the tested car's lane are long, and what is uncovered."""
    count = (role.count.hi or span(role.count).lo + MOST_MORE) if role.where == "ahead" else 1
    one = LONG if SIZES[role.kind].length > SHORT else SHORT
    leaves = bool(role.actions) and role.actions[0].what in LEAVES
    return (count - 1) * one + leaves * UNCOVERED


def _most(amount: Amount | None) -> float:
    return 0.0 if amount is None else amount.hi or amount.lo or 0.0


def _lasts(role: Role, speed: float, across: float) -> float:
    """Returns after how many seconds what somebody does has happened; ``across`` is how many metres who comes
    from beside the road has to go if nothing is said."""
    usual = speed if role.faster or role.kind not in USUAL_SPEEDS else USUAL_SPEEDS[role.kind] / KMH
    own = _most(role.speed) / KMH if role.speed else max(usual + _most(role.faster) / KMH, 0.0)
    own *= role.kind in MOVING
    comes = role.where == "oncoming" or any(each.what == "wrong_way" for each in role.actions[:1])
    closing = speed + own if comes else speed - own
    gap = _most(role.gap) or _most(role.lead) or _most(role.headway) * speed
    meets = gap / closing if closing > 1.0 and role.where in ("ahead", "lane", "far", "oncoming") else 0.0
    if role.where in ACROSS and own > 0:
        own = span(role.speed).lo / KMH if role.speed and role.speed.lo else own
        own = _most(role.actions[0].to) / KMH or own if role.actions else own
        rates = [abs(_most(each.accel)) for each in role.actions if each.accel]
        walks = (_most(role.away) or across) / own + sum(own / 2 / rate for rate in rates if rate)
        walks = _most(role.actions[0].ttc) or walks if role.actions else walks
        meets = max(ROLLS + 2.0, walks + 1.0)  # they are never there sooner
    return max(meets, _ends(role.actions, own))


def _ends(actions: Sequence[Action], speed: float) -> float:
    """Returns after how many seconds somebody of a speed has done one thing after another."""
    lasts = max((_most(each.time) for each in actions), default=0.0) or ROLLS
    for action in actions:
        seconds, speed = _takes(action, speed)
        lasts += seconds
    return lasts


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
    if scene.turn and place.take and not place.take.endswith(scene.turn):
        raise BriefError(
            f"the tested car goes {scene.turn} at the junction, and the words say {place.take}; change one of"
            " them"
        )
    return place.model_copy(update={"take": place.take or scene.turn})


def _suited(
    road: Brief, scene: Scene, lanes: int, speed: float, straight: float, metres: float,
    map_size: float | None = None, far: float = 0.0,
) -> Brief:  # fmt: skip
    """Asks of a road for lanes, a length in metres, if there is room of ``far`` metres, and bends that are
    wide, or begin after a straight."""
    easy = _with_radius(road, _easy_radius(road, scene, speed))
    far = far if metres < far < _length(road).hi - 10.0 else metres
    for each, length in ((easy, far), (easy, metres), (road, far)):
        if (each, length) != (road, metres):
            asked = _long_enough(each, scene, lanes, speed, straight, length)
            if is_possible(asked, map_size, 0.0):
                return asked
    return _long_enough(road, scene, lanes, speed, straight, metres)


def _long_enough(
    road: Brief, scene: Scene, lanes: int, speed: float, straight: float, metres: float
) -> Brief:
    road = _drivable(road, straight, speed, scene.speed is not None)
    lanes = max(lanes, LANES_OF_MOTORWAY) if road.motorway and road.lanes is None else lanes
    if lanes > 1 and span(road.lanes).lo < lanes <= span(road.lanes).hi:
        road = road.model_copy(update={"lanes": Amount(lo=lanes, hi=road.lanes and road.lanes.hi)})
    have, need = _length(road), ceil(metres / 10) * 10
    if have.hi < need and scene.speed is not None:
        raise BriefError(
            f"at {KMH * speed:.0f} km/h the scene needs {need} m of road to begin, to happen and to"
            f" stop, and {have.hi:g} m are asked for; ask for a longer road, or for a slower car"
        )
    return _as_long(road, metres)


def _surely_as_long(road: Brief, metres: float) -> Brief:
    """Asks of a road for a length in metres that it has but for the slack of lengths that are told."""
    least, slack = _length(road).lo, ROAD_LENGTH_SLACK if road.length else LENGTH_SLACK
    if not least * (1 - slack) < metres <= least:
        return road
    return road.model_copy(update={"length": Amount(lo=metres, hi=road.length and road.length.hi)})


def _as_long(road: Brief, metres: float) -> Brief:
    """Asks of a road for a length in metres, if it can have that."""
    have, metres = _length(road), float(ceil(metres / 10) * 10)
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


def _easy_radius(road: Brief, scene: Scene, speed: float) -> float:
    """Returns the least radius in metres of a road for the greatest speed of a scene; 0 if the words say what
    road it is."""
    turns = [each for each in road.clauses if each.kind not in STRAIGHT]
    is_straight = (road.clauses and not turns) or span(road.turns).hi == 0
    if road.surroundings is not None or road.speed is not None or is_straight:
        return 0.0
    kmh = max(KMH * speed, *(_most(role.speed) for role in scene.actors if role.where not in ACROSS), 0.0)
    radius = float(ceil(limits_at(min(max(kmh, SLOWEST), FASTEST)).radius))
    if road.motorway:
        return max(radius, MOTORWAY_RADIUS)
    is_open = not road.clauses and road.turns in (None, at_least(1))
    return radius if is_open else min(radius, WIDEST)


def _with_radius(road: Brief, radius: float) -> Brief:
    """Asks for a least radius of the turns of which nothing is said."""
    if not radius or road.radius is not None or road.sharpness is not None or road.hard:
        return road
    wide = {"radius": at_least(radius)}
    turns = [each for each in road.clauses if each.kind not in STRAIGHT]
    clauses = [
        each.model_copy(update=wide if each.kind == "turn" and not (each.radius or each.sharpness) else {})
        for each in road.clauses
    ]
    return road.model_copy(update={"clauses": tuple(clauses)} if turns else wide)


def _drivable(road: Brief, metres: float, speed: float, is_said: bool) -> Brief:
    """Asks for bends that the tested car can drive at its speed, or else for a straight before them."""
    radius, metres = float(ceil(speed**2 / ASIDE)), float(ceil(metres))
    turns = [each for each in road.clauses if each.kind not in STRAIGHT]
    has_straight = bool(road.clauses) and road.clauses[0].kind == "straight"
    lengths = span(road.clauses[0].length) if has_straight else Range(0.0)
    if lengths.lo >= metres or (road.clauses and not turns) or span(road.turns).hi == 0:
        return road
    road = _with_radius(road, radius)
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
