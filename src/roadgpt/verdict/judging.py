"""Turns a Drive into a Verdict."""

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from roadgpt.brief.scene import LATE, NEVER, STRUCK, Event
from roadgpt.drive.drive import PEDALS, RUN_IN, SCRIPT
from roadgpt.drive.drive_monitor import STUCK_AMONG_OTHERS, STUCK_TIME
from roadgpt.language.names import Face
from roadgpt.language.table import VEHICLES
from roadgpt.road.world import share_in_words
from roadgpt.verdict.criteria import (
    FREE,
    HITS,
    NAMED,
    ROBOT,
    STEERED,
    SUCCESS,
    Criterion,
    Judged,
    first_failure,
    incidents_of,
    is_ordered,
)
from roadgpt.verdict.oracle import EPSILON, consult, has_departed, margins
from roadgpt.verdict.verdict import (
    DEPARTURES,
    STANDS,
    Cause,
    Fault,
    Incident,
    Law,
    Outcome,
    Side,
    Verdict,
    percent,
)

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World
    from roadgpt.verdict.avoidable import Avoidance

FAULTS: dict[Fault | None, str] = {
    "ego": "at fault", "other": "not at fault", "both": "both at fault", "nobody": "nobody at fault",
}  # fmt: skip
FACES: dict[Face, str] = {"front": "front", "rear": "rear", "left": "left side", "right": "right side"}

NOT_MET, AVOIDED = "they never touched", "the tested driver avoided that"
LEAST = 0.005  # m; smaller distances beyond a marking are not stated

GIVES_WAY: tuple[Cause, ...] = ("stop line", "red light", "failure to yield")
SOON = 3.0  # s after the cause of a failure, within which a contact is told in the same sentence


