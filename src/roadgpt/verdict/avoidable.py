"""Finds whether a careful driver could have avoided a collision of the tested car.

Each of the four drivers of ``verdict.careful`` takes the place of the tested car, on its way up to the
contact and further along its lane, from when the other is visible on; it can brake, but not steer. The other
moves as recorded; from the end of the recording, or from a contact that makes it brake, it goes on evenly.

- A vehicle that goes along the way is followed or cuts in, as in UN Regulation No. 157. It is perceived
  EVALUATED after its middle has come WANDERS out of the middle of its lane towards the car, or once it is in
  the strip that the car's box needs; a hard braking, of SUDDEN, EVALUATED after its begin.
- For everybody else the definition is ours: danger begins when the path that it takes with its present
  velocity leads into the car's strip before the car has passed.

No driver brakes harder than the friction circle and the grade allow at its place, beside what a bend takes.

``docs/explanation/traffic.md`` has all definitions.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.brief.visibility import visual_range, weather_drawn
from roadgpt.drive import company
from roadgpt.geometry.boxes import separation
from roadgpt.geometry.curve import Array
from roadgpt.language.table import VEHICLES
from roadgpt.network import legs_of, network_of
from roadgpt.network.landscape import horizon_around
from roadgpt.network.lanes import lanes_of
from roadgpt.network.line import LEAST_GRIP, SPACING, Line, driven_line
from roadgpt.traffic.actor import SPEED, STEP, STILL, X
from roadgpt.verdict.careful import CAREFUL, DRIVERS, FULL, DriverModel, Moment, drive_on, stopping_distance
from roadgpt.verdict.criteria import OVER_BY, limits_at
from roadgpt.verdict.measures import ACROSS, Measures, measure
from roadgpt.verdict.verdict import PARTLY, Incident, percent

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World
    from roadgpt.road.world import Avoider


COLLIDES = "collides"
FINE = 0.01  # s, from one step of a driver to the next
WINDOW, AFTER = 10.0, 10.0  # s before and after the contact: from 130 km/h the four stop within 7 s
BEHIND, OBJECT = 2.0, 0.6  # m: the eye behind the car's front; the height of an object
AHEAD = 300.0  # m of lane after the contact
WANDERS, EVALUATED, SUDDEN = 0.375, 0.4, 5.0  # m, s, m/s^2
TOWARDS = 0.05  # m/s sideways; tracks are rounded to a millimetre
KEPT, NEARER = 2.0, 0.1  # s; m, by which a gap is smaller that the tested car is told to have kept
COMFORT, OVER, RECENT, SIDEWAYS = 3.5, 0.5, 3.0, 2.0
"""ISO 15622: m/s^2, the hardest braking of cruise control; ours: the seconds over which it is measured, the
seconds before the contact in which it counts, and the m/s^2 sideways above which a bend calls for it."""
SOON, CLOSE, CALLS = 4.0, 1.0, 1.5
"""Somebody calls for braking with a conflict time or time headway of fewer s, or if m/s^2 are required."""
FRONTS = np.array(
    [[2.0, 2.0, 2.4, 3.33, 5.56, 8.33, 11.11, 13.89, 16.67], [1, 1, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6]]
)
"""R157, 5.2.3.3: speeds in m/s and the least time gaps in s; the least distance is 2 m."""


AVOIDERS: "Mapping[Avoider, tuple[str, tuple[DriverModel, ...]]]" = {
    "r157": ("the careful driver of UN R157", DRIVERS[:1]),
    "reg157": ("Reg157", DRIVERS[1:2]),
    "fsm": ("FSM", DRIVERS[2:3]),
    "rss": ("RSS", DRIVERS[3:]),
    "any": ("any of four drivers", DRIVERS),
}
"""In words, and the drivers of whom one has to avoid a collision, or it was unavoidable."""


class Avoidance(NamedTuple):
    """Whether and by whom a collision could have been avoided."""

    by: tuple[str, ...]
    """Those of the four drivers that avoid it."""
    criterion: "Avoider"
    """By which of AVOIDERS it is judged whether it was avoidable."""
    is_avoidable: bool
    """Whether it was, by this criterion."""
    is_own_doing: bool
    """Whether the tested car brought it about itself."""
    said: str


def avoidance_of(road: "Road", drive: "Drive", world: "World", collision: Incident) -> Avoidance:
    """Returns by whom the tested car's first collision could have been avoided."""
    meeting = _Encounter(road, drive, world, collision)
    courses = {driver.said: _course(driver, meeting) for driver in DRIVERS}
    by = tuple(said for said, how in courses.items() if how != COLLIDES)
    criterion = world.limits.avoidable or ("r157" if _is_of_r157(meeting) else "any")
    whose, whom = AVOIDERS[criterion]
    is_avoidable = any(driver.said in by for driver in whom)
    each = ", ".join(f"{said} {how}" for said, how in courses.items())
    said = f"{'' if is_avoidable else 'not '}avoidable by {whose}: {each}"
    gap = meeting.gap[:, meeting.number]
    before = np.flatnonzero(np.isinf(gap[:-1]))  # with the next the scene placed it ahead, or it came there
    given = float(gap[before[-1] + 1 if len(before) else 0]) if world.scene.actors else np.inf
    own = meeting.own_doing(given) or _braked_for_nothing(road, drive, world, meeting.measured, collision)
    said = f"avoidable: it {own}; {said}" if own else said
    return Avoidance(by, criterion, is_avoidable, bool(own), said)


