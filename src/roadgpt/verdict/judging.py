"""Turns a Drive into a Verdict."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive.drive_monitor import STUCK_AMONG_OTHERS, STUCK_TIME
from roadgpt.errors import UsageError
from roadgpt.language.table import VEHICLES
from roadgpt.network import only_road
from roadgpt.road.world import share_in_words
from roadgpt.traffic.actor import SPEED
from roadgpt.traffic.traffic import LATE
from roadgpt.verdict.oracle import EPSILON, consult, has_departed, is_outside, margins
from roadgpt.verdict.verdict import (
    DEPARTURES,
    STANDS,
    Cause,
    Face,
    Fault,
    Incident,
    Outcome,
    Side,
    Verdict,
    percent,
)

if TYPE_CHECKING:
    from roadgpt.drive import Drive, Ended
    from roadgpt.road import Road, World

INCIDENTS: dict[str, str] = {
    "out of lane": "out of its lane",
    "wrong turn": "on a wrong road",
    "wrong way": "against the direction of its lane",
    "off road": "a wheel off the road",
    "stop line": "no stop at a stop sign",
    "red light": "past a red light",
    "failure to yield": "no giving way",
    "collision": "a contact",
    "near miss": "a near miss",
    "blocked": "standing for 30 s before a free way",
    "speeding": "above the speed limit",
}

FAULTS: dict[Fault | None, str] = {
    "ego": "at fault", "other": "not at fault", "both": "both at fault", "nobody": "nobody at fault",
}  # fmt: skip
FACES: dict[Face, str] = {"front": "front", "rear": "rear", "left": "left side", "right": "right side"}

LEAST = 0.005  # m; smaller distances beyond a marking are not stated

# The competition's own words, to which it adds the name of the simulation. For the competition, a car that
# falls has left the lane. The competition has neither signs, lights nor others on the road, so the words for
# a collision are ours.
SBFT: dict[Cause | None, str] = {
    **dict.fromkeys((None, "stop line", "red light", "failure to yield"), "Successful test"),
    **dict.fromkeys((*DEPARTURES, "wrong turn", "wrong way"), "Car drove out of the lane"),
    "stuck": "Car is not moving fast enough",
    "timeout": "Timeout Simulation",
    "collision": "Car collided",
}

FAILING: tuple[Cause, ...] = (
    "collision", "wrong turn", "wrong way", "stop line", "red light", "failure to yield",
)  # fmt: skip
"""The kinds of incidents that fail a test: if nothing else failed, or, with others on the road, if they came
first. The kind of the first such incident is then the cause. A tyre off the road, near misses, standing and
speeding fail no test.
"""

GIVES_WAY: tuple[Cause, ...] = ("stop line", "red light", "failure to yield")
SOON = 3.0  # s after the cause of a failure, within which a contact is told in the same sentence

FAILED: dict[Cause, str] = {
    "out of lane": "left its lane to the {side}{where} {reached} {fast}{how}",
    "fell": "fell off {deck} to the {side} {reached} {fast}",
    "rolled": "left the road to the {side} and rolled over {reached} {fast}",
    "crashed": "left the road to the {side} and crashed into {wall} {reached} {fast}",
    "sank": "left the road to the {side} and drove into water {reached} {fast}",
    "wrong turn": "took a wrong turn {reached} {fast}",
    "wrong way": "drove against the direction of its lane {reached} {fast}",
    "stop line": "did not stop at the stop sign {reached}: it crossed the line {fast}",
    "red light": "ran a red light {reached}: it crossed the line {fast}",
    "failure to yield": "did not give way to {whom} {reached}: it entered the junction {fast}",
    "collision": "{contact}",
    "stuck": "was stuck {reached}: it moved less than 1 m in {patience:.0f} s",
    "timeout": "ran out of time {reached} of {length:.0f} m",
}
"""The description of a failure by its cause; ``_failed`` fills in the gaps."""


def judge(
    road: "Road", drive: "Drive", world: "World", known: tuple[int, Cause | None] | None = None
) -> Verdict:
    """Returns the Verdict of a drive: whether the car kept its lane, the margin, and where it first failed.

    Only the first failure counts, also where a drive continues after it (``keep_driving``). The competition
    checks whether the car is at the goal, or stuck, before whether it is in its lane; the step at which it is
    so is therefore ignored for the margin and ``max_oob``.

    On a route through junctions or among others, ``incidents`` lists what the car did wrong
    (``roadgpt.verdict.incidents``). On a route, if the car kept its lane up to the goal, the first wrong
    turn, wrong way or missed stop is the failure; with others on the road, the earliest of all failures is
    the cause, and a contact within 3 s is told in the same sentence. A collision that could not have been
    avoided (``roadgpt.verdict.avoidable``) is UNAVOIDABLE.

    ``known`` is the step that decides and the cause of failure, or None, if an earlier verdict has them;
    with others on the road they are found again.

    Raises:
        UsageError: The drive was stopped at a smaller tolerance than ``world.limits.oob_tolerance``."""
    road = world.lay(road)
    has_incidents = only_road(road, world) is None or drive.others is not None
    incidents = tuple[Incident, ...]()
    if has_incidents:
        from roadgpt.verdict.incidents import incidents_of  # a single road does not need it

        incidents = incidents_of(road, drive, world)
    known = known if drive.others is None else None
    step, cause = known or _first_failure(road, drive, world)
    if cause is None or drive.others is not None:
        step, cause = _first_of(incidents, drive, step, cause)
    behind = _behind(road, drive, world) if cause in ("stuck", "timeout") else ""
    cause = None if behind else cause
    hits = [each for each in incidents if each.contact is not None]
    first = hits[0] if hits else None
    soon = (each for each in hits if 0 <= each.at_time - drive["time"][step] <= SOON)
    contact = first if cause == "collision" else next(soon, None) if cause else None
    every = margins(road, drive, world)
    least = float(every[: drive.lane_steps].min())
    side: Side | None = None
    if cause in DEPARTURES:
        side = "left" if drive["t"][step] > world.profile_of(road).middle(drive["s"][step]) else "right"
    if cause in DEPARTURES[1:]:
        least = min(least, -EPSILON)
    beyond = most_beyond(road, drive, world)
    handed_to = drive.handed_to(step) if cause else None
    outcome: Outcome = "FAIL" if cause else "PASS"
    found, avoidable, excuse, law, fault = None, None, "", None, None
    gap, ttc = _least(road, drive, world, first)
    is_yielding = handed_to and cause in GIVES_WAY  # what came of it may be a matter of the brakes
    if first is not None and (is_yielding or cause == "collision"):
        from roadgpt.verdict.avoidable import avoidance_of

        found = avoidance_of(road, drive, world, first)
        is_avoidable = found.is_avoidable or found.is_own_doing
        avoidable = is_avoidable if cause == "collision" else None
        outcome = "FAIL" if is_avoidable or cause != "collision" else "UNAVOIDABLE"
    if first is not None and first.contact is not None:
        from roadgpt.verdict.law import fault_of, law_of

        law = law_of(road, drive, world, incidents)
        fault = fault_of(law, first.contact, bool(found and found.is_own_doing))
    if handed_to and outcome == "FAIL":
        excuse = f"{handed_to} drove where the car failed, so the failure is not {drive.driver}'s"
        if first and found and found.is_avoidable and _asks_for_emergency_braking(drive, first):
            excuse = f"{handed_to} drove there, but emergency braking stays {drive.driver}'s"
            handed_to = None
    if cause is None:
        description = _kept(drive, world, least, beyond, behind)
    else:
        whom = next((each.other for each in incidents if each.kind == cause), None)
        description = _failed(road, drive, world, step, cause, side, contact, whom, fault)
    untold = [each for each in incidents if each is not contact or cause == "collision"]
    description += _counted(untold, cause) + _who_drove(drive.shares, excuse)
    s, x, y, time = (float(drive[name][step]) for name in ("s", "x", "y", "time"))
    description += f"; {found.said}" if found else ""
    if cause == "collision" and contact is not None:
        s, (x, y), time = contact.at_s, contact.at_xy, contact.at_time
    description += "".join(f"; {each}" for each in drive.limited)
    if cause is None and drive.missed:
        from roadgpt.verdict.happened import told

        outcome, why = told(road, drive, world)
        description = f"{description}; {why}" if outcome == "PASS" else f"{why}; {description}"
    else:
        description += "".join(f"; {each}" for each in drive.missed if not each.endswith(LATE))
    return Verdict(
        outcome=outcome,
        cause=cause,
        description=description,
        sbft_description=SBFT[cause],
        max_oob=drive.max_outside,
        margin=least,
        oob_counter=int(consult(road, drive, world).oob_counter[-1]),
        beyond=beyond,
        at_s=s if cause else None,
        at_xy=(x, y) if cause else None,
        at_time=time if cause else None,
        side=side,
        incidents=incidents if has_incidents else None,
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


def _least(
    road: "Road", drive: "Drive", world: "World", hit: Incident | None
) -> tuple[float | None, float | None]:
    """Returns the least gap in metres and the least time to collision in seconds up to the first contact."""
    if drive.others is None:
        return None, None
    from roadgpt.verdict.measures import measure

    measured = measure(road, drive, world)
    before = measured.time <= (np.inf if hit is None else hit.at_time)
    least = [float(each[before].min(initial=np.inf)) for each in (measured.gap, measured.ttc)]
    gap, ttc = (round(each, 3) if np.isfinite(each) else None for each in least)
    return gap if hit is None else 0.0, ttc


def most_beyond(road: "Road", drive: "Drive", world: "World") -> float:
    """Returns the largest distance in metres by which the car's body extended beyond the outer edge of a lane
    marking; 0 if it never did."""
    from roadgpt.drive.lane_position import MarkingMonitor

    body = MarkingMonitor.for_body(road, world, drive.car).along(drive, floor=0.0)
    return max(float(body[: drive.lane_steps].max()), 0.0)


def _first_failure(road: "Road", drive: "Drive", world: "World") -> tuple[int, Cause | None]:
    """Returns the step at which the drive failed and the cause; the last step and None if it did not."""
    last = len(drive) - 1
    out = is_outside(road, drive, world)
    if out.any():
        return int(np.argmax(out)), "out of lane"
    if drive.ended == "out_of_lane":
        raise UsageError(
            f"the drive was ended with {drive['outside'][last]:.3f} of the car outside its lane, which "
            f"a tolerance of {world.limits.oob_tolerance:g} allows: drive the road again with this tolerance"
        )
    causes: dict[Ended, Cause] = {
        "fell": "fell", "rolled": "rolled", "crashed": "crashed", "sank": "sank",
        "stuck": "stuck", "timeout": "timeout", "collision": "collision",
    }  # fmt: skip
    return last, causes.get(drive.ended)


def _first_of(
    incidents: Sequence[Incident], drive: "Drive", step: int, cause: Cause | None
) -> tuple[int, Cause | None]:
    """Returns the step and the cause of the first failing incident; ``step`` and ``cause`` if there is none,
    or if they came first."""
    for each, name in ((each, name) for each in incidents for name in FAILING if name == each.kind):
        first = min(int(np.searchsorted(drive["time"], each.at_time)), len(drive) - 1)
        return (first, name) if cause is None or first <= step else (step, cause)
    return step, cause


def _counted(incidents: Sequence[Incident], cause: Cause | None) -> str:
    """Returns the number of incidents of each kind in words; the first of the cause's kind is named
    already."""
    of_kind: Counter[str | None] = Counter(each.kind for each in incidents)
    same = of_kind.pop(cause, 0)
    words = [f"{same} times in all"] if same > 1 else []
    for kind, count in of_kind.items():
        first = next(each.at_s for each in incidents if each.kind == kind)
        often = "once," if count == 1 else f"{count} times, first"
        words.append(f"{INCIDENTS[str(kind)]} {often} after {first:.0f} m")
    return "".join(f"; {each}" for each in words)


def _asks_for_emergency_braking(drive: "Drive", contact: Incident) -> bool:
    """Whether UN R152 asks for emergency braking at the speed before a contact."""
    assert drive.others is not None
    kind = next(each.kind for each in drive.others.actors if each.name == contact.other)
    before = (drive["time"] > contact.at_time - SOON) & (drive["time"] <= contact.at_time)
    return (10 if kind in VEHICLES else 20) <= round(3.6 * float(drive["speed"][before].max())) <= 60


def _who_drove(shares: Mapping[str, float], excuse: str) -> str:
    if not shares:
        return ""
    (own, share), *others = shares.items()
    told = " and ".join(f"{name} for {percent(part)}" for name, part in others)
    excuse = f"; {excuse}" * bool(excuse)
    return f"; {own} drove {percent(share)} of the way and handed over to {told}{excuse}"


def far_beyond(beyond: float) -> str:
    """Returns in words how far a car was outside its lane; ``beyond`` is in metres beyond the marking."""
    return f"{beyond:.2f} m beyond the marking" if beyond >= LEAST else "on the marking"


def _behind(road: "Road", drive: "Drive", world: "World") -> str:
    """Returns in words behind whom of a scene the car stayed at the end; empty if the way was free."""
    if drive.others is None or not drive.others.actors or not world.scene.actors:
        return ""
    from roadgpt.verdict.incidents import FREE
    from roadgpt.verdict.measures import measure

    gaps = measure(road, drive, world).gap[-1]
    who = int(np.argmin(gaps))
    if gaps[who] > FREE:
        return ""
    speed = abs(float(drive.others.states[-1, who, SPEED]))
    does = f"drives at {speed * 3.6:.0f} km/h" if speed > STANDS else "stands"
    return f"{gaps[who]:.1f} m behind {drive.others.actors[who].name}, which {does} in its way"


def _kept(drive: "Drive", world: "World", margin: float, beyond: float, behind: str) -> str:
    """Describes a PASS, and how far outside its lane the car was, which the tolerance allows to a limit."""
    reached = f"to the goal after {drive['s'][-1]:.0f} m"
    if behind:
        reached = f"for {drive['s'][-1]:.0f} m and stayed {behind}"
    if not drive.max_outside:
        return f"kept its lane {reached}, never less than {margin:.2f} m sideways from failing"
    kept = f"kept its lane within the tolerance of {percent(world.limits.oob_tolerance)}"
    if world.limits.lane_departure:
        kept = "kept its front tyres within the markings"
    outside = f"at most {percent(drive.max_outside)} of the car was outside, {far_beyond(beyond)}"
    return f"{kept} {reached}: {outside}, {margin:.2f} m sideways from failing"


def _failed(
    road: "Road", drive: "Drive", world: "World", step: int, cause: Cause, side: Side | None,
    contact: Incident | None, whom: str | None, fault: Fault | None,
) -> str:  # fmt: skip
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
    told = FAILED[cause].format(
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


def _place(road: "Road", world: "World", cause: Cause, s: float) -> dict[str, str]:
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
    is_hit = found.face == "rear" or (found.face != "front" and found.other_face == "front")
    verb = f"was hit by {name}" if is_hit else f"hit {name}"
    own, other = FACES[found.face], FACES[found.other_face]
    its = f"at {abs(found.other_speed) * 3.6:.0f} km/h" if abs(found.other_speed) > STANDS else "standing"
    overlap = "" if found.overlap is None else f" and {percent(found.overlap)} overlap"
    return (
        f"{verb} {where} at {found.speed * 3.6:.0f} km/h: its {own} met the {other} of {name}, {its}, with "
        f"{found.impact_speed * 3.6:.0f} km/h of difference{overlap}; {FAULTS[fault]}"
    )