def judge(
    road: "Road", drive: "Drive", world: "World", known: tuple[int, Cause | None] | None = None
) -> Verdict:
    """Returns the Verdict of a drive: whether the car kept its lane, the margin, and where it first failed.

    Only the first failure counts, also where a drive continues after it (``keep_driving``). The competition
    checks whether the car is at the goal, or stuck, before whether it is in its lane; the step at which it is
    so is therefore ignored for the margin and ``max_oob``.

    On a route through junctions or among others, ``incidents`` lists what the car did wrong
    (``roadgpt.verdict.criteria``). On a route, if the car kept its lane up to the goal, the first wrong
    turn, wrong way or missed stop is the failure; with others on the road, the earliest of all failures is
    the cause, and a contact within 3 s is told in the same sentence. A collision that could not have been
    avoided (``roadgpt.verdict.avoidable``) is UNAVOIDABLE.

    ``known`` is the step that decides and the cause of failure, or None, if an earlier verdict has them;
    with others on the road they are found again.

    Raises:
        UsageError: The drive was stopped at a smaller tolerance than ``world.limits.oob_tolerance``."""
    laid = world.lay(road)
    case = Judged(drive.followed(laid, world), drive, world)
    done = incidents_of(case)
    incidents = tuple(each for each in done if not is_ordered(drive, each))
    step, failed = first_failure(case, incidents, known if drive.others is None else None)
    waits = failed.name in ("stuck", "timeout") if failed else drive.ended == "over"
    by_script = drive.handed_to(step) in (SCRIPT, PEDALS) and bool(drive.missed)
    behind = _behind(case) if waits else ""
    failed = None if behind or (by_script and waits) else failed
    cause = cast("Cause | None", failed and failed.name)
    hit = next((each for each in incidents if each.contact is not None), None)
    handed_to = drive.handed_to(step) if failed else None
    if handed_to == PEDALS and (cause in DEPARTURES or cause in STEERED):
        handed_to = None
    asks = cause == "collision" or bool(handed_to and cause in GIVES_WAY)  # those may be up to the brakes
    found, law, fault = _blame(case, laid, done, hit, asks)
    avoidable = found.is_avoidable or found.is_own_doing if found and cause == "collision" else None
    outcome: Outcome = "PASS" if failed is None else "UNAVOIDABLE" if avoidable is False else "FAIL"
    excuse = ""
    if handed_to and outcome == "FAIL":
        excuse = f"{handed_to} drove where the car failed, so the failure is not {drive.driver}'s"
        if hit and found and found.is_avoidable and _asks_for_emergency_braking(drive, hit):
            excuse = f"{handed_to} drove there, but emergency braking stays {drive.driver}'s"
            handed_to = None
    least = float(margins(case.road, drive, world)[drive.counts].min())
    least = min(least, -EPSILON) if cause in DEPARTURES[1:] else least
    beyond, (gap, ttc) = most_beyond(case.road, drive, world), _least(case, hit)
    side = _side(case, step) if cause in DEPARTURES else None
    soon = (each for each in incidents if each.contact and 0 <= each.at_time - drive["time"][step] <= SOON)
    contact = hit if cause == "collision" else next(soon, None) if failed else None
    if failed is None:
        description = _kept(drive, world, least, beyond, behind)
    else:
        whom = next((each.other for each in incidents if each.kind == cause), None)
        description = _failed(case, step, failed, side, contact, whom, fault)
    untold = [each for each in incidents if each is not contact or cause == "collision"]
    crashed = (each for each in drive.history if each.what.startswith("hits ") and each.time is not None)
    description += "".join(f"; {each.who} {each.what} at {each.time:.1f} s" for each in crashed)
    description += _on_face(world, hit) + _counted(untold, cause) + _who_drove(drive, excuse)
    description += _led_out(drive, world)
    description += "".join(f"; {each}" for each in [*filter(None, [found and found.said]), *drive.limited])
    if failed is None and drive.missed:
        from roadgpt.verdict.happened import told

        outcome, why = told(laid, drive, world)
        description = f"{description}; {why}" if outcome == "PASS" else f"{why}; {description}"
    elif drive.missed:
        description += "".join(f"; {each}" for each in drive.missed if not each.endswith(LATE))
    is_robots = drive.driver == ROBOT and outcome == "PASS"
    events = _events(case, incidents, NOT_MET if failed or is_robots else AVOIDED)
    unmet = [each for each in events or () if each.what.startswith(HITS) and each.time is None]
    never = [f"{each.who} {each.what}: {each.why}" for each in unmet]
    if never and is_robots:
        outcome, description = "INVALID", f"did not happen: {' and '.join(never)}; {description}"
    else:
        description += "".join(f"; {NEVER} {each}" for each in never)
    s, x, y, time = (float(drive[name][step]) for name in ("s", "x", "y", "time"))
    if cause == "collision" and contact is not None:
        s, (x, y), time = contact.at_s, contact.at_xy, contact.at_time
    return Verdict(
        outcome=outcome,
        cause=cause,
        description=description,
        sbft_description=failed.sbft if failed else SUCCESS,
        max_oob=drive.max_outside,
        margin=least,
        oob_counter=int(consult(case.road, drive, world).oob_counter[-1]),
        beyond=beyond,
        at_s=s if failed else None,
        at_xy=(x, y) if failed else None,
        at_time=time if failed else None,
        side=side,
        incidents=incidents if case.is_route or drive.others is not None else None,
        events=events,
        least_gap=gap,
        least_ttc=ttc,
        own_share=drive.shares.get(drive.driver),
        law=law,
        avoidable=avoidable,
        at_fault=fault,
        avoided_by=found and found.by,
        criterion=found and found.criterion,
        handed_to=handed_to,
    )


def _events(case: Judged, incidents: Sequence[Incident], why: str) -> tuple[Event, ...] | None:
    if case.drive.others is None and not (case.drive.handovers or case.drive.history):
        return None
    from roadgpt.verdict.events import events_of

    return events_of(case, incidents, why) or None


def _blame(
    case: Judged, laid: "Road", incidents: Sequence[Incident], hit: Incident | None, is_avoidance_asked: bool
) -> "tuple[Avoidance | None, Law | None, Fault | None]":
    """Returns whether the first contact could have been avoided, what the law says, and whose fault it is.

    For the law, a car that was made to change lanes is in its lane there, but not in an oncoming lane."""
    found, (road, drive, world) = None, (case.road, case.drive, case.world)
    if hit is None or hit.contact is None:
        return None, None, None
    if is_avoidance_asked:
        from roadgpt.verdict.avoidable import avoidance_of

        found = avoidance_of(road, drive, world, hit)
    from roadgpt.verdict.law import fault_of, law_of

    profile = world.profile_of(road)
    is_own_side = (profile.middle(hit.at_s) - profile.centre(hit.at_s)) * profile.side > 0
    law = law_of(road if is_own_side else laid, drive, world, incidents)
    return found, law, fault_of(law, hit.contact, bool(found and found.is_own_doing))


def _side(case: Judged, step: int) -> Side:
    middle = case.world.profile_of(case.road).middle(case.drive["s"][step])
    return "left" if case.drive["t"][step] > middle else "right"


