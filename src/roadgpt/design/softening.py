"""What grades may be moved to, so that the parabolas between them suit the speed, and the moving."""

from collections.abc import Sequence
from itertools import pairwise
from math import inf

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.words import Range, overlap
from roadgpt.design.vertical import Pace, softened

LEAST_SLOPE = 1.8  # percent: the least slope of a climb or fall that is to be seen as one
MOST_SHIFT = 40.0  # percentage points
BISECTIONS = 50
HELD = 0.5  # percentage points that a grade that was asked for over some metres may be softened by


def steep_kept(values: np.ndarray, lengths: np.ndarray, limits: Sequence[Range], least: float) -> list[Range]:
    """Returns the limits, of which the longest element that is as steep as required must stay so."""
    out = [*limits]
    steep = [i for i in sorted(range(len(out)), key=lambda i: -lengths[i]) if abs(values[i]) >= least]
    if steep:
        i = steep[0]
        room = Range(least) if values[i] > 0 else Range(-inf, -least)
        out[i] = overlap(out[i], room) or out[i]
    return out


def held(element: Element, value: float, room: Range) -> Range:
    """Returns the limit of a straight of required length and grade: what was drawn, or hardly less."""
    if element.required_grade is None or not element.has_fixed_length or 0 in element.required_grade:
        return room
    return overlap(room, Range(value - HELD, value + HELD)) or room


def one_way(value: float, room: Range) -> Range:
    """Returns the limit of an element that must go on climbing, or falling."""
    if np.isnan(value) or abs(value) < LEAST_SLOPE:
        return room
    return overlap(room, Range(LEAST_SLOPE) if value > 0 else Range(-inf, -LEAST_SLOPE)) or room


def softened_values(
    values: np.ndarray, lengths: np.ndarray, limits: Sequence[Range], pace: Pace, ease: float, bumps: bool
) -> np.ndarray:
    """Returns grades whose changes leave room for parabolas; its neighbours share a joining straight."""
    known = np.flatnonzero(~np.isnan(values))
    if len(known) < 2 or np.ptp(values[known]) == 0:
        return values
    ends = np.cumsum(lengths)
    begins = ends - lengths
    joints = [float(ends[a] + begins[b]) / 2 for a, b in pairwise(known)]
    own = np.diff([0.0, *joints, float(ends[-1])])
    radii = [pace.eased(s, ease, bumps) for s in joints]
    out = values.copy()
    rooms = [limits[int(i)] for i in known]
    out[known] = softened(
        values[known].tolist(), own.tolist(), radii, [r.lo for r in rooms], [r.hi for r in rooms]
    )
    return out


def climbing(grades: np.ndarray, lengths: np.ndarray, limits: Sequence[Range], metres: float) -> np.ndarray:
    """Returns grades shifted alike, each as far as its limits allow, until the total climb is ``metres``."""
    least, most = np.array([r.lo for r in limits]), np.array([r.hi for r in limits])
    down, up = -MOST_SHIFT, MOST_SHIFT
    for _ in range(BISECTIONS):
        middle = (down + up) / 2
        climbed = float(np.clip(grades + middle, least, most) @ lengths) / 100
        down, up = (middle, up) if climbed < metres else (down, middle)
    return np.asarray(np.clip(grades + down, least, most))
