"""What a design speed requires of a road: radii, vertical curves, transitions, and straights.

Source: AASHTO, A Policy on Geometric Design of Highways and Streets (2018, the "Green Book"), chapter 3. The
least radius is V^2 / (127 (e + f)) with the side friction f of the table and a superelevation e of 6 percent.
Vertical curves give the stopping sight distance S of the table: K is S^2 / 658 on a crest, and S^2 / (120 +
3.5 S) in a sag, in metres per percentage point. A transition takes 2 s at the design speed. Speeds between
two rows get values between them. The guide sets no limits for straights; those are of RAS-L 1995: 6 V metres
or more between two curves to the same side, and 20 V at most, for V in km/h."""

from collections.abc import Mapping
from functools import cache
from math import radians
from typing import NamedTuple

from roadgpt.brief.words import KINDS
from roadgpt.language.table import ROADS

SLOWEST, FASTEST = 20.0, 130.0  # km/h
EVERY = 10.0  # km/h, from one value of the table to the next
FRICTION = (0.35, 0.28, 0.23, 0.19, 0.17, 0.15, 0.14, 0.13, 0.12, 0.11, 0.09, 0.08)
SIGHT = (20, 35, 50, 65, 85, 105, 130, 160, 185, 220, 250, 285)
"""Side friction, and stopping sight distance in metres, for the design speeds from ``SLOWEST`` on."""
SUPERELEVATION = 0.06
TRANSITION = 2.0  # s
BETWEEN_SAME_SIDE = 6.0  # m of straight for each km/h, between two turns to the same side
USUAL: Mapping[str, float] = {name: row["speed"] for name, row in ROADS["surroundings"].items()}
"""The design speed in km/h of each kind of road that gives none."""
FOR_ROUNDING = 1.002  # ratio of drawn vertical radii to the least ones: inclines are written to the tenth


class SpeedLimits(NamedTuple):
    """What a design speed requires; lengths are in metres."""

    kmh: float
    radius: float  # the least radius of turns
    crest: float  # the least vertical radius of crests: 100 K
    sag: float  # the least vertical radius of sags
    sight: float  # the stopping sight distance
    transition: float  # the length of the clothoid at either end of a turn, where the turn has room for it

    @property
    def vertical_radius(self) -> float:
        """The least vertical radius that is drawn, on crests and in sags alike."""
        return FOR_ROUNDING * max(self.crest, self.sag)

    @property
    def shortest_turn(self) -> float:
        """The length of a turn of the least radius by the least angle that is drawn."""
        degrees = KINDS["turn"].degrees
        assert degrees is not None
        return self.radius * radians(degrees.lo) + self.transition


@cache
def limits_at(kmh: float) -> SpeedLimits:
    """Returns what a design speed, from ``SLOWEST`` to ``FASTEST`` km/h, requires."""
    row = min(int((kmh - SLOWEST) / EVERY), len(SIGHT) - 2)
    share = (kmh - SLOWEST) / EVERY - row
    friction, sight = (column[row] + share * (column[row + 1] - column[row]) for column in (FRICTION, SIGHT))
    return SpeedLimits(
        kmh,
        radius=kmh**2 / (127 * (SUPERELEVATION + friction)),
        crest=100 * sight**2 / 658,
        sag=100 * sight**2 / (120 + 3.5 * sight),
        sight=sight,
        transition=TRANSITION * kmh / 3.6,
    )
