"""Finds the place on given land where a drafted road needs the least earthworks, and the grades for it.

Every place is a shift and a turn of the whole draft, whose turns and lengths therefore stay as they are. Many
places are compared by the land along the road, smoothed. At the best of them, a linear programme finds the
grades with the least area between road and land, within the limits on grades and their changes."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import linprog

from roadgpt.brief.model import Brief
from roadgpt.check import inspect
from roadgpt.errors import DesignError
from roadgpt.geometry.curve import Array
from roadgpt.ground.relief import Relief
from roadgpt.road import Design, World, build
from roadgpt.road.design import Segment

STEP = 5.0  # m between the stations at which road and land are compared
PIECE = 30.0  # m, longest part of a straight with one grade
TURNS, PLACES = 24, 18  # directions, and places along either side of the land
BEST = 6  # places for which grades are sought
MARGIN = 20.0  # m from the road to the border of the land
WINDOW = 50.0  # m over which the land is smoothed
RADIUS = 160.0  # m, least vertical radius: 2.4 m/s^2 at 70 km/h; the rule allows 3 m/s^2
FREE = 0.02  # ratio by which grades may differ from those of a draft whose heights are asked for
DEEPEST = 15.0  # m, of cuttings and fills; beyond that a road needs a tunnel or a bridge


def placed(design: Design, brief: Brief, world: World, relief: Relief) -> Design:
    """Returns a drafted road at its best place on the land. Raises DesignError if there is none."""
    segments = tuple(part for each in design.segments for part in _parts(each))
    plain = design.model_copy(update={"segments": segments, "starting_point": (0.0, 0.0, 0.0), "theta": 0.0})
    road = build(plain)
    s = np.linspace(0.0, road.length, max(2, round(road.length / STEP) + 1))
    best: tuple[float, str] = (np.inf, "there is no room for it")
    line = road.at(s)
    for is_alike, is_bound in ((False, False), (True, False), (True, True)):
        for x, y, theta in _places(line, relief, world.limits.max_grade, is_alike):
            land = relief.at(*_moved(line[:, :2], x, y, theta).T)
            found = _grades(segments, s, land, world.limits.max_grade, is_bound)
            if found is None:
                best = min(best, (np.inf, "its grades do not follow the land"))
                continue
            z, grades, deep = found
            if deep > DEEPEST:
                at = f"at ({x:.0f}, {y:.0f}) it would lie up to {deep:.0f} m above or below the land"
                best = min(best, (deep, at)) if is_bound else best
                continue
            made = plain.model_copy(update={
                "starting_point": (round(x, 2), round(y, 2), round(z, 2)),
                "theta": round(float(np.degrees(theta)), 2),
                "segments": tuple(
                    each.model_copy(update={"incline": round(100 * float(grade), 2) + 0.0})
                    for each, grade in zip(segments, grades, strict=True)
                ),
            })  # fmt: skip
            findings = inspect(world.lay(build(made)), brief, world, "strict")
            if not findings:
                return made
            best = min(best, (DEEPEST, findings[0].sentence)) if is_bound else best
    raise DesignError(f"the road has no place on this land: {best[1]}; ask for a shorter or a steeper road")


def _parts(segment: Segment) -> Iterator[Segment]:
    """Yields a straight in parts that may have grades of their own; a turn stays whole."""
    count = 1 if segment.turn_degrees else max(1, round(segment.distance / PIECE))
    for n in range(count):
        part = round(segment.distance / count, 3)
        last = segment.distance - part * (count - 1)
        more = {} if n == 0 else {"vertical_radius": None}
        yield segment.model_copy(update={"distance": last if n == count - 1 else part, **more})


def _moved(points: Array, x: float, y: float, theta: float) -> Array:
    c, n = np.cos(theta), np.sin(theta)
    return np.asarray(points @ np.array([[c, n], [-n, c]]) + [x, y])


def _places(line: Array, relief: Relief, steepest: float, is_alike: bool) -> list[tuple[float, float, float]]:
    """Returns where a road with a centre line ``(n, 3)`` may begin, and its heading there, the best places
    first: where the land is even along the road, or, if ``is_alike``, rises as the road does."""
    size, heights = np.array(relief.size), line[:, 2] - line[:, 2].mean()
    found: list[tuple[float, tuple[float, float, float]]] = []
    for theta in np.arange(TURNS) * 2 * np.pi / TURNS:
        turned = _moved(line[:, :2], 0.0, 0.0, theta)
        low, high = MARGIN - turned.min(axis=0), size - MARGIN - turned.max(axis=0)
        if (low > high).any():
            continue
        x, y = (each.ravel() for each in np.meshgrid(*(np.linspace(low[i], high[i], PLACES) for i in (0, 1))))
        along = turned[None] + np.column_stack([x, y])[:, None]
        land = relief.at(*along.reshape(-1, 2).T).reshape(along.shape[:2])
        if is_alike:
            score = np.abs(land - land.mean(axis=1, keepdims=True) - heights).mean(axis=1)
        else:
            level = uniform_filter1d(land, max(3, int(WINDOW / STEP)), axis=1, mode="nearest")
            excess = np.maximum(np.abs(np.diff(level, axis=1)) - steepest * STEP, 0.0)
            score = np.abs(land - level).mean(axis=1) + excess.sum(axis=1)
        found += [
            (float(score[k]), (float(x[k]), float(y[k]), float(theta))) for k in np.argsort(score)[:BEST]
        ]
    return [place for _, place in sorted(found)[:BEST]]


def _grades(
    segments: Sequence[Segment], s: Array, land: Array, steepest: float, is_bound: bool
) -> tuple[float, Array, float] | None:
    """Returns the height of the start, the grade of each segment, and the deepest cutting or fill, in metres;
    None if the limits contradict each other. If ``is_bound``, grades stay near those of the draft."""
    ends = np.cumsum([each.distance for each in segments])
    starts = ends - [each.distance for each in segments]
    run = np.clip(s[:, None], starts, ends) - starts  # metres of each segment before each station
    m, n = len(segments), len(s)
    heights = np.column_stack([np.ones(n), run])
    no, one = np.zeros((max(m - 1, 0), 1 + m + n)), np.eye(n)
    lengths = np.array([each.distance for each in segments])
    for k in range(m - 1):
        no[k, 1 + k], no[k, 2 + k] = 1.0, -1.0
    change = 0.9 * np.minimum(lengths[:-1], lengths[1:]) / RADIUS
    above = np.block([[heights, -one], [-heights, -one]])
    cost = np.r_[np.zeros(1 + m), np.ones(n)]
    drafted = np.array([each.incline / 100 for each in segments])
    low, high = np.full(m, -steepest), np.full(m, steepest)
    if is_bound:
        low, high = np.maximum(low, drafted - FREE), np.minimum(high, drafted + FREE)
    bounds = [(None, None), *zip(low, high, strict=True), *[(0.0, None)] * n]
    solved = linprog(
        cost, np.vstack([above, no, -no]), np.r_[land, -land, change, change], bounds=bounds, method="highs"
    )
    if solved.x is None:
        return None
    z, grades = float(solved.x[0]), np.asarray(solved.x[1 : 1 + m])
    return z, grades, float(np.abs(heights @ solved.x[: 1 + m] - land).max())
