"""Defines the View that a driver gets and the Command that it returns at every control step."""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.language.names import ActorKind, What
from roadgpt.language.table import ROAD_USERS, VEHICLES
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.network import Route


class JunctionAhead(NamedTuple):
    """A junction that the route passes, as a driver sees it."""

    distance: float
    """Distance in metres along the route from the car's centre of gravity to the junction; 0 inside it."""
    kind: str
    """"t_junction", "y_junction", "crossroads", "star", "roundabout", "merge" or "diverge"."""
    turn: float
    """Change of direction in radians from the road of arrival to the road of departure, left positive, in
    (-pi, pi]."""
    exit: int
    """Number of the road on which the route leaves, counted counter-clockwise from the road of arrival, or
    clockwise with traffic on the left. At a roundabout it is the number of the exit."""
    control: str
    """What applies to the car: "priority", "yield", "stop", "lights" or "none"."""
    length: float
    """Length in metres of that part of the way through the junction which is still ahead of the car."""


class LightAhead(NamedTuple):
    """Traffic lights that the route comes to, as a driver sees them."""

    distance: float
    """Distance in metres along the route from the car's centre of gravity to the stop line."""
    shows: Literal["green", "yellow", "red"]


class SignAhead(NamedTuple):
    """A sign that the route comes to, as a driver sees it."""

    kind: Literal["stop", "yield", "speed limit"]
    distance: float
    """Distance in metres along the route from the car's centre of gravity: to the line of "stop" and "yield",
    or to the junction where there is no line; 0 of a speed limit that holds where the car is."""
    limit: float | None = None
    """The speed limit in m/s; None for other signs."""


class Other(NamedTuple):
    """Somebody or something else on the road, as a driver sees it."""

    kind: ActorKind
    """Such as "car" or "adult"; the page Plans lists them. More may come: ``group`` stays."""
    x: float
    """Position of the middle of its box along x in metres, and along ``y``."""
    y: float
    heading: float
    """Heading in radians, in (-pi, pi]; 0 along +x, positive to the left."""
    speed: float
    """Speed along its heading in metres per second; negative when it reverses."""
    length: float
    """Length of its box in metres, and ``width``."""
    width: float
    s: float = math.nan
    """Station of the middle of its box in metres along the road's centre line, seen from the nearest place of
    the road; before its begin negative. ``t`` is its offset to the left. NaN in simulators that do not tell
    them."""
    t: float = math.nan
    lane: int | None = None
    """The driving lane of the road in which the middle of its box is, counted to the left from the one that
    the car is to follow, oncoming lanes included: 0 is that one, 1 the next one to its left, -1 the next one
    to its right. None if it is in none of them."""

    @property
    def group(self) -> Literal["vehicle", "person", "animal", "thing"]:
        """What its kind is one of."""
        return ROAD_USERS[self.kind].group


class Others(tuple[Other, ...]):
    """The others that a driver sees, nearest first."""

    @cached_property
    def boxes(self) -> NDArray[np.float64]:
        """Each Other from ``x`` to ``width``, and 1.0 if it is a vehicle, else 0.0; shape (n, 7)."""
        return np.array([(*each[1:7], each.kind in VEHICLES) for each in self], float).reshape(-1, 7)


class DrivingTask(NamedTuple):
    """What a scene tells the car to do, and its driver does itself, because it names that in ``follows``."""

    what: What
    """Such as "change_lane"; the page Plans lists them."""
    numbers: Mapping[str, float]
    """Those of the scene, in m, m/s, m/s^2 and s. What changes the speed has "to", the speed to come to, and
    "accel" with which, once it has begun; "distance" is how far the front of the car is from the place where
    it is to stop."""
    side: Literal["left", "right"] | None
    has_begun: bool
    """Whether it is to be done now; False: it is what comes next."""


class View(NamedTuple):
    """The current state of the car, with its road and world.

    A new View is made for every control step, so a driver may keep it.

    The position is that of the car's centre of gravity."""

    time: float
    """Seconds since the start."""
    x: float
    """Position along x in metres."""
    y: float
    """Position along y in metres."""
    z: float
    """Height of the centre of gravity in metres; it is about half a metre above the road."""
    heading: float
    """Heading in radians, in (-pi, pi]; 0 along +x, positive to the left."""
    speed: float
    """Speed in metres per second, never negative."""
    yaw_rate: float
    """Yaw rate in radians per second, positive to the left."""
    s: float
    """Station of the car, in metres along the road's centre line."""
    t: float
    """Offset of the car in metres to the left of the centre line. The middle of its lane is at
    ``world.profile_of(road).middle(s)``. On a road with superelevation, the offset is measured along the
    surface, to the foot of the perpendicular from the centre of gravity."""
    road: Road
    world: World
    steer: float
    """Current angle of the front wheels in radians, left positive."""
    dt: float
    """Seconds to the next control step."""
    vx: float
    """Forward velocity of the car in metres per second; negative when it rolls back."""
    vy: float
    """Velocity of the car to its left in metres per second."""
    image: Any = None
    """The driver's camera image, shape (height, width, 3), uint8; None if the driver has no attribute
    ``camera``."""
    route: "Route | None" = None
    """The road as a way through a network of roads; None on a single road."""
    junctions: tuple[JunctionAhead, ...] = ()
    """The junctions on the route that the car has not left yet, nearest first."""
    lanes_left: int = 0
    """Number of driving lanes to the left of the lane that the car is to follow, oncoming lanes included."""
    lanes_right: int = 0
    """Number of driving lanes to the right of the lane that the car is to follow, oncoming lanes included."""
    others: tuple[Other, ...] = ()
    """The others on the road whose middles are within 200 m of the middle of the car, on all sides, nearest
    first. Left out is whom the driver cannot see, from 1.2 m above the road in the middle of the car: who is
    hidden behind the boxes of others, or behind a crest of the road, and in fog, rain and at night who is
    beyond the visual range."""
    lights: tuple[LightAhead, ...] = ()
    """The traffic lights on the route whose stop lines are ahead of the car, nearest first; empty if no
    traffic drives on the map: then all lights are green."""
    signs: tuple[SignAhead, ...] = ()
    """The signs on the route, nearest first: to stop or to give way, and the speed limits that its lanes have
    of their own. Empty if a simulator does not tell them."""
    task: DrivingTask | None = None
    """What the car is to do by the scene, if the driver names that in its ``follows``; None if there is
    nothing."""


class CameraSpec(NamedTuple):
    """The camera that a driver requests by having an attribute ``camera``; the defaults are those of the SBFT
    competition."""

    width: int = 320
    """Width of the image in pixels."""
    height: int = 160
    """Height of the image in pixels."""
    field_of_view: float = 1.22
    """Vertical field of view in radians, from the top of the image to the bottom."""
    ahead: float = 0.3
    """Position of the camera in metres ahead of the centre of gravity."""
    up: float = 1.3
    """Position of the camera in metres above the road."""
    down: float = 0.05
    """Angle in radians by which the camera is tilted downwards."""
    every: int = 2
    """Number of control steps from one image to the next; 2 gives 25 images a second. BeamNG renders an image
    at every step."""


class Command(NamedTuple):
    """The driver's answer, which holds until the next control step."""

    steer: float
    """Angle of the front wheels in radians, left positive; the car turns its wheels at a limited rate."""
    throttle: float = 0.0
    """Throttle pedal, 0 to 1."""
    brake: float = 0.0
    """Brake pedal, 0 to 1."""
