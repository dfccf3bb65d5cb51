"""Says who had the way in a collision, which offences each of the two committed, and whose fault it was.

Sources: Vienna Convention on Road Traffic, 1968, and, for coming into another's lane, UN R79, 5.6.4.7: who is
behind must not have to brake with more than 3 m/s2, begun after 0.4 s, to keep a distance of 1 s. Offences at
junctions are those of ``verdict.right_of_way``, for both alike; ``docs/explanation/traffic.md`` has all.

At fault is whose offence has to do with the contact, and the tested car also where it brought the collision
about itself (``verdict.avoidable``). That one could have braked in time is no offence, and things and animals
commit none.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.geometry.boxes import CORNER
from roadgpt.geometry.curve import Array
from roadgpt.language.table import PERSONS, VEHICLES
from roadgpt.network import legs_of, network_of, only_road
from roadgpt.network.lanes import lanes_of
from roadgpt.network.line import Boxes, Line
from roadgpt.network.markings import CROSSED
from roadgpt.traffic.actor import HEADING, SPEED, STEP, STILL, X, Y
from roadgpt.verdict.criteria import OVER, OVER_BY, STOOD, STOP_WITHIN, TOO_FAST, limits_at
from roadgpt.verdict.measures import ACROSS, measure
from roadgpt.verdict.right_of_way import LATER, who_drives
from roadgpt.verdict.verdict import STANDS, Contact, Fault, Incident, Law, Offence, Party

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

LIABLE = (*VEHICLES, *PERSONS)
BEFORE = 15.0  # m before a junction, within which its lines lie
RECENT = 3.0  # s before the contact
TURNS = np.pi / 9  # a turn, of the tested car or of its way through a junction
BACKS = 0.5  # s: more than rolling back
BEGINS, BRAKES, APART = 0.4, 3.0, 1.0  # UN R79, 5.6.4.7: s, m/s^2, s

Found = tuple[Party | None, set[Offence], set[Offence]]
"""Who had the way, and the offences of the tested car and of the other."""


def law_of(road: "Road", drive: "Drive", world: "World", incidents: Sequence[Incident]) -> Law:
    """Returns what the law says of the first collision among the incidents."""
    hit = next(each for each in incidents if each.contact is not None)
    assert drive.others is not None
    number = [each.name for each in drive.others.actors].index(str(hit.other))
    way, own, its = _at_junction(road, drive, world, incidents, hit, number) or _on_road(
        road, drive, world, incidents, hit, number
    )
    recent = (drive["time"] > hit.at_time - RECENT) & (drive["time"] <= hit.at_time)
    if _is_fast(drive["speed"][recent], limits_at(road, world, drive["s"][recent]), drive["time"][1]):
        own.add("speed")
    states = drive.others.states[: _sample(hit) + 1, number]
    limit = float(limits_at(road, world, np.array([hit.at_s]))[0])
    if only_road(road, world) is None:
        (places,) = lanes_of(network_of(road, world)).places(states[-1:, [X, Y]])
        limits = (each.lane.member.profile.lanes[each.lane.id.lane].speed_limit for each in places)
        limit = max((each or world.limits.speed_limit for each in limits), default=np.inf)
    if _is_fast(np.abs(states[-round(RECENT / STEP) :, SPEED]), limit, STEP):
        its.add("speed")
    is_liable = drive.others.actors[number].kind in LIABLE
    return Law(way, tuple(sorted(own)), tuple(sorted(its)) if is_liable else ())


def _sample(hit: Incident) -> int:
    """The last sample of the others before a contact."""
    return int(hit.at_time / STEP + 1e-9)


def fault_of(law: Law, contact: Contact, is_own_doing: bool) -> Fault:
    """Returns whose fault a collision was, by the law and the tested car's conduct."""
    speed_of: dict[bool, set[Offence]] = {True: {"speed"}, False: set()}  # who is hit in the rear
    own = is_own_doing or bool({*law.ego} - speed_of[contact.face == "rear"])
    its = bool({*law.other} - speed_of[contact.other_face == "rear"])
    return ("both" if its else "ego") if own else "other" if its else "nobody"


def _is_fast(speed: Array, limit: Array | float, step: float) -> bool:
    return bool(((speed > OVER * limit) & (speed > limit + OVER_BY)).sum() * step >= TOO_FAST)


