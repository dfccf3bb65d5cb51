"""One step of the vehicles that drive along lanes: they follow each other, give way, and change lanes.

Following: the Intelligent Driver Model (M. Treiber, A. Hennecke, D. Helbing, Congested traffic states in
empirical observations and microscopic simulations, Phys. Rev. E 62, 2000), above the desired speed as in M.
Treiber, A. Kesting, Traffic Flow Dynamics (2013), 11.3.7, and behind leaders as improved there. Everybody
within a vehicle's lanes ahead is a leader, also who only reaches into them, who comes towards it, and the
tested car. Nobody brakes harder than HARDEST, nor drives faster than from where it can still stop behind its
leader (P. G. Gipps, A behavioural car-following model, Transp. Res. B 15, 1981). All accelerations stay in
the friction circle at the vehicle's place and grade.

Changes of lane: MOBIL without politeness (A. Kesting, M. Treiber, D. Helbing, General lane-changing model
MOBIL, Transp. Res. Record 1999, 2007). From the first moment of a change on the vehicle belongs
to both lanes: it follows the leaders of both, and those behind it in both follow it.

Junctions: a vehicle enters a junction only with a grant for its way through. A grant is given when nobody
holds or occupies a way that meets it, and nobody to whom the vehicle gives way would arrive before it has
left the place where the ways meet. Who has waited for PATIENCE seconds goes before those who can still stop
without effort."""

import math
from typing import NamedTuple

import numpy as np

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.boxes import touch
from roadgpt.network.line import LEAST_GRIP, SIDEWAYS, SLOWING
from roadgpt.traffic.actor import STEP, FloatArray
from roadgpt.traffic.lane_map import ACROSS, CALM, PF, PG, PV, IntArray, LaneMap, across, place_on, touched

S, V, LENGTH, WIDTH, FACTOR, TOP, HEADWAY, PULLS, BRAKES, ASIDE, BEGAN, PROGRESS, WAIT, A_NEXT = range(14)
PULL, BRAKE, GRIP, LASTS, DENIED, CHANGES = range(14, 20)
"""Columns of numbers of a vehicle: the station of its middle in its lane, its speed, length and width; the
share of speed limits and the top speed that it drives; IDM's T, a and b; its offset to the left of its
lane's middle, that offset when its change of lane began, and the share of the change that is done (1: none
under way); for how long it has stood first in line; its acceleration in the next step; IDM's a and b, the
hardest braking and the seconds of a change of lane that friction and grade allow at its place; the hardest
braking that they denied it; and the seconds of a change of lane that it takes itself."""
NUMBERS = CHANGES + 1
AT, LAST, GRANTED, OLD, STATE, HAS_STOPPED, GOAL = range(7)
"""Columns of whole numbers: which lane of its way it is in, the number of lanes of its way, up to which of
them it has a grant, the lane that it is leaving (-1: none), its state, whether it has stood at the stop
sign ahead, and the exit of the map to which it drives."""
ABSENT, DRIVES, STANDS_HIT = range(3)
TESTED = 0
"""The row of the tested car, which is not moved."""
JAM = 2.0  # m, IDM's s0
HARDEST = 9.0  # m/s^2, as SUMO's emergencyDecel
SPARE = 0.1  # m/s^2, by which one is told to want to brake harder than it can
EASY = 2.0  # m/s^2, with which a vehicle plans to stop
FIRM = 3.0  # m/s^2, with which it stops for a yellow light; else it drives on
GENTLY = 1.5  # m/s^2, before bends
BESIDE_ME = 4.0  # m/s^2, against somebody who moves in beside
HORIZON = 150.0  # m
LINE = 1.0  # m, between the front of a waiting vehicle and the line
PEAK, WIDE = 6.3, 4.0  # m/s^2 sideways for each m at 1 s, also if it brakes meanwhile; m from lane to lane
LONGER = 1.02  # by which a change under way lasts longer after a step at most, so that nobody turns at once
LEAST_WAY = 15.0  # m, of way that a change takes at least
FASTER = 2.0  # m/s, by which one may become faster during a change that has to be done before a junction
EVERY = 10  # steps, after which a vehicle considers a change again
SLOWEST_CHANGE = 3.0  # m/s, below which nobody changes lanes without need
GAIN = 0.4  # m/s^2, by which a change has to pay
SAFE = 2.0  # m/s^2, that a change may cost the follower
URGENT = 4.0  # m/s^2, the same where the lane ends
MARGIN = 1.0  # s, between leaving a conflict and the arrival of somebody with priority
PATIENCE = 30.0  # s
TURN = 2.0  # s, after which the first of several waiting vehicles goes
SPRINT = 4.0  # m/s^2, with which the tested car may speed up before it comes
AGAINST_MUST = 6.0  # m/s^2: a tested car that would have to brake harder before a line counts as beyond it
SOON = 4.0  # s, before which a tested car with priority has its way reserved
STANDING = 0.3  # m/s
ALONG = 0.7  # cosine of the angle to the tested car, above which a vehicle hits it from behind
AFTER_CONTACT = 6.0  # m/s^2, with which a vehicle stops that the tested car has touched
LET_IN = 10.0  # s, that somebody stands at the end of a lane before one vehicle lets it in
ASKS = -1e9  # stands for the speed of an entry of somebody who asks to be let in
GREEN, YELLOW, RED = 0, 1, 2


