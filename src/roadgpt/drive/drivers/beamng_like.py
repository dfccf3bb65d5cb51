"""The default driver under test: cuts corners and brakes late, as BeamNG's AI did in recordings."""

import math
from dataclasses import dataclass, replace

import numpy as np

from roadgpt.drive.driving_line import (
    EASY_BRAKING,
    FloatArray,
    highest_speeds,
    kept_in_lane,
    line_along,
    pursuit_curvature,
    smoothed,
    stations,
)
from roadgpt.drive.keeping_distance import KeepingDistance
from roadgpt.drive.view import Command, View
from roadgpt.road import Road, World
from roadgpt.road.profile import Profile
from roadgpt.road.speed_profile import DrivingLimits, plan_speed

USUAL = 70 / 3.6  # m/s, the limit under which BeamNG's AI was recorded
BRAKING = 0.9  # g; recordings of BeamNG's AI: 8.5 to 10.8 m/s^2
TRACTION = 0.7  # g; recordings: 6.7 to 7.2 m/s^2
SMOOTHING = 5.0  # m, half-width of the Hann window over the lane's curvature
HALF_TRACK = 0.90  # m from the car's middle to the outer edge of the wheels of one side
PURSUIT_CUTS = 8.5  # m^2: the car runs inside its line by this times its curvature (measured: 8.0, r = 0.995)
TIGHTEST = 0.2  # lower bound of 1 + 2k, for centre lines that turn more tightly than the lane can


