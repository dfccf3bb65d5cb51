"""What comes from somebody of a scene: a door that it opens, and a load that it drops."""

import math

from roadgpt.language.names import ActorKind
from roadgpt.language.table import SIZES
from roadgpt.road.speed_profile import GRAVITY
from roadgpt.traffic.actor import STEP, STILL
from roadgpt.traffic.performer import Performer

COMES: dict[str, ActorKind] = {"open_door": "door", "drop": "lost_load"}
HINGE = 0.3  # of its length behind its front, where a front door hangs; ours
OPENS, WIDE = 1.0, math.radians(70.0)  # s, and how far a door opens; ours
SLIDES = 0.5 * GRAVITY  # m/s^2, of a load on a dry road; ours


class Extra:
    """What comes from one of the maneuvers of somebody, from its begin on."""

    def __init__(self, who: Performer, number: int) -> None:
        self._who, self._number = who, number
        self.kind = COMES[who.maneuvers[number].what]
        self._lasted, self._load = 0.0, tuple[float, ...]()

    def move(self) -> None:
        """Moves it on by STEP."""
        is_shown, state = self._number in self._who.shown, self._who.state()
        if self.kind == "door":
            stands = is_shown and abs(self._who.longitudinal.v) < STILL
            self._lasted += STEP if stands or self._lasted else 0.0
            return
        if is_shown and not self._load and state is not None:
            x, y, z, heading, v = state
            back = (self._who.size.length + SIZES[self.kind].length) / 2
            self._load = x - back * math.cos(heading), y - back * math.sin(heading), z, heading, v
        elif self._load:
            x, y, z, heading, v = self._load
            slower = max(v - SLIDES * STEP, 0.0)
            gone = (v + slower) / 2 * STEP
            self._load = x + gone * math.cos(heading), y + gone * math.sin(heading), z, heading, slower

    def state(self) -> tuple[float, ...] | None:
        """Returns its state; None while it is not there."""
        state = self._who.state()
        ends = self._who.maneuvers[self._number].n.get("duration", math.inf)
        if self.kind != "door" or state is None or not 0.0 < self._lasted <= ends:
            return self._load or None
        x, y, z, heading, _ = state
        side, (length, width, _) = self._side, self._who.size
        along, across = (0.5 - HINGE) * length, side * width / 2
        x += along * math.cos(heading) - across * math.sin(heading)
        y += along * math.sin(heading) + across * math.cos(heading)
        heading += side * (math.pi - WIDE * min(self._lasted / OPENS, 1.0))
        reach = SIZES[self.kind].length / 2
        return x + reach * math.cos(heading), y + reach * math.sin(heading), z, heading, 0.0

    @property
    def _side(self) -> int:
        """1 for its left, -1 for its right: the side that is told as the tested car sees it, else that
        towards its lane."""
        side = self._who.maneuvers[self._number].action.side
        is_left = side == "left" if side else self._who.lateral.t <= 0
        return self._who.course.forward if is_left else -self._who.course.forward
