"""When maneuvers begin, and what they consist of then, for whoever acts and whomever it meets."""

import math
from collections.abc import Sequence

from roadgpt.language.table import MANEUVERS
from roadgpt.traffic.actor import STEP, STILL
from roadgpt.traffic.course import Course, Met
from roadgpt.traffic.following import JAM, time_over
from roadgpt.traffic.lateral import Lateral, Offsets
from roadgpt.traffic.longitudinal import Longitudinal, reach
from roadgpt.traffic.maneuver import (
    BRAKE,
    CHANGE,
    FAST,
    LATERAL,
    REVERSING,
    ROLL,
    STOP,
    TURNING,
    Maneuver,
    Phase,
    starting,
)

LAST = 2.5  # s before a meeting, from which on somebody who is moving no longer matches whom it meets
WAITS = 30.0  # m before the meeting, in which one that stands is held to wait for who stands there


class Triggers:
    """What somebody sees of the time and of whom it meets: by that its maneuvers begin."""

    def __init__(
        self, course: Course, offsets: Offsets, lateral: Lateral, longitudinal: Longitudinal, met: Met,
        events: dict[tuple[str, ...], float], waits: bool,
    ) -> None:  # fmt: skip
        self.course, self.offsets, self.lateral, self.longitudinal = course, offsets, lateral, longitudinal
        self.time, self.met, self.start = 0.0, met, met.s
        self.events = events
        """When what has begun and ended in the scene."""
        self.waits = waits
        """Whether it stands until it has to go to be in time for its meeting."""
        self.signs: dict[Maneuver, float] = {}

    def wait(self, maneuver: Maneuver, before: float | None = None) -> float:
        """Returns in how many seconds a maneuver begins, as far as it can be seen now. The one ``before`` it
        ends in so many seconds; None: there is none."""
        n, met, course, v = maneuver.n, self.met, self.course, self.longitudinal.v
        if maneuver.event:
            return self.events.get(maneuver.event, math.inf) - self.time
        if "time" in n:
            return n["time"] - self.time
        if "distance" in n:
            return (n["distance"] - (met.s - self.start)) / max(met.v, 1e-3)
        if "station" in n:
            left = course.forward * (n["station"] - course.along)
            return left / max(abs(v), 1e-3) if left > 0 else 0.0
        meets = course.faces or course.meeting
        soon = course.eta(v, met) if meets else math.inf
        if course.meeting and v > 0 and not course.is_along:  # it goes on also if the other waits
            soon = min(soon, (course.meeting.own - course.s) / v)
        if "ttc" in n and meets:
            return soon - n["ttc"]
        if {"gap", "headway", "ttc"} & {*n}:
            return self._until(maneuver)
        if maneuver.what == "turn_off" and course.meeting:
            room = course.meeting.own - course.s - (v**2 - n.get("to", TURNING) ** 2) / 2 / STOP
            return max(before or 0.0, room / max(v, 1e-3))
        if before is not None:
            return before
        is_waited_for = met.s < self.start + 1.0 or course.apart(met) < WAITS
        if course.meeting and self.waits and (met.v > STILL or not is_waited_for):
            way = course.forward * (course.meeting.own - course.s)
            return course.eta(v, met) - time_over(0.0, max(way, 0.0), *self.longitudinal.starts(n))
        return soon - LAST if meets and not self.waits else maneuver.rolls - self.time

    def _until(self, maneuver: Maneuver) -> float:
        """Returns in how many seconds a gap, a headway or a time to collision is reached, from either side;
        if it is there from the begin on, the maneuver begins after ``rolls``."""
        n, course, v = maneuver.n, self.course, self.longitudinal.v
        gap, rate = course.gap(v, self.met)
        if "ttc" in n:
            aim = -rate * n["ttc"]
            if rate >= 0:
                return math.inf
        else:
            aim = n["gap"] if "gap" in n else n["headway"] * (self.met.v if course.along > self.met.s else v)
            if maneuver.is_at_line:
                aim -= rate * self.until_over_line(maneuver, course.along, self.lateral.t)
        off = gap - aim
        first = self.signs.setdefault(maneuver, off)
        if abs(first) < 0.3:
            return maneuver.rolls - self.time
        if first * off <= 0 or ("ttc" in n and off < 0):
            return 0.0
        return -off / rate if off * rate < 0 else math.inf

    def until_over_line(self, maneuver: Maneuver, s: float, t: float) -> float:
        """Returns how many seconds after its begin from a place a maneuver leads over the line of the lane of
        whom it meets."""
        course, offsets = self.course, self.offsets
        if maneuver.what == "cross" and course.meeting:
            way = max(offsets.over_line(course.meeting) - course.s, 0.0)
            return time_over(0.0, way, *self.longitudinal.starts(maneuver.n))
        by, outside = offsets.leads_to(maneuver, s, t) - t, abs(t) - offsets.lane_width(s) / 2
        over = min(max((outside - offsets.width / 2) / max(abs(by), 1e-6), 0.0), 1.0)
        lasts = maneuver.slides(by, course.sideways(self.longitudinal.v, s))
        return lasts * math.acos(1.0 - 2.0 * over) / math.pi

    def planned(self, eta: float, maneuvers: Sequence[Maneuver], lead: Maneuver | None) -> float:
        """Returns how far it is to be from its meeting so many seconds before it, by its first maneuver that
        changes something, ``lead``."""
        n, cruise = lead.n if lead else dict[str, float](), self.longitudinal.cruise
        if not {"to", "accel"} & {*n} or {"station", "gap", "headway"} & {*n}:
            assert self.course.meeting is not None
            return self.course.way.before(self.course.meeting.own, cruise, eta)
        last, goal = n.get("ttc", LAST), n.get("to", cruise)
        if {"time", "distance"} & {*n}:
            last = min(max(eta - self.wait(maneuvers[0]), 0.0), eta)
        return cruise * (eta - last) + reach(last, cruise, goal, abs(n.get("accel", CHANGE)))

    def phases(self, maneuver: Maneuver) -> list[Phase]:  # noqa: C901 - a table
        """Returns what a maneuver consists of, seen from where it begins."""
        n, course, speed, t, out = maneuver.n, self.course, self.longitudinal, self.lateral.t, Phase()
        v, limit = speed.v, self.offsets.stage.world.limits.speed_limit
        lasts, accel, to = n.get("duration"), n.get("accel") or None, n.get("to")
        pull = CHANGE if accel is None else abs(accel)
        faster = None if accel is None else FAST * (accel > 0)
        if maneuver.what in LATERAL:
            place = self.offsets.leads_to(maneuver, course.along, t)
            slides = maneuver.slides(abs(place - t), course.sideways(v))
            out = Phase(faster if to is None else to, pull, place, slides, until="there")
        back = out._replace(to=t)
        match maneuver.what:
            case "keep":
                return [Phase(lasts=ROLL if lasts is None else lasts)]
            case "brake":
                return [Phase(min(to or 0.0, v), n.get("decel", BRAKE), lasts=lasts, until="speed")]
            case "stop":
                halt, again = Phase(0.0, n.get("decel", STOP), until="speed"), v or speed.cruise
                goes = Phase(again, starting(speed.kind, again), until="speed")
                return [halt] if lasts is None else [halt, Phase(lasts=lasts), goes]
            case "speed" if to is None and accel is not None:
                return [Phase(faster, pull, lasts=ROLL if lasts is None else lasts)]
            case "speed":
                goal = limit if to is None else to
                if accel is None and lasts:
                    pull, lasts = max(abs(goal - v) / lasts, 1e-6), None
                return [Phase(goal, pull, lasts=lasts, until="speed")]
            case "wait":
                return [
                    Phase(0.0, STOP, until="speed"), Phase(lasts=math.inf if lasts is None else lasts)
                ]  # fmt: skip
            case "open_door":
                return [Phase(0.0, STOP, until="speed"), Phase(lasts=lasts or math.inf)]
            case "drop":
                return [Phase(lasts=STEP)]
            case "creep":
                goal = (MANEUVERS["creep"].usual or 0.0) / 3.6 if to is None else to
                return [Phase(goal, CHANGE, until="speed"), *([Phase(lasts=lasts)] if lasts else [])]
            case "follow":
                headway = max(course.gap(v, self.met)[0] - JAM, 0.0) / max(v, 1.0)
                return [Phase(lasts=math.inf if lasts is None else lasts, follows=headway)]
            case "open_gap":
                slower = max(v - 2.0, 0.0)
                slow, back = Phase(slower, 1.0, until="speed"), Phase(v, 1.0, until="speed")
                return [slow, Phase(lasts=max((lasts or 6.0) - 2 * (v - slower), 0.0)), back]
            case "swerve":
                return [out, Phase(lasts=max((lasts or 0.0) - 2 * out.slides, 0.0)), back]
            case "overtake" if course.forward < 0:
                return [out, Phase(lasts=3.0), back]
            case "overtake":
                goal = max(self.met.v + 20 / 3.6, v) if to is None else to
                fast = Phase(goal, pull, until="passed")
                if self.offsets.where != "behind":
                    return [fast]
                return [out._replace(goal=goal), fast, back._replace(goal=None)]
            case "pull_out":
                goal = limit if to is None else to
                return [out._replace(goal=goal, pull=starting(speed.kind, goal) if accel is None else pull)]
            case "drift" | "cut_in" | "cut_out" | "change_lane" | "wrong_way":
                return [out]
            case "reverse" if not course.backs:
                back = Phase(-(REVERSING if to is None else to), 1.0, until="speed")
                return [Phase(0.0, STOP, until="speed"), back, Phase(lasts=lasts or math.inf)]
            case "turn_off":
                return [Phase(min(v, TURNING) if to is None else to, STOP, until="met")]
            case _:  # merge, turn_in, turn_across, cross, run_light, run_sign, reverse out of a driveway
                goal = speed.cruise if to is None else to
                start = starting(speed.kind, goal) if self.waits else CHANGE
                if course.backs and lasts is not None:
                    return [Phase(goal, start, lasts=lasts), Phase(0.0, STOP, until="speed")]
                return [Phase(goal, start if accel is None else pull, until="met")]