class Crowd(NamedTuple):
    """Everybody on the road, as arrays that are changed in place."""

    lanes: LaneMap
    numbers: FloatArray
    """A row of numbers for each vehicle; row TESTED is the tested car."""
    whole: IntArray
    """A row of whole numbers for each vehicle."""
    ways: IntArray
    """The lanes of each vehicle's way."""
    states: FloatArray
    """Where the vehicles are, ``(vehicles, 5)``."""
    entries: FloatArray
    """Room for the boxes in lanes: lane, first and last station, speed along it, and whose."""
    lights: IntArray
    """GREEN, YELLOW or RED for each lane."""


@compiled
def idm(
    v: float, wanted: float, gap: float, leader: float, pull: float, brake: float, headway: float
) -> float:
    """Returns the acceleration in m/s^2 behind a leader ``gap`` metres ahead at speed ``leader``; the gap
    may be infinite."""
    if v <= wanted:
        free = pull * (1.0 - (v / max(wanted, 0.1)) ** 4)
    else:
        free = -brake * (1.0 - (max(wanted, 0.0) / v) ** (4.0 * pull / brake))
    if gap == math.inf:
        return free
    desired = JAM + max(0.0, v * headway + v * (v - leader) / (2.0 * math.sqrt(pull * brake)))
    return free - pull * (desired / max(gap, 0.1)) ** 2


@compiled
def closing(
    v: float, wanted: float, gap: float, leader: float, pull: float, brake: float, headway: float
) -> float:
    """Returns the acceleration in m/s^2 behind a leader by the improved IDM: one follows as far as one wants
    also when nearly as fast as one wants."""
    free = idm(v, wanted, math.inf, leader, pull, brake, headway)
    desired = JAM + max(0.0, v * headway + v * (v - leader) / (2.0 * math.sqrt(pull * brake)))
    z = desired / max(gap, 0.1)
    if z >= 1.0:
        return min(free, 0.0) + pull * (1.0 - z * z)
    return free * (1.0 - z ** (2.0 * pull / free)) if free > 1e-3 else free


@compiled
def hold(crowd: Crowd, i: int) -> None:
    """Writes what friction and grade allow a vehicle at its place."""
    lanes, row, v = crowd.lanes, crowd.numbers[i], crowd.numbers[i, V]
    lane = crowd.ways[i, crowd.whole[i, AT]]
    last = lanes.first[lane + 1] - lanes.first[lane] - 1
    sample = lanes.sample[lanes.first[lane] + min(max(int(row[S] / lanes.step[lane] + 0.5), 0), last)]
    circle, falls = sample[PG], sample[PF]
    taken = min(ACROSS, CALM * circle) * (v / sample[PV]) ** 2
    spare = max(SIDEWAYS * circle - taken, LEAST_GRIP)
    lasts = max(row[CHANGES], math.sqrt(PEAK * WIDE / spare))
    row[LASTS] = lasts if row[PROGRESS] >= 1.0 else min(max(lasts, row[LASTS]), LONGER * row[LASTS])
    if row[PROGRESS] < 1.0:
        taken += PEAK * abs(row[BEGAN]) * (v / max(v * row[LASTS], LEAST_WAY)) ** 2
    left = math.sqrt(max(circle * circle - taken * taken, 0.0))
    row[GRIP] = min(HARDEST, max(left + falls, LEAST_GRIP))
    row[PULL] = min(row[PULLS], max(SLOWING * left - falls, LEAST_GRIP))
    row[BRAKE] = min(row[BRAKES], SLOWING * row[GRIP])


@inlined
def _easy(row: FloatArray) -> float:
    """Returns the m/s^2 with which a vehicle plans to stop."""
    return float(max(min(EASY, row[BRAKE]), LEAST_GRIP))


@inlined
def _stoppable(v: float, gap: float, leader: float, hardest: float) -> float:
    """Returns the highest speed after a step from which one stops behind a leader that brakes as hard."""
    room = max(gap - 0.5, 0.0) + max(leader, 0.0) ** 2 / (2.0 * hardest)
    reach = hardest * STEP / 2.0
    return -reach + math.sqrt(reach * reach + 2.0 * hardest * max(room - v * STEP / 2.0, 0.0))


