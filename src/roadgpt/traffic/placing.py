"""Where somebody of a scene is at first, and on which way it comes to meet the tested car.

What a scene leaves open is chosen so that something comes of it: who crosses or comes towards the tested car
meets it, and the first maneuver begins after ROLL seconds."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import takewhile
from typing import NoReturn

import numpy as np

from roadgpt.brief.scene import HEAD_ON, LEAVES, ON_ITS_WAY, STRUCK, Action, Role
from roadgpt.errors import SceneError
from roadgpt.geometry.boxes import touch
from roadgpt.language.table import ALONG, CUES, MANEUVERS, MOVING, NUMBERS, PLACES, USUAL_SPEEDS, one_of
from roadgpt.network.line import SPACING, Line
from roadgpt.road.road import GOAL
from roadgpt.traffic.actor import SIZES, STILL
from roadgpt.traffic.course import Course, Meeting, Met
from roadgpt.traffic.following import time_over
from roadgpt.traffic.lateral import SHARPEST, Lateral, Offsets
from roadgpt.traffic.longitudinal import EASY, Longitudinal, reach
from roadgpt.traffic.maneuver import LATERAL, REVERSING, ROLL, TURNING, Maneuver, drawn
from roadgpt.traffic.places import bus_bays, stretch_of
from roadgpt.traffic.traffic import Aiming, Stage
from roadgpt.traffic.triggers import LAST, Triggers
from roadgpt.traffic.ways import way_of

SETTLED = 1.0  # s, as ROLL for who is in the tested car's lane at a distance that the scene says
CUT_IN = 10.0  # m, the gap at which one cuts in
LANE = 3.5  # m from lane to lane
APART = 0.05  # m, between who leaves a lane and who stands there
CLEAR = 0.6  # share of a change of lanes after which one is clear of a car in the lane that is left
HEADWAY = 2.0  # s, of who is ahead
BEHIND = 1.5  # s, of who is behind, and of several alike one behind another
INTO = 1.0  # s of headway with which one turns in or merges ahead of the tested car
STANDS = 2.0  # m between several alike that stand
FARTHEST = 60.0  # m, from which somebody comes to cross at a time to collision that is said
ONCOMING = 40.0  # m between several alike that come towards the tested car
NEAR = 10.0  # m before the meeting, where a vehicle waits at a junction
INSIDE = 0.3  # m, by which who drifts against the side of the tested car would come into it
CROSSINGS = ("crossing", "crosswalk")
PLACED = ("gap", "headway", "lead", "station")


class Placing:
    """Somebody of a scene where it is at first, in metres and seconds, with the numbers that were drawn."""

    def __init__(
        self, stage: Stage, lane: Line, role: Role, met: Met, rng: np.random.Generator,
        alike: "Sequence[Placing]", events: dict[tuple[str, ...], float],
    ) -> None:  # fmt: skip
        """Draws its numbers, and places it as seen from the tested car, whose lane is ``lane``, behind those
        of the same role so far, ``alike``. Raises SceneError if the road has no such place."""
        self.stage, self.role, self.met, self.copy = stage, role, met, len(alike)
        self.size, where = SIZES[role.kind], role.where
        self.n, numbers = drawn(role, rng), [drawn(each, rng) for each in role.actions]
        if role.kind == "bus" and where == "parked" and not (role.at or alike or {*PLACED} & {*self.n}):
            bays = [s for s, side in bus_bays(stage.road) if s > met.s and role.side in (None, side)]
            self.n |= {"station": bays[0]} if bays else {}
        self.n |= {field: alike[0].n[field] for field in PLACED if alike and getattr(role, field)}
        is_in_front = role.hits in ("front", "rear") and where in ("ahead", "behind", "oncoming")
        self.on_face = (
            self.n.pop("impact", 0.5) if role.hits and not is_in_front else self.n.get("impact", 0.5)
        )
        """The share of the face that it is to hit from where that counts."""
        cruise, actions = self._cruise(), [*zip(role.actions, numbers, strict=True)]
        comes = where == "junction" and "away" in self.n
        if not actions and (comes or where in CROSSINGS):
            actions = [(Action(what="cross"), {})]
        self.whats, self.maneuvers = [action.what for action, _ in actions], list[Maneuver]()
        for action, n in actions:
            if action.at and not action.at.what:
                first, last = stretch_of(action.at, stage.road, lane)
                before = first if where == "oncoming" else max(first - 2.0 * cruise, 0.0)
                n["station"] = {"after": last, "in": (first + last) / 2, "before": before}[action.at.word]
            earlier = self.whats[: len(self.maneuvers)].count(action.what)
            self.maneuvers.append(Maneuver(action, n, earlier))
        keeps = [*takewhile(lambda each: each.what == "keep" and each.is_open, self.maneuvers)]
        self.lead = next(iter([*self.maneuvers[len(keeps) :], *self.maneuvers]), None)
        """Its first maneuver, or that behind those in which it keeps its speed."""
        self.first = self.lead.what if self.lead else None
        self.cue = self.lead.n if self.lead else dict[str, float]()
        crosses = where == "beside" and not {"cross", "turn_in", "reverse"}.isdisjoint(self.whats)
        crosses |= where in CROSSINGS
        is_along = where in (*ALONG, "parked", "beside") and role.goes != "turn_across" and not crosses
        is_against = where == "oncoming" or self.first == "wrong_way"
        forward = -1 if is_along and is_against else 1
        faces = forward < 0 and bool(self.first in HEAD_ON or {"impact", "overlap"} & {*self.n})
        is_in_lane = where in ("ahead", "behind", "oncoming")
        self.course = Course(lane, lane, self.size.length, forward, is_along, crosses, is_in_lane, faces)
        self.course.backs = crosses and "reverse" in self.whats
        stands = role.kind not in MOVING or where == "parked" or crosses
        stands |= comes or (where == "beside" and "speed" not in self.n)
        if stands and self.maneuvers:  # where it begins to act is where it is
            self.n |= {"station": self.cue.pop("station")} if "station" in self.cue else {}
            if is_along and self.maneuvers[0].is_open:
                self.cue["ttc"] = LAST
        v = 0.0 if stands or self.n.get("speed") == 0 else cruise
        self.offsets = Offsets(
            stage, self.course, where, role.side, self.n, self.first, self.size.width, met.width
        )
        self.lateral = Lateral(self.n.get("offset", 0.0))
        self.longitudinal = Longitudinal(
            self.course, self.lateral, role.kind, cruise, v, self.n.get("speed", 0.0)
        )
        waits = v == 0 and not is_along
        self.triggers = Triggers(
            self.course, self.offsets, self.lateral, self.longitudinal, met, events, waits
        )
        self.held: tuple[float, float] | None = None
        """How far its middle is ahead of the tested car's at first, and how much faster it is, if it keeps to
        that until its first maneuver."""
        self.uncovers = False
        """Whether it leaves its lane in time before those who stand there."""
        self.is_placed = bool(role.at) or not {*PLACED}.isdisjoint(self.n)
        """Whether the scene says where it is at first."""
        is_near = where in ("ahead", "behind") and not {"gap", "headway", "lead"}.isdisjoint(self.n)
        self.rolls = SETTLED if is_near else ROLL
        left = (lane.length - GOAL - met.s) / max(met.v, 1.0)
        if left < self.rolls + SETTLED:  # the drive is over before
            self.rolls = max(left, 0.0) / 2
        keeps = [each for each in keeps if each is not self.lead]
        self.settles = self.rolls + sum(each.n.get("duration", ROLL) for each in keeps)
        """After how many seconds its first maneuver begins that changes something, if nothing is said."""
        for each in self.maneuvers:
            each.rolls = self.settles if each is self.lead is not self.maneuvers[0] else self.rolls
            each.is_at_line = each is self.lead and not self.is_placed and each.what in ("cut_in", "cross")
        turns_off = is_along and "turn_off" in self.whats
        if is_along:
            self._drift_to_hit(v)
            self.course.s = self._beside()
            self.lateral.t = self.offsets.at_first(self.course.s, self.whats)
            if v == 0 and where in ("ahead", "behind"):  # in a lane, also where the route changes lanes
                self.lateral.t += lane.to_lane(self.course.s)
            if self.first == "cut_in" and {"time", "distance", "station"}.isdisjoint(self.cue):
                self.held = (self.course.s - met.s, v - met.v)
        if not is_along or turns_off:
            friction = stage.world.site.friction
            way = alike[0].course.way if alike else replace(self._own_way(), friction=friction)
            assert way.meets is not None
            crossing = Meeting(way.meets[0], lane.from_road(way.meets[1]))
            self.course.way, self.course.shift = way, crossing.its - crossing.own
            if turns_off:
                self.course.s, self.course.meeting = self.course.s - self.course.shift, crossing
            else:
                self._come_to(crossing)
        self.matches = bool(self.course.meeting and v and not turns_off)
        """Whether it comes to its meeting when the tested car does."""
        self.lateral.stays()
        self.put(self.course.s)

    def put(self, s: float) -> None:
        """Puts it at a station of its way, with a speed that is possible there."""
        self.course.s = s
        self.held = self.held and (s - self.met.s, self.held[1])
        self.longitudinal.bend(self.longitudinal.told)
        self.longitudinal.goal = self.longitudinal.v

    def _drift_to_hit(self, v: float) -> None:
        """Lets somebody drift who is to hit somebody, is beside the lane, and does nothing that leads it
        sideways: for a side of the tested car as far as it needs, else to its middle."""
        is_open = {*LATERAL} & {*self.whats} <= {"drift"}
        aside = (
            abs(self.offsets.at_first(self.met.s, self.whats)) if self.role.hits and v and is_open else 0.0
        )
        apart = (self.size.width + self.met.width) / 2
        if aside < apart:
            return
        if "drift" not in self.whats:
            self.maneuvers.append(Maneuver(Action(what="drift"), {}, rolls=self.rolls))
            self.lead = self.lead or self.maneuvers[-1]
            self.cue, self.first = self.lead.n, self.lead.what
        shift = aside if self.role.hits in ("front", "rear") else aside - apart + INSIDE
        for each in self.maneuvers:
            each.n |= {"shift": shift} if each.what == "drift" and "shift" not in each.n else {}

    @property
    def freedoms(self) -> tuple[str, ...]:
        """What of an Aiming the scene leaves open, best first."""
        lead, along = self.lead, ("along",) * (not self.is_placed or self.course.meeting is not None)
        slides = any(each.what in LATERAL for each in self.maneuvers) or self.course.meeting is not None
        is_open = slides and lead and {*CUES, "at"}.isdisjoint(lead.action.model_fields_set)
        may = self.role.hits in STRUCK and {"offset", "overlap"}.isdisjoint(self.n)
        may = may and (not slides or self.first == "drift")
        aside, later = ("aside",) * may, ("time",) * bool(is_open)
        return (*aside, *along, *later) if self.role.hits in ("front", "rear") else (*along, *later, *aside)

    def aim(self, aim: Aiming) -> None:
        """Moves it as far as it needs to hit somebody."""
        course = self.course
        if course.meeting:
            course.meeting = course.meeting._replace(own=course.meeting.own + aim.along)
        self.lateral.t += aim.aside
        if aim.time is not None:
            self.cue.pop("ttc", None)
            self.cue["time"] = max(aim.time, 0.0)
        self.put(course.s + (0.0 if self.triggers.waits else aim.along))

    @property
    def begins(self) -> float:
        """The station of its way where it begins to act."""
        return self.course.s + max(self.triggers.wait(self.maneuvers[0]), 0.0) * self.longitudinal.v

    @property
    def half(self) -> float:
        """How far its middle is from that of the tested car where their boxes meet in a lane."""
        return (self.size.length + self.met.length) / 2

    def between(self, other: "Placing") -> float:
        """Returns how far its middle is from that of another where their boxes meet in a lane."""
        return (self.size.length + other.size.length) / 2

    def touches(self, other: "Placing") -> bool:
        """Returns whether two would be in one place."""
        (x, y, _, heading), (x_2, y_2, _, heading_2) = (
            each.course.way.pose(each.course.s, each.lateral.t) for each in (self, other)
        )
        return bool(touch(x_2 - x, y_2 - y, heading, *self.size[:2], heading_2, *other.size[:2]))

    def runs_into(self, other: "Placing") -> bool:
        """Returns whether one of them would have to brake hard at first behind the other in its lane."""
        one, two = (self, other) if self.course.s < other.course.s else (other, self)
        is_behind = self.course.way is other.course.way is self.course.lane
        is_behind &= self.course.forward == other.course.forward > 0
        is_behind &= abs(self.lateral.t - other.lateral.t) < (self.size.width + other.size.width) / 2
        room = two.course.s - one.course.s - self.between(other)
        needs = max(one.longitudinal.v - two.longitudinal.v, 0.0) ** 2 / 2 / EASY
        return is_behind and one.first not in LEAVES and room < needs

    def part(self, other: "Placing") -> None:
        """Moves it away from another in whose place it would be: in its lane away from the tested car, on a
        way of its own back, or aside if it stands there. Raises SceneError if the scene says where both are.
        """
        course, v, met = self.course, self.longitudinal.v, self.course.meeting
        room = self.between(other) + STANDS + BEHIND * v + (v - other.longitudinal.v) ** 2 / 2 / EASY
        if met and self.triggers.waits:
            aside = math.sin(course.lane.pose(met.its)[3] - course.way.pose(met.own)[3])
            self.lateral.t += math.copysign(self.size.width + 0.5, aside)
        elif met and not course.is_along:
            course.meeting = met._replace(own=met.own - room)
            self.put(course.s - room)
        elif not self.is_placed:
            self.put(other.course.along + math.copysign(room, course.s - self.met.s))
        else:
            raise SceneError(
                f"{one_of(self.role.kind)} {PLACES[self.role.where].said} would be in "
                f"{one_of(other.role.kind)} {PLACES[other.role.where].said}; give one of them another place"
            )

    def leave(self, other: "Placing") -> None:
        """Makes sure that it has left its lane, from a station on, before it is beside somebody who stands
        there: sideways as fast as that needs, if the scene does not say. Raises SceneError if it is too slow.
        """
        maneuver, begins, v, t = self.maneuvers[0], self.begins, self.longitudinal.v, self.lateral.t
        room = other.course.s - begins - self.between(other)
        by = self.offsets.leads_to(maneuver, begins, t) - t
        aside = (
            (self.size.width + other.size.width) / 2 + APART + math.copysign(1, by) * (other.lateral.t - t)
        )
        share = math.acos(1.0 - 2.0 * min(max(aside / abs(by), 0.0), 1.0)) / math.pi
        if not {"lateral", "duration"} & {*maneuver.n}:
            needed = math.pi / 2 * abs(by) * share * v / max(room, 1.0)
            maneuver.n["lateral"] = min(max(LATERAL[maneuver.what], needed), NUMBERS["lateral"].most)
        lasts = maneuver.slides(by, self.course.sideways(v, begins))
        needed = share * max(SHARPEST * math.pi / 2 * abs(by), v * lasts)
        if needed > room:
            raise SceneError(
                f"the {self.role.kind} ahead begins to leave its lane {room:.0f} m before the "
                f"{other.role.kind.replace('_', ' ')} that stands there, and needs {needed:.0f} m at "
                f"{v * 3.6:.0f} km/h; give more distance, a greater 'lat', or less speed"
            )
        self.uncovers = True

    def check(self) -> None:
        """Raises SceneError if it cannot be, or act, where it is."""
        course, met, v = self.course, self.met, self.longitudinal.v
        first = self.maneuvers[0] if self.maneuvers else None
        if course.is_along and course.forward < 0 and course.s < 0:
            self._refuse("drives away before it is on the road; give another place")
        is_behind = self.role.where in ("behind", "parked") and not self.stage.world.first_speed
        if v == 0 and not self.triggers.waits and not course.is_there(is_behind, False):
            is_early = course.along < self.size.length / 2
            end = "begins at 0" if is_early else f"ends at {self.stage.road.length:.0f}"
            self._refuse(f"would stand at {course.along:.0f} m, but the road {end} m; change it")
        if self.held and course.along + ROLL * v < self.size.length / 2:
            self._refuse("would have to act before the begin of the road; give another gap or speed")
        wait = self.triggers.wait(first) if first and (self.triggers.waits or self.held) else 0.0
        if self.triggers.waits and wait < 0:
            self._refuse("cannot be where it meets the tested car in time; give another place, or more speed")
        if self.held and wait == math.inf and first and not first.event:
            self._refuse("never comes to where it is to act; give another gap or speed")
        is_beside = abs(self.lateral.t - met.t) >= (self.size.width + met.width) / 2
        if course.is_along and abs(course.along - met.s) < self.half and not is_beside:
            self._refuse("would be in the tested car at the start; give another gap")
        moves = self.longitudinal.cruise > 0
        for each in self.maneuvers:
            moves = moves or each.what in ("speed", "pull_out")
            moves = moves or (each.what == "overtake" and course.forward > 0)
            moves = moves or max(each.n.get("to", 0.0), each.n.get("accel", 0.0)) > 0
            if each.what in (*LATERAL, "merge") and not moves:
                self._refuse(f"stands, so it never {MANEUVERS[each.what].said}; give it a speed, or 'accel'")
            if each.what in LATERAL:
                self.offsets.leads_to(each, course.along, self.lateral.t)

    def _refuse(self, why: str) -> NoReturn:
        where = self.role.where.replace("lane", "in the next lane")
        raise SceneError(f"the {self.role.kind.replace('_', ' ')} {where} {why}")

    def _cruise(self) -> float:
        """Returns the speed that it has, or comes to as soon as it starts."""
        role, limit = self.role, self.stage.world.limits.speed_limit
        if role.kind not in MOVING:
            return 0.0
        if "speed" in self.n and (self.n["speed"] or role.where not in (*CROSSINGS, "junction")):
            return self.n["speed"]
        if "faster" in self.n:
            return max(self.met.v + self.n["faster"], 0.0)
        if role.kind in USUAL_SPEEDS:
            return min(USUAL_SPEEDS[role.kind] / 3.6, limit)
        if role.where == "beside" and any(each.what == "reverse" for each in role.actions):
            return REVERSING
        if role.actions and role.actions[0].what in ("turn_in", "turn_across"):
            return min(TURNING, limit)
        return limit if role.where == "oncoming" else min(self.met.v, limit) or limit

    def _own_way(self) -> Line:
        """Returns the way of somebody who does not stay along the tested car's lane: to where the tested car
        is when it has rolled for long enough, or to the place that the scene says."""
        lane, (road, world, *_), at = self.course.lane, self.stage, self.role.at
        front, v, crosses = self.met.s + self.half, self.met.v, self.course.crosses
        away, angle = self.n.get("away"), self.n.get("angle")
        near = front + v * (ROLL + HEADWAY if crosses else LAST)
        if at:
            first, last = stretch_of(at, road, lane)
            before, after = first - self.n.get("gap", EASY * v), last + self.n.get("gap", 0.0)
            near = {"after": after, "in": first, "before": before}[at.word]
        near = self.n.get("station", near)
        is_open = crosses and "station" not in self.n and not at
        last = lane.length - GOAL - self.size.width  # so that they meet on a short road, too
        near = min(near, last) if is_open else near
        way = way_of(self.role, lane.to_road(max(near, 0.0)), road, world, away, angle)
        if not crosses or way.meets is None:
            return way
        begin, starts = way.meets[0], self.longitudinal.starts(self.cue)
        lasts = self.cue.get("ttc", time_over(0.0, begin + self.met.width / 2, *starts))
        if "ttc" in self.cue and away is None:
            away = max(begin, min(reach(lasts, 0.0, *starts), FARTHEST))
        if is_open:
            near = max(near, min(front + v * (1.0 + lasts), last))
        return way_of(self.role, lane.to_road(max(near, 0.0)), road, world, away, angle)

    def _come_to(self, crossing: Meeting) -> None:
        """Chooses the meeting of somebody who comes along another way, and where it is at first. The places
        on the tested car are those of Euro NCAP: CCCscp, CCFtap, CMCscp, CMFtap."""
        course, car, role, (length, width, _) = self.course, self.met, self.role, self.size
        v, (own, its) = self.longitudinal.v, crossing
        if "impact" in self.n or role.kind in USUAL_SPEEDS:
            own, its = own + (self.n.get("impact", 0.5) - 0.5) * car.width, its - width / 2
        elif self.first in ("merge", "turn_in") or role.where in ("ramp", "roundabout"):
            its = its - INTO * car.v - length / 2
        elif role.where == "oncoming" or role.side == "opposite":
            own, its = own - length / 2, its - width / math.sqrt(2)
        elif role.kind == "motorcycle":
            own, its = own - (car.width + length) / 2, its + car.length / 10
        else:
            own, its = own - length / 4, its - width / 2
        if v == 0:
            course.meeting, course.s = Meeting(own, its), 0.0 if course.crosses else self._waiting(crossing)
            return
        if "ttc" in self.cue and self.first in ON_ITS_WAY:  # it comes over the line at that time
            own = self.offsets.over_line(crossing) + v * self.cue["ttc"]
        course.meeting = Meeting(own - self.copy * (length + STANDS + BEHIND * v), its)
        eta = (its - car.s - car.length / 2) / max(car.v, 1.0)
        course.s = course.meeting.own - self.triggers.planned(eta, self.maneuvers, self.lead)

    def _waiting(self, met: Meeting) -> float:
        """Returns the station of its way where somebody stands at first who comes along another road."""
        if "away" not in self.n:
            return max(met.own - NEAR, self.size.length / 2)
        way, away = self.course.way, self.n["away"]
        before = way.stations <= met.own
        apart = np.abs(self.course.lane.locate(*way.points[before, :2].T)[1])
        far = np.flatnonzero(apart >= away - SPACING / 2)
        if not len(far):
            raise SceneError(
                f"the road of the {self.role.kind} at the junction begins less than {away:g} m from the "
                "tested car's path; give it less away="
            )
        near = slice(max(far[-1] - 1, 0), far[-1] + 2)
        return float(np.interp(-away, -apart[near], way.stations[before][near]))

    def _beside(self) -> float:
        """Returns the station along the tested car's lane where somebody is at first who is along it."""
        n, car, v, where, length = self.n, self.met, self.longitudinal.v, self.role.where, self.size.length
        apart = length + max(STANDS + BEHIND * v, ONCOMING * (self.course.forward < 0))
        if where == "behind" or (self.first == "overtake" and self.course.forward > 0):
            apart = -apart
        if "station" in n or "lead" in n:
            s = n["station"] if "station" in n else car.s + n["lead"]
        elif self.role.at:
            first, last = stretch_of(self.role.at, self.stage.road, self.course.lane)
            half = length / 2 + n.get("gap", 5.0)
            s = {"after": last + half, "in": (first + last) / 2, "before": first - half}[self.role.at.word]
        else:
            gap = self._said_gap(n)
            sign = -1 if where == "behind" else 1
            s = car.s + sign * ((self._gap_of_cue() if gap is None else gap) + self.half)
            last = self.course.lane.length - length / 2 - 1.0
            if gap is None and v == 0 and car.s + self.half + HEADWAY * car.v < last:
                s = min(s, last)
        return s + self.copy * apart

    def _said_gap(self, n: Mapping[str, float]) -> float | None:
        """Returns the gap of a place or of a condition that is told as a gap or a headway."""
        if "gap" in n or "headway" not in n:
            return n.get("gap")
        behind = self.longitudinal.v if self.role.where == "behind" else self.met.v
        return n["headway"] * behind if behind > STILL else STANDS

    def _gap_of_cue(self) -> float:
        """Returns the gap at first of which nothing is said: that its first maneuver begins in time."""
        car, cue, where, v, lead = self.met, self.cue, self.role.where, self.longitudinal.v, self.lead
        offsets, away = self.offsets, self.course.forward * v - car.v
        rate = -away if where == "behind" else away
        slower, said, comes = max(-rate, 0.0), self._said_gap(cue), LAST
        if where == "oncoming" and self.first in HEAD_ON and lead:
            t = offsets.of(where, car.s)
            aside = abs(offsets.leads_to(lead, car.s, t) - offsets.at_first(car.s, self.whats))
            comes = 1.0 + math.pi / 2 * aside / cue.get("lateral", LATERAL[lead.what])
            cue |= {"ttc": comes} if lead.is_open else {}
        if where == "oncoming" and "station" in cue:  # it is there when they are about to meet
            gap = cue["station"] - self.half - car.s
            return max(gap + v * max(gap + rate * comes, 0.0) / max(car.v, 1.0), ONCOMING)
        if "ttc" in cue and rate < 0:
            at = -rate * cue["ttc"]
        elif lead and (said is not None or self.first == "cut_in"):
            at = CUT_IN if said is None else said
            if self.first == "cut_in":
                at -= rate * self.triggers.until_over_line(lead, car.s, offsets.of(where, car.s))
        elif lead and self.first == "overtake" and self.course.forward > 0:
            closes = max(v - car.v, 0.0) * CLEAR * lead.slides(LANE, self.course.sideways(v, car.s))
            at = max(car.v, closes + STANDS) if where == "behind" else -2 * self.half - car.v
        elif where == "behind":
            return max(BEHIND * v, STANDS)
        elif where in ("lane", "far"):
            return 5.0 - self.half + slower * self.settles
        elif self.course.forward < 0:
            at = -rate * LAST
        else:
            stops = slower**2 / 2 / min(EASY, self.longitudinal.room(False, car.s))
            return max(HEADWAY * car.v, slower * self.rolls + stops, STANDS)
        at -= rate * self.settles
        return max(at, STANDS) if where in ("ahead", "behind") else at
