"""What was driven of a scenario, measured from the recorded drive and tracks alone: plane geometry on the
middle of the tested car's lane, independent of what placed and moved the others.

All is measured up to the event: the first contact, or else the end of the drive. Distances are in metres,
times in seconds, speeds in km/h, those sideways in m/s."""

from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree
from shapely import LineString, Polygon, get_coordinates
from shapely.affinity import rotate, translate

from boxed import corners
from roadgpt.run import Run

X, Y, _, HEADING, SPEED = range(5)
REFERENCE = {"adult": 0.06, "child": 0.0405, "bicycle": -0.015}
"""Metres from the middle of Euro NCAP's targets back to their reference points: hip, hip and crank (Vector's
CA-FC 2026: 0.36 m of 0.6 m and 0.396 m of 0.711 m behind the front, 0.62 m before the rear axle)."""
MOVED, STARTED = 0.05, 0.02  # m/s and m, from which on somebody has begun to change its speed, or its line


class Measured:
    """A finished drive."""

    def __init__(self, run: Run) -> None:
        assert run.drive is not None, run.description
        assert run.road is not None
        self.run, self.drive, self.others = run, run.drive, run.drive.others
        s = np.arange(0.0, run.road.length, 0.25)
        line = run.road.at(s, run.world.profile_of(run.road).middle(s))[:, :2]
        self.path, self._nearest = LineString(line), KDTree(line)
        self._stations = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        time = self.drive["time"]
        self.time = time[np.isclose(time * 10, np.rint(time * 10), atol=1e-6)]
        if self.others is not None:
            self.time = self.time[: len(self.others)]

    def car(self, time: Any) -> Any:
        """x, y, heading and speed of the middle of the tested car's box."""
        d, at = self.drive, np.asarray(time, float)
        x, y, speed = (np.interp(at, d["time"], d[name]) for name in ("x", "y", "speed"))
        heading = np.interp(at, d["time"], np.unwrap(d["heading"]))
        x, y = x + d.car.ahead * np.cos(heading), y + d.car.ahead * np.sin(heading)
        return np.array([x, y, heading, speed])

    def other(self, who: int, time: Any) -> Any:
        """x, y, heading, speed of the middle of an actor's box."""
        return np.moveaxis(self.others.at(time)[..., who, :], -1, 0)[[X, Y, HEADING, SPEED]]

    def along(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Stations on the middle of the tested car's lane, and metres to its left; NaN where nobody is."""
        places = np.nan_to_num(np.column_stack([np.ravel(x), np.ravel(y)]), nan=1e6)
        line = get_coordinates(self.path)
        at = np.clip(self._nearest.query(places)[1], 1, len(line) - 2)
        way = line[at + 1] - line[at - 1]
        way /= np.hypot(*way.T)[:, None]
        away = places - line[at]
        s = self._stations[at] + way[:, 0] * away[:, 0] + way[:, 1] * away[:, 1]
        t = way[:, 0] * away[:, 1] - way[:, 1] * away[:, 0]
        return np.where(places[:, 0] < 1e6, [s, t], np.nan)

    def size(self, who: int) -> tuple[float, float]:
        return self.others.actors[who].size[:2]

    def _apart(self, who: int, time: float) -> float:
        boxes = []
        car = self.drive.car
        for (x, y, heading, _), (length, width) in (
            (self.car(time), (car.length, car.width)),
            (self.other(who, time), self.size(who)),
        ):
            box = Polygon([(a * length / 2, b * width / 2) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))])
            boxes.append(translate(rotate(box, heading, (0, 0), use_radians=True), x, y))
        return float(boxes[0].distance(boxes[1]))

    def contact(self, who: int) -> float:
        """The time of the first contact with an actor; infinite without one."""
        x, y, *_ = self.other(who, self.time)
        own = self.car(self.time)
        near = np.hypot(x - own[0], y - own[1]) < (self.drive.car.length + self.size(who)[0]) / 2 + 3.0
        for coarse in self.time[near]:
            (*_, heading, speed), (*_, own_heading, own_speed) = self.other(who, coarse), self.car(coarse)
            closing = abs(speed * np.exp(1j * heading) - own_speed * np.exp(1j * own_heading))
            if self._apart(who, coarse) > 0.12 * closing + 0.05:
                continue
            for time in np.arange(coarse, coarse + 0.0999, 0.005):
                if time <= self.time[-1] and self._apart(who, time) <= 0:
                    return float(time)
        return float("inf")

    @cached_property
    def event(self) -> float:
        count = 0 if self.others is None else len(self.others.actors)
        return min([self.contact(who) for who in range(count)] + [float(self.time[-1])])

    @cached_property
    def until(self) -> Any:
        """The times of the tracks up to the event."""
        return self.time[self.time < self.event - 1e-6]

    def onset(self, who: int) -> float:
        """When an actor begins to change its speed, which it does evenly, or its line, at first as the square
        of the time; the first sample if it does neither."""
        x, y, _, v = self.other(who, self.until)
        _, t = self.along(x, y)
        found = []
        for values, least, power, most in ((v, MOVED, 1.0, 1.0), (t, STARTED, 2.0, 8.0)):
            there = np.flatnonzero(~np.isnan(values))
            off = np.abs(values[there] - values[there][0])
            begun = np.flatnonzero(off > least)
            if len(begun) and begun[0] + 1 < len(off):
                one, two = off[begun[0] : begun[0] + 2] ** (1 / power)
                since = one / (two - one) if two > one else 1.0
                found.append(self.until[there[begun[0]]] - 0.1 * min(max(since, 0.0), most))
        return float(min(found, default=self.until[int((~np.isnan(v)).argmax())]))

    # what is measured of an actor; ``want`` is what is prescribed, for the value that is farthest from it

    def ego(self, who: int, want: float) -> float:
        return _worst(self.car(self.until)[3] * 3.6, want)

    def aside(self, who: int, want: float) -> float:
        x, y, *_ = self.car(self.until)
        return _worst(self.along(x, y)[1], want)

    def released(self, who: int, want: float) -> float:
        """The speed sideways with which the script leaves the tested car to its driver, over 0.1 s."""
        time = self.drive.handovers[-1].end
        x, y, *_ = self.car(np.array([time - 0.1, time]))
        return float(np.abs(np.diff(self.along(x, y)[1]))[0] / 0.1)

    def led(self, who: int, want: float) -> float:
        """The speed of the tested car until the script leaves it to its driver."""
        return _worst(self.car(self.until[self.until <= self.drive.handovers[-1].end])[3] * 3.6, want)

    def changes_by(self, who: int, want: float) -> float:
        """How far to the left the tested car is at the event."""
        x, y, *_ = self.car(self.until[-1:])
        return float(self.along(x, y)[1][0])

    def speed(self, who: int, want: float) -> float:
        """At the event."""
        return float(self.other(who, self.until[-1])[3] * 3.6)

    def keeps(self, who: int, want: float) -> float:
        """Along the lane, all the time."""
        x, y, *_ = self.other(who, self.until)
        there = ~np.isnan(x)
        s, _ = self.along(x[there], y[there])
        return _worst(np.abs(np.diff(s)) / 0.1 * 3.6, want)

    def keeps_own(self, who: int, want: float) -> float:
        """Along its own way, all the time."""
        return _worst(self.other(who, self.until)[3] * 3.6, want)

    def at_first(self, who: int, want: float) -> float:
        """The speed before it begins to act."""
        return float(self.other(who, self.onset(who))[3] * 3.6)

    def _gap(self, who: int, time: float) -> float:
        (x, y, *_), (u, v, *_) = self.other(who, time), self.car(time)
        (ahead, own), _ = self.along([x, u], [y, v])
        return float(ahead - own - (self.drive.car.length + self.size(who)[0]) / 2)

    def gap(self, who: int, want: float) -> float:
        """From bumper to bumper where it begins to act."""
        return self._gap(who, self.onset(who))

    def headway(self, who: int, want: float) -> float:
        time = self.onset(who)
        return self._gap(who, time) / float(self.car(time)[3])

    def to_the_next(self, who: int, want: float) -> float:
        """Along the lane from its front to the rear of the next actor, where it begins to act."""
        (ahead, s), _ = self.along(*self.other([who + 1, who], self.onset(who))[:2])
        return float(ahead - s - (self.size(who)[0] + self.size(who + 1)[0]) / 2)

    def between(self, who: int, want: float) -> float:
        """Along the lane between the middles of it and the next actor."""
        (ahead, s), _ = self.along(*self.other([who + 1, who], 0.0)[:2])
        return float(abs(ahead - s))

    def lead(self, who: int, want: float) -> float:
        """From the middle of the tested car to its middle, at first."""
        first = float(self.others.time[self._there(who)][0])
        (x, y, *_), (u, v, *_) = self.other(who, first), self.car(first)
        (ahead, own), _ = self.along([x, u], [y, v])
        return float(ahead - own)

    def left(self, who: int, want: float) -> float:
        """How far to the left of the tested car's lane it is at first."""
        return float(self.along(*self.other(who, [self.others.time[self._there(who)][0]])[:2])[1][0])

    def _there(self, who: int) -> Any:
        return ~np.isnan(self.others.states[:, who, X])

    def _t(self, who: int) -> Any:
        x, y, *_ = self.other(who, self.until)
        return self.along(x, y)[1]

    def most_left(self, who: int, want: float) -> float:
        return float(np.nanmax(self._t(who)))

    def most_right(self, who: int, want: float) -> float:
        return float(np.nanmin(self._t(who)))

    def last_left(self, who: int, want: float) -> float:
        return float(self._t(who)[-1])

    def sideways(self, who: int, want: float) -> float:
        return float(np.nanmax(np.abs(np.diff(self._t(who)))) / 0.1)

    def sideways_rate(self, who: int, want: float) -> float:
        """The greatest acceleration sideways, over 0.4 s."""
        t = self._t(who)
        return float(np.nanmax(np.abs(t[8:] - 2 * t[4:-4] + t[:-8])) / 0.16)

    def begins(self, who: int, want: float) -> float:
        return self.onset(who)

    def to(self, who: int, want: float) -> float:
        """The speed at last, also after the event."""
        return float(self.others.states[-1, who, SPEED] * 3.6)

    def _ends(self, who: int) -> Any:
        """From where to where a box is along the lane, and across it."""
        x, y, heading, _ = self.other(who, 0.0)
        box = corners(np.array([x, y, 0.0, heading]), self.others.actors[who].size)
        return [(min(each), max(each)) for each in self.along(*box.T)]

    def clear(self, who: int, want: float) -> float:
        """From the middle of the lane to who stands beside it."""
        return float(np.abs(self._ends(who)[1]).min())

    def before(self, who: int, want: float) -> float:
        """Along the lane to the side of the first actor, who crosses."""
        (s,), _ = self.along(*self.other(0, [self.event])[:2])
        return float(s - self.size(0)[1] / 2 - self._ends(who)[0][1])

    def apart(self, who: int, want: float) -> float:
        """Between it and the next actor."""
        pairs = zip(self._ends(who), self._ends(who + 1), strict=True)
        return float(max(max(a[0] - b[1], b[0] - a[1]) for a, b in pairs))

    def friction(self, who: int, want: float) -> float:
        """The least."""
        return min(map(self.run.world.friction_at, np.arange(0.0, 100.0)))

    def _slippery(self) -> Any:
        """Where friction changes."""
        s = np.arange(0.0, 100.0, 0.1)
        return s[1:][np.diff([self.run.world.friction_at(each) for each in s]) != 0]

    def first(self, who: int, want: float) -> float:
        return float(self._slippery()[0])

    def second(self, who: int, want: float) -> float:
        return float(self._slippery()[2])

    def third(self, who: int, want: float) -> float:
        return float(self._slippery()[4])

    def long(self, who: int, want: float) -> float:
        first = self._slippery()
        return _worst(first[1::2] - first[::2], want)

    def rate(self, who: int, want: float) -> float:
        """How fast its speed changes in m/s2, in the middle of its first change."""
        v = np.array(self.other(who, self.until)[3])
        first = round(self.onset(who) / 0.1) + 1
        change = np.diff(v[first:]) / 0.1
        steady = np.abs(change) > 0.5 * abs(want)
        last = int(steady.argmin()) if not steady.all() else len(steady)
        return float(np.mean(change[:last]))

    def run_up(self, who: int, want: float) -> float:
        """The way from rest until it is as fast as at the event."""
        x, y, _, v = self.other(who, self.until)
        moves, last = v > MOVED, v[-1]
        full = int((v > last - 0.01).argmax())
        first = int(moves.argmax()) - 1
        way = np.hypot(np.diff(x[first : full + 1]), np.diff(y[first : full + 1])).sum()
        sooner = (v[full] - v[full - 1]) / 0.1  # it was as fast before the sample that shows it
        rate = np.median(np.diff(v[first + 1 : full])) / 0.1 if full - first > 3 else sooner
        return float(way - last * max(0.1 - (last - v[full - 1]) / max(rate, 1e-6), 0.0))

    def steady(self, who: int, want: float) -> float:
        """The way at its speed of the event, up to the tested car's path or to the contact."""
        _, _, _, v = self.other(who, self.until)
        full = int((v > v[-1] - 0.01).argmax())
        if abs(self._t(who)[0]) < 1.0:
            return float(v[-1] * (self.event - self.until[full]))
        return float(abs(self._t(who)[full]))

    def starts(self, who: int, want: float) -> float:
        """The seconds that the tested car's front needs to its flank when somebody starts who has its speed
        at once: so long before it has gone some way with that speed."""
        x, y, _, v = self.other(who, self.until)
        late = int((v > v[-1] - 0.01).argmax()) + 3
        start = float(self.until[late] - np.hypot(x[late] - x[0], y[late] - y[0]) / v[late])
        (path, own), _ = self.along([x[late], self.car(start)[0]], [y[late], self.car(start)[1]])
        return float(path - own - (self.drive.car.length + self.size(who)[1]) / 2) / float(self.car(start)[3])

    def start_distance(self, who: int, want: float) -> float:
        """How far the tested car's front is from its path when it starts."""
        time = self.onset(who)
        (x, y, *_), (u, v, *_) = self.other(who, time), self.car(time)
        (path, own), _ = self.along([x, u], [y, v])
        return float(path - own - self.drive.car.length / 2)

    def behind_junction(self, who: int, want: float) -> float:
        (s, *_), _ = self.along(*self.other(who, [self.event])[:2])
        end = self.run.road.passages[0].end
        (last,), _ = self.along(
            *self.run.road.at([end], self.run.world.profile_of(self.run.road).middle([end]))[0, :2]
        )
        return float(s - last)

    def _in_car(self, who: int, time: float) -> tuple[float, float]:
        (x, y, *_), (u, v, heading, _) = self.other(who, time), self.car(time)
        c, s = np.cos(heading), np.sin(heading)
        return float((x - u) * c + (y - v) * s), float((y - v) * c - (x - u) * s)

    def impact(self, who: int, want: float) -> float:
        """Percent of the tested car's width, from the near side, of the other's reference point: at the
        contact, or, of who crosses, when the tested car's front is beside its flank."""
        car, time = self.drive.car, self.event
        if crosses := abs(self._t(who)[0]) > 2.0:
            times = np.arange(max(self.event - 0.3, 0.0), self.event + 0.3, 0.005)
            ahead = [self._in_car(who, each)[0] - car.length / 2 - self.size(who)[1] / 2 for each in times]
            time = float(np.interp(0.0, -np.array(ahead), times))
        left = self._in_car(who, time)[1]
        if crosses:
            turned = self.other(who, time)[2] - self.car(time)[2]
            left -= np.sin(turned) * REFERENCE.get(self.others.actors[who].kind, 0.0)
        return 100 * (left / car.width + 0.5)

    def past(self, who: int, want: float) -> float:
        """How far behind the other's front the middle of the tested car's front meets its flank."""
        times = np.arange(self.event - 0.3, self.event + 0.3, 0.005)
        ahead = [
            self._in_car(who, each)[0] - (self.drive.car.length + self.size(who)[1]) / 2 for each in times
        ]
        left = self._in_car(who, float(np.interp(0.0, -np.array(ahead), times)))[1]
        side = np.sign(self._t(who)[~np.isnan(self._t(who))][0])
        return self.size(who)[0] / 2 - side * left

    def flank(self, who: int, want: float) -> float:
        """How far behind the tested car's front the other's front meets its flank."""
        times = np.arange(self.event - 0.3, self.event + 0.3, 0.005)
        reach = (self.drive.car.width + self.size(who)[0]) / 2
        side = np.sign(self._in_car(who, self.event)[1])
        left = [side * self._in_car(who, each)[1] - reach for each in times]
        time = float(np.interp(0.0, -np.array(left), times))
        return self.drive.car.length / 2 - self._in_car(who, time)[0]

    def front_short(self, who: int, want: float) -> float:
        """How far the tested car's front is before the crossing of the paths when the other's front is
        there."""
        tracks = self.other(who, self.others.time[self._there(who)])
        crossing = LineString(tracks[:2].T).intersection(self.path)
        crossing = crossing if crossing.geom_type == "Point" else crossing.geoms[0]
        times = np.arange(max(self.event - 1.5, 0.0), self.event + 0.8, 0.01)
        x, y, heading, _ = self.other(who, times)
        own = self.size(who)[0] / 2
        front = np.hypot(x + own * np.cos(heading) - crossing.x, y + own * np.sin(heading) - crossing.y)
        time = times[int(front.argmin())]
        (s,), _ = self.along(*self.car([time])[:2])
        return float(self.path.project(crossing) - s - self.drive.car.length / 2)

    def meets(self, who: int, want: float) -> float:
        """The least distance of the boxes."""
        if np.isfinite(self.contact(who)):
            return 0.0
        x, y, *_ = self.other(who, self.until)
        u, v, *_ = self.car(self.until)
        nearest = int(np.nanargmin(np.hypot(x - u, y - v)))
        return min(self._apart(who, each) for each in self.until[max(nearest - 3, 0) : nearest + 4])


def _worst(values: Any, want: float) -> float:
    return float(values[int(np.nanargmax(np.abs(values - want)))])