@inlined
def _seen(row: FloatArray, entry: FloatArray, ahead: float, v: float, wanted: float) -> tuple[float, float]:
    """Returns the acceleration that an entry allows whose lane begins ``ahead`` metres before the vehicle's
    middle, and the highest next speed; both are infinite for entries behind the vehicle."""
    low, high = ahead + entry[1], ahead + entry[2]
    if low + high <= 0.0 or low > HORIZON:
        return math.inf, math.inf
    gap = low - row[LENGTH] / 2.0
    if entry[3] == ASKS:
        if gap < v * v / (2.0 * _easy(row)) + JAM:
            return math.inf, math.inf
        return closing(v, wanted, gap, 0.0, row[PULL], row[BRAKE], row[HEADWAY]), math.inf
    if gap <= 0.0:
        return -BESIDE_ME, math.inf
    return (
        closing(v, wanted, gap, entry[3], row[PULL], row[BRAKE], row[HEADWAY]),
        _stoppable(v, gap, entry[3], row[GRIP]),
    )


@compiled
def _leaders(
    crowd: Crowd, i: int, wanted: float, count: int, lane: int, offset: float
) -> tuple[float, float]:
    """Returns the smallest acceleration and next speed that anybody ahead of vehicle ``i`` allows, in the
    lanes of its way, or, with ``lane`` >= 0, in this lane, which begins ``offset`` metres before the
    vehicle's middle."""
    numbers, whole, entries = crowd.numbers, crowd.whole, crowd.entries
    row, v = numbers[i], numbers[i, V]
    least, most = math.inf, math.inf
    k, ahead = whole[i, AT], -row[S]
    if lane >= 0:
        ahead = offset
    while ahead < HORIZON and (lane >= 0 or k < whole[i, LAST]):
        here = lane if lane >= 0 else crowd.ways[i, k]
        for n in range(count):
            if entries[n, 0] == here and entries[n, 4] != i:
                a, fastest = _seen(row, entries[n], ahead, v, wanted)
                least, most = min(least, a), min(most, fastest)
        if lane >= 0:
            break
        ahead += crowd.lanes.length[here]
        k += 1
    return least, most


@inlined
def _wanted(lanes: LaneMap, row: FloatArray, lane: int) -> float:
    return float(min(lanes.limit[lane] * row[FACTOR], row[TOP]))


@compiled
def bends(crowd: Crowd, i: int) -> tuple[float, float]:
    """Returns the speed that a vehicle wants by the bends and speed limits ahead, and the greatest at which
    the friction circle lets it through the bends."""
    lanes, whole, ways = crowd.lanes, crowd.whole, crowd.ways
    row = crowd.numbers[i]
    fastest, most = _wanted(lanes, row, ways[i, whole[i, AT]]), math.inf
    slowing = min(GENTLY, row[BRAKE])
    far = row[V] * row[V] / (2.0 * slowing) + 10.0
    k, s, ahead = whole[i, AT], row[S], 0.0
    while ahead < far and k < whole[i, LAST]:
        lane = ways[i, k]
        own = _wanted(lanes, row, lane)
        while s <= lanes.length[lane] and ahead < far:
            n = lanes.first[lane] + min(
                int(s / lanes.step[lane] + 0.5), lanes.first[lane + 1] - lanes.first[lane] - 1
            )
            bend, circle = lanes.sample[n, PV], lanes.sample[n, PG]
            allowed = min(bend * row[FACTOR], own)
            fastest = min(fastest, math.sqrt(allowed * allowed + 2.0 * slowing * ahead))
            square = bend * bend * SIDEWAYS * circle / min(ACROSS, CALM * circle)
            most = min(most, math.sqrt(square + 2.0 * SLOWING * row[GRIP] * ahead))
            s += 2.0
            ahead += 2.0
        s -= lanes.length[lane]
        k += 1
    return fastest, most


@compiled
def _next_way(crowd: Crowd, i: int) -> tuple[int, float, int]:
    """Returns which lane of its way is the next through a junction, the metres from the vehicle's middle to
    its start, and the lane before it; -1 where there is none within HORIZON."""
    lanes, whole = crowd.lanes, crowd.whole
    k, ahead = whole[i, AT], -crowd.numbers[i, S]
    before = -1
    while k < whole[i, LAST] and ahead < HORIZON:
        lane = crowd.ways[i, k]
        if lanes.junction[lane] >= 0 and k > whole[i, GRANTED]:
            return k, ahead, before
        ahead += lanes.length[lane]
        before = lane
        k += 1
    return -1, math.inf, -1


@compiled
def _holds(crowd: Crowd, j: int, lane: int, until: float) -> bool:
    """Returns whether a vehicle has, or had, a grant for a lane, and its rear has not yet passed station
    ``until`` of it."""
    lanes, numbers, whole, ways = crowd.lanes, crowd.numbers, crowd.whole, crowd.ways
    begin, ahead = max(whole[j, AT] - 3, 0), -numbers[j, S]
    for q in range(begin, whole[j, AT]):
        ahead -= lanes.length[ways[j, q]]
    for q in range(begin, max(whole[j, GRANTED] + 1, whole[j, AT])):
        if ways[j, q] == lane and -ahead - numbers[j, LENGTH] / 2.0 < until:
            return True
        ahead += lanes.length[ways[j, q]]
    return False


