"""One actor of a scene: where it is at first, how it comes to meet the tested car, and what it does.

What a scene leaves open is chosen so that something comes of it: who crosses or comes towards the tested car
meets it, and the first action begins after ROLL seconds. Speeds change with a constant acceleration.
Sideways, an actor moves by half a cosine wave: slowly at first and at the end, and in the middle with the
greatest speed that its action says."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import takewhile
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.scene import ACCELERATES, HEAD_ON, LEAVES, ON_ITS_WAY, Action, Role
from roadgpt.errors import SceneError
from roadgpt.language.names import Side, What, Where
from roadgpt.language.table import (
    ALONG,
    CUES,
    MANEUVERS,
    MOVING,
    NUMBERS,
    PLACES,
    ROAD_USERS,
    USUAL_SPEEDS,
    one_of,
)
from roadgpt.road.road import GOAL
from roadgpt.road.speed_profile import GRAVITY
from roadgpt.traffic.actor import SIZES, STEP, STILL
from roadgpt.traffic.following import AFTER_CONTACT, HARDEST, JAM, idm, time_over
from roadgpt.traffic.lane_map import LEAST
from roadgpt.traffic.places import offset_of, stretch_of
from roadgpt.traffic.traffic import Stage
from roadgpt.traffic.way import GRIP, LEAST_GRIP, SPACING, Way
from roadgpt.traffic.ways import way_of

ROLL = 4.0  # s, after which the first action begins whose begin the scene leaves open
SETTLED = 1.0  # s, the same for who is in the tested car's lane at a distance that the scene says
LAST = 2.5  # s before a meeting, from which on somebody who is moving no longer matches the tested car
GOES = 2.0  # s before its own meeting, from which on it goes on also if the tested car waits for it
CATCH_UP = 1.0  # s, in which most of the way that is missing before a meeting is made good
MATCHED = 3.0  # m/s^2, with which somebody matches the tested car
SHARPEST = 2.0  # sideways nobody moves faster than the speed ahead divided by this
FAST = 250.0 / 3.6  # m/s, the most that a scene can ask for
BRAKE, STOP = (MANEUVERS[what].usual or 0.0 for what in ("brake", "stop"))
PULL = ROAD_USERS["car"].pull or 0.0
CHANGE = 2.0  # m/s^2
FIRM = 7.0  # m/s^2, the hardest with which one brakes behind others in its lane
EASY = 4.0  # m/s^2, with which the tested car can stop before who stands or is slow
TURNING = 20.0 / 3.6  # m/s, of vehicles that turn at a junction, at most
CUT_IN = 10.0  # m, the gap at which one cuts in
PASSED = 10.0  # m, the gap at which one has overtaken
LANE = 3.5  # m from lane to lane
APART = 0.05  # m, between who leaves a lane and who stands there
CLEAR = 0.6  # share of a change of lanes after which one is clear of a car in the lane that is left
HEADWAY = 2.0  # s, of who is ahead
BEHIND = 1.5  # s, of who is behind, and of several alike one behind another
BEYOND = 50.0  # m off the road: behind a car that stands at its begin, or at its end with something to do
INTO = 1.0  # s of headway with which one turns in or merges ahead of the tested car
STANDS = 2.0  # m between several alike that stand
FARTHEST = 60.0  # m, from which somebody comes to cross at a time to collision that is said
ONCOMING = 40.0  # m between several alike that come towards the tested car
NEAR = 10.0  # m before the meeting, where a vehicle waits at a junction
WAITS = 30.0  # m before the meeting, in which a tested car that stands is held to wait for who stands there
LATERAL: Mapping[What, float] = {
    "swerve": 0.5, "drift": 0.5, "cut_in": 1.5, "cut_out": 1.5, "change_lane": 1.0, "overtake": 1.5,
    "pull_out": 1.0, "wrong_way": 1.0,
}  # fmt: skip
"""The greatest speed sideways in m/s."""
PATH, RUNS, RUNNING_PATH = 1.0, 6.0 / 3.6, 1.5
"""Euro NCAP's persons reach their speed within 1 m (CPNA), or 1.5 m if they run (CPFA)."""
AHEAD = (0.0, 1.0, 2.0, 3.0)  # s, at which bends count for a movement sideways
ROUNDED, STEEP = 0.05, 0.1  # m/s^2, by which limits are told, and from which pull on a grade that is
QUICKEST = 10.0  # m/s^2, with which a person starts at most
CROSSINGS = ("crossing", "crosswalk")
IN_LANE = ("ahead", "behind", "oncoming")
PLACED = ("gap", "headway", "lead", "station")
SCALES: Mapping[str, float] = {
    "speed": 1 / 3.6, "faster": 1 / 3.6, "to": 1 / 3.6, "overlap": 0.01, "impact": 0.01,
}  # fmt: skip


class Car(NamedTuple):
    """The tested car as it is seen from its lane: the station of its middle and its speed in metres and
    seconds, and its size."""

    s: float
    v: float
    length: float
    width: float


@dataclass(frozen=True, eq=False)
class Deed:
    """An action, and the numbers that were drawn for it, in metres, seconds and shares. Two of them are never
    equal: a second swerve is another one."""

    action: Action
    n: dict[str, float]

    @property
    def what(self) -> What:
        """What is done."""
        return self.action.what

    @property
    def event(self) -> tuple[str, ...] | None:
        """What somebody else does, on which it begins."""
        mark = self.action.at
        return (mark.word, mark.of, str(mark.number), mark.what) if mark and mark.what else None

    @property
    def is_open(self) -> bool:
        """Whether the scene leaves open when it begins."""
        return self.event is None and not {*CUES} & {*self.n}


class Meeting(NamedTuple):
    """Two stations in metres that are to be reached at the same time: that of an actor's middle along its
    way, and that of the tested car's front along its lane."""

    own: float
    car: float


class Phase(NamedTuple):
    """A part of an action."""

    goal: float | None = None
    """The speed in m/s that it comes to, by ``pull``; negative backwards, None: as it is."""
    pull: float = CHANGE
    to: float | None = None
    """Where it moves to sideways, in metres to the left of the way, within ``slides`` seconds."""
    slides: float = 0.0
    lasts: float | None = None
    """After how many seconds it ends at the latest; the speed that is reached by then stays."""
    until: Literal["speed", "there", "passed", "met"] | None = None
    follows: float | None = None
    """The headway in seconds to the tested car that it keeps."""


