"""Finds who is in the path of a car ahead of it, and how hard each of them makes it brake."""

import math

import numpy as np

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.boxes import part_inside
from roadgpt.traffic.actor import FloatArray
from roadgpt.traffic.following import BESIDE_ME, HORIZON, idm

HALF_WIDTH = 0.93  # m, of RoadGPT's saloon
SPARE = 0.2  # m, on either side of the car, except towards who comes towards it
ALONG = 0.7  # cosine of the angle to the path above which somebody drives along it, and does not cross it
MOVES_OVER = 1.0  # s, before which somebody beside the path who moves towards it counts as in it
WALKS = 3.0  # s, the same for persons, animals and things
CROSSES = 1.5  # s, the same for vehicles that come from the side
STOPS = 4.0  # m/s^2, with which a vehicle from the side may still stop before the path
CLEAR = 0.5  # s, between one who leaves a place and one who comes to it
PASSES = 5.0  # m, length of the car
STEP = 0.5  # m
X, Y, HEADING, SPEED, LENGTH, WIDTH, IS_VEHICLE = range(7)


@inlined
def _is_across(x: float, y: float, heading: float, half: float, other: FloatArray) -> bool:
    """Returns whether a box overlaps the line of ``half`` metres to both sides of a point of the path. Seen
    along the path, the box is longer by half a STEP at both ends."""
    turn = heading - other[HEADING]
    low, high = part_inside(
        x - other[X], y - other[Y], -math.sin(heading), math.cos(heading), other[HEADING],
        other[LENGTH] + STEP * abs(math.cos(turn)), other[WIDTH] + STEP * abs(math.sin(turn)), -half, half,
    )  # fmt: skip
    return low <= high


@compiled
def look_ahead(
    path: FloatArray, start: float, others: FloatArray, car: FloatArray, follows: FloatArray
) -> FloatArray:
    """Returns for each of the others the metres between the car's front and it along the path, its speed
    along the path, the acceleration in m/s^2 that it allows, and whether it is a vehicle. For who is not in
    the path, metres and acceleration are infinite.

    In the path is whose box overlaps the strip that the car covers there, within HORIZON metres; who will be
    there soon, seen by where and how fast they move now; and nobody who will have crossed it before the car
    comes.

    Args:
        path: x, y and heading of the middle of the path every STEP metres.
        start: the metres along the path at the car's centre of gravity.
        others: x, y, heading, speed, length and width of each, and 1.0 if it is a vehicle, shape (n, 7).
        car: x, y and heading of the car, its speed, and the metres from its centre of gravity to its front.
        follows: IDM's T, a and b."""
    out = np.empty((len(others), 4))
    v, front, first = car[SPEED], car[4], int(start / STEP)
    for k in range(len(others)):
        other = others[k]
        out[k] = math.inf, 0.0, math.inf, other[IS_VEHICLE]
        reach = math.hypot(other[LENGTH], other[WIDTH]) / 2.0 + HALF_WIDTH + SPARE + 1.0
        hit, near, nearest, j = -1, first, math.inf, first
        while j < len(path) and j * STEP < start + front + HORIZON:
            away = math.hypot(path[j, 0] - other[X], path[j, 1] - other[Y])
            if away < nearest:
                near, nearest = j, away
            if away > reach:
                j += max(int((away - reach) / STEP), 1)  # nothing before is within reach
                continue
            turn = other[HEADING] - path[j, 2]
            half = HALF_WIDTH + (SPARE if math.cos(turn) > -ALONG else 0.0)
            if _is_across(path[j, 0], path[j, 1], path[j, 2], half, other):
                hit = j
                break
            j += 1
        here = hit if hit >= 0 else near
        turn = other[HEADING] - path[here, 2]
        c, s = math.cos(path[here, 2]), math.sin(path[here, 2])
        dx, dy = other[X] - path[here, 0], other[Y] - path[here, 1]
        aside = dy * c - dx * s
        along, across = other[SPEED] * math.cos(turn), other[SPEED] * math.sin(turn)
        long = (other[LENGTH] * abs(math.cos(turn)) + other[WIDTH] * abs(math.sin(turn))) / 2.0
        wide = (other[LENGTH] * abs(math.sin(turn)) + other[WIDTH] * abs(math.cos(turn))) / 2.0
        half, crosses = HALF_WIDTH + SPARE, abs(math.cos(turn)) < ALONG
        if hit >= 0:
            gap = hit * STEP - start - front
            to_x, to_y = other[X] - car[X], other[Y] - car[Y]
            ahead = to_x * math.cos(car[HEADING]) + to_y * math.sin(car[HEADING])
            if gap <= 0.0 and ahead <= 0.0:
                continue  # it is beside the car or behind it
            leaves = half + wide - aside * (1.0 if across > 0.0 else -1.0)
            if crosses and leaves + CLEAR * abs(across) < abs(across) * gap / max(v, 0.1):
                continue
        else:
            gap = near * STEP + dx * c + dy * s - long - start - front
            closing = -across if aside > 0.0 else across
            left = abs(aside) - wide - half
            if gap <= 0.0 or gap > HORIZON or closing < 0.1:
                continue
            soon = (WALKS if other[IS_VEHICLE] == 0.0 else MOVES_OVER) * closing
            if crosses and other[IS_VEHICLE] != 0.0:
                soon = max(CROSSES * closing, closing * closing / (2.0 * STOPS))
            if left > soon:
                continue
            if crosses:
                is_past = v * left > closing * (gap + 2.0 * long + PASSES + CLEAR * v)
                has_left = v * (left + 2.0 * (wide + half) + CLEAR * closing) < closing * gap
                if is_past or has_left:
                    continue
        out[k, 0], out[k, 1] = gap, along
        if gap <= 0.0:
            out[k, 2] = -BESIDE_ME
        else:
            out[k, 2] = idm(v, math.inf, gap, along, follows[1], follows[2], follows[0])
    return out