def _at_junction(
    road: "Road", drive: "Drive", world: "World", incidents: Sequence[Incident], hit: Incident, number: int
) -> Found | None:
    """Returns what the rules of a junction say; None if the two do not come there from different arms."""
    from roadgpt.traffic.following import GREEN, RED
    from roadgpt.traffic.lights import lights_of

    network, others = network_of(road, world), drive.others
    assert others is not None
    lanes, time = lanes_of(network), hit.at_time
    for leg, start, end in zip(legs_of(road, world), road.starts, road.starts[1:], strict=False):
        if not start - drive.car.length < hit.at_s < end + drive.car.length:
            continue
        ways = [
            (leaves - begins, begins, key)
            for key in (lanes.met_by(leg) if leg.road in network.connection_of else ())
            if key.road in network.connection_of
            and network.connection_of[key.road][1].incoming != network.connection_of[leg.road][1].incoming
            for who, begins, _, leaves in who_drives(others, lanes[key], 0.0, np.inf)
            if who == number and begins <= time <= leaves + LATER
        ]
        if not ways:
            continue
        _, begins, key = max(ways)
        arm, before = network.connection_of[key.road][1].incoming, lanes[lanes[key].predecessors[0]]
        states = others.states[: int(begins / STEP) + 1, number]
        away = np.hypot(*(states[:, [X, Y]] - states[-1, [X, Y]]).T) - (before.before_line or 0.0)
        crossed = int(np.flatnonzero(away > 0).max(initial=-1)) + 1  # the first with its front past the line
        lit = drive.lights and begins > 0  # not for who was in the junction from the beginning on
        shown = lights_of(road, world, drive.seed).shown(arm, STEP * crossed) if lit else GREEN
        done = {each.kind for each in incidents if start - BEFORE < each.at_s <= hit.at_s}
        red, its_red = "red light" in done, shown == RED
        way: Party | None = "other" if key in lanes.gives_way_to(leg) else None
        way = "ego" if leg in lanes.gives_way_to(key) else way
        way = way if red == its_red else "other" if red else "ego"
        own, its = set[Offence](["red light"] * red), set[Offence](["red light"] * its_red)
        near = (away > 0) & (away <= STOP_WITHIN)
        if "stop line" in done:
            own.add("stop")
        if before.control == "stop" and begins and not (np.abs(states[near, SPEED]) < STOOD).any():
            its.add("stop")
        if way is not None and not (red or its_red):
            (own if way == "other" else its).add("priority")
        if way or own or its:
            return None if red and its_red else way, own, its
    return None


def _on_road(
    road: "Road", drive: "Drive", world: "World", incidents: Sequence[Incident], hit: Incident, number: int
) -> Found:
    """Returns what the rules of a road say: who was in the lane in which the two touched, and since when."""
    measured, contact, last = measure(road, drive, world), hit.contact, _sample(hit)
    assert drive.others is not None
    assert contact is not None
    line, kind = measured.lane, drive.others.actors[number].kind
    mine, boxes = measured.car[: last + 1], measured.others[: last + 1, number]
    s, t = map(float, line.locate(*contact.xy))
    reach = float(line.width_at(s)) / 2
    along, across = boxes.velocity[-1]
    stands = np.hypot(along, across) <= STILL
    lately = (drive["time"] > hit.at_time - BACKS) & (drive["time"] <= hit.at_time)
    if drive["vx"][lately].max() < -STILL:
        return "other", {"wrong way"}, set()
    if abs(t) >= reach - CORNER:
        is_over = abs(mine.t[-1]) > reach and along < 0
        return "other", {"wrong way" if is_over else "lane"}, set()
    network, heading = network_of(road, world), float(drive.others.states[last, number, HEADING])
    kerb = 1 if network.left_hand else -1
    is_beside = not stands and "rear" not in (contact.face, contact.other_face)
    for way in road.passages if is_beside else ():
        came, goes = road.heading([way.start, way.end])
        is_turn = np.sin(goes - came) * kerb > np.sin(TURNS)  # towards its kerb; who is there goes on
        is_there = way.start - CROSSED <= hit.at_s <= way.end + CROSSED
        if is_turn and is_there and np.cos(heading - came) > np.cos(TURNS):
            return "other", {"priority"}, set()
    if not stands and abs(across) > ACROSS * np.hypot(along, across):
        for crosswalk in road.crosswalks if kind in PERSONS else ():
            if abs(s - crosswalk.s) > CROSSED / 2:
                continue
            if (way := crosswalk.passage) is None:
                return "other", {"priority"}, set()
            done = {each.kind for each in incidents if way.start - BEFORE < each.at_s <= hit.at_s}
            if "red light" in done:
                return "other", {"red light"}, set()
            turns = np.cos(np.subtract(*road.heading([way.start, way.end]))) < np.cos(TURNS)
            if not (drive.lights and way.control == "lights") or (crosswalk.is_behind and turns):
                return "other", {"priority"}, set()
        return "ego", set(), {"priority"}
    if not stands and along < 0:
        return "ego", set(), {"wrong way" if abs(boxes.t[-1]) < reach else "lane"}
    if contact.face == "rear" and _came_in_short(line, mine, boxes):
        return "other", {"lane"}, set()
    if contact.face == "rear" or contact.speed <= STANDS:
        return "ego", set(), {"distance"}
    if contact.face != "front":
        return "ego", set(), {"lane"}
    if _came_in_short(line, boxes, mine):
        return "ego", set(), {"lane" if kind in VEHICLES else "priority"}
    return "other", {"distance"}, set()


def _came_in_short(line: Line, ahead: Boxes, behind: Boxes) -> bool:
    """Returns whether the one ahead came into the lane too short in front of the one behind."""
    out = np.flatnonzero(~line.holds(ahead) & ~np.isnan(ahead.t))
    if not len(out) or (came := int(out[-1]) + 1) >= len(ahead.t):
        return False
    closing = max(behind.velocity[came, 0] - ahead.velocity[came, 0], 0.0)
    gap = ahead.along[came] - ahead.reach[0][came] - behind.along[came] - behind.size[came, 0] / 2
    return bool(gap < closing * BEGINS + closing**2 / (2 * BRAKES) + ahead.velocity[came, 0] * APART)
