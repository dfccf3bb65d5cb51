"""The mover ``script``: the actors of a scene, who are where it says at first, and do what it says.

What a scene leaves open is chosen so that something comes of it: who crosses or comes towards the tested car
meets it, and the first action begins after ROLL seconds."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.brief.amount import Frozen, exactly
from roadgpt.brief.junctions import Side
from roadgpt.brief.scene import ALONG, CUES, DOINGS, MOVING, NUMBERS, Action, Mark, Role, What, Where
from roadgpt.check.measures import measure
from roadgpt.errors import SceneError
from roadgpt.plural import plural
from roadgpt.road.road import START
from roadgpt.traffic.acting import LAST, LATERAL, ROLL, TURNING, Act, Car, Deed, Meeting, reach, starts
from roadgpt.traffic.actor import SIZES, Actor, FloatArray, TestedCar, corners
from roadgpt.traffic.following import time_over
from roadgpt.traffic.places import offset_of, parked_rows, way_of
from roadgpt.traffic.way import Way

if TYPE_CHECKING:
    from roadgpt.traffic import Stage

KMH = 3.6
SCALES: Mapping[str, float] = {
    "speed": 1 / KMH, "faster": 1 / KMH, "to": 1 / KMH, "overlap": 0.01, "impact": 0.01,
}  # fmt: skip
USUAL: Mapping[str, float] = {"adult": 5 / KMH, "child": 5 / KMH, "bicycle": 15 / KMH, "animal": 20 / KMH}
"""Speeds in m/s: those of Euro NCAP's persons (CPNA) and bicycle (CBNA); that of the animal is ours."""
CUT_IN = 10.0  # m, the gap at which one cuts in
HEADWAY = 2.0  # s, of who is ahead
BEHIND = 1.5  # s, of who is behind, and of several alike one behind another
STANDS = 2.0  # m between several alike that stand
ONCOMING = 40.0  # m between several alike that come towards the tested car
EASY = 4.0  # m/s^2, with which the tested car can stop before who stands or is slow
INTO = 1.0  # s of headway with which one turns in or merges ahead of the tested car
NEAR = 10.0  # m before the meeting, where a vehicle waits at a junction
PLACES = ("gap", "headway", "lead", "station")
CROSSES: tuple[What, ...] = ("cross", "turn_in")


def _drawn(thing: Frozen, rng: np.random.Generator) -> Any:
    """Returns a role or an action with a single number for each of its ranges."""
    found = {}
    for field, number in NUMBERS.items():
        amount = getattr(thing, field, None)
        if amount is not None:
            low = number.least if amount.lo is None else amount.lo
            high = number.most if amount.hi is None else amount.hi
            found[field] = exactly(float(rng.uniform(low, high)) if low < high else low)
    return thing.model_copy(update=found)


def _numbers(thing: Frozen) -> dict[str, float]:
    """Returns the numbers that were drawn, in metres, seconds and shares."""
    given = ((field, getattr(thing, field, None)) for field in NUMBERS)
    return {field: each.lo * SCALES.get(field, 1.0) for field, each in given if each is not None}