@compiled
def time_over(v: float, way: float, top: float, pull: float) -> float:
    """Returns the seconds that a vehicle needs for some metres when it accelerates up to a speed."""
    if v >= top:
        return way / max(v, 0.1)
    rise = (top - v) / pull
    if (v + top) / 2.0 * rise >= way:
        return (-v + math.sqrt(v * v + 2.0 * pull * way)) / pull
    return rise + (way - (v + top) / 2.0 * rise) / top


@inlined
def is_awaited(v: float, spare: float, arrives: float, leaves: float, waited: float, turn: float) -> bool:
    """Returns whether one that gives way waits for another, which would arrive where their ways meet before
    it leaves that place, both in seconds: not for who stands once it has waited for ``turn`` seconds, nor
    after PATIENCE seconds for who can stop with ``spare`` metres left before its line."""
    has_waited = (waited > PATIENCE and spare > 0.0) or (v < STANDING and waited > turn)
    return not has_waited and arrives < leaves


@compiled
def _comes_before(crowd: Crowd, i: int, j: int, other: int, first: float, leaves: float) -> bool:
    """Returns whether vehicle ``i`` has to wait for ``j``, to whom it gives way: ``j`` comes to station
    ``first`` of lane ``other`` before ``i`` has left that place, in ``leaves`` seconds."""
    numbers = crowd.numbers
    q, away, before = _next_way(crowd, j)
    if q < 0 or crowd.ways[j, q] != other or (before >= 0 and crowd.lights[before] == RED):
        return False
    line, v, waits = away - numbers[j, LENGTH] / 2.0, numbers[j, V], numbers[i, WAIT]
    if j == TESTED:
        sprint = min(SPRINT, numbers[j, GRIP])
        arrives = time_over(v, line + first, crowd.lanes.limit[other], sprint)
        # so that not both begin to move at once; if it has waited longer, it was asked before, and cannot go
        return is_awaited(v, -math.inf, arrives, leaves + MARGIN, waits, 2.0 * TURN)
    spare = line - v * v / (2.0 * _easy(numbers[j])) - 5.0 if before >= 0 else math.inf
    return is_awaited(v, spare, (line + first) / max(v, 3.0), leaves + MARGIN, waits, TURN)


@compiled
def _has_room(crowd: Crowd, i: int, k: int, ahead: float, count: int) -> bool:
    """Returns whether a vehicle finds room behind lane ``k`` of its way, so that it does not stand in the
    junction: also if all who are there, or have a grant to come there, queue before the next junction;
    and also for who has waited longer, and too long."""
    lanes, numbers, whole, ways, entries = crowd.lanes, crowd.numbers, crowd.whole, crowd.ways, crowd.entries
    needed, far = numbers[i, LENGTH] + JAM, 0.0
    there = ways[i, min(k + 1, whole[i, LAST] - 1)]
    if lanes.onward_of[there] < lanes.onward_of[there + 1]:
        queue = 0.0
        for j in range(len(numbers)):
            if j != i and whole[j, STATE] != ABSENT:
                last = max(whole[j, AT], whole[j, GRANTED] + 1)
                if numbers[j, WAIT] > max(numbers[i, WAIT], PATIENCE):  # else cars leave no room for a bus
                    last = max(last, whole[j, AT] + 2)
                for q in range(whole[j, AT], min(last, whole[j, LAST] - 1) + 1):
                    if ways[j, q] == there:
                        queue += numbers[j, LENGTH] + JAM
        if queue > 0.0 and queue + needed > lanes.stop[there]:
            return False
    for q in range(k + 1, min(k + 3, whole[i, LAST])):
        for n in range(count):
            is_slow = entries[n, 0] == ways[i, q] and entries[n, 4] != i and entries[n, 3] < 3.0
            if is_slow and far + entries[n, 1] <= needed:
                return bool(ahead + lanes.length[ways[i, k]] < 0.0)
        far += lanes.length[ways[i, q]]
        if far > needed:
            break
    return True


