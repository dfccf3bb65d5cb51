"""Traffic lights that run: which lanes see green, yellow or red at a time.

Opposite arms of a junction have green together, or one after another where somebody runs a red light who
comes towards the tested car; the arms or pairs one after another, each for GREEN_FOR seconds, then yellow for
YELLOW_FOR and red for everybody for CLEARING. Source: FHWA, Traffic Signal Timing Manual (2008), sections
4.3 (split phasing), 5.3 and 5.4: yellow 3 to 5 s, red clearance 1 to 2 s, and at least 15 s of green for an
arm of a larger road."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import Role, Signal
from roadgpt.geometry import wrap_angle
from roadgpt.language.names import Shown
from roadgpt.network import network_of
from roadgpt.network.network import Arm, Junction, Network, RoadEnd
from roadgpt.road import Road, World
from roadgpt.traffic.following import GREEN, RED, YELLOW
from roadgpt.traffic.maneuver import drawn

GREEN_FOR, YELLOW_FOR, CLEARING = 15.0, 3.0, 2.0  # s
PHASE = GREEN_FOR + YELLOW_FOR + CLEARING
BEGINS: Mapping[Shown, float] = {"green": 0.0, "yellow": GREEN_FOR, "red": GREEN_FOR + YELLOW_FOR}
"""Seconds after its green at which an arm gets a colour."""
WHEN_IT_COMES: Mapping[Shown, float] = {
    "green": GREEN_FOR / 2, "yellow": GREEN_FOR + 1.0, "red": GREEN_FOR + YELLOW_FOR + 6.0,
}  # fmt: skip
"""The same for when the tested car comes: it sees red in time to stop with 2 m/s^2 at 50 km/h."""
OF_SIGNAL = (113, 127)  # beside the seed
OPPOSITE = math.radians(135.0)  # arms whose directions differ by more have green together


class Lights:
    """The lights of a network, which begin at a moment of their cycle that the seed decides."""

    def __init__(self, network: Network, seed: int, actors: Sequence[Role] = ()) -> None:
        rng = np.random.default_rng([seed, len(network.junctions)])
        self.phases: dict[RoadEnd, tuple[int, int, float]] = {}
        """For each arm with lights its phase, the number of phases, and the moment at which the cycle
        begins."""
        most = 1 if any(_runs(each) and each.side == "opposite" for each in actors) else 2
        for junction in network.junctions:
            groups: list[list[Arm]] = []
            for arm in junction.arms:
                turned = [abs(wrap_angle(arm.direction - first.direction)) for first, *_ in groups]
                is_free = [
                    by > OPPOSITE and len(pair) < most for by, pair in zip(turned, groups, strict=True)
                ]
                if arm.control == "lights" and any(is_free):
                    groups[is_free.index(True)].append(arm)
                elif arm.control == "lights":
                    groups.append([arm])
            begin = float(rng.uniform(0.0, PHASE * max(len(groups), 1)))
            for n, group in enumerate(groups):
                self.phases |= {arm.end: (n, len(groups), begin) for arm in group}

    def shown(self, end: RoadEnd, time: float) -> int:
        """Returns GREEN, YELLOW or RED for the traffic that comes from the end of a road at a time in
        seconds; GREEN if it has no lights."""
        if end not in self.phases:
            return GREEN
        phase, count, begin = self.phases[end]
        since = (time + begin) % (PHASE * count) - phase * PHASE
        if not 0.0 <= since < GREEN_FOR + YELLOW_FOR:
            return RED
        return GREEN if since < GREEN_FOR else YELLOW

    def show(self, junction: Junction, end: RoadEnd, time: float, since: float) -> None:
        """Moves the cycle of a junction so that one of its arms has begun its green so many seconds before a
        time."""
        phase, count, _ = self.phases[end]
        begin = (phase * PHASE + since - time) % (PHASE * count)
        for arm in junction.arms:
            if arm.end in self.phases:
                self.phases[arm.end] = (*self.phases[arm.end][:2], begin)

    def cycle(self, junction: Junction) -> list[tuple[float, dict[RoadEnd, int]]]:
        """Returns what the lights of a junction show from time 0 on, until that begins anew: seconds, and
        GREEN, YELLOW or RED for each arm with lights. Empty if there are none."""
        arms = [arm.end for arm in junction.arms if arm.end in self.phases]
        if not arms:
            return []
        _, count, begin = self.phases[arms[0]]
        changes = [n * PHASE + each for n in range(count) for each in (0, GREEN_FOR, GREEN_FOR + YELLOW_FOR)]
        times = sorted({0.0, PHASE * count, *((each - begin) % (PHASE * count) for each in changes)})
        return [(b - a, {arm: self.shown(arm, (a + b) / 2) for arm in arms}) for a, b in pairwise(times)]


def comes_from_side(role: Role) -> bool:
    """Returns whether somebody, who does not only stand, comes to a junction on a road from the side."""
    is_there = role.where == "junction" and role.side != "opposite" and role.goes != "turn_across"
    return is_there and (bool(role.actions) or role.speed != exactly(0))


def _runs(role: Role) -> bool:
    return any(each.what == "run_light" for each in role.actions)


def lights_of(road: Road, world: World, seed: int) -> Lights:
    """Returns the lights that run in a drive. If the scene has actors, the tested car has green wherever it
    comes at its first speed, and so has who drives along with it or towards it. If somebody comes from the
    side and nobody runs a red light, that one has green, and the tested car red. What the first lights on its
    way show may be told."""
    actors, signal = world.scene.actors, world.scene.lights
    lights = Lights(network_of(road, world), seed, actors)
    crosses = any(map(comes_from_side, actors)) and not any(map(_runs, actors))
    speed = world.first_speed or world.limits.speed_limit  # who stands at first goes on up to the limit
    for passage in road.passages if actors else ():
        if passage.control == "lights":
            own = lights.phases[passage.arrival]
            others = [each for each in passage.arms if lights.phases.get(each, own) != own]
            end = others[0] if crosses and others else passage.arrival
            lights.show(passage.entered, end, passage.start / speed, GREEN_FOR / 2)
    lit = next((each for each in road.passages if each.control == "lights"), None)
    if signal is not None and lit is not None:
        comes = (lit.start - world.start_on(road)) / speed
        turns = turns_at(signal, seed)
        if turns is None:
            lights.show(lit.entered, lit.arrival, comes, WHEN_IT_COMES[signal.shows])
        else:
            lights.show(lit.entered, lit.arrival, turns, BEGINS[signal.shows])
    return lights


def turns_at(signal: Signal, seed: int) -> float | None:
    """Returns from when on, in seconds, the lights show what is told; None: when the tested car comes."""
    return drawn(signal, np.random.default_rng([seed, *OF_SIGNAL])).get("time")