class Script:
    """Moves the actors of a scene, and places its rows of parked cars."""

    def __init__(self, stage: "Stage") -> None:
        """Draws the numbers of the scene and places everybody as seen from where the tested car starts.
        Raises SceneError if something of the scene cannot be on this road."""
        self._road, self._world = stage.road, stage.world
        self._way = Way.along(stage.road, stage.world)
        self._cast: list[tuple[int, int, Role]] = []
        for number, role in enumerate(stage.world.scene.actors):
            low, high = role.count.lo or 1, role.count.hi or 50
            count = int(np.random.default_rng([stage.seed, number]).integers(int(low), int(high) + 1))
            for copy in range(count):
                rng = np.random.default_rng([stage.seed, number, copy])
                one = _drawn(role, rng)
                changed = {"actions": tuple(_drawn(each, rng) for each in one.actions)}
                if copy:  # several alike are one behind another
                    changed |= {field: getattr(self._cast[-1][2], field) for field in PLACES}
                self._cast.append((number, copy, one.model_copy(update=changed)))
        first = self._station(min(START, stage.road.length / 2))
        self._place(Car(first, stage.world.first_speed, 0.0, *SIZES["car"][:2]))
        free = [act.way.points for act in self._acts if act.way is not self._way]
        states = [(act.state(), act.size) for act in self._acts]
        free += [corners(np.array(state), size) for state, size in states if state]
        rows = parked_rows(stage.world.scene, stage.road, stage.world, stage.seed, free)
        kinds = [role.kind for _, _, role in self._cast] + [kind for kind, _ in rows]
        self.actors = [
            Actor(f"{kind} {kinds[: n + 1].count(kind)}", kind, SIZES[kind]) for n, kind in enumerate(kinds)
        ]
        self._states = np.full((len(kinds), 5), np.nan)
        self._states[len(self._cast) :] = np.array([state for _, state in rows]).reshape(-1, 5)

    def start(self, car: TestedCar) -> FloatArray:
        """Places everybody as seen from the tested car."""
        self._first, self._came, self._last = self._seen(car, 0.0), 0.0, self._seen(car, 0.0).s
        self._now = 0.0, self._first
        self._place(self._first)
        return self._shown()

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states of all actors STEP after ``time``. They react to nobody else's body."""
        del bodies
        here = self._seen(car, self._came)
        self._came += here.s - self._last
        self._last = here.s
        here = here._replace(came=self._came)
        self._now = time, here
        for act in self._acts:
            act.move(time, here)
        return self._shown()

    def missed(self) -> tuple[str, ...]:
        """Returns what of the scene has not begun so far, a sentence for each actor."""
        time, car = self._now
        found = []
        for actor, act in zip(self.actors, self._acts, strict=False):
            is_late = act.state() is None and not act.is_gone
            deed = act.unseen or next(iter(act.deeds[0 if is_late else act.begun :]), None)
            if deed is None:
                continue
            why = "the drive ended before"
            if act.state() is None:
                why = "it was not on the road yet" if is_late else "it had left the road"
            elif deed.event or ({*CUES} & {*deed.n} and act.wait(deed, time, car) == math.inf):
                why = "what it waits for did not come"
            found.append(f"it never happened that {actor.name} {DOINGS[deed.what].said}: {why}")
        return tuple(found)

    def _shown(self) -> FloatArray:
        for n, act in enumerate(self._acts):
            self._states[n] = act.state() or np.nan
        return self._states.copy()

    def _station(self, s: float) -> float:
        """Returns the station along the middle of the tested car's lane of a station of its road."""
        assert self._way.road_stations is not None
        return float(np.interp(s, self._way.road_stations, self._way.stations))

    def _road_station(self, s: float) -> float:
        assert self._way.road_stations is not None
        return float(np.interp(s, self._way.stations, self._way.road_stations))

    def _seen(self, car: TestedCar, came: float) -> Car:
        s = self._station(car.s)
        x, y, _, heading = self._way.pose(s)
        s += (car.x - x) * math.cos(heading) + (car.y - y) * math.sin(heading)
        return Car(s, car.speed, came, car.length, car.width)

    def _place(self, car: Car) -> None:
        """Makes the acts of everybody."""
        self._car, self._acts = car, list[Act]()
        events, ways = dict[tuple[str, ...], float](), dict[int, Way]()
        scene = self._world.scene
        for number, copy, role in self._cast:
            same = [each for each in scene.actors[: number + 1] if each.kind == role.kind]
            name = (role.kind, str(len(same))) if copy == 0 else None
            self._acts.append(_Placing(self, role, number, copy, ways).act(events, name))

    def stretch(self, mark: Mark) -> tuple[float, float]:
        """Returns the first and the last station, along the tested car's lane, of a part of its route."""
        passages = [(each.start, each.end) for each in self._road.passages]
        spans = passages
        if mark.of == "turn":
            edges = [0.0, *(edge for span in passages for edge in span), self._road.length]
            free = [(a, b) for a, b in list(pairwise(edges))[::2] if b - a > 10.0]
            points = [self._road.at(np.linspace(a, b, math.ceil(b - a) + 1)) for a, b in free]
            spans = [
                (a + turn.start, a + turn.end)
                for (a, _), line in zip(free, points, strict=True)
                for turn in measure(line).turns
            ]
        at = mark.number - 1 if mark.number > 0 else len(spans) + mark.number
        if not 0 <= at < len(spans):
            raise SceneError(
                f"the scene names {mark.of} {mark.number}, but the road has "
                f"{plural(len(spans), str(mark.of)) if spans else f'no {mark.of}'}; name another place"
            )
        first, last = spans[at]
        return self._station(first), self._station(last)


