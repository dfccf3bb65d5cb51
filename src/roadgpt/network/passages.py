"""Lists the passages of a route: its ways through junctions. The way through a roundabout is one passage,
though a roundabout has several junctions.
"""

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

from roadgpt.brief.junctions import Control
from roadgpt.network.network import Arm, Junction, Leg, Network, RoadEnd

CROSSWALK = (1.0, 3.0)  # m, from a junction to a crosswalk, and length of the stripes (Germany, R-FGUe)
GAP = 1.0  # m, between a stop line and a crosswalk
CROSSED = sum(CROSSWALK) + GAP  # m, from a junction with a crosswalk to a stop line
STOP_LINE = 0.5  # m, width of a stop line; without a crosswalk it lies next to the junction (Germany, RMS-1)


class Passage(NamedTuple):
    """The way of a route through one junction or one roundabout."""

    start: float
    """Station in metres at which the route enters the junction or roundabout."""
    end: float
    """Station in metres at which the route leaves the junction or roundabout."""
    entered: Junction
    """The junction; for a roundabout, the junction of the arm on which the route arrives."""
    arrival: RoadEnd
    """The end, at the junction, of the road on which the route arrives."""
    departure: RoadEnd
    """The end, at the junction, of the road on which the route goes on."""
    arms: tuple[RoadEnd, ...]
    """The ends of all roads that meet there, first the road of arrival, then counter-clockwise if traffic
    drives on the right and clockwise if it drives on the left."""

    @property
    def exit(self) -> int:
        """Number of the exit, from 1 in the order of ``arms``; the road of arrival is the last exit."""
        return self.arms.index(self.departure) or len(self.arms)

    @property
    def stop_line(self) -> float | None:
        """Station in metres at which the line of a stop sign begins; None if there is no stop sign."""
        return self.start - line_before(self._arm) - STOP_LINE if self.control == "stop" else None

    @property
    def control(self) -> Control:
        """The sign or the light that the route meets at the road of arrival."""
        return self._arm.control

    @property
    def _arm(self) -> Arm:
        return next(arm for arm in self.entered.arms if arm.end == self.arrival)


def line_before(arm: Arm) -> float:
    """Returns the distance in metres from a junction to the stop line of an arm: 0 without a crosswalk."""
    return CROSSED if arm.crosswalk else 0.0


def passages_of(network: Network, legs: Sequence[Leg], starts: Sequence[float]) -> tuple[Passage, ...]:
    """Returns the passages of a route in driving order; ``starts`` are those of ``Route.starts``."""
    groups = groupby(range(len(legs)), key=lambda n: _place(network, legs[n]))
    return tuple(
        _passage(network, legs[own[0]], legs[own[-1]], starts[own[0]], starts[own[-1] + 1])
        for own in (list(group) for place, group in groups if place is not None)
    )


def _place(network: Network, leg: Leg) -> tuple[str, int] | None:
    """Returns a key for the junction or roundabout in which a leg lies; None outside junctions."""
    ring = network.roundabout_of.get(leg.road)
    if ring is not None:
        return "roundabout", ring.junctions[0]
    junction = network.road(leg.road).junction
    return None if junction is None else ("junction", junction)


def _passage(network: Network, one: Leg, other: Leg, start: float, end: float) -> Passage:
    """Returns the way through a junction or roundabout; ``one`` and ``other`` are its first and last leg."""
    entered, first = network.connection_of[one.road]
    last = network.connection_of[other.road][1]
    ring = network.roundabout_of.get(entered.id)
    # the first arm of each junction of a roundabout is the one that is no part of the ring
    arms = entered.arms if ring is None else [network.junction(each).arms[0] for each in ring.junctions]
    if ring is None and network.left_hand:
        arms = arms[::-1]
    ends = [arm.end for arm in arms]
    at = ends.index(first.incoming)
    return Passage(start, end, entered, first.incoming, last.outgoing, (*ends[at:], *ends[:at]))