def _least(case: Judged, hit: Incident | None) -> tuple[float | None, float | None]:
    """Returns the least gap in metres and the least time to collision in seconds up to the first contact."""
    if case.drive.others is None:
        return None, None
    before = case.measured.time <= (np.inf if hit is None else hit.at_time)
    least = [float(each[before].min(initial=np.inf)) for each in (case.measured.gap, case.measured.ttc)]
    gap, ttc = (round(each, 3) if np.isfinite(each) else None for each in least)
    return gap if hit is None else 0.0, ttc


def most_beyond(road: "Road", drive: "Drive", world: "World") -> float:
    """Returns the largest distance in metres by which the car's body extended beyond the outer edge of a lane
    marking; 0 if it never did."""
    from roadgpt.drive.lane_position import MarkingMonitor

    body = MarkingMonitor.for_body(road, world, drive.car).along(drive, floor=0.0)
    return max(float(body[drive.counts].max()), 0.0)


def _counted(incidents: Sequence[Incident], cause: Cause | None) -> str:
    """Returns the number of incidents of each kind in words; the first of the cause's kind is named
    already."""
    of_kind: Counter[str | None] = Counter(each.kind for each in incidents)
    same = of_kind.pop(cause, 0)
    words = [f"{same} times in all"] if same > 1 else []
    for kind, count in of_kind.items():
        first = next(each.at_s for each in incidents if each.kind == kind)
        often = "once," if count == 1 else f"{count} times, first"
        words.append(f"{NAMED[str(kind)].said} {often} after {first:.0f} m")
    return "".join(f"; {each}" for each in words)


def _on_face(world: "World", hit: Incident | None) -> str:
    """Returns in words where the tested car was touched, if the scene tells that."""
    found = hit and hit.contact
    if not found or found.place is None or all(each.hits not in STRUCK for each in world.scene.actors):
        return ""
    of = "left" if found.face in ("front", "rear") else "front"
    return f"; touched at {percent(found.place)} of its {FACES[found.face]} from the {of}"


def _asks_for_emergency_braking(drive: "Drive", contact: Incident) -> bool:
    """Whether UN R152 asks for emergency braking at the speed before a contact."""
    assert drive.others is not None
    kind = next(each.kind for each in drive.others.actors if each.name == contact.other)
    before = (drive["time"] > contact.at_time - SOON) & (drive["time"] <= contact.at_time)
    return (10 if kind in VEHICLES else 20) <= round(3.6 * float(drive["speed"][before].max())) <= 60


def _who_drove(drive: "Drive", excuse: str) -> str:
    if not drive.shares:
        return ""
    (own, share), *others = drive.shares.items()
    run_in = [f"{RUN_IN} drove until {each.end:.1f} s (T0)" for each in drive.handovers if each.by == RUN_IN]
    told = " and ".join(f"{name} for {percent(part)}" for name, part in others if name != RUN_IN)
    took = [f"{own} drove {percent(share)} of the way and handed over to {told}"] if told else []
    return "".join(f"; {each}" for each in (*run_in, *took, *filter(None, [excuse])))


def _led_out(drive: "Drive", world: "World") -> str:
    """Returns in words how far the script steered the car out of its lane, where that does not count."""
    time, led = drive["time"], np.zeros(len(drive), bool)
    for each in drive.handovers:
        led |= (time > each.start) & (time <= each.end) & (each.by == SCRIPT)
    most = float(drive["outside"][led].max(initial=0.0))
    out = most > world.limits.oob_tolerance
    return f"; {SCRIPT} steered it out of its lane, with up to {percent(most)} of it outside" if out else ""


def far_beyond(beyond: float) -> str:
    """Returns in words how far a car was outside its lane; ``beyond`` is in metres beyond the marking."""
    return f"{beyond:.2f} m beyond the marking" if beyond >= LEAST else "on the marking"


def _behind(case: Judged) -> str:
    """Returns in words behind whom of a scene the car stayed at the end; empty if the way was free."""
    others = case.drive.others
    if others is None or not others.actors or not (case.world.scene.actors or case.world.scene.roadworks):
        return ""
    gaps = case.measured.gap[-1]
    who = int(np.argmin(gaps))
    if gaps[who] > FREE:
        return ""
    from roadgpt.traffic.actor import SPEED

    speed = abs(float(others.states[-1, who, SPEED]))
    does = f"drives at {speed * 3.6:.0f} km/h" if speed > STANDS else "stands"
    return f"{gaps[who]:.1f} m behind {others.actors[who].name}, which {does} in its way"