class _Placing:
    """Where somebody of a scene is at first, and how it is made to meet the tested car."""

    def __init__(self, script: Script, role: Role, number: int, copy: int, ways: dict[int, Way]) -> None:
        self.script, self.role, self.number, self.copy, self.ways = script, role, number, copy, ways
        self.road, self.world, self.car = script._road, script._world, script._car
        self.kind, self.where, self.side = role.kind, role.where, role.side
        self.size, self.n = SIZES[role.kind], _numbers(role)
        self.half = (self.size.length + self.car.length) / 2
        self.limit = self.world.limits.speed_limit
        self.deeds = [self._deed(action) for action in role.actions]
        if not self.deeds and self.where in ("crossing", "crosswalk"):
            self.deeds = [Deed("cross", None, {})]
        whats = [deed.what for deed in self.deeds]
        self.first = whats[0] if whats else None
        self.crosses = self.where in ("crossing", "crosswalk") or (
            self.where == "beside" and any(what in CROSSES for what in whats)
        )
        self.is_along = not self.crosses and (
            self.where in (*ALONG, "parked", "beside") and "turn_across" not in whats
        )
        self.turns_off = self.is_along and "turn_off" in whats
        self.forward = 1
        if self.is_along and (self.where == "oncoming" or self.first == "wrong_way"):
            self.forward = -1
        self.kerb = self.world.profile_of(self.road).side
        self.cruise = self._cruise()
        self.stands = (
            self.kind not in MOVING
            or self.where == "parked"
            or self.crosses
            or (self.where == "beside" and "speed" not in self.n)
        )
        if self.stands and self.deeds:
            self._stand(self.deeds[0])

    def _stand(self, deed: Deed) -> None:
        """Makes the place where somebody who stands begins to act the place where it is."""
        n = dict(deed.n)
        if "station" in n:
            self.n |= {"station": n.pop("station")}
        if self.is_along and not deed.event and not {*CUES} & {*n}:
            n["ttc"] = LAST
        self.deeds[0] = deed._replace(n=n)

    def _deed(self, action: Action) -> Deed:
        n, mark = _numbers(action), action.at
        if mark is None or mark.what:
            return Deed(action.what, action.side, n, mark)
        first, last = self.script.stretch(mark)
        before = max(first - 2.0 * self._cruise(), 0.0)
        at = {"after": last, "in": (first + last) / 2, "before": before}[mark.word]
        return Deed(action.what, action.side, n | {"station": at})

    def _cruise(self) -> float:
        """The speed that it has, or comes to as soon as it starts."""
        if self.kind not in MOVING:
            return 0.0
        if "speed" in self.n and (self.n["speed"] or self.where not in ("crossing", "crosswalk", "junction")):
            return self.n["speed"]
        if "faster" in self.n:
            return max(self.car.v + self.n["faster"], 0.0)
        if self.kind in USUAL:
            return min(USUAL[self.kind], self.limit)
        if self.role.actions and self.role.actions[0].what in ("turn_in", "turn_across"):
            return min(TURNING, self.limit)
        return self.limit if self.where == "oncoming" else min(self.car.v, self.limit) or self.limit

    def act(self, events: dict[tuple[str, ...], float], name: tuple[str, ...] | None) -> Act:
        """Makes the act; raises SceneError if it cannot be on this road."""
        v = 0.0 if self.stands or self.n.get("speed") == 0 else self.cruise
        way, meeting, held, shift, t = self.script._way, None, None, 0.0, 0.0
        if self.is_along:
            s = self._beside(v)
            t = self._aside(s)
            meeting = self._head_on(s)
            if self.first == "cut_in" and not {"time", "distance", "station"} & {*self.deeds[0].n}:
                held = (s - self.car.s, v - self.car.v)
        if not self.is_along or self.turns_off:
            way = self._own_way()
            assert way.meets is not None
            crossing = Meeting(way.meets[0], self.script._station(way.meets[1]))
            shift = crossing.car - crossing.own
            if self.turns_off:
                s, meeting = s - shift, crossing
            else:
                meeting, s = self._crossing(crossing, v)
        act = Act(
            self.kind, self.where, self.size, self.deeds, way, self.forward, shift, s, t, v, self.cruise,
            self.limit, self._leads_to, events, name, meeting, v == 0 and not self.is_along, held,
            bool(meeting and v and not self.turns_off),
        )  # fmt: skip
        if self.copy and self.crosses and meeting:
            aside = math.sin(self.script._way.pose(meeting.car)[3] - way.pose(meeting.own)[3])
            act.t = self.copy * (self.size.width + 0.5) * math.copysign(1.0, aside)
        self._check(act)
        return act

    def _one(self) -> str:
        return f"the {self.kind.replace('_', ' ')} {self.where.replace('lane', 'in the next lane')}"

    def _check(self, act: Act) -> None:
        if self.is_along and self.forward < 0 and act.s < 0:
            raise SceneError(f"{self._one()} drives away before it is on the road; give another place")
        if act.v == 0 and not act.waits and act.state() is None:
            raise SceneError(
                f"{self._one()} would stand at {act.along:.0f} m, but the road is {self.road.length:.0f} m "
                "long; make the road longer, or give another place"
            )
        if act.held and act.along + ROLL * act.v < act.size.length / 2:
            raise SceneError(
                f"{self._one()} would have to begin its action before the begin of the road; give another "
                "gap, or another speed"
            )
        first = self.deeds[0] if self.deeds else None
        if act.waits and first and act.wait(first, 0.0, self.car) < 0:
            raise SceneError(
                f"{self._one()} cannot be where it meets the tested car in time; give another place, or more "
                "speed"
            )
        waits = first.event if first else None
        if act.held and first and not waits and act.wait(first, 0.0, self.car) == math.inf:
            raise SceneError(f"{self._one()} never comes to where it is to act; give another gap or speed")
        moves = act.cruise > 0
        for deed in self.deeds:
            starts_to_move = deed.what in ("speed", "overtake", "pull_out")
            moves = moves or starts_to_move or max(deed.n.get("to", 0.0), deed.n.get("accel", 0.0)) > 0
            if deed.what in LATERAL and not moves:
                raise SceneError(
                    f"{self._one()} stands, so it never {DOINGS[deed.what].said}; give it a speed, or 'accel'"
                )
            if deed.what in LATERAL and deed.what != "merge":
                self._leads_to(act, deed)

    def _own_way(self) -> Way:
        """Returns the way of somebody who does not stay along the tested car's lane: to where the tested car
        is when it has rolled for long enough, or to the place that the scene says."""
        if self.number not in self.ways:
            role, cue = self.role, self.deeds[0].n if self.deeds else {}
            if self.crosses and "ttc" in cue and role.away is None:
                away = reach(cue["ttc"], 0.0, *starts(self.kind, cue, self.cruise))
                role = role.model_copy(update={"away": exactly(min(away, 60.0))})
            near = self.car.s + self.half + self.car.v * (ROLL + HEADWAY if self.crosses else LAST)
            if role.at:
                first, last = self.script.stretch(role.at)
                near = {"after": last, "in": first, "before": first - EASY * self.car.v}[role.at.word]
            near = self.n.get("station", near)
            way = self._way_from(role, near)
            if self.crosses and way.meets and "station" not in self.n and not role.at:
                path = way.meets[0] + self.car.width / 2
                lasts = 1.0 + time_over(0.0, path, *starts(self.kind, cue, self.cruise))
                later = self.car.s + self.half + self.car.v * lasts
                way = self._way_from(role, later) if later > near else way
            self.ways[self.number] = way
        return self.ways[self.number]

    def _way_from(self, role: Role, near: float) -> Way:
        return way_of(role, self.script._road_station(max(near, 0.0)), self.road, self.world)

    def _crossing(self, met: Meeting, v: float) -> tuple[Meeting, float]:
        """Returns the meeting of somebody who comes along another way, and the station where it is at first.
        The places on the tested car are those of Euro NCAP: CCCscp, CCFtap, CMCscp, CMFtap."""
        car, length, width = self.car, *self.size[:2]
        what = self.first
        if "impact" in self.n or self.kind in USUAL:
            hit = (self.n.get("impact", 0.5) - 0.5) * car.width
            found = Meeting(met.own + hit, met.car - width / 2)
        elif what in ("merge", "turn_in") or self.where in ("ramp", "roundabout"):
            found = Meeting(met.own, met.car - INTO * car.v - length / 2)
        elif self.where == "oncoming" or self.side == "opposite":
            found = Meeting(met.own - length / 2, met.car - width / math.sqrt(2))
        elif self.kind == "motorcycle":
            found = Meeting(met.own - (car.width + length) / 2, met.car + car.length / 10)
        else:
            found = Meeting(met.own - length / 4, met.car - width / 2)
        if v == 0:
            away = self.n.get("away", NEAR)
            return found, 0.0 if self.crosses else max(met.own - away, length / 2)
        found = found._replace(own=found.own - self.copy * (length + STANDS + BEHIND * v))
        eta = (found.car - car.s - car.length / 2) / max(car.v, 1.0)
        return found, found.own - v * eta

    def _head_on(self, s: float) -> Meeting | None:
        """Returns where somebody who comes towards the tested car in its lane meets it."""
        comes = self.first in ("drift", "wrong_way", "overtake") or {"impact", "overlap"} & {*self.n}
        if self.forward > 0 or not comes:
            return None
        gap = s - self.car.s - self.half
        share = self.car.v / max(self.car.v + self.cruise, 0.1)
        place = self.car.s + self.car.length / 2 + gap * share
        return Meeting(place + self.size.length / 2, place)

    def _beside(self, v: float) -> float:
        """Returns the station along the tested car's lane where somebody is at first who is along it."""
        n, car = self.n, self.car
        sign = -1 if self.where == "behind" else 1
        reach = self.size.length + (STANDS + BEHIND * v if v else STANDS)
        if self.forward < 0:
            reach = max(reach, ONCOMING + self.size.length)
        if self.where == "behind" or (self.first == "overtake" and self.forward > 0):
            reach = -reach
        behind = v if self.where == "behind" else car.v
        if "station" in n or "lead" in n:
            s = n["station"] if "station" in n else car.s + n["lead"]
        elif self.role.at:
            first, last = self.script.stretch(self.role.at)
            half = self.size.length / 2 + 5.0
            s = {"after": last + half, "in": (first + last) / 2, "before": first - half}[self.role.at.word]
        elif "gap" in n or "headway" in n:
            gap = n["gap"] if "gap" in n else n["headway"] * behind
            s = car.s + sign * (gap + self.half)
        else:
            s = car.s + sign * (self._gap(v) + self.half)
            last = self.script._way.length - self.size.length / 2 - 1.0
            if v == 0 and car.s + self.half + HEADWAY * car.v < last:
                s = min(s, last)
        return s + self.copy * reach

    def _gap(self, v: float) -> float:
        """Returns the gap at first of which nothing is said: so that its first action begins after ROLL."""
        car, cue = self.car, self.deeds[0].n if self.deeds else {}
        away = self.forward * v - car.v
        rate = -away if self.where == "behind" else away
        behind = v if self.where == "behind" else car.v
        is_open = self.deeds and not self.deeds[0].event and not {*CUES} & {*cue}
        if self.where == "oncoming" and is_open and self.first in ("drift", "wrong_way", "overtake"):
            aside = abs(self._leads_to(None, self.deeds[0]) - self._aside(car.s))
            peak = cue.get("lateral", LATERAL[self.deeds[0].what])
            self.deeds[0] = self.deeds[0]._replace(n={**cue, "ttc": 1.0 + math.pi / 2 * aside / peak})
            cue = self.deeds[0].n
        if "ttc" in cue and rate < 0:
            at = -rate * cue["ttc"]
        elif "gap" in cue or "headway" in cue:
            at = cue["gap"] if "gap" in cue else cue["headway"] * behind
        elif self.first == "cut_in":
            at = CUT_IN
        elif self.first == "overtake" and self.forward > 0:
            at = car.v if self.where == "behind" else -2 * self.half - car.v
        elif self.where == "behind":
            return BEHIND * v
        elif self.where in ("lane", "far"):
            return 5.0 - self.half + max(-rate, 0.0) * ROLL
        elif self.forward < 0:
            at = -rate * LAST
        else:
            slower = max(-rate, 0.0)
            return max(HEADWAY * car.v, slower * ROLL + slower**2 / 2 / EASY)
        return at - rate * ROLL

    def _across(self) -> float:
        """Returns where in the tested car's lane it is, or comes to: see ``overlap`` and ``impact``."""
        car, width = self.car, self.size.width
        left = {"left": 1, "right": -1}.get(str(self.side), self.kerb)
        if self.where == "oncoming":
            left = -self.kerb
        if "impact" in self.n and self.is_along:
            return (self.kerb if self.where == "oncoming" else left) * car.width * (0.5 - self.n["impact"])
        share = self.n.get("overlap", 1.0)
        most = min(width, car.width) / car.width
        return 0.0 if share >= most - 1e-9 else left * ((car.width + width) / 2 - share * car.width)

    def _aside(self, s: float) -> float:
        """Returns how far to the left of the middle of the tested car's lane it is at first."""
        comes_later = any(deed.what in ("cut_in", "wrong_way", "drift", "overtake") for deed in self.deeds)
        given = {"impact", "overlap"} & {*self.n}
        if self.where in ("ahead", "behind") or (given and not comes_later):
            return self.n.get("offset", 0.0) + (self._across() if given else 0.0)
        return self._place(self.where, s) + self.n.get("offset", 0.0)

    def _place(self, where: Where, s: float, side: Side | None = None) -> float:
        if side is None and self.side in ("left", "right"):
            side = self.side
        station = self.script._road_station(min(max(s, 0.0), self.script._way.length))
        try:
            return offset_of(where, side, station, self.road, self.world, self.size.width)
        except SceneError:
            is_kerb = side == ("left" if self.kerb > 0 else "right")
            if where != "lane" or is_kerb or self.first not in ("cut_in", "overtake"):
                raise
            return offset_of("oncoming", None, station, self.road, self.world, self.size.width)

    def _leads_to(self, act: Act | None, deed: Deed) -> float:
        """Returns where an action leads to, in metres to the left of the tested car's lane's middle."""
        s, t = (act.along, act.t) if act else (self.car.s, self._place(self.where, self.car.s))
        width = float(self.world.profile_of(self.road).width(self.script._road_station(s)))
        side = deed.side
        towards: Side = "right" if t > 0 else "left"
        match deed.what:
            case "cut_out":
                return self._place("lane", s, side)
            case "change_lane" if self.where in ("ahead", "behind") and abs(t) < width / 2:
                return self._place("lane", s, side)
            case "change_lane" if self.where == "oncoming":
                return t + math.copysign(width, t if side is None else 1 if side == "left" else -1)
            case "change_lane" if side in (None, towards):
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
