"""Reverses the tested car, or turns it round on its road, for the script of a scene.

Turning round, it goes at full lock towards the oncoming lanes until it points back along its road. Where a
corner comes to the edge of the lanes before that, it stops, reverses at full lock the other way until the
other edge, and goes on; then it drives back in the middle of the oncoming lane."""

import math

from roadgpt.drive.drive import Box
from roadgpt.drive.driving_line import pedals_for
from roadgpt.drive.view import View
from roadgpt.errors import SceneError
from roadgpt.geometry import wrap_angle
from roadgpt.road import Road, World
from roadgpt.traffic.maneuver import REVERSING, Maneuver
from roadgpt.traffic.places import SIGN, offset_of

CREEPS = 1.8  # m/s, at full lock
PULL = 2.0  # 1/s, acceleration per speed error
HALTS = 2.5  # m/s^2, before it changes gear
HALTED = 0.05  # m/s
LOCK = 0.62  # rad, of the front wheels
EDGE = 0.25  # m, from the corners to the edge of the lanes
ROUND = math.radians(8.0)  # from pointing back: then it drives on straight
TURNS, ASIDE = 1.2, 0.35  # rad per rad of heading, and of heading per metre, of the steering
LASTS = 6.0  # s, it reverses, or drives back behind the turn, where nothing is said
MOST = 12  # changes of gear, after which the road is too narrow


class Shunt:
    """One such movement. Distances to the left are those of its road, as the car came."""

    def __init__(self, road: Road, world: World, box: Box, maneuver: Maneuver, view: View) -> None:
        """Raises SceneError if the road has no lane to go back in."""
        self._road, self._world, self._box, self._n = road, world, box, maneuver.n
        self._turns_round, self._middle = maneuver.what == "u_turn", view.t
        profile = world.profile_of(road)
        self._side = SIGN["right" if profile.left_hand else "left"]
        if self._turns_round:
            self._middle = float(profile.middle(view.s))
            self._middle += offset_of("oncoming", None, view.s, road, world, box.width)
        self._gear, self._changes, self._since = (1 if self._turns_round else -1), 0, math.nan
        self._halts = False
        self.is_done = False

    @property
    def reach(self) -> float:
        """How many metres it reverses at most."""
        return self._n.get("duration", LASTS) * self._n.get("to", REVERSING)

    def command(self, view: View) -> tuple[float, float, float]:
        """Returns steering angle in radians, throttle (negative in reverse gear) and brake for now."""
        along = wrap_angle(view.heading - float(self._road.heading(view.s)))
        back = float(wrap_angle(along - math.pi))
        straight = not self._turns_round or abs(back) < ROUND or not math.isnan(self._since)
        if straight:
            self._since = view.time if math.isnan(self._since) else self._since
            self.is_done = view.time - self._since >= self._n.get("duration", LASTS)
            if self._turns_round:
                steer = -TURNS * (back - ASIDE * (view.t - self._middle))
            else:
                steer = TURNS * (float(along) - ASIDE * (view.t - self._middle))
            usual = REVERSING if not self._turns_round else self._n.get("to", 2 * CREEPS)
            speed = self._n.get("to", usual)
        else:
            self._change_gear(view, float(along))
            steer, speed = self._gear * self._side * LOCK, 0.0 if self._halts else CREEPS
        ahead = self._gear * view.vx
        pull = PULL * (speed - ahead) if speed else -HALTS
        if not speed and ahead < HALTED:
            return steer, 0.0, 1.0
        grade = self._gear * float(self._road.grade(view.s)) * math.cos(along)
        throttle, brake = pedals_for(pull, grade, max(ahead, 0.0))
        return min(max(steer, -LOCK), LOCK), self._gear * throttle, brake

    def _change_gear(self, view: View, along: float) -> None:
        """Stops before the edge of the lanes, and then goes on the other way."""
        if self._halts and abs(view.vx) < HALTED:
            self._halts, self._gear, self._changes = False, -self._gear, self._changes + 1
            if self._changes > MOST:
                raise SceneError(
                    f"the tested car cannot turn round at {view.s:.0f} m, where the road is too narrow"
                )
        towards, end = self._gear * self._side, self._box.ahead + self._gear * self._box.length / 2
        edges = self._world.profile_of(self._road).edges(view.s)
        edge = float(edges.left) if towards > 0 else -float(edges.right)
        corner = towards * (view.t + end * math.sin(along)) + self._box.width / 2 * abs(math.cos(along))
        nears = math.sin(along) * self._side > 0  # so that going on brings it nearer to that edge
        self._halts |= nears and corner + view.vx**2 / (2 * HALTS) > edge - EDGE