class Slide(NamedTuple):
    """A movement sideways in half a cosine wave: its begin and its extent in metres, and seconds."""

    begin: float
    by: float
    lasts: float

    @property
    def peak(self) -> float:
        """The greatest speed in m/s."""
        return math.pi / 2 * abs(self.by) / self.lasts


def drawn(thing: Role | Action, rng: np.random.Generator) -> dict[str, float]:
    """Returns a number for each range of a role or an action, in metres, seconds and shares."""
    found = {}
    for field, number in NUMBERS.items():
        amount = getattr(thing, field, None)
        if amount is not None:
            low = number.least if amount.lo is None else amount.lo
            high = number.most if amount.hi is None else amount.hi
            one = float(rng.uniform(low, high)) if low < high else low
            found[field] = one * SCALES.get(field, 1.0)
    return found


def _slides(deed: Deed, by: float, most: float) -> float:
    """Returns how many seconds a movement sideways by some metres lasts, with at most so many m/s^2."""
    lasts = math.pi / 2 * abs(by) / deed.n.get("lateral", LATERAL[deed.what])
    if "duration" in deed.n and "lateral" not in deed.n:
        lasts = deed.n["duration"] * (0.5 if deed.what == "swerve" else 1.0)
    return max(lasts, math.pi * math.sqrt(abs(by) / 2 / most), 1e-3)


def reach(time: float, speed: float, goal: float, pull: float) -> float:
    """Returns how far one comes in some seconds whose speed changes to ``goal`` with ``pull``."""
    changes = min(time, abs(goal - speed) / max(pull, 1e-9))
    last = speed + math.copysign(pull * changes, goal - speed)
    return (speed + last) / 2 * changes + last * (time - changes)