@compiled
def _may_enter(crowd: Crowd, i: int, k: int, ahead: float, is_over: bool, count: int) -> bool:
    """Returns whether vehicle ``i`` may enter lane ``k`` of its way, which begins ``ahead`` metres before
    its middle. ``is_over`` is whether it stands beyond the line, and only waits for those with a grant."""
    lanes, numbers, whole, ways, entries = crowd.lanes, crowd.numbers, crowd.whole, crowd.ways, crowd.entries
    lane, row = ways[i, k], numbers[i]
    begin, end = lanes.conflict_of[lane], lanes.conflict_of[lane + 1]
    bends = lanes.sample[lanes.first[lane] : lanes.first[lane + 1], PV]
    slowest = max(min(lanes.limit[lane], bends.min()), 2.0)
    for c in range(begin, end):
        other, first, last = lanes.conflict[c, 0], lanes.conflict_at[c, 2], lanes.conflict_at[c, 3]
        for n in range(0 if is_over else count):  # also somebody without a grant, such as a pedestrian
            is_there = entries[n, 0] == other and entries[n, 4] != i
            is_there = is_there and entries[n, 1] < last and entries[n, 2] > first
            if is_there:
                its = entries[:count][entries[:count, 4] == entries[n, 4], 0]
                if k + 1 >= whole[i, LAST] or not (its == ways[i, k + 1]).any():
                    return False  # but who leads, with its rear still there, is followed
        until = max(ahead, 0.0) + lanes.conflict_at[c, 1] + row[LENGTH] / 2.0
        leaves = time_over(row[V], until, slowest, row[PULL])
        for j in range(len(numbers)):
            if j == i or whole[j, STATE] != DRIVES:
                continue
            if _holds(crowd, j, other, last):
                return False
            if is_over or lanes.conflict[c, 1] < (0 if j == TESTED else 1):  # it goes first among equals
                continue
            if _comes_before(crowd, i, j, other, first, leaves):
                return False
    if begin == end or lanes.leaves_ring[lane]:  # in a ring everybody moves up, or it would stand for ever
        return True
    if _has_room(crowd, i, k, ahead, count):
        return True
    if row[WAIT] > PATIENCE:  # it looks for another way, or a circle of full roads would stand for ever
        whole[i, LAST] = k
    return False


@compiled
def _is_first(crowd: Crowd, i: int, k: int, count: int) -> bool:
    """Returns whether nobody without a grant is between vehicle ``i`` and lane ``k`` of its way."""
    numbers, whole, ways, entries = crowd.numbers, crowd.whole, crowd.ways, crowd.entries
    ahead = -numbers[i, S]
    for q in range(whole[i, AT], k):
        lane = ways[i, q]
        for j in range(len(numbers)):
            if j == i or whole[j, STATE] == ABSENT or ways[j, whole[j, AT]] != lane:
                continue
            if ahead + numbers[j, S] > 0.0 and whole[j, GRANTED] <= whole[j, AT]:
                return False
        for n in range(count):
            if entries[n, 0] == lane and entries[n, 4] < 0.0 and ahead + entries[n, 1] > 0.0:
                return False
        ahead += crowd.lanes.length[lane]
    return True


@compiled
def _to_stop(crowd: Crowd, i: int, count: int) -> float:
    """Gives a vehicle a grant for the junction ahead if it may enter, and returns the metres from its front
    to the place where it has to stop otherwise; infinite if there is none."""
    lanes, whole, ways, lights = crowd.lanes, crowd.whole, crowd.ways, crowd.lights
    k, ahead, before = _next_way(crowd, i)
    if k < 0:
        return math.inf
    row = crowd.numbers[i]
    line = ahead - row[LENGTH] / 2.0
    if before >= 0:
        line -= lanes.length[before] - lanes.stop[before]
    if line > max(15.0, row[V] ** 2 / (2.0 * _easy(row)) + row[V] + 5.0):
        return math.inf
    if before < 0:  # it stands in the junction already
        whole[i, GRANTED] = k
        return math.inf
    if line < 5.0 and row[V] < STANDING:
        row[WAIT] += STEP
        whole[i, HAS_STOPPED] = 1
    is_late = row[V] > 0.5 and line < row[V] ** 2 / (2.0 * min(FIRM, row[GRIP]))
    closed = lights[before] == RED or (lights[before] == YELLOW and not is_late)
    is_over = line < -LINE
    if not is_over and (closed or (lanes.has_stop_sign[before] and whole[i, HAS_STOPPED] == 0)):
        return float(line)
    is_changing = row[PROGRESS] < 1.0  # it might wait for the lane that it leaves, and others for its grant
    if is_changing or not (_is_first(crowd, i, k, count) and _may_enter(crowd, i, k, ahead, is_over, count)):
        return float(line)
    through = lanes.junction[ways[i, k]]
    while k < whole[i, LAST] and lanes.junction[ways[i, k]] == through:
        whole[i, GRANTED] = k
        k += 1
    row[WAIT] = 0.0
    whole[i, HAS_STOPPED] = 0
    return math.inf


