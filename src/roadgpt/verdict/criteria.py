"""What a test is judged by: criteria in the order in which they decide, each with its source.

A criterion finds incidents, each with its place: the first step at which its condition holds. Those by which
drives end are found by the simulator. Who adds one writes an entry, and its name where Causes and kinds of
incidents are named (``verdict.verdict``)."""

import math
from collections.abc import Callable, Sequence, Set
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.drive.drive import PEDALS, RETURNS, RUN_IN, SCRIPT
from roadgpt.errors import UsageError
from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.network import legs_of, network_of, only_road
from roadgpt.verdict.oracle import BoolArray, is_outside
from roadgpt.verdict.verdict import STANDS, Cause, Incident, IncidentKind

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.drive.drive import GivenTask
    from roadgpt.road import Road, World
    from roadgpt.verdict.measures import Measures

SUCCESS, LEFT = "Successful test", "Car drove out of the lane"
"""The competition's own words, to which it adds the name of the simulation. For the competition, a car that
falls has left the lane; it has neither signs, lights nor others, so that those of a collision are ours."""

GONE = 0.9  # share of the car outside its lane; a car that slides wide and comes back took no wrong turn
ALONG = math.radians(30.0)  # between the heading of the car and that of a wrong road on which it drives
BACKWARDS, BACK = math.radians(90.0), 1.0  # between the headings of car and route; s of driving the wrong way
STOP_WITHIN = 4.0  # m before the line
IN_LANE, NEAR = 0.5, 0.5  # m from the middle, m/s from the speed at which a task is done
EDGE = 0.02  # m, by which a tyre may be beyond the polygon of the paved area, whose chords cut bends by 2 mm
CONFLICT, ENCROACHED = 0.95, 1.0  # s
ROBOT, HITS = "robot", "hits the tested car's "
APART = 3.0  # s between two near misses
STOOD, PATIENCE, FREE = 0.1, 30.0, 10.0  # m/s, s, m
OVER, OVER_BY, TOO_FAST = 1.05, 1.0, 1.0  # ratio, m/s, s


class Judged:
    """A drive that is judged, and what several criteria ask about it."""

    def __init__(self, road: "Road", drive: "Drive", world: "World") -> None:
        self.road, self.drive, self.world = road, drive, world
        self.is_route = only_road(road, world) is None

    def began(self, kind: IncidentKind, times: Sequence[float], other: str | None = None) -> list[Incident]:
        """Returns what began at some times."""
        x, y, s = (
            np.interp(times, self.drive["time"], self.drive[name]).tolist() for name in ("x", "y", "s")
        )
        rows = zip(s, x, y, times, strict=True)
        return [Incident(kind, s, (x, y), float(time), other) for s, x, y, time in rows]

    @cached_property
    def is_out(self) -> BoolArray:
        """At which steps the car is out of its lane."""
        return is_outside(self.road, self.drive, self.world)

    @cached_property
    def measured(self) -> "Measures":
        """How critical the drive among others was."""
        from roadgpt.verdict.measures import measure  # a drive alone needs none of these

        return measure(self.road, self.drive, self.world)

    @cached_property
    def speed(self) -> Array:
        """The tested car's speed at the times of ``measured``."""
        return np.interp(self.measured.time, self.drive["time"], self.drive["speed"])

    @cached_property
    def contacts(self) -> Sequence[Incident]:
        """The first contact with each of the others."""
        from roadgpt.verdict.contact import contacts_of

        return contacts_of(self.drive)

    @cached_property
    def near_misses(self) -> list[Incident]:
        """The near misses; those with the same other within 3 s are one."""
        assert self.drive.others is not None
        measured, hit, found = self.measured, {each.other for each in self.contacts}, list[Incident]()
        crashed = min((each.at_time for each in self.contacts), default=np.inf)
        for number, actor in enumerate(self.drive.others.actors):
            if actor.name in hit:
                continue
            times = [*measured.time[(measured.conflict[:, number] < CONFLICT) & (self.speed > STANDS)]]
            if measured.pet[number] < ENCROACHED:
                times.append(measured.pet_time[number])
            times = sorted(each for each in times if each < crashed)
            late = [each for n, each in enumerate(times) if n == 0 or each - times[n - 1] > APART]
            found += self.began("near miss", late, actor.name)
        return found

    @cached_property
    def taken(self) -> list[Incident]:
        """Red lights and failures to yield."""
        from roadgpt.verdict.right_of_way import taken

        every = taken(self.road, self.drive, self.world, [*self.contacts, *self.near_misses])
        return [one for kind, time, other in every for one in self.began(kind, [time], other)]