def _is_of_r157(meeting: "_Encounter") -> bool:
    """Whether somebody cut in or braked hard ahead, as UN R157 defines it, or stands where a vehicle that was
    ahead of the tested car left its lane."""
    if meeting.cuts_in or meeting.brakes_hard:
        return True
    gap = meeting.gap
    is_between = np.isfinite(gap) & (gap < gap[:, [meeting.number]])
    has_left = np.isinf(gap[-1]) & (meeting.measured.distance[len(gap) - 1] > 0)
    return meeting.stands and bool((is_between.any(axis=0) & has_left).any())


def _braked_for_nothing(
    road: "Road", drive: "Drive", world: "World", measured: Measures, collision: Incident
) -> str:
    """Returns how hard the tested car braked before it was hit from behind, in words; empty if it did not, if
    it would have been hit anyway, or if something within its way to a stop may have called for it."""
    hit, end = collision.contact, collision.at_time
    assert drive.others is not None
    assert hit is not None
    time = measured.time
    speed, earlier = (np.interp(time - by, drive["time"], np.abs(drive["speed"])) for by in (0.0, OVER))
    braking = (earlier - speed) / OVER
    hard = np.flatnonzero((braking > COMFORT) & (time > end - RECENT) & (time <= end))
    if hit.face != "rear" or not len(hard):
        return ""
    since, before = time[hard[0]] - OVER, earlier[hard[0]]
    far, s = before**2 / (2 * COMFORT) + before, float(np.interp(since, drive["time"], drive["s"]))
    ahead = np.linspace(s, min(s + far, road.length), int(far / SPACING) + 2)
    others = [each.name != collision.other for each in drive.others.actors]
    needs = (measured.deceleration > CALLS) | (measured.conflict < SOON) | (measured.headway < CLOSE)
    lanes, legs = lanes_of(network_of(road, world)), legs_of(road, world)
    near = [leg for leg, at in zip(legs, road.starts, strict=False) if s < at < ahead[-1]]
    is_called = (
        hit.other_speed > before + OVER_BY
        or needs[(time >= since - 1.0) & (time <= end)][:, others].any()
        or before > limits_at(road, world, ahead).min() + OVER_BY
        or before**2 * np.abs(road.curvature(ahead)).max() > SIDEWAYS
        or any(lanes.gives_way_to(leg) for leg in near)
        or any(s < way.line < ahead[-1] and way.control in ("stop", "lights") for way in road.passages)
    )
    most = braking[hard].max()
    return "" if is_called else f"had braked with {most:.1f} m/s2 and nothing in its way called for it"


