"""How somebody moves sideways from its way, and where places and maneuvers are that lead it aside."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.scene import HEAD_ON
from roadgpt.errors import SceneError
from roadgpt.language.names import Side, What, Where
from roadgpt.traffic.course import Course, Meeting
from roadgpt.traffic.lane_map import LEAST
from roadgpt.traffic.maneuver import Maneuver
from roadgpt.traffic.places import SIGN, offset_of
from roadgpt.traffic.traffic import Stage

SHARPEST = 2.0  # sideways nobody moves faster than the speed ahead divided by this


class Slide(NamedTuple):
    """A movement sideways in half a cosine wave: its begin and its extent in metres, and seconds."""

    begin: float
    by: float
    lasts: float

    @property
    def peak(self) -> float:
        """The greatest speed in m/s."""
        return math.pi / 2 * abs(self.by) / self.lasts


class Lateral:
    """How far somebody is to the left of its way in metres, and its movement sideways by half a cosine wave:
    slowly at first and at the end, and in the middle with the greatest speed that its maneuver says."""

    def __init__(self, t: float = 0.0) -> None:
        self.t, self.slope = t, 0.0
        self.slide: Slide | None = None
        self.slid = 0.0
        """For how many seconds that has lasted, as its time passes."""
        self.keeps_lane = False
        """Whether it stays in its lane where its way changes lanes, and does not go with it."""

    def stays(self) -> None:
        """Notes whether it is in a lane beside its way from now on."""
        self.keeps_lane = abs(self.t) > LEAST / 2

    def slide_to(self, t: float, lasts: float) -> None:
        """Begins a movement to a place, which lasts some seconds."""
        self.slide, self.slid = Slide(self.t, t - self.t, lasts), 0.0

    @property
    def end(self) -> float:
        """Where it comes to, or is."""
        return self.t if self.slide is None else self.slide.begin + self.slide.by

    @property
    def taken(self) -> float:
        """The acceleration sideways in m/s^2."""
        if self.slide is None:
            return 0.0
        share = math.cos(math.pi * self.slid / self.slide.lasts)
        return abs(self.slide.by * share) * (math.pi / self.slide.lasts) ** 2 / 2

    def pace(self, v: float) -> float:
        """Returns how fast the time of a movement passes: slower for who is slow, not at all at rest."""
        peak = self.slide.peak if self.slide else 0.0
        return min(1.0, abs(v) / (SHARPEST * peak)) if peak else 1.0

    def left(self, v: float) -> float:
        """Returns for how many seconds the movement still lasts at a speed."""
        slid = self.slide.lasts - self.slid if self.slide else 0.0
        return max(slid, 0.0) / (self.pace(v) or 1e-9)

    def step(self, course: Course, since: float, v: float, gone: float, time: float) -> None:
        """Moves it sideways by some seconds in which it went some metres, from station ``since`` of its
        course on, and has come to speed ``v``."""
        if self.slide is None:
            if course.way.aside is not None and self.keeps_lane:
                places = np.interp([course.s, since], course.way.stations, course.way.aside)
                by = float(np.diff(places)[0])
                self.t, self.slope = self.t + by, by / max(abs(course.s - since), 1e-9)
            return
        self.slid += self.pace(gone / max(time, 1e-9)) * time
        share = self.slid / self.slide.lasts
        if share >= 1.0 - 1e-9:
            self.t, self.slope, self.slide = self.end, 0.0, None
            self.stays()
            return
        self.t = self.slide.begin + self.slide.by * (1 - math.cos(math.pi * share)) / 2
        aside = math.copysign(self.slide.peak, self.slide.by) * math.sin(math.pi * share)
        self.slope = aside / max(abs(v), SHARPEST * self.slide.peak, 1e-9)


@dataclass(frozen=True)
class Offsets:
    """Where places and the ends of maneuvers are beside the lane of a course, in metres to its left, for
    somebody of a width who is at a place of a scene at first."""

    stage: Stage
    course: Course
    where: Where
    side: Side | Literal["opposite"] | None
    n: Mapping[str, float]
    first: What | None
    """Its first maneuver."""
    width: float
    its_width: float
    """That of whom it meets."""

    @property
    def kerb(self) -> int:
        """1 if that of the lane is on its left, -1 on its right."""
        return self.stage.world.profile_of(self.stage.road).side

    def lane_width(self, s: float) -> float:
        """Returns the width of the lane at one of its stations."""
        return float(self.stage.world.profile_of(self.stage.road).width(self.course.lane.to_road(s)))

    def of(self, where: Where, s: float, side: Side | None = None) -> float:
        """Returns where a place is. Raises SceneError if there is none."""
        if side is None and self.side != "opposite":
            side = self.side
        if where == "beside" and "away" in self.n:
            return self.n["away"] * SIGN.get(str(side), self.kerb)
        lane, (road, world, *_) = self.course.lane, self.stage
        place = lane.to_road(min(max(s, 0.0), lane.length)), road, world, self.width
        try:
            return offset_of(where, side, *place)
        except SceneError:
            is_kerb = side == ("left" if self.kerb > 0 else "right")
            if where != "lane" or is_kerb or self.first not in ("cut_in", "overtake"):
                raise
            return offset_of("oncoming", None, *place)

    def across(self) -> float:
        """Returns where in the lane it is, or comes to: see ``overlap`` and ``impact``."""
        left = SIGN.get(str(self.side), self.kerb)
        if "impact" in self.n and self.course.is_along:
            left = self.kerb if self.where == "oncoming" else left
            return left * self.its_width * (0.5 - self.n["impact"])
        if self.where == "oncoming":
            left = -self.kerb
        share = self.n.get("overlap", 1.0)
        most = min(self.width, self.its_width) / self.its_width
        return (
            0.0
            if share >= most - 1e-9
            else left * ((self.its_width + self.width) / 2 - share * self.its_width)
        )

    def at_first(self, s: float, whats: list[What]) -> float:
        """Returns where it is at first that does ``whats``."""
        given, comes_later = {"impact", "overlap"} & {*self.n}, {"cut_in", *HEAD_ON} & {*whats}
        if self.where in ("ahead", "behind") or (given and not comes_later):
            return self.n.get("offset", 0.0) + (self.across() if given else 0.0)
        return self.of(self.where, s) + self.n.get("offset", 0.0)

    def leads_to(self, maneuver: Maneuver, s: float, t: float) -> float:
        """Returns where a maneuver leads to from a place."""
        width, side = self.lane_width(s), maneuver.action.side
        match maneuver.what:
            case "cut_out":
                return self.of("lane", s, side)
            case "change_lane" if self.where in ("ahead", "behind") and abs(t) < width / 2:
                return self.of("lane", s, side)
            case "change_lane" if self.where == "oncoming":
                return t + math.copysign(width, t if side is None else SIGN[side])
            case "change_lane" if side in (None, "right" if t > 0 else "left"):
                return 0.0 if self.where == "lane" else self.of("lane", s)
            case "change_lane":
                return self.of("far", s, side)
            case "overtake" if self.where == "behind":
                return self.of("lane", s, "left" if self.kerb < 0 else "right")
            case "drift":
                room = min(1.0, max(abs(t) - width / 2 - 0.2, 0.5))
                left = side == "left" if side else t < 0 if abs(t) > width / 2 else self.kerb > 0
                return t + (1 if left else -1) * maneuver.n.get("shift", room)
            case "swerve":
                shift = maneuver.n.get("shift", max((width - self.width) / 2 - 0.1, 0.3))
                return t + (-shift if maneuver.before % 2 else shift)
            case "wrong_way" if self.where != "oncoming":
                return t
            case _:  # cut_in, wrong_way, pull_out, overtake of who comes towards whom it meets
                return self.across()

    def over_line(self, met: Meeting) -> float:
        """Returns from which station of its way on it is over the line of the lane where they meet."""
        turned = self.course.lane.pose(met.its)[3] - self.course.way.pose(met.own)[3]
        corner = self.lane_width(met.its) / 2 + self.width / 2 * abs(math.cos(turned))
        return met.own - corner / max(abs(math.sin(turned)), 0.3) - self.course.length / 2