@compiled
def _change(crowd: Crowd, i: int, side: int, own: float, wanted: float, count: int, must: bool) -> float:
    """Returns by how much the acceleration of a vehicle rises if it changes to the lane on one side (0:
    left, 1: right); minus infinity if it cannot or may not."""
    lanes = crowd.lanes
    lane, row = crowd.ways[i, crowd.whole[i, AT]], crowd.numbers[i]
    target = lanes.beside[lane, side]
    if target < 0 or (lanes.ends[target] and not must):
        return -math.inf
    s = across(lanes, lane, row[S], target)
    way = max((row[V] + FASTER) * row[LASTS], LEAST_WAY)
    end = min(lanes.usable[target, 1], lanes.stop[target] - LINE - row[LENGTH] / 2.0)
    if s < lanes.usable[target, 0] + row[LENGTH] or (not must and s + way > end):
        return -math.inf
    limit = min(URGENT if must else SAFE, SLOWING * row[GRIP])
    best = idm(row[V], wanted, math.inf, 0.0, row[PULL], row[BRAKE], row[HEADWAY])
    for n in range(count):
        entry = crowd.entries[n]
        back, offset = False, 0.0
        if entry[4] == i or entry[3] == ASKS:
            continue
        if entry[0] != target:
            before = int(entry[0])
            for at in range(lanes.onward_of[before], lanes.onward_of[before + 1]):
                back = back or lanes.onward[at] == target
            if not back:
                continue
            offset = -lanes.length[before]
        low, high = entry[1] + offset - s, entry[2] + offset - s
        if low + high > 0.0 and not back:
            gap = low - row[LENGTH] / 2.0
            if gap < 1.0 or entry[3] < -1.0:
                return -math.inf
            best = min(best, closing(row[V], wanted, gap, entry[3], row[PULL], row[BRAKE], row[HEADWAY]))
        else:
            gap = -row[LENGTH] / 2.0 - high
            v = max(entry[3], 0.0)
            if gap < 1.0 or idm(v, max(v, 1.0), gap, row[V], 1.5, 2.0, 1.0) < -limit:
                return -math.inf
    return best - own if best > -limit else -math.inf


@compiled
def _locate(crowd: Crowd) -> None:
    """Writes the states of the vehicles that are there, and NaN for the others."""
    numbers, whole, out = crowd.numbers, crowd.whole, crowd.states
    for i in range(len(numbers)):
        before = out[i, 3]
        out[i] = math.nan
        if i == TESTED or whole[i, STATE] == ABSENT:
            continue
        row = numbers[i]
        lane = crowd.ways[i, whole[i, AT]]
        x, y, z, heading, _ = place_on(crowd.lanes, lane, row[S])
        aside = row[ASIDE]
        slant = 0.0
        if row[PROGRESS] < 1.0:
            p = row[PROGRESS]
            slope = -row[BEGAN] * 30.0 * p * p * (1.0 - p) * (1.0 - p)
            slant = math.atan(slope / max(row[V] * row[LASTS], LEAST_WAY))
        out[i, 0] = x - aside * math.sin(heading)
        out[i, 1] = y + aside * math.cos(heading)
        out[i, 2] = z
        out[i, 3] = heading + slant
        if not math.isnan(before):  # so that it is unwrapped from moment to moment
            out[i, 3] += 2.0 * math.pi * round((before - out[i, 3]) / (2.0 * math.pi))
        out[i, 4] = row[V]


@inlined
def _add(entries: FloatArray, count: int, lane: int, s: float, length: float, speed: float, body: int) -> int:
    """Adds a row for a box whose middle is at a station of a lane; returns the number of rows then."""
    if count < len(entries):
        entries[count, 0], entries[count, 3], entries[count, 4] = lane, speed, body
        entries[count, 1], entries[count, 2] = s - length / 2.0, s + length / 2.0
        count += 1
    return count


@compiled
def _boxes(crowd: Crowd, bodies: FloatArray) -> int:
    """Writes which lanes everybody is in into ``entries``; returns the number of rows. Who changes lanes is
    in the new one from the first moment, and who asks to be let in stands for those behind it in the lane
    that it wants."""
    lanes, numbers, whole, entries = crowd.lanes, crowd.numbers, crowd.whole, crowd.entries
    count = 0
    for i in range(len(numbers)):
        if whole[i, STATE] == ABSENT:
            continue
        begin, state, row = count, crowd.states[i], numbers[i]
        count = touched(
            lanes, state[0], state[1], state[3], row[LENGTH], row[WIDTH], row[V], float(i), entries, count
        )
        if i == TESTED:
            continue
        lane, is_there = crowd.ways[i, whole[i, AT]], row[PROGRESS] >= 1.0
        for n in range(begin, count):
            is_there = is_there or entries[n, 0] == lane
        if not is_there:
            count = _add(entries, count, lane, row[S], row[LENGTH], row[V], i)
        if row[WAIT] > LET_IN and lanes.ends[lane]:
            target = max(lanes.beside[lane, 0], lanes.beside[lane, 1])
            if target >= 0:
                s = across(lanes, lane, row[S], target)
                count = _add(entries, count, target, s, row[LENGTH], ASKS, i)
    for m in range(len(bodies)):
        body = bodies[m]
        count = touched(lanes, body[0], body[1], body[3], body[5], body[6], body[4], -1.0 - m, entries, count)
    return count