def _course(driver: DriverModel, meeting: "_Encounter") -> str:
    """Returns how it ends for a driver in words."""
    places, speeds = drive_on(driver, meeting.seen, meeting.free, FINE, float(meeting.places[0]))
    ahead = meeting.along - places
    away = np.stack([ahead, meeting.t], axis=-1)
    apart = separation(away, np.zeros(len(ahead)), meeting.own, meeting.heading, meeting.its).max(axis=-1)
    gap = (ahead - meeting.stretch - meeting.own[0] / 2)[(meeting.clearance < 0) & (ahead > 0)]
    if (apart < 0).any():
        return COLLIDES
    is_told = len(gap) and not speeds[-1] and gap.min() >= 0.05
    return f"stops {gap.min():.1f} m short" if is_told else "avoids it"


class _Encounter:
    """The other as the four drivers see it from the tested car's way, from when it is visible on, every FINE
    seconds."""

    def __init__(self, road: "Road", drive: "Drive", world: "World", collision: Incident) -> None:
        assert drive.others is not None
        self.drive, self.at_time = drive, collision.at_time
        self.number = number = [each.name for each in drive.others.actors].index(str(collision.other))
        actor, states = drive.others.actors[number], drive.others.states[:, number]
        hit = min(int(self.at_time / STEP + 1e-9), len(states) - 1)
        hit -= int(np.isnan(states[hit, X]))  # it left at the step itself
        gone = np.flatnonzero(np.isnan(states[:, X]))
        begin = max([0, int((self.at_time - WINDOW) / STEP), *(gone[gone < hit] + 1)])
        end = min([len(states), *gone[gone > hit]])
        if actor.name in drive.stopped:
            end = hit + 1
        self.measured = measure(road, drive, world)
        self.gap = self.measured.gap[self.measured.time <= self.at_time]
        way, self.when, self.run, aside = _way(drive, self.measured.lane, STEP * begin, self.at_time)
        other, size = states[begin:end], np.array(actor.size[:2])
        boxes = way.boxes(other, size)
        time, self.way = STEP * np.arange(begin, hit + 1), way
        self._horizon = horizon_around(road, world)
        scene = weather_drawn(world.scene, drive.seed)
        reach = visual_range(scene, actor.kind)
        seen = np.array([self._is_seen(number, each, reach) for each in time])
        start = int(np.argmax(seen)) if seen.any() else hit - begin
        early, since = float(time[max(start - 1, 0)]), float(time[start])
        while since - early > FINE / 10:
            middle = (early + since) / 2
            early, since = (early, middle) if self._is_seen(number, middle, reach) else (middle, since)
        seen[max(start - 1, 0)] = True

        # From the last sample on, the other goes on evenly.
        more = np.arange(1, 2 + int(AFTER / STEP) + hit + 1 - begin)
        along, t = (
            np.concatenate([row, row[-1] + more * (row[-1] - row[-2] if len(row) > 1 else 0.0)])
            for row in (boxes.along, boxes.t)
        )
        stretch, side, heading = (
            np.pad(row, (0, len(more)), "edge") for row in (*boxes.reach, boxes.heading)
        )
        pace, drift = (np.append(np.diff(row), 0.0) / STEP for row in (along, t))
        towards, clearance = -np.sign(t) * drift, np.abs(t) - side - drive.car.width / 2
        follows = (np.abs(np.sin(heading)) < ACROSS) & (np.cos(heading) > 0) & (pace > STILL)
        follows &= actor.kind in VEHICLES
        wide = float(world.profile_of(road).width(collision.at_s))
        home = wide * round((t[start] + aside) / wide) - aside  # the middle of its lane
        wanders = ((home - t) * np.sign(home) >= WANDERS) & (towards > TOWARDS)
        wanders[:start] = False
        steps = round(EVALUATED / STEP)
        is_coming = np.arange(len(t)) >= (np.argmax(wanders) + steps if wanders.any() else np.inf)
        hard = np.append(0.0, np.diff(pace)) < -SUDDEN * STEP
        sudden = follows & (clearance < 0) & (np.convolve(hard, np.ones(steps))[: len(t)] > steps - 0.5)
        self.stands = bool(abs(other[hit - begin, SPEED]) < STILL)
        self.brakes_hard = bool(sudden[: len(seen)].any())
        self.cuts_in = bool(follows[start] and clearance[start] > 0 and follows[hit - begin])
        visible = np.concatenate([seen, np.ones(len(t) - len(seen), bool)])

        at = np.arange(since, self.at_time + AFTER, FINE)
        sample = ((at - time[0]) / STEP + 1e-6).astype(int)
        whole = time[0] + STEP * np.arange(len(t))
        self.along, self.t, self.heading, self.stretch, self.clearance = (
            np.interp(at, whole, row) for row in (along, t, heading, stretch, clearance)
        )
        self.own, self.its = np.array([drive.car.length, drive.car.width]), size
        flags = (pace, towards, follows, visible, (clearance < 0) | is_coming, sudden)
        rows = (self.along, self.stretch, self.clearance, *(row[sample] for row in flags))
        self._rows = [*zip(*(row.tolist() for row in rows), strict=True)]
        self._length = drive.car.length + float(size[0])

        then = np.minimum(at, self.at_time)
        self._lane, driven = driven_line(road, world), np.interp(self.when, drive["time"], drive["s"])
        grid = np.arange(0.0, way.length + SPACING, SPACING)  # beyond the driven part, stations go on with it
        s = np.interp(grid, self.run, driven) + np.maximum(grid - self.run[-1], 0.0)
        self._stations = [self._lane.from_road(each) for each in s.tolist()]

        eye = self._eye(since)
        sight = _sight(way, eye, visual_range(scene, "lane")) - BEHIND
        ahead = [eye, *grid[(grid >= eye) & (grid <= eye + sight)].tolist()]
        grip = float(np.mean([np.clip(self._grip(each, 0.0), LEAST_GRIP, FULL) for each in ahead]))
        speeds = np.arange(0.0, 80.0, 0.1)
        ways = [stopping_distance(speed, grip) for speed in speeds]
        self.recorded = np.interp(then, drive["time"], np.abs(drive["speed"]))
        limit = np.interp(then, drive["time"], limits_at(road, world, drive["s"]))
        self.free = np.minimum(self.recorded, np.minimum(limit, np.interp(sight, ways, speeds))).tolist()
        self.places = np.interp(then, self.when, self.run)
        self._samples = range(0, max(int((self.at_time - since) / FINE), 1), round(STEP / FINE))

    def _eye(self, time: float) -> float:
        """The station of the driver's eye along the way."""
        return float(np.interp(time, self.when, self.run)) + self.drive.car.length / 2 - BEHIND

    def _is_seen(self, number: int, time: float, reach: float) -> bool:
        """Whether there is a free line of sight to one of the others; ``reach`` is the visual range."""
        assert self.drive.others is not None
        actors, states = self.drive.others.actors, self.drive.others.at(time)
        order = np.flatnonzero(~np.isnan(states[:, X]))
        sizes, count = np.array([each.size for each in actors]), len(order)
        eye = np.array(self.way.pose(self._eye(time))[:3]) + [0.0, 0.0, company.EYE]
        ground = self.way.points[:: round(company.SPACING / SPACING), :3].copy()
        far, seen = reach + sizes[number, 0] / 2, np.empty((count, 4))
        found = company.in_sight(states, sizes, eye, ground, self._horizon, order, seen, count, far)
        return number in order[:found]

    def _grip(self, place: float, speed: float) -> float:
        """With how many m/s^2 one brakes at most at a place of the way."""
        station = self._stations[min(max(int(place / SPACING), 0), len(self._stations) - 1)]
        left, _, falls = self._lane.room(station, speed)
        return left + falls

    def seen(self, at: int, place: float, speed: float, gained: float) -> Moment:
        """Returns what a driver sees at a step, given its place, speed and acceleration."""
        along, stretch, clearance, pace, towards, follows, visible, perceived, sudden = self._rows[at]
        grip = self._grip(place, speed)
        if not visible:
            return Moment(np.inf, np.inf, self._length, speed, gained, pace, 0.0, False, grip=grip)
        gap, meets = along - stretch - place - self.own[0] / 2, False
        if not follows and (clearance < 0 or towards > 0):
            enters = max(clearance, 0.0) / towards if clearance > 0 else 0.0
            meets = along + stretch + pace * enters > place + speed * enters - self.own[0] / 2
        way = (gap, clearance, self._length, speed, gained, pace, towards)
        return Moment(*way, perceived and follows, sudden, meets, grip)

    def own_doing(self, given: float) -> str:
        """Returns how the tested car brought the collision about, in words; empty if it did not. The gap that
        was ``given`` to it is not its doing."""
        outside = float(np.interp(self.at_time, self.drive["time"], self.drive["outside"]))
        if outside > PARTLY:
            return f"was outside its lane with {percent(outside)} of it"
        kept = 0
        for at in self._samples:
            moment = self.seen(at, self.places[at], self.recorded[at], 0.0)
            if CAREFUL.braking(moment):
                break
            least = max(moment.speed * np.interp(moment.speed, *FRONTS), 2.0)
            closes = moment.speed > moment.its_speed - 0.1
            is_near = moment.clearance < 0 < moment.gap < min(least, given) - NEARER
            kept = kept + 1 if is_near and closes and self._rows[at][5] else 0
            if kept * STEP >= KEPT:
                return f"kept {moment.gap:.1f} m, not the {least:.1f} m of UN R157"
        return ""