class Act:
    """An actor of a scene on its way, in metres and seconds."""

    def __init__(
        self, stage: Stage, path: Way, role: Role, car: Car, rng: np.random.Generator,
        events: dict[tuple[str, ...], float], name: tuple[str, str], alike: "list[Act]",
    ) -> None:  # fmt: skip
        """Draws its numbers, and places it as seen from the tested car, whose lane is ``path``, behind those
        of the same role so far, ``alike``, of whom only the first one makes events: ``events`` holds when
        what has begun and ended in the scene, and calls it ``name``. Raises SceneError if the road has no
        such place."""
        self.road, self.world, self.path, self.role = stage.road, stage.world, path, role
        self.kind, self.where, self.side, self.size = role.kind, role.where, role.side, SIZES[role.kind]
        self.time, self.car, self.start = 0.0, car, car.s
        self.events, self.name, self.copy = events, name, len(alike)
        self.half = (self.size.length + car.length) / 2
        self.limit = self.world.limits.speed_limit
        self.kerb = self.world.profile_of(self.road).side
        self.n, numbers = drawn(role, rng), [drawn(each, rng) for each in role.actions]
        self.n |= {field: alike[0].n[field] for field in PLACED if alike and getattr(role, field)}
        self.cruise = self._cruise()
        """The speed that it is to have when it meets the tested car."""
        self.deeds = [self._deed(*each) for each in zip(role.actions, numbers, strict=True)]
        comes = self.where == "junction" and "away" in self.n
        if not self.deeds and (comes or self.where in CROSSINGS):
            self.deeds = [Deed(Action(what="cross"), {})]
        whats = [deed.what for deed in self.deeds]
        keeps = [*takewhile(lambda deed: deed.what == "keep" and deed.is_open, self.deeds)]
        self.lead = next(iter([*self.deeds[len(keeps) :], *self.deeds]), None)
        """Its first action, or that behind those in which it keeps its speed."""
        self.first = self.lead.what if self.lead else None
        self.cue = self.lead.n if self.lead else dict[str, float]()
        crosses = self.where == "beside" and not {"cross", "turn_in"}.isdisjoint(whats)
        self.crosses = crosses or self.where in CROSSINGS
        is_along = self.where in (*ALONG, "parked", "beside") and role.goes != "turn_across"
        self.is_along = is_along and not self.crosses
        is_against = self.where == "oncoming" or self.first == "wrong_way"
        self.forward = -1 if self.is_along and is_against else 1
        """1 along its way, -1 against it."""
        stands = self.kind not in MOVING or self.where == "parked" or self.crosses
        stands |= comes or (self.where == "beside" and "speed" not in self.n)
        if stands and self.deeds:  # where it begins to act is where it is
            self.n |= {"station": self.cue.pop("station")} if "station" in self.cue else {}
            if self.is_along and self.deeds[0].is_open:
                self.cue["ttc"] = LAST
        self.v = v = 0.0 if stands or self.n.get("speed") == 0 else self.cruise
        self.slide: Slide | None = None
        self.limited: dict[int, tuple[str, bool]] = {}
        """Of the actions that ask for more than there is, in words with how much less they were done, and
        whether the scene says the number and the road does not give it; -1 is its speed."""
        self.way, self.shift, self.t = path, 0.0, self.n.get("offset", 0.0)
        """From a station of its way, ``shift`` leads to that of the tested car's lane beside it; ``t`` is how
        far it is to the left of its way."""
        self.meeting: Meeting | None = None
        self.faces = self.forward < 0 and bool(self.first in HEAD_ON or {"impact", "overlap"} & {*self.n})
        """Whether it comes towards the tested car in its lane, or will."""
        self.held: tuple[float, float] | None = None
        """How far its middle is ahead of the tested car's at first, and how much faster it is, if it keeps to
        that until its first action."""
        turns_off = self.is_along and "turn_off" in whats
        is_near = self.where in ("ahead", "behind") and not {"gap", "headway", "lead"}.isdisjoint(self.n)
        self.rolls = SETTLED if is_near else ROLL
        left = (path.length - GOAL - car.s) / max(car.v, 1.0)
        if left < self.rolls + SETTLED:  # the drive is over before
            self.rolls = max(left, 0.0) / 2
        keeps = [each for each in keeps if each is not self.lead]
        self.settles = self.rolls + sum(each.n.get("duration", ROLL) for each in keeps)
        """After how many seconds that begins if nothing is said."""
        self.is_placed = bool(role.at) or not {*PLACED}.isdisjoint(self.n)
        """Whether the scene says where it is at first."""
        if self.is_along:
            self.s = self._beside()
            self.t = self._aside(self.s)
            if self.first == "cut_in" and {"time", "distance", "station"}.isdisjoint(self.cue):
                self.held = (self.s - car.s, v - car.v)
        if not self.is_along or turns_off:
            self.way = alike[0].way if alike else replace(self._own_way(), friction=self.world.site.friction)
            assert self.way.meets is not None
            crossing = Meeting(self.way.meets[0], path.from_road(self.way.meets[1]))
            self.shift = crossing.car - crossing.own
            if turns_off:
                self.s, self.meeting = self.s - self.shift, crossing
            else:
                self.meeting, self.s = self._crossing(crossing)
        self.keeps_lane = abs(self.t) > LEAST / 2
        """Whether it stays in its lane where the tested car's way changes lanes, and does not go with it."""
        self.waits = v == 0 and not self.is_along
        """Whether it stands until it has to go to be in time for its meeting."""
        self.matches = bool(self.meeting and v and not turns_off)
        """Whether it comes to its meeting when the tested car does."""
        self.uncovers = False
        """Whether it leaves its lane in time before those who stand there."""
        self.inside = 0.0 if self.way.road_stations is None else self.size.length / 2 - 0.01
        """How far its middle is at least from the ends of its way, or it is not there."""
        self.put(self.s)
        self.hits: bool | None = None
        """Whether it hit the tested car from behind when it first touched it; None if it has not."""
        self.ahead: tuple[float, float] | None = None
        """How far it is to who is ahead of it on its way, in metres, and how fast that moves as it does."""
        self.pull, self.begun = CHANGE, 0
        self.shown = set[int]()
        """The numbers of the actions that it did while it was there."""
        self.phases: list[Phase] = []
        self.clock, self.slid, self.slope = 0.0, 0.0, 0.0
        self.signs: dict[int, float] = {}

    def put(self, s: float) -> None:
        """Puts it at a station of its way, with a speed that is possible there."""
        self.s = s
        self.held = self.held and (s - self.car.s, self.held[1])
        self.goal = self.v = min(self.v, self._bend()[1])

    def _bend(self) -> tuple[float, float]:
        """See ``Way.bend``; notes where it is slower than the scene says."""
        stretch, fastest = self.way.bend(self.s, self.t, self.forward)
        told = min(self.v, self.n.get("speed", 0.0))
        if fastest < told - STILL and (self.way is self.path or not self.time):
            slower = f" is slower than {3.6 * self.n['speed']:.0f} km/h where it comes to a bend"
            self.limited.setdefault(-1, (slower, False))
        return stretch, fastest

    def part(self, other: "Act") -> None:
        """Moves it away from another in whose place it would be: in its lane away from the tested car, on a
        way of its own back, or aside if it stands there. Raises SceneError if the scene says where both are.
        """
        room = self.between(other) + STANDS + BEHIND * self.v + (self.v - other.v) ** 2 / 2 / EASY
        if self.meeting and self.waits:
            aside = math.sin(self.path.pose(self.meeting.car)[3] - self.way.pose(self.meeting.own)[3])
            self.t += math.copysign(self.size.width + 0.5, aside)
        elif self.meeting and not self.is_along:
            self.meeting = self.meeting._replace(own=self.meeting.own - room)
            self.put(self.s - room)
        elif not self.is_placed:
            self.put(other.along + math.copysign(room, self.s - self.car.s))
        else:
            raise SceneError(
                f"{one_of(self.kind)} {PLACES[self.where].said} would be in {one_of(other.kind)} "
                f"{PLACES[other.where].said}; give one of them another place"
            )

    def _deed(self, action: Action, n: dict[str, float]) -> Deed:
        if action.at and not action.at.what:
            first, last = stretch_of(action.at, self.road, self.path)
            before = first if self.where == "oncoming" else max(first - 2.0 * self.cruise, 0.0)
            n["station"] = {"after": last, "in": (first + last) / 2, "before": before}[action.at.word]
        return Deed(action, n)

    def _cruise(self) -> float:
        """The speed that it has, or comes to as soon as it starts."""
        if self.kind not in MOVING:
            return 0.0
        if "speed" in self.n and (self.n["speed"] or self.where not in (*CROSSINGS, "junction")):
            return self.n["speed"]
        if "faster" in self.n:
            return max(self.car.v + self.n["faster"], 0.0)
        if self.kind in USUAL_SPEEDS:
            return min(USUAL_SPEEDS[self.kind] / 3.6, self.limit)
        if self.role.actions and self.role.actions[0].what in ("turn_in", "turn_across"):
            return min(TURNING, self.limit)
        return self.limit if self.where == "oncoming" else min(self.car.v, self.limit) or self.limit

    def check(self) -> None:
        """Raises SceneError if it cannot be, or act, where it is."""

        def refuse(why: str) -> None:
            where = self.where.replace("lane", "in the next lane")
            raise SceneError(f"the {self.kind.replace('_', ' ')} {where} {why}")

        first = self.deeds[0] if self.deeds else None
        if self.is_along and self.forward < 0 and self.s < 0:
            refuse("drives away before it is on the road; give another place")
        if self.v == 0 and not self.waits and self.state() is None:
            refuse(
                f"would stand at {self.along:.0f} m, but the road ends at {self.road.length:.0f} m; change it"
            )
        if self.held and self.along + ROLL * self.v < self.size.length / 2:
            refuse("would have to act before the begin of the road; give another gap or speed")
        wait = self.wait(first) if first and (self.waits or self.held) else 0.0
        if self.waits and wait < 0:
            refuse("cannot be where it meets the tested car in time; give another place, or more speed")
        if self.held and wait == math.inf and first and not first.event:
            refuse("never comes to where it is to act; give another gap or speed")
        half = (self.size.width + self.car.width) / 2
        if self.is_along and abs(self.along - self.car.s) < self.half and abs(self.t) < half:
            refuse("would be in the tested car at the start; give another gap")
        moves = self.cruise > 0
        for deed in self.deeds:
            moves = moves or deed.what in ("speed", "pull_out")
            moves = moves or (deed.what == "overtake" and self.forward > 0)
            moves = moves or max(deed.n.get("to", 0.0), deed.n.get("accel", 0.0)) > 0
            if deed.what in (*LATERAL, "merge") and not moves:
                refuse(f"stands, so it never {MANEUVERS[deed.what].said}; give it a speed, or 'accel'")
            if deed.what in LATERAL:
                self._leads_to(deed, self.along, self.t)

    # where it is at first

    def _own_way(self) -> Way:
        """Returns the way of somebody who does not stay along the tested car's lane: to where the tested car
        is when it has rolled for long enough, or to the place that the scene says."""
        front, v, away = self.car.s + self.half, self.car.v, self.n.get("away")
        near = front + v * (ROLL + HEADWAY if self.crosses else LAST)
        if self.role.at:
            first, last = stretch_of(self.role.at, self.road, self.path)
            before, after = first - self.n.get("gap", EASY * v), last + self.n.get("gap", 0.0)
            near = {"after": after, "in": first, "before": before}[self.role.at.word]
        near = self.n.get("station", near)
        is_open = self.crosses and "station" not in self.n and not self.role.at
        last = self.path.length - GOAL - self.size.width  # so that they meet on a short road, too
        near = min(near, last) if is_open else near
        way = way_of(self.role, self.path.to_road(max(near, 0.0)), self.road, self.world, away)
        if not self.crosses or way.meets is None:
            return way
        begin, starts = way.meets[0], self._starts(self.cue)
        lasts = self.cue.get("ttc", time_over(0.0, begin + self.car.width / 2, *starts))
        if "ttc" in self.cue and away is None:
            away = max(begin, min(reach(lasts, 0.0, *starts), FARTHEST))
        if is_open:
            near = max(near, min(front + v * (1.0 + lasts), last))
        return way_of(self.role, self.path.to_road(max(near, 0.0)), self.road, self.world, away)

    def _crossing(self, met: Meeting) -> tuple[Meeting, float]:
        """Returns the meeting of somebody who comes along another way, and the station where it is at first.
        The places on the tested car are those of Euro NCAP: CCCscp, CCFtap, CMCscp, CMFtap."""
        car, (length, width, _) = self.car, self.size
        if "impact" in self.n or self.kind in USUAL_SPEEDS:
            hit = (self.n.get("impact", 0.5) - 0.5) * car.width
            found = Meeting(met.own + hit, met.car - width / 2)
        elif self.first in ("merge", "turn_in") or self.where in ("ramp", "roundabout"):
            found = Meeting(met.own, met.car - INTO * car.v - length / 2)
        elif self.where == "oncoming" or self.side == "opposite":
            found = Meeting(met.own - length / 2, met.car - width / math.sqrt(2))
        elif self.kind == "motorcycle":
            found = Meeting(met.own - (car.width + length) / 2, met.car + car.length / 10)
        else:
            found = Meeting(met.own - length / 4, met.car - width / 2)
        if self.v == 0:
            return found, 0.0 if self.crosses else self._waiting(met)
        if "ttc" in self.cue and self.first in ON_ITS_WAY:  # it comes over the line at that time
            found = found._replace(own=self._over_line(met) + self.v * self.cue["ttc"])
        self.meeting = found._replace(own=found.own - self.copy * (length + STANDS + BEHIND * self.v))
        eta = (found.car - car.s - car.length / 2) / max(car.v, 1.0)
        return self.meeting, self.meeting.own - self._planned(eta)

    def _waiting(self, met: Meeting) -> float:
        """Returns the station of its way where somebody stands at first who comes along another road."""
        if "away" not in self.n:
            return max(met.own - NEAR, self.size.length / 2)
        before = self.way.stations <= met.own
        apart = np.abs(self.path.locate(*self.way.points[before, :2].T)[1])
        far = np.flatnonzero(apart >= self.n["away"] - SPACING / 2)
        if not len(far):
            raise SceneError(
                f"the road of the {self.kind} at the junction begins less than {self.n['away']:g} m from the "
                "tested car's path; give it less away="
            )
        near = slice(max(far[-1] - 1, 0), far[-1] + 2)
        return float(np.interp(-self.n["away"], -apart[near], self.way.stations[before][near]))

    def _beside(self) -> float:
        """Returns the station along the tested car's lane where somebody is at first who is along it."""
        n, car, v, length = self.n, self.car, self.v, self.size.length
        apart = length + max(STANDS + BEHIND * v, ONCOMING * (self.forward < 0))
        if self.where == "behind" or (self.first == "overtake" and self.forward > 0):
            apart = -apart
        if "station" in n or "lead" in n:
            s = n["station"] if "station" in n else car.s + n["lead"]
        elif self.role.at:
            first, last = stretch_of(self.role.at, self.road, self.path)
            half = length / 2 + n.get("gap", 5.0)
            s = {"after": last + half, "in": (first + last) / 2, "before": first - half}[self.role.at.word]
        else:
            gap = self._said_gap(n)
            sign = -1 if self.where == "behind" else 1
            s = car.s + sign * ((self._gap_of_cue() if gap is None else gap) + self.half)
            last = self.path.length - length / 2 - 1.0
            if gap is None and v == 0 and car.s + self.half + HEADWAY * car.v < last:
                s = min(s, last)
        return s + self.copy * apart

    def _said_gap(self, n: Mapping[str, float]) -> float | None:
        """Returns the gap of a place or of a condition that is told as a gap or a headway."""
        if "gap" in n or "headway" not in n:
            return n.get("gap")
        behind = self.v if self.where == "behind" else self.car.v
        return n["headway"] * behind if behind > STILL else STANDS

    def _gap_of_cue(self) -> float:
        """Returns the gap at first of which nothing is said: that its first action begins after ``rolls``."""
        car, cue = self.car, self.cue
        away = self.forward * self.v - car.v
        rate = -away if self.where == "behind" else away
        slower, said, v, comes = max(-rate, 0.0), self._said_gap(cue), self.v, LAST
        if self.where == "oncoming" and self.first in HEAD_ON and self.lead:
            t = self._place(self.where, car.s)
            aside = abs(self._leads_to(self.lead, car.s, t) - self._aside(car.s))
            comes = 1.0 + math.pi / 2 * aside / cue.get("lateral", LATERAL[self.lead.what])
            cue |= {"ttc": comes} if self.lead.is_open else {}
        if self.where == "oncoming" and "station" in cue:  # it is there when they are about to meet
            gap = cue["station"] - self.half - car.s
            return max(gap + v * max(gap + rate * comes, 0.0) / max(car.v, 1.0), ONCOMING)
        if "ttc" in cue and rate < 0:
            at = -rate * cue["ttc"]
        elif said is not None or self.first == "cut_in":
            at = CUT_IN if said is None else said
            if self.first == "cut_in":
                assert self.lead is not None
                at -= rate * self._until_over_line(self.lead, car.s, self._place(self.where, car.s))
        elif self.first == "overtake" and self.forward > 0:
            assert self.lead is not None
            closes = max(v - car.v, 0.0) * CLEAR * _slides(self.lead, LANE, self._sideways(car.s))
            at = max(car.v, closes + STANDS) if self.where == "behind" else -2 * self.half - car.v
        elif self.where == "behind":
            return max(BEHIND * self.v, STANDS)
        elif self.where in ("lane", "far"):
            return 5.0 - self.half + slower * self.settles
        elif self.forward < 0:
            at = -rate * LAST
        else:
            stops = slower**2 / 2 / min(EASY, self._room(False, car.s))
            return max(HEADWAY * car.v, slower * self.rolls + stops, STANDS)
        at -= rate * self.settles
        return max(at, STANDS) if self.where in ("ahead", "behind") else at

    def _across(self) -> float:
        """Returns where in the tested car's lane it is, or comes to: see ``overlap`` and ``impact``."""
        car, width = self.car, self.size.width
        left = {"left": 1, "right": -1}.get(str(self.side), self.kerb)
        if "impact" in self.n and self.is_along:
            return (self.kerb if self.where == "oncoming" else left) * car.width * (0.5 - self.n["impact"])
        if self.where == "oncoming":
            left = -self.kerb
        share = self.n.get("overlap", 1.0)
        most = min(width, car.width) / car.width
        return 0.0 if share >= most - 1e-9 else left * ((car.width + width) / 2 - share * car.width)

    def _aside(self, s: float) -> float:
        """Returns how far to the left of the middle of the tested car's lane it is at first."""
        comes_later = any(deed.what in ("cut_in", *HEAD_ON) for deed in self.deeds)
        given = {"impact", "overlap"} & {*self.n}
        if self.where in ("ahead", "behind") or (given and not comes_later):
            return self.n.get("offset", 0.0) + (self._across() if given else 0.0)
        return self._place(self.where, s) + self.n.get("offset", 0.0)

    def _place(self, where: Where, s: float, side: Side | None = None) -> float:
        if side is None and self.side in ("left", "right"):
            side = self.side
        if where == "beside" and "away" in self.n:
            return self.n["away"] * {"left": 1, "right": -1}.get(str(side), self.kerb)
        place = self.path.to_road(min(max(s, 0.0), self.path.length)), self.road, self.world, self.size.width
        try:
            return offset_of(where, side, *place)
        except SceneError:
            is_kerb = side == ("left" if self.kerb > 0 else "right")
            if where != "lane" or is_kerb or self.first not in ("cut_in", "overtake"):
                raise
            return offset_of("oncoming", None, *place)

    def _leads_to(self, deed: Deed, s: float, t: float) -> float:
        """Returns where an action leads to from a place, in metres to the left of the middle of the tested
        car's lane."""
        width = float(self.world.profile_of(self.road).width(self.path.to_road(s)))
        side = deed.action.side
        match deed.what:
            case "cut_out":
                return self._place("lane", s, side)
            case "change_lane" if self.where in ("ahead", "behind") and abs(t) < width / 2:
                return self._place("lane", s, side)
            case "change_lane" if self.where == "oncoming":
                return t + math.copysign(width, t if side is None else 1 if side == "left" else -1)
            case "change_lane" if side in (None, "right" if t > 0 else "left"):
                return 0.0 if self.where == "lane" else self._place("lane", s)
            case "change_lane":
                return self._place("far", s, side)
            case "overtake" if self.where == "behind":
                return self._place("lane", s, "left" if self.kerb < 0 else "right")
            case "drift":
                room = min(1.0, max(abs(t) - width / 2 - 0.2, 0.5))
                left = side == "left" if side else t < 0 if abs(t) > width / 2 else self.kerb > 0
                return t + (1 if left else -1) * deed.n.get("shift", room)
            case "swerve":
                before = sum(each.what == "swerve" for each in self.deeds[: self.deeds.index(deed)])
                shift = deed.n.get("shift", max((width - self.size.width) / 2 - 0.1, 0.3))
                return t + (-shift if before % 2 else shift)
            case "wrong_way" if self.where != "oncoming":
                return t
            case _:  # cut_in, wrong_way, pull_out, overtake of who comes towards the tested car
                return self._across()

    def leave(self, other: "Act") -> None:
        """Makes sure that it has left its lane, from a station on, before it is beside somebody who stands
        there: sideways as fast as that needs, if the scene does not say. Raises SceneError if it is too slow.
        """
        deed, begins = self.deeds[0], self.begins
        room = other.s - begins - self.between(other)
        by = self._leads_to(deed, begins, self.t) - self.t
        aside = (self.size.width + other.size.width) / 2 + APART + math.copysign(1, by) * (other.t - self.t)
        share = math.acos(1.0 - 2.0 * min(max(aside / abs(by), 0.0), 1.0)) / math.pi
        if not {"lateral", "duration"} & {*deed.n}:
            needed = math.pi / 2 * abs(by) * share * self.v / max(room, 1.0)
            deed.n["lateral"] = min(max(LATERAL[deed.what], needed), NUMBERS["lateral"].most)
        lasts = _slides(deed, by, self._sideways(begins))
        needed = share * max(SHARPEST * math.pi / 2 * abs(by), self.v * lasts)
        if needed > room:
            raise SceneError(
                f"the {self.kind} ahead begins to leave its lane {room:.0f} m before the "
                f"{other.kind.replace('_', ' ')} that stands there, and needs {needed:.0f} m at "
                f"{self.v * 3.6:.0f} km/h; give more distance, a greater 'lat', or less speed"
            )
        self.uncovers = True

    # how it moves

    @property
    def along(self) -> float:
        """The station along the tested car's lane."""
        return self.s + self.shift

    @property
    def begins(self) -> float:
        """The station of its way where it begins to act, as far as it can be seen now."""
        return self.s + max(self.wait(self.deeds[0]), 0.0) * self.v

    def between(self, other: "Act") -> float:
        """Returns how far its middle is from that of another where their boxes meet in a lane."""
        return (self.size.length + other.size.length) / 2

    def runs_into(self, other: "Act") -> bool:
        """Returns whether one of them would have to brake hard at first behind the other in its lane."""
        one, two = (self, other) if self.s < other.s else (other, self)
        is_behind = self.way is other.way is self.path and self.forward == other.forward > 0
        is_behind &= abs(self.t - other.t) < (self.size.width + other.size.width) / 2
        room = two.s - one.s - self.between(other)
        return is_behind and one.first not in LEAVES and room < max(one.v - two.v, 0.0) ** 2 / 2 / EASY

    @property
    def minds(self) -> bool:
        """Whether it drives behind the tested car as behind others: who comes from behind to overtake it, and
        others who have done all that they do, or are late where they meet it."""
        if self.where == "behind":
            return any(deed.what == "overtake" for deed in self.deeds)
        has_done = self.begun == len(self.deeds) and not self.phases
        return self.hits is None and (self._apart() < -self.car.length if self.meeting else has_done)

    def state(self) -> tuple[float, ...] | None:
        """Returns its state; None while it is not there: its box is not yet, or no longer, on its way."""
        is_behind = self.where == "behind" and not self.world.first_speed
        acts = self.v > 0 and len(self.shown) < len(self.deeds)
        first, last = (-BEYOND if self.inside and each else self.inside for each in (is_behind, acts))
        if not first <= self.s <= self.way.length - last:
            return None
        x, y, z, heading = self.way.pose(self.s, self.t)
        turned = math.atan(self.slope)
        heading += turned if self.forward > 0 else math.pi - turned
        return x, y, z, heading, math.copysign(math.hypot(self.v, self.v * self.slope), self.v)

    def move(self, time: float, car: Car) -> None:
        """Moves it from a time to STEP later."""
        self.time, self.car, left = time, car, STEP
        if self.hits:
            self.goal, self.pull, self.phases = 0.0, AFTER_CONTACT, []
            self.v = min(self.v, max(car.v, 0.0))
        elif not self.begun:
            self._match()
        while self.begun < len(self.deeds) and not self.hits:
            deed = self.deeds[self.begun]
            wait = max(self.wait(deed), 0.0)
            if wait >= left:
                break
            self._go(wait)
            left -= wait
            self.begun += 1
            self._tell("with")
            self.phases = self._phases(deed)
            self._show()
            self._enter()
        self._go(left)
        if self.phases:
            self._show()

    def _show(self) -> None:
        """Notes that it does what it does, if it is there; who meets the tested car where the scene leaves
        open when, does so on its path and before the car has passed."""
        if not self.begun or self.state() is None:
            return
        deed = self.deeds[self.begun - 1]
        if self.meeting and not self.is_along and deed.is_open and deed.what in ON_ITS_WAY:
            left = self.meeting.own - self.s - self.size.length / 2
            if left > self.car.width or self.car.s - self.car.length / 2 > self.meeting.car:
                return
        self.shown.add(self.begun - 1)

    def _tell(self, word: str) -> None:
        if not self.copy:
            self.events[word, *self.name, self.deeds[self.begun - 1].what] = self.time

    def _match(self) -> None:
        """Chooses the speed before the first action, so that it meets the tested car whatever that does."""
        if self.held:
            ahead, faster = self.held
            wanted = (ahead + faster * self.time - (self.along - self.car.s)) / CATCH_UP
            wanted += self.car.v + faster
            self.goal, self.pull = min(max(wanted, self.cruise / 2), FAST), MATCHED
        elif self.matches and self.meeting:
            eta, self.goal, self.pull = self._eta(), self.cruise, MATCHED
            way = self.meeting.own - self.s
            self.matches = eta > LAST and way > self._planned(GOES)
            if self.matches:
                missing = way - self._planned(eta)
                faster = math.copysign(min(abs(missing) / CATCH_UP, math.sqrt(4.0 * abs(missing))), missing)
                least = 0.5 if self.state() or self.car.v < STILL else 0.0  # else both would wait
                self.goal = min(max(self.cruise + faster, least * self.cruise), 1.5 * self.cruise)

    def _eta(self) -> float:
        """The seconds until the tested car is where they meet, as fast as both are now."""
        gap, rate = (self._apart(), -self.car.v) if self.meeting and not self.faces else self.gap()
        return gap / max(-rate, 1e-3)

    def _apart(self) -> float:
        """How far the front of the tested car is before where they meet."""
        return self.meeting.car - self.car.s - self.car.length / 2 if self.meeting else math.inf

    def _planned(self, eta: float) -> float:
        """Returns how far it is to be from its meeting so many seconds before it."""
        n = self.cue
        if not {"to", "accel"} & {*n} or {"station", "gap", "headway"} & {*n}:
            assert self.meeting is not None
            return self.way.before(self.meeting.own, self.cruise, eta)
        last, goal = n.get("ttc", LAST), n.get("to", self.cruise)
        if {"time", "distance"} & {*n}:
            last = min(max(eta - self.wait(self.deeds[0]), 0.0), eta)
        return self.cruise * (eta - last) + reach(last, self.cruise, goal, abs(n.get("accel", CHANGE)))

    def wait(self, deed: Deed) -> float:
        """Returns in how many seconds an action begins, as far as it can be seen now."""
        n, car = deed.n, self.car
        if deed.event:
            return self.events.get(deed.event, math.inf) - self.time
        if "time" in n:
            return n["time"] - self.time
        if "distance" in n:
            return (n["distance"] - (car.s - self.start)) / max(car.v, 1e-3)
        if "station" in n:
            left = self.forward * (n["station"] - self.along)
            return left / max(abs(self.v), 1e-3) if left > 0 else 0.0
        meets = self.faces or self.meeting
        soon = self._eta() if meets else math.inf
        if self.meeting and self.v > 0 and not self.is_along:  # it goes on also if the tested car waits
            soon = min(soon, (self.meeting.own - self.s) / self.v)
        if "ttc" in n and meets:
            return soon - n["ttc"]
        if {"gap", "headway", "ttc"} & {*n}:
            return self._until(deed)
        before = 0.0 if not self.phases else self._left() if len(self.phases) == 1 else math.inf
        if deed.what == "turn_off" and self.meeting:
            room = self.meeting.own - self.s - (self.v**2 - n.get("to", TURNING) ** 2) / 2 / STOP
            return max(before, room / max(self.v, 1e-3))
        if self.begun:
            return before
        is_waited_for = car.s < self.start + 1.0 or self._apart() < WAITS
        if self.meeting and self.waits and (car.v > STILL or not is_waited_for):
            way = self.forward * (self.meeting.own - self.s)
            return self._eta() - time_over(0.0, max(way, 0.0), *self._starts(n))
        return soon - LAST if meets and not self.waits else self.rolls - self.time

    def _until(self, deed: Deed) -> float:
        """Returns in how many seconds a gap, a headway or a time to collision is reached, from either side;
        if it is there from the begin on, the action begins after ``rolls``. Where the scene leaves open where
        somebody is at first who cuts in or crosses, the gap is that when it comes over the line into the
        tested car's lane."""
        n, (gap, rate) = deed.n, self.gap()
        if "ttc" in n:
            aim = -rate * n["ttc"]
            if rate >= 0:
                return math.inf
        else:
            behind = self.car.v if self.along > self.car.s else self.v
            aim = n["gap"] if "gap" in n else n["headway"] * behind
            if deed is self.lead and not self.is_placed and deed.what in ("cut_in", "cross"):
                aim -= rate * self._until_over_line(deed, self.along, self.t)
        off = gap - aim
        first = self.signs.setdefault(self.begun, off)
        if abs(first) < 0.3:
            return (self.settles if deed is self.lead else self.rolls) - self.time
        if first * off <= 0 or ("ttc" in n and off < 0):
            return 0.0
        return -off / rate if off * rate < 0 else math.inf

    def _until_over_line(self, deed: Deed, s: float, t: float) -> float:
        """Returns how many seconds after its begin from a place an action leads over the line of the tested
        car's lane."""
        if deed.what == "cross" and self.meeting:
            way = max(self._over_line(self.meeting) - self.s, 0.0)
            return time_over(0.0, way, *self._starts(deed.n))
        by = self._leads_to(deed, s, t) - t
        over = min(max((abs(t) - self._half_lane(s) - self.size.width / 2) / max(abs(by), 1e-6), 0.0), 1.0)
        return _slides(deed, by, self._sideways(s)) * math.acos(1.0 - 2.0 * over) / math.pi

    def _half_lane(self, s: float) -> float:
        return float(self.world.profile_of(self.road).width(self.path.to_road(s))) / 2

    def _over_line(self, met: Meeting) -> float:
        """Returns from which station of its way on it is over the line of the tested car's lane where they
        meet."""
        turned = self.path.pose(met.car)[3] - self.way.pose(met.own)[3]
        corner = self._half_lane(met.car) + self.size.width / 2 * abs(math.cos(turned))
        return met.own - corner / max(abs(math.sin(turned)), 0.3) - self.size.length / 2

    def gap(self) -> tuple[float, float]:
        """Returns the distance to the tested car from bumper to bumper, and how fast it grows; of those in
        other lanes, it is negative where they are beside or behind the car. Of who crosses, it is that to
        where the paths meet."""
        if self.crosses:
            return self._apart(), -self.car.v
        apart, away = self.along - self.car.s, self.forward * self.v - self.car.v
        sign = -1 if apart < 0 and self.where in IN_LANE else 1
        return sign * apart - self.half, sign * away

    def _starts(self, n: Mapping[str, float]) -> tuple[float, float]:
        """Returns the speed that it comes to from rest by the numbers of an action, and its acceleration."""
        goal = n.get("to", self.cruise)
        return goal, min(abs(n.get("accel", self._pull(goal))), self._room(True, 0.0))

    def _pull(self, speed: float) -> float:
        """Returns with which acceleration it starts to move if it will have this speed."""
        path = RUNNING_PATH if speed > RUNS else PATH
        return ROAD_USERS[self.kind].pull or min(max(speed**2 / 2 / path, 0.1), QUICKEST)

    def _phases(self, deed: Deed) -> list[Phase]:  # noqa: C901 - a table
        """Returns what an action consists of, seen from where it begins."""
        n, what, v = deed.n, deed.what, self.v
        lasts, accel, to = n.get("duration"), n.get("accel") or None, n.get("to")
        pull = CHANGE if accel is None else abs(accel)
        if what in LATERAL:
            place = self._leads_to(deed, self.along, self.t)
            most, by = self._sideways(self.s), abs(place - self.t)
            slides = _slides(deed, by, most)
            self._note(deed, by * (math.pi / _slides(deed, by, math.inf)) ** 2 / 2, most, " sideways")
            goal = to if to is not None else None if accel is None else FAST * (accel > 0)
            out = Phase(goal, pull, place, slides, until="there")
            back = out._replace(to=self.t)
        match what:
            case "keep":
                return [Phase(lasts=ROLL if lasts is None else lasts)]
            case "brake":
                return [Phase(min(to or 0.0, v), n.get("decel", BRAKE), lasts=lasts, until="speed")]
            case "stop":
                halt, speed = Phase(0.0, n.get("decel", STOP), until="speed"), v or self.cruise
                goes = Phase(speed, self._pull(speed), until="speed")
                return [halt] if lasts is None else [halt, Phase(lasts=lasts), goes]
            case "speed" if to is None and accel is not None:
                return [Phase(FAST * (accel > 0), pull, lasts=ROLL if lasts is None else lasts)]
            case "speed":
                goal = self.limit if to is None else to
                if accel is None and lasts:
                    pull, lasts = max(abs(goal - v) / lasts, 1e-6), None
                return [Phase(goal, pull, lasts=lasts, until="speed")]
            case "follow":
                headway = max(self.gap()[0] - JAM, 0.0) / max(v, 1.0)
                return [Phase(lasts=math.inf if lasts is None else lasts, follows=headway)]
            case "open_gap":
                slower = max(v - 2.0, 0.0)
                slow, again = Phase(slower, 1.0, until="speed"), Phase(v, 1.0, until="speed")
                return [slow, Phase(lasts=max((lasts or 6.0) - 2 * (v - slower), 0.0)), again]
            case "swerve":
                return [out, Phase(lasts=max((lasts or 0.0) - 2 * out.slides, 0.0)), back]
            case "overtake" if self.forward < 0:
                return [out, Phase(lasts=3.0), back]
            case "overtake":
                goal = max(self.car.v + 20 / 3.6, v) if to is None else to
                fast = Phase(goal, pull, until="passed")
                if self.where != "behind":
                    return [fast]
                return [out._replace(goal=goal), fast, back._replace(goal=None)]
            case "pull_out":
                goal = self.limit if to is None else to
                return [out._replace(goal=goal, pull=self._pull(goal) if accel is None else pull)]
            case "drift" | "cut_in" | "cut_out" | "change_lane" | "wrong_way":
                return [out]
            case "reverse":
                back = Phase(-(5 / 3.6 if to is None else to), 1.0, until="speed")
                return [Phase(0.0, STOP, until="speed"), back, Phase(lasts=lasts or math.inf)]
            case "turn_off":
                return [Phase(min(v, TURNING) if to is None else to, STOP, until="met")]
            case _:  # merge, turn_in, turn_across, cross, run_light, run_sign
                goal = self.cruise if to is None else to
                start = self._pull(goal) if self.waits else CHANGE
                return [Phase(goal, start if accel is None else pull, until="met")]

    def _enter(self) -> None:
        """Begins the phase that is next."""
        self.clock = 0.0
        if not self.phases:
            self._tell("after")
            return
        phase = self.phases[0]
        if phase.goal is not None:
            self.goal, self.pull = phase.goal, phase.pull
        if phase.to is not None:
            self.slide, self.slid = Slide(self.t, phase.to - self.t, phase.slides), 0.0

    def _left(self) -> float:
        """Returns after how many seconds the phase ends, as far as it can be seen now."""
        phase, left = self.phases[0], math.inf
        if phase.until == "speed":
            left = abs(self.goal - self.v) / min(self.pull, self._room(self.goal > self.v, self.s))
        elif phase.until == "there":
            slid = self.slide.lasts - self.slid if self.slide else 0.0
            left = max(slid, 0.0) / (self._pace(self.v) or 1e-9)
        elif phase.until == "passed":
            left = (PASSED - (self.along - self.car.s - self.half)) / max(self.v - self.car.v, 1e-9)
        elif phase.until == "met" and self.meeting:
            far = self.forward * (self.meeting.own - self.s)
            left = (far + self.size.length) / max(self.v, 1e-9)
        return max(left if phase.lasts is None else min(left, phase.lasts - self.clock), 0.0)

    def _go(self, lasts: float) -> None:
        """Moves it, and the tested car as fast as it is, by some seconds."""
        while lasts > 1e-9:
            part = min(lasts, self._left()) if self.phases else lasts
            self._drive(part)
            self.time, self.car = self.time + part, self.car._replace(s=self.car.s + self.car.v * part)
            self.clock, lasts = self.clock + part, lasts - part
            if self.phases and self._left() < 1e-9:
                if self.phases[0].lasts is not None:
                    self.goal = self.v
                del self.phases[0]
                self._enter()

    def _pace(self, v: float) -> float:
        """How fast the time of a movement sideways passes: slower for who is slow, not at all at rest."""
        peak = self.slide.peak if self.slide else 0.0
        return min(1.0, abs(v) / (SHARPEST * peak)) if peak else 1.0

    def _room(self, is_faster: bool, s: float) -> float:
        """The most in m/s^2 with which friction and grade let it become faster or slower at a place, beside
        what its bend and its movement sideways take."""
        aside = 0.0
        if self.slide is not None:
            share = math.cos(math.pi * self.slid / self.slide.lasts)
            aside = abs(self.slide.by * share) * (math.pi / self.slide.lasts) ** 2 / 2
        left, _, falls = self.way.room(s, self.v, aside)
        return max(left - falls * self.forward * (1 if is_faster else -1), LEAST_GRIP)

    def _sideways(self, s: float) -> float:
        """The most in m/s^2 with which it moves sideways from a place on."""
        ahead = (s + self.forward * self.v * time for time in AHEAD)
        return min(GRIP, *(self.way.room(each, self.v)[1] for each in ahead))

    def _note(self, deed: Deed, asked: float, most: float, where: str = "") -> None:
        """Notes that an action asks for more than there is."""
        if asked > most + ROUNDED:
            _, _, falls = self.way.room(self.s, 0.0)
            mu = self.world.site.friction
            if self.way is self.path:
                mu = self.world.friction_at(self.path.to_road(self.s))
            if abs(falls) > STEEP:
                where += f" on a grade of {100 * abs(math.tan(math.asin(falls / GRAVITY))):.0f} %"
            given = not ACCELERATES.isdisjoint(deed.n) and bool(most < GRIP)
            said = f" with at most {most:.1f} m/s2, not {asked:.1f}{where}: friction is {mu:g}"
            self.limited.setdefault(self.deeds.index(deed), (said, given))

    def _drive(self, time: float) -> None:
        """Moves it by some seconds, within which nothing else begins."""
        if self.phases and self.phases[0].follows is not None:
            pull = idm(self.v, FAST, self.gap()[0], self.car.v, PULL, CHANGE, self.phases[0].follows)
            self.goal, self.pull = (FAST if pull > 0 else 0.0), max(min(abs(pull), HARDEST), 1e-6)
        pull = self.pull
        if self.goal != self.v and (most := self._room(self.goal > self.v, self.s)) < pull:
            if self.phases and self.phases[0].follows is None:
                self._note(self.deeds[self.begun - 1], pull, most)
            pull = most
        before, speeds_up = self.v, min(time, abs(self.goal - self.v) / pull)
        self.v += math.copysign(pull * speeds_up, self.goal - self.v)
        if speeds_up < time:
            self.v = self.goal
        stretch, fastest = self._bend()
        self.v = min(self.v, fastest)
        if self.ahead is not None:
            (gap, speed), most = self.ahead, self._room(False, self.s)
            safe = speed * abs(speed) + 2 * min(EASY, most) * max(gap - abs(self.v) * STEP - JAM / 2, 0.0)
            safe = max(math.sqrt(max(safe, 0.0)), abs(before) - min(FIRM, most) * time)
            if safe < abs(self.v):
                self.v, speeds_up = math.copysign(safe, self.v), time
        gone = (before + self.v) / 2 * speeds_up + self.v * (time - speeds_up)
        begin, self.s = self.s, self.s + self.forward * gone / stretch
        if self.slide is None:
            if self.way.aside is not None and self.keeps_lane:
                by = float(np.diff(np.interp([self.s, begin], self.way.stations, self.way.aside))[0])
                self.t, self.slope = self.t + by, by / max(abs(self.s - begin), 1e-9)
            return
        self.slid += self._pace(gone / max(time, 1e-9)) * time
        share = self.slid / self.slide.lasts
        if share >= 1.0 - 1e-9:
            self.t, self.slope, self.slide = self.slide.begin + self.slide.by, 0.0, None
            self.keeps_lane = abs(self.t) > LEAST / 2
            return
        self.t = self.slide.begin + self.slide.by * (1 - math.cos(math.pi * share)) / 2
        aside = math.copysign(self.slide.peak, self.slide.by) * math.sin(math.pi * share)
        self.slope = aside / max(abs(self.v), SHARPEST * self.slide.peak, 1e-9)