@compiled
def _begin_change(crowd: Crowd, i: int, target: int) -> None:
    """Makes a vehicle change to a lane beside its own, from where on its way has to be planned anew."""
    lanes, whole, ways = crowd.lanes, crowd.whole, crowd.ways
    row, state, lane = crowd.numbers[i], crowd.states[i], ways[i, whole[i, AT]]
    s = across(lanes, lane, row[S], target)
    x, y, _, heading, _ = place_on(lanes, target, s)
    s += (state[0] - x) * math.cos(heading) + (state[1] - y) * math.sin(heading)
    x, y, _, heading, _ = place_on(lanes, target, s)
    row[ASIDE] = (state[1] - y) * math.cos(heading) - (state[0] - x) * math.sin(heading)
    row[BEGAN], row[PROGRESS], row[S], row[WAIT] = row[ASIDE], 0.0, s, 0.0
    whole[i, OLD], whole[i, LAST] = lane, whole[i, AT] + 1
    ways[i, whole[i, AT]] = target


@compiled
def _decide(crowd: Crowd, i: int, count: int, may_change: bool) -> int:
    """Decides the acceleration of a vehicle, and whether it begins to change lanes; returns the number of
    rows of ``entries``, to which its box in the new lane is added."""
    lanes, numbers, whole = crowd.lanes, crowd.numbers, crowd.whole
    row, v = numbers[i], numbers[i, V]
    lane = crowd.ways[i, whole[i, AT]]
    wanted, most = bends(crowd, i)
    pull, brake, headway = row[PULL], row[BRAKE], row[HEADWAY]
    least = idm(v, wanted, math.inf, 0.0, pull, brake, headway)
    a, fastest = _leaders(crowd, i, wanted, count, -1, 0.0)
    least, fastest = min(least, a), min(fastest, most)
    if whole[i, OLD] >= 0:
        old = whole[i, OLD]
        offset = -across(lanes, lane, row[S], old)
        a, also = _leaders(crowd, i, wanted, count, old, offset)
        least, fastest = min(least, a), min(fastest, also)
    alone = least
    line = _to_stop(crowd, i, count)
    if line < math.inf:
        least = min(least, closing(v, wanted, max(line + JAM - LINE, 0.1), 0.0, pull, brake, headway))
        if line > 0.0:
            fastest = min(fastest, _stoppable(v, line + 0.5, 0.0, row[GRIP]))
    ends = lanes.ends[lane]
    if ends:
        left = lanes.usable[lane, 1] - row[S] - row[LENGTH] / 2.0
        least = min(least, closing(v, wanted, max(left, 0.1), 0.0, pull, brake, headway))
        fastest = min(fastest, _stoppable(v, max(left, 0.0) + 0.5, 0.0, row[GRIP]))
        row[WAIT] += STEP * (v < STANDING)
    if may_change and row[PROGRESS] >= 1.0 and lanes.junction[lane] < 0 and (v > SLOWEST_CHANGE or ends):
        best, side = (-math.inf, -1) if ends else (GAIN, -1)
        for each in range(2):
            gain = _change(crowd, i, each, alone, wanted, count, ends)
            if gain > best:
                best, side = gain, each
        if side >= 0:
            target = lanes.beside[lane, side]
            _begin_change(crowd, i, target)
            count = _add(crowd.entries, count, target, row[S], row[LENGTH], v, i)
    wants = min(max(-least, (v - fastest) / STEP), HARDEST)
    if wants > row[GRIP] + SPARE:
        row[DENIED] = max(row[DENIED], wants)
    after = min(v + max(least, -row[GRIP]) * STEP, max(fastest, v - row[GRIP] * STEP))
    row[A_NEXT] = (max(after, 0.0) - v) / STEP
    return count


@compiled
def _move(lanes: LaneMap, row: FloatArray, whole: IntArray, way: IntArray) -> None:
    """Moves one vehicle by STEP with its decided acceleration, along its lanes and sideways."""
    v, a = row[V], row[A_NEXT]
    after = max(v + a * STEP, 0.0)
    driven = (v + after) / 2.0 * STEP if v + a * STEP >= 0.0 else v * v / (-2.0 * a)
    row[V] = after
    row[S] += driven
    if row[PROGRESS] < 1.0:
        p = min(row[PROGRESS] + driven / max(row[LASTS] * after, LEAST_WAY), 1.0)
        row[PROGRESS], row[ASIDE] = p, row[BEGAN] * (1.0 - p * p * p * (10.0 - 15.0 * p + 6.0 * p * p))
        if p >= 1.0:
            whole[OLD] = -1
    while row[S] > lanes.length[way[whole[AT]]]:
        if whole[AT] + 1 >= whole[LAST]:
            whole[STATE] = ABSENT
            break
        row[S] -= lanes.length[way[whole[AT]]]
        whole[AT] += 1
        whole[OLD] = -1