def _out_of_lane(case: Judged) -> list[Incident]:
    return case.began("out of lane", _lasting(case.drive["time"], case.is_out))


def _is_beside(case: Judged) -> BoolArray:
    edges, t = case.world.profile_of(case.road).edges(case.drive["s"]), case.drive["t"]
    return np.asarray((t > edges.left) | (t < edges.right))


def _wrong_ways(case: Judged) -> list[Incident]:
    turned = np.abs(wrap_angle(case.drive["heading"] - case.road.heading(case.drive["s"])))
    is_wrong = (turned > BACKWARDS) & ~_is_beside(case)
    return case.began("wrong way", _lasting(case.drive["time"], is_wrong, BACK))


def _blocked(case: Judged) -> list[Incident]:
    is_free = case.measured.gap.min(axis=1, initial=np.inf) > FREE
    return case.began("blocked", _lasting(case.measured.time, (case.speed < STOOD) & is_free, PATIENCE))


def _speeding(case: Judged) -> list[Incident]:
    speed, limit = case.drive["speed"], limits_at(case.road, case.world, case.drive["s"])
    fast = (speed > OVER * limit) & (speed > limit + OVER_BY)
    return case.began("speeding", _lasting(case.drive["time"], fast, TOO_FAST))


def limits_at(road: "Road", world: "World", s: Array) -> Array:
    """Returns the speed limit in m/s, at these stations, of the lane that the tested car is to follow."""
    from roadgpt.drive.outlook import limits_of

    starts, limits = zip(*(limits_of(road, world) or [(0.0, world.limits.speed_limit)]), strict=True)
    return np.asarray(np.array(limits)[np.searchsorted(starts[1:], s, "right")])


