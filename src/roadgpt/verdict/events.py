"""Lists what happened in a test: whether, when and where.

Beside what the scene prescribes, these are contacts and other incidents, where the tested car was out of its
lane, and who drove in its driver's place. Lights that are told "when the tested car comes" are those that
show it the colour in the last COMES metres before their line."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from roadgpt.brief.scene import CAR, ENDED, MIRROR, SIGNALS, STRUCK, Event
from roadgpt.language.names import Shown
from roadgpt.language.table import MANEUVERS
from roadgpt.traffic.script import how_many
from roadgpt.verdict.criteria import HITS, NAMED, Judged
from roadgpt.verdict.oracle import has_departed
from roadgpt.verdict.verdict import Incident

COMES = 50.0  # m: where one at 50 km/h brakes for red with 2 m/s^2
UNENDED = "not ended when the drive ended"
SHOWN: tuple[Shown, ...] = ("green", "yellow", "red")
"""By the numbers of the lights."""


def events_of(case: Judged, incidents: Sequence[Incident], why: str) -> tuple[Event, ...]:
    """Returns the events of a drive in order of time, and then what did not happen; ``why`` nobody hit the
    tested car who is to."""
    drive = case.drive
    found = [*map(_ended, drive.history), *_told_hits(case, why), *_lights(case), *_out_of_lane(case)]
    for each in incidents:
        if each.kind != "out of lane":
            what = (
                f"{NAMED[each.kind].said} {'for' if each.kind == 'task' else 'with'} {each.other}"
                if each.other
                else NAMED[each.kind].said
            )
            found.append(Event(CAR, what, each.at_time, each.at_s))
    for hand in drive.handovers:
        s = float(np.interp(hand.start, drive["time"], drive["s"]))
        found.append(Event(CAR, f"driven by {hand.by}", hand.start, s, hand.end))
    return tuple(sorted(map(_rounded, found), key=lambda each: np.inf if each.time is None else each.time))


def _told_hits(case: Judged, why: str) -> Iterator[Event]:
    kinds = Counter[str]()
    for number, role in enumerate(case.world.scene.actors if case.drive.others else ()):
        kinds[role.kind] += how_many(role, number, case.drive.seed)
        if role.hits not in STRUCK:
            continue
        who, what = f"{role.kind} {kinds[role.kind]}", f"{HITS}{role.hits}"
        hit = next((each for each in case.contacts if each.other == who), None)
        face = hit and hit.contact and hit.contact.face
        if hit and face in (("left", "right") if role.hits == MIRROR else (role.hits,)):
            yield Event(who, what, hit.at_time, hit.at_s)
        else:
            yield Event(who, what, why=f"it hit the {face}" if face else why)


def _ended(event: Event) -> Event:
    """Says of what has begun and not ended that it has not; what a script releases has no end."""
    is_open = not event.what.startswith(MANEUVERS["release"].said)
    is_open &= event.time is not None and event.until is None and not event.why
    return replace(event, why=UNENDED) if is_open else event


def _rounded(event: Event) -> Event:
    time, s, until = (each if each is None else round(each, 3) for each in (event.time, event.s, event.until))
    return replace(event, time=time, s=s, until=until)


def _out_of_lane(case: Judged) -> Iterator[Event]:
    """Yields where the car was out of its lane, also while the script steered."""
    drive, (time, s) = case.drive, (case.drive["time"], case.drive["s"])
    out = (drive["outside"] > case.world.limits.oob_tolerance) | has_departed(case.road, drive, case.world)
    edges = np.flatnonzero(np.diff(np.r_[False, out, False]))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        until = float(time[last]) if last < len(time) else None
        yield Event(CAR, "out of its lane", float(time[first]), float(s[first]), until)


def _lights(case: Judged) -> Iterator[Event]:
    """Yields what is told of the first lights on the way."""
    signal, drive = case.world.scene.lights, case.drive
    lit = next((each for each in case.road.passages if each.light_line is not None), None)
    if signal is None or lit is None or lit.light_line is None:
        return
    from roadgpt.traffic.lights import lights_of, turns_at

    lights, time = lights_of(case.road, case.world, drive.seed), drive["time"]
    what = str(signal).removeprefix("the traffic lights ")
    shown = np.array([SHOWN[lights.shown(lit.arrival, each)] for each in time.tolist()])
    way = lit.light_line - drive["s"] - drive.car.ahead - drive.car.length / 2
    turns = turns_at(signal, drive.seed)
    comes = (way > 0) & (way < COMES) if turns is None else time > turns
    at = np.flatnonzero(comes & (shown == signal.shows))
    if len(at):
        yield Event(SIGNALS, what, float(time[at[0]]), lit.light_line)
    else:
        why = f"they showed {shown[comes][-1]}" if comes.any() else ENDED
        yield Event(SIGNALS, what, why=why)