def _way(drive: "Drive", lane: Line, begin: float, contact: float) -> tuple[Line, Array, Array, float]:
    """Returns the way of the middle of the tested car's box up to the contact and along its lane, the times
    and stations at which it was there, and how far it was to the left of its lane's middle at last."""
    time, (x, y, heading) = drive["time"], drive.middles.T
    when = np.append(time[(time >= begin) & (time < contact)], contact)
    columns = (x, y, drive["z"] - drive.car.height, heading)
    *track, heading = (np.interp(when, time, column) for column in columns)
    points = np.stack(track, axis=-1)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points[:, :2], axis=0).T))])
    short = max(SPACING - run[-1], 0.0)  # a way of at least one stretch, if the car stood
    behind = points[0] - short * np.array([np.cos(heading[0]), np.sin(heading[0]), 0.0])
    run += short
    grid = np.linspace(0.0, run[-1], int(run[-1] / SPACING) + 1)
    driven = [np.interp(grid, np.append(0.0, run), row) for row in np.vstack([behind, points]).T]
    s, t = map(float, lane.locate(*points[-1, :2]))
    further = [lane.pose(s + each, t)[:3] for each in np.arange(SPACING, AHEAD, SPACING).tolist()]
    way = np.concatenate([np.stack(driven, axis=-1), further])
    return Line.through(way, drive.car.width), when, run, t


def _sight(way: Line, eye_at: float, reach: float) -> float:
    """Returns how far an eye sees an object of OBJECT on its way in metres, in a visual range."""
    ahead = way.stations > eye_at
    away, low = way.stations[ahead] - eye_at, way.points[ahead, 2] - way.pose(eye_at)[2] - company.EYE
    hides = np.append(-np.inf, np.maximum.accumulate(low / away)[:-1])
    hidden = (low + OBJECT) / away < hides
    return min(float(away[np.argmax(hidden)]) if hidden.any() else np.inf, reach)