def _lasting(time: Array, holds: BoolArray, least: float = 0.0) -> list[float]:
    """Returns when a condition began that then held for ``least`` seconds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]])))
    stretches = zip(edges[::2], edges[1::2] - 1, strict=True)
    return [float(time[first]) for first, last in stretches if time[last] - time[first] >= least - 1e-9]


def _wrong_turns(case: Judged) -> list[Incident]:
    from shapely import contains_xy

    from roadgpt.network.paved import ribbon

    (road, drive, world), beside = (case.road, case.drive, case.world), _is_beside(case)
    wrong, own = np.zeros(len(drive), bool), {leg.road for leg in legs_of(road, world)}
    steps = np.flatnonzero(beside & (drive["outside"] > GONE))
    for member in network_of(road, world).roads if len(steps) else ():
        x, y = drive["x"][steps], drive["y"][steps]
        on = contains_xy(ribbon(member.road), x, y)
        if member.id in own or not on.any():
            continue
        ahead = member.road.heading(member.road.locate(x[on], y[on])[0])
        turned = np.abs(wrap_angle(drive["heading"][steps[on]] - ahead))
        if member.junction is None:  # an arm, on which one may drive either way
            turned = np.minimum(turned, math.pi - turned)
        wrong[steps[on][turned < ALONG]] = True
    for step in np.flatnonzero(beside[1:]) + 1:
        wrong[step] |= wrong[step - 1]
    return case.began("wrong turn", _lasting(drive["time"], wrong))


def _off_road(case: Judged) -> list[Incident]:
    """The rear axle is assumed to be as far behind the middle of the car as the front axle is ahead of it."""
    import shapely

    from roadgpt.geometry.boxes import corners

    drive, paved = case.drive, network_of(case.road, case.world).paved.buffer(EDGE)
    shapely.prepare(paved)
    size = np.array([2 * (drive.car.axle - drive.car.ahead), drive.car.tyres])
    tyres = corners(drive.middles[:, :2], drive["heading"], size)
    off = ~shapely.contains_xy(paved, tyres[..., 0], tyres[..., 1]).all(axis=1)
    return case.began("off road", _lasting(drive["time"], off))


def _stops_missed(case: Judged) -> list[Incident]:
    drive, missed = case.drive, list[float]()
    front = drive["s"] + drive.car.ahead + drive.car.length / 2
    for line in [way.stop_line for way in case.road.passages if way.stop_line is not None]:
        step = int(np.argmax(front > line))
        near = (front[:step] >= line - STOP_WITHIN) & (drive["speed"][:step] < STOOD)
        if front[step] > line and not near.any():
            missed.append(float(drive["time"][step]))
    return case.began("stop line", missed)


def _is_done(case: Judged, task: "GivenTask") -> bool:
    """Returns whether a driver did what it was told, by how the car moved."""
    drive = case.drive
    when = np.flatnonzero((drive["time"] >= task.start) & (drive["time"] <= task.end))
    s, v, t = (drive[name][when] for name in ("s", "speed", "t"))
    if not len(when):
        return False
    if task.what == "change_lane":
        aside = np.abs(t - case.world.profile_of(case.road).middle(s))
        return bool(((aside < IN_LANE) & (s >= (task.at or 0.0))).any())
    if task.goal == 0.0:
        front = s + drive.car.ahead + drive.car.length / 2
        return bool(((v < STOOD) & (front <= (task.at or np.inf))).any())
    return bool(((v >= task.goal - NEAR) if v[0] < task.goal else (v <= task.goal + NEAR)).any())


def _tasks_missed(case: Judged) -> list[Incident]:
    last = float(case.drive["time"][-1])
    missed = [each for each in case.drive.tasks if not _is_done(case, each)]
    return [one for each in missed for one in case.began("task", [min(each.end, last)], each.did)]


class Criterion(NamedTuple):
    """Something that a test is judged by."""

    name: Cause | IncidentKind
    source: str
    find: Callable[[Judged], Sequence[Incident]] | None = None
    """Finds it; None: a drive ends by it."""
    said: str = ""
    """As an incident, in words, before how often it happened."""
    failed: str = ""
    """The description of a failure, in which ``judging`` fills in the gaps; empty: it fails no test."""
    sbft: str = LEFT
    """What the SBFT competition says of a failure."""
    needs: Set[str] = frozenset()
    """Whether it counts only on a route, or among others."""


STEERED: Set[str] = {"out of lane", "wrong turn", "wrong way", "off road"}
MEETING: Set[str] = {"collision", "near miss", "task"}
"""What the wheel decides, and what is judged whoever had the wheel: the driver can brake at any time."""
ROUTE, OTHERS = frozenset({"route"}), frozenset({"others"})
CRITERIA = (
    Criterion(
        "out of lane", "SBFT tool competition: more of the car's box than the tolerance is outside its lane; "
        "in a junction, that of the route. With lane_departure, a front tyre is beyond a marking",
        _out_of_lane, "out of its lane", "left its lane to the {side}{where} {reached} {fast}{how}",
    ),
    Criterion("fell", "SBFT, as out of lane", None, "", "fell off {deck} to the {side} {reached} {fast}"),
    Criterion("rolled", "ours", None, "", "left the road to the {side} and rolled over {reached} {fast}"),
    Criterion(
        "crashed", "ours", None, "", "left the road to the {side} and crashed into {wall} {reached} {fast}"
    ),
    Criterion("sank", "ours", None, "", "left the road to the {side} and drove into water {reached} {fast}"),
    Criterion(
        "stuck", "SBFT: less than 1 m in 10 s; ours: in 30 s among others, and not behind one of them",
        None, "", "was stuck {reached}: it moved less than 1 m in {patience:.0f} s",
        "Car is not moving fast enough",
    ),
    Criterion(
        "timeout", "SBFT; ours: not behind one of the others",
        None, "", "ran out of time {reached} of {length:.0f} m", "Timeout Simulation",
    ),
    Criterion(
        "wrong turn", "CARLA, stricter: more than 90 % of the car is outside its lane, its centre of gravity "
        "is beside the road of the route, on one that the route does not use, and its heading within 30 "
        "degrees of the direction of that (outside junctions, of either); until the car is back",
        _wrong_turns, "on a wrong road", "took a wrong turn {reached} {fast}", needs=ROUTE,
    ),
    Criterion(
        "wrong way", "ours: on the road of the route, more than 90 degrees from its direction, for 1 s",
        _wrong_ways, "against the direction of its lane",
        "drove against the direction of its lane {reached} {fast}", needs=ROUTE,
    ),
    Criterion(
        "off road", "CARLA, stricter: the outer edge of a tyre is outside the paved area of the network",
        _off_road, "a wheel off the road", needs=ROUTE,
    ),
    Criterion(
        "stop line", "CARLA: the front crosses the line at a stop sign, and the car never stood still (below "
        "0.1 m/s) while its front was within the last 4 m before the line",
        _stops_missed, "no stop at a stop sign",
        "did not stop at the stop sign {reached}: it crossed the line {fast}", SUCCESS, ROUTE,
    ),
    Criterion(
        "task", "ours: what the scene tells, and the driver follows, is not done within 1.2 times as long as "
        "told, and 2 s: a speed within 0.5 m/s, a stop, the new lane within 0.5 m",
        _tasks_missed, "a task not done", "did not do what it was told {reached}: {whom}", SUCCESS,
    ),
    Criterion(
        "collision", "UN R157: the first contact with each of the others (``verdict.contact``); none that "
        "could not have been avoided (``verdict.avoidable``) is a failure",
        lambda case: case.contacts, "a contact", "{contact}", "Car collided", OTHERS,
    ),
    Criterion(
        "near miss", "nuPlan: with somebody who was not hit, a conflict time (``verdict.measures``) below "
        "0.95 s while the tested car moves; Peesapati, Hunter and Rodgers (2013): a post-encroachment time "
        "below 1 s, closest to accidents. None after a collision: nobody moves then as cars would",
        lambda case: case.near_misses, "a near miss", needs=OTHERS,
    ),
    Criterion(
        "red light", "Vienna Convention on Road Traffic (1968): ``verdict.right_of_way``",
        lambda case: [each for each in case.taken if each.kind == "red light"], "past a red light",
        "ran a red light {reached}: it crossed the line {fast}", SUCCESS, ROUTE | OTHERS,
    ),
    Criterion(
        "failure to yield", "Vienna Convention, UN R79: ``verdict.right_of_way``",
        lambda case: [each for each in case.taken if each.kind == "failure to yield"], "no giving way",
        "did not give way to {whom} {reached}: it entered the junction {fast}", SUCCESS, ROUTE | OTHERS,
    ),
    Criterion(
        "blocked", "ours: the car stands (below 0.1 m/s) for 30 s with nobody within 10 m ahead in its lane",
        _blocked, "standing for 30 s before a free way", needs=OTHERS,
    ),
    Criterion(
        "speeding", "ours: more than 5 % and more than 1 m/s above the limit of the lane for 1 s",
        _speeding, "above the speed limit", needs=OTHERS,
    ),
)  # fmt: skip
"""The first one that holds decides, of those of routes the one that came first; among others, that which came
first of all, and at one step rather than the lane and the end of the drive."""
NAMED: dict[str, Criterion] = {each.name: each for each in CRITERIA}


def incidents_of(case: Judged) -> tuple[Incident, ...]:
    """Returns what went wrong in a drive, in order of time, also what the script of the scene ordered."""
    has = (ROUTE if case.is_route else set()) | (OTHERS if case.drive.others is not None else set())
    found = [one for each in CRITERIA if each.find and each.needs <= has for one in each.find(case)]
    return tuple(sorted(found, key=lambda each: each.at_time))


def is_ordered(drive: "Drive", incident: Incident) -> bool:
    """Whether the script had the hand by which something was done: the wheel, or for what is not steered the
    pedals as well. Of what others do to the car, nothing is."""
    if incident.kind in MEETING:
        return False
    hands = {SCRIPT: RETURNS} if incident.kind in STEERED else {SCRIPT: RETURNS, PEDALS: 0.0, RUN_IN: 0.0}
    return any(
        each.start < incident.at_time <= each.end + hands[each.by]
        for each in drive.handovers
        if each.by in hands
    )


def first_failure(
    case: Judged, incidents: Sequence[Incident], known: tuple[int, Cause | None] | None
) -> tuple[int, Criterion | None]:
    """Returns the step at which a drive failed and by which criterion; the last step and None if it did not.
    What decides without incidents may be ``known``. Raises UsageError if the drive was ended for less than
    its tolerance."""
    drive, last = case.drive, len(case.drive) - 1
    times = np.searchsorted(drive["time"], [each.at_time for each in incidents])
    rows = [*zip(np.minimum(times, last).tolist(), (NAMED[each.kind] for each in incidents), strict=True)]
    step, first = known[0] if known else last, NAMED.get(str(known[1] if known else drive.ended))
    if known is None and case.is_out.any():
        step, first = int(np.argmax(case.is_out)), NAMED["out of lane"]
    elif known is None and drive.ended == "out_of_lane":
        raise UsageError(
            f"the drive was ended with {drive['outside'][last]:.3f} of the car outside its lane, which a "
            f"tolerance of {case.world.limits.oob_tolerance:g} allows: drive the road again with this "
            "tolerance"
        )
    other = next((row for row in rows if row[1].failed and row[1].name != "out of lane"), None)
    is_before = other and other[0] <= step and (drive.others is not None or other[1].name == "task")
    is_other = other and (first is None or is_before)
    return other if other and is_other else (step, first)