@compiled
def step(crowd: Crowd, bodies: FloatArray, room: FloatArray, tick: int) -> None:
    """Moves everybody by STEP.

    Args:
        crowd: Everybody; the state of the tested car is its present one.
        bodies: Others whom this step does not move: states, length and width, ``(m, 7)``.
        room: Gets the metres at the start of each lane that are free, and the speed of who is there.
        tick: The number of the step."""
    numbers, whole, states, entries = crowd.numbers, crowd.whole, crowd.states, crowd.entries
    count = _boxes(crowd, bodies)
    for i in range(len(numbers)):
        if whole[i, STATE] != ABSENT:
            hold(crowd, i)
    if whole[TESTED, STATE] == DRIVES:
        _reserve(crowd, count)
    order = np.argsort(-numbers[:, WAIT], kind="mergesort")
    for at in range(len(numbers)):
        i = order[at]
        if i == TESTED or whole[i, STATE] == ABSENT:
            continue
        if whole[TESTED, STATE] == DRIVES:
            one, other, size, its = states[i], states[TESTED], numbers[i], numbers[TESTED]
            dx, dy = other[0] - one[0], other[1] - one[1]
            if touch(dx, dy, one[3], size[LENGTH], size[WIDTH], other[3], its[LENGTH], its[WIDTH]):
                whole[i, STATE] = STANDS_HIT
                is_behind = dx * math.cos(one[3]) + dy * math.sin(one[3]) > size[LENGTH] / 2.0
                if is_behind and math.cos(other[3] - one[3]) > ALONG:  # it does not drive through the car
                    size[V] = min(size[V], max(its[V], 0.0))
        if whole[i, STATE] == STANDS_HIT:
            numbers[i, A_NEXT] = max(-min(AFTER_CONTACT, numbers[i, GRIP]), -numbers[i, V] / STEP)
        else:
            count = _decide(crowd, i, count, (tick + i) % EVERY == 0)
    room[:] = math.inf
    for n in range(count):
        lane = int(entries[n, 0])
        if entries[n, 1] < room[lane, 0]:
            room[lane, 0], room[lane, 1] = entries[n, 1], max(entries[n, 3], 0.0)
    for i in range(len(numbers)):
        if i != TESTED and whole[i, STATE] != ABSENT:
            _move(crowd.lanes, numbers[i], whole[i], crowd.ways[i])
    _locate(crowd)


@compiled
def _reserve(crowd: Crowd, count: int) -> None:
    """Gives the tested car the grants for the ways through junctions that it cannot or need not stop before,
    or when it has waited for its turn, or for too long; where it stands then, it gives them back."""
    lanes, numbers, whole, ways = crowd.lanes, crowd.numbers, crowd.whole, crowd.ways
    row, here = numbers[TESTED], whole[TESTED, AT]
    if whole[TESTED, GRANTED] > here and row[V] < STANDING:
        row[WAIT] += STEP
        whole[TESTED, GRANTED] = here if row[WAIT] >= 0.0 else whole[TESTED, GRANTED]
    k, ahead, before = _next_way(crowd, TESTED)
    if k < 0:
        return
    line = ahead - row[LENGTH] / 2.0
    meets = lanes.conflict[lanes.conflict_of[ways[TESTED, k]] : lanes.conflict_of[ways[TESTED, k] + 1]]
    has_priority = (meets[:, 1] < 1).all()
    top = lanes.limit[ways[TESTED, here]]
    soon = has_priority and row[V] > STANDING and time_over(row[V], max(line, 0.0), top, SPRINT) < SOON
    waits = row[V] < STANDING and line < lanes.length[before] - lanes.stop[before] + 5.0
    row[WAIT] = max(row[WAIT], 0.0) + STEP * (waits and crowd.lights[before] == GREEN)
    must = before < 0 or line < 0.0 or line < row[V] ** 2 / (2.0 * min(AGAINST_MUST, row[GRIP]))
    goes = must or soon or row[WAIT] > PATIENCE
    if not goes and (row[WAIT] <= TURN or not _may_enter(crowd, TESTED, k, ahead, False, count)):
        return
    whole[TESTED, GRANTED], row[WAIT] = k, -PATIENCE if goes else -2.0 * TURN
    for j in range(len(numbers)):  # who is not there yet gives its grant back, if it stops without effort
        at, its = whole[j, AT], numbers[j]
        stops = its[S] + its[LENGTH] / 2.0 + its[V] ** 2 / (2.0 * _easy(its))
        is_ahead = at < whole[j, GRANTED] and (meets[:, 0] == ways[j, at + 1]).any()
        if is_ahead and stops < lanes.length[ways[j, at]]:
            whole[j, GRANTED] = at