def _kept(drive: "Drive", world: "World", margin: float, beyond: float, behind: str) -> str:
    """Describes a PASS, and how far outside its lane the car was, which the tolerance allows to a limit."""
    if drive.ended == "over" and not world.scene.is_test:
        did = "was parked to the end of the scene" if world.scene.parks else "turned round as told"
        return f"{did}, after {drive.duration:.0f} s"
    reached = f"for {drive['s'][-1]:.0f} m" if behind else f"to the goal after {drive['s'][-1]:.0f} m"
    if drive.ended == "over":
        reached = f"for {drive['s'][-1]:.0f} m, to the end of the event after {drive.duration:.1f} s"
    reached += f"{',' * (drive.ended == 'over')} and stayed {behind}" * bool(behind)
    if not drive.max_outside:
        return f"kept its lane {reached}, never less than {margin:.2f} m sideways from failing"
    kept = f"kept its lane within the tolerance of {percent(world.limits.oob_tolerance)}"
    if world.limits.lane_departure:
        kept = "kept its front tyres within the markings"
    outside = f"at most {percent(drive.max_outside)} of the car was outside, {far_beyond(beyond)}"
    return f"{kept} {reached}: {outside}, {margin:.2f} m sideways from failing"


def _failed(
    case: Judged, step: int, failed: Criterion, side: Side | None, contact: Incident | None,
    whom: str | None, fault: Fault | None,
) -> str:  # fmt: skip
    (road, drive, world), cause = (case.road, case.drive, case.world), failed.name
    profile = world.profile_of(road)
    is_beside = (
        side == ("right" if profile.left_hand else "left") and profile.driven_id != profile.along_ids[0]
    )
    has_crossed = cause == "out of lane" and has_departed(road, drive, world)[step]
    how = (
        "a front tyre passed the marking"
        if has_crossed
        else f"more than {share_in_words(world.limits.oob_tolerance)} was outside"
    )
    later = f"{contact.at_time - drive['time'][step]:.1f} s later" if contact else ""
    told = failed.failed.format(
        side=side,
        where=", into the next lane of its direction," if is_beside else "",
        reached=f"after {min(drive['s'][step], road.length):.0f} m",
        fast=f"at {drive['speed'][step] * 3.6:.0f} km/h",
        how="" if contact else f": {how}",
        length=road.length,
        whom=whom,
        patience=STUCK_TIME if drive.others is None else STUCK_AMONG_OTHERS,
        **_place(road, world, cause, float(drive["s"][step])),
        contact=_touched(contact, f"after {contact.at_s:.0f} m", fault) if contact else "hit somebody",
    )
    if contact is None or cause == "collision":
        return told
    return f"{told} and {_touched(contact, later, fault)}" + (f"; {how}" if cause == "out of lane" else "")


def _place(road: "Road", world: "World", cause: str, s: float) -> dict[str, str]:
    """Returns what a car falls off, and what it crashes into, at a station."""
    if cause not in ("fell", "crashed") or not world.has_ground:
        return {"deck": "the road", "wall": "the slope"}
    from roadgpt.network.landscape import crossings

    kinds = {each.kind for each in crossings(road, world) if each.start <= s <= each.end}
    wall = "the wall of the tunnel" if "tunnel" in kinds else "the parapet" if kinds else "the slope"
    return {"deck": "the bridge" if kinds else "the road", "wall": wall}


def _touched(incident: Incident, where: str, fault: Fault | None) -> str:
    """Returns in words how the tested car and somebody else touched, and whose fault it was."""
    found, name = incident.contact, incident.other
    assert found is not None
    moves = abs(found.other_speed) > STANDS
    from_there = found.face == "rear" or (found.face != "front" and found.other_face == "front")
    is_hit = moves and (found.speed <= STANDS or from_there)
    verb = f"was hit by {name}" if is_hit else f"hit {name}"
    own, other = FACES[found.face], FACES[found.other_face]
    its = f"at {abs(found.other_speed) * 3.6:.0f} km/h" if moves else "standing"
    overlap = "" if found.overlap is None else f" and {percent(found.overlap)} overlap"
    return (
        f"{verb} {where} at {found.speed * 3.6:.0f} km/h: its {own} met the {other} of {name}, {its}, with "
        f"{found.impact_speed * 3.6:.0f} km/h of difference{overlap}; {FAULTS[fault]}"
    )