@dataclass(eq=False)
class BeamngLike:
    """Cuts the inside of every bend, as BeamNG's AI did in recordings.

    Its planned line is shifted from the lane's middle towards the inside of the bend by ``cut * tanh(k /
    sharpness)`` metres, where k is the curvature of the middle of its lane. It steers towards a point of this
    line ahead of the car, and slows down in bends to keep the lateral acceleration below a limit.

    It imitates BeamNG's AI at aggression 0.7 under a speed limit of 70 km/h, as the SBFT tool competition
    uses it. Its parameters were fitted to the recorded outcomes of 2,388 flat roads, and tested on 2,129
    others: on average it is a fair substitute, but it cannot predict the outcome of a single road
    (docs/explanation/fair-judge.md has the figures). Like BeamNG's AI it fails by cutting corners: it leaves
    its lane for another lane or for the shoulder, and both count as outside.

    All recordings have the same speed limit and a dry two-lane road without superelevation. Three properties
    of the driver are therefore assumptions: it cuts more at a higher speed limit (``eagerness``), it always
    plans for a dry road (``assumed_friction``), and its planned speed takes superelevation into account.

    No recording has a junction. Inside junctions and roundabouts the driver drives as people do
    (``drive.driving_line``). The middle of the car keeps at least 1.5 m from both edges of a lane that is
    3 m wide or wider. The car is at most as fast as people are on a line of the same radius, and brakes
    for this speed with at most 3.4 m/s^2. The car stops at stop signs.

    Args:
        cut: largest shift towards the inside of a bend, in metres, at a speed limit of 70 km/h.
        sharpness: curvature in 1/m at which the shift is 76 % of ``cut``.
        aside: constant shift of the line to the right of the lane's middle, in metres; to the left with
            traffic on the left.
        joining: distance from the road's start, in metres, over which the driver moves from the lane's middle
            to its line.
        eagerness: exponent with which ``cut`` grows with the speed limit; 0 makes it constant.
        risk: planned lateral acceleration in bends, in g, at most 0.95 times the friction; BeamNG's AI at
            aggression 0.7 reaches 0.64.
        headway: time in seconds in which the car would reach the point that it steers towards.
        nearest: smallest distance to the point that it steers towards, in metres.
        compensation: steering angle added per lateral acceleration, in rad per m/s^2.
        throttle: throttle per m/s of speed error.
        brake: brake per m/s of speed error.
        edge_room: distance in metres between the outer wheels and the outer edge of a carriageway without a
            shoulder (a floating mesh road). The outer wheels are the right wheels, or the left wheels with
            traffic on the left. On a one-way road, the inner wheels keep the same distance from the inner
            edge. With None the driver ignores the edges and may fall off.
        assumed_friction: friction that the driver plans for; None for the friction of the world.
        wheelbase: wheelbase in metres."""

    name = "beamng_like"

    cut: float = 3.85
    sharpness: float = 0.104
    aside: float = 0.1
    joining: float = 35.0
    eagerness: float = 0.5
    risk: float = 0.64
    headway: float = 0.65
    nearest: float = 7.75
    compensation: float = 0.003
    throttle: float = 0.2
    brake: float = 0.4
    edge_room: float | None = 0.3
    assumed_friction: float | None = 1.0
    wheelbase: float = 2.83

    def start(self, road: Road, world: World, seed: int) -> None:
        """Plans the line and the speed for a road."""
        del seed  # the same road is driven the same way every time
        line = line_along(road, self.offsets(road, world))
        friction = world.site.friction if self.assumed_friction is None else self.assumed_friction
        most = 0.95 * friction
        limits = DrivingLimits(
            min(self.risk, most), min(BRAKING, most), min(TRACTION, most), world.driven_speed
        )
        # Like BeamNG's plan, this one considers slopes but not crests. Superelevation is an assumption.
        level = replace(line, crest=[0.0] * len(line.crest))
        self._line = line
        self._speed = plan_speed(level, limits, highest_speeds(road, world, line, EASY_BRAKING))
        self._distance = KeepingDistance(line, road)

    def bend(self, road: Road, world: World) -> FloatArray:
        """Returns the curvature of the lane's middle in 1/m at ``stations(road)``, shape ``(n,)``.

        The curvature is smoothed over 10 m, so that short bends vanish."""
        s = stations(road)
        bend = road.curvature(s)
        stretch = np.maximum(1 - world.profile_of(road).middle(s) * bend, TIGHTEST)
        return smoothed(bend / stretch, float(s[1]), SMOOTHING)

    def offsets(self, road: Road, world: World) -> FloatArray:
        """Returns the offsets of the planned line at ``stations(road)``, shape ``(n,)``.

        They are in metres to the left of the road's centre line."""
        s, bend, profile = stations(road), self.bend(road, world), world.profile_of(road)
        middle = profile.middle(s)
        cut = self.cut * (world.limits.speed_limit / USUAL) ** self.eagerness
        aside = profile.side * self.aside
        offset: FloatArray = middle + self._joined(s) * (cut * np.tanh(bend / self.sharpness) + aside)
        kept = offset if self.edge_room is None else self._kept_on(profile, s, bend, offset)
        return kept_in_lane(road, world, s, kept, PURSUIT_CUTS * bend)

    def _kept_on(self, profile: Profile, s: FloatArray, bend: FloatArray, offset: FloatArray) -> FloatArray:
        """Returns the offsets, moved away from edges of the carriageway that have no shoulder."""
        assert self.edge_room is not None
        room, edges, rims = HALF_TRACK + self.edge_room, profile.edges(s), profile.rims(s)
        kept, has_oncoming = offset, profile.count[1] > 0
        if not (has_oncoming and profile.left_hand):
            most = np.maximum(kept, room + np.maximum(-bend, 0.0) * PURSUIT_CUTS + edges.right)
            kept = np.where(rims.right < edges.right, kept, most)
        if not has_oncoming or profile.left_hand:
            least = np.minimum(kept, edges.left - room - np.maximum(bend, 0.0) * PURSUIT_CUTS)
            kept = np.where(rims.left > edges.left, kept, least)
        return kept

    def _joined(self, s: FloatArray) -> FloatArray:
        """Returns which share (0..1) of the move from the lane's middle to the planned line is complete."""
        share = np.clip(s / self.joining, 0.0, 1.0) if self.joining > 0 else np.ones_like(s)
        return np.asarray(share * share * (3 - 2 * share), float)

    def steer(self, view: View) -> Command:
        """Steers towards a point of the planned line ahead of the car, and follows the planned speed."""
        line, v = self._line, view.speed
        bend = pursuit_curvature(line, view, max(self.headway * v, self.nearest))
        steer = math.atan(self.wheelbase * bend) + self.compensation * v * v * bend
        here, _ = line.place(view.s)
        error = self._speed[here] - v
        if error > 0:
            command = Command(steer, min(self.throttle * error, 1.0), 0.0)
        else:
            command = Command(steer, 0.0, min(-self.brake * error, 1.0))
        return self._distance.kept(view, command)
