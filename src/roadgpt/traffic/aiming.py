"""Finds where somebody is at first, and when it acts, that is to hit the tested car or another one.

The scene is played with a tested car that reacts to nobody, again and again, with somebody farther ahead,
farther aside or later, until it touches whom it is to hit where it is to hit that: by bisection between two
plays between which the place of the touch passes the one that is told. A place is how far it is around the
tested car, clockwise from its front left corner; each face counts as 1."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import count
from typing import NamedTuple

import numpy as np

from roadgpt.brief.scene import STRUCK
from roadgpt.errors import SceneError
from roadgpt.geometry.boxes import touching, turned
from roadgpt.network.line import driven_line
from roadgpt.road import Road, World
from roadgpt.road.road import GOAL
from roadgpt.traffic.actor import HEADING, SIZES, STEP, FloatArray, Size, TestedCar, X, Y
from roadgpt.traffic.crash import first_touch
from roadgpt.traffic.performer import Performer
from roadgpt.traffic.places import SIGN
from roadgpt.traffic.script import Script
from roadgpt.traffic.traffic import Aiming, Mover, Stage, Traffic

LASTS, SLOWEST = 120.0, 1.0  # s, after which a drive among others that is slower in m/s is over
CLOCKWISE = ("front", "right", "rear", "left")
AT_MIRROR = 0.35  # of the car's length behind its front, where door mirrors are; ours
EXACT, CLOSE = 0.005, 0.03  # shares of a face: those sought, and those taken where there is nothing nearer
PLAYS, HALVINGS = 14, 14  # at most: to each side of the first one, and between two
BLIND = 6  # plays to each side after which nobody is met any more
WIDE = {"along": 0.25, "aside": 0.25, "time": 0.5}
"""From one play to the next: shares of its length and of its width, and seconds."""
INSIDE, PASSED = 1.0, 20.0  # m between middles: they have touched; they have passed each other


def steady(road: Road, world: World, size: Size = SIZES["car"], ahead: float = 0.0) -> Iterator[TestedCar]:
    """Yields, every STEP seconds, a tested car that keeps to the middle of its lane and to the speed of the
    scene. The middle of its box, of a ``size``, is ``ahead`` metres before its centre of gravity."""
    way, v = driven_line(road, world), world.first_speed
    first = way.from_road(world.start_on(road))
    for n in count():
        time = n * STEP
        s = way.to_road(first + v * time)
        if s > road.length - GOAL or (time > LASTS and v < SLOWEST):
            return
        x, y, _, heading = way.pose(first + v * time + ahead)
        t = float(world.profile_of(road).middle(s))
        yield TestedCar(x, y, heading, v, s, t, size.length, size.width)


class _Play(NamedTuple):
    """What came of a play."""

    place: float | None = None
    """Where somebody was touched; None if nobody was."""
    ahead: float | None = None
    """How far one was ahead of the other when it had come as far aside as the other."""


def aims_of(stage: Stage, path: Sequence[TestedCar]) -> dict[int, Aiming | None]:
    """Returns the aims of those of a scene who are to hit somebody. ``path`` is how the tested car moves that
    reacts to nobody, every STEP seconds. Raises SceneError if somebody cannot hit whom it is to hit."""
    aims: dict[int, Aiming | None] = {n: None for n, each in enumerate(stage.world.scene.actors) if each.hits}
    for number in aims:
        aims[number] = Aiming()
        script = Script(stage._replace(aims=aims))
        aims[number] = _aimed(stage, script, number, aims, path)
    return aims


def _aimed(
    stage: Stage, script: Script, number: int, aims: dict[int, Aiming | None], path: Sequence[TestedCar]
) -> Aiming:
    who, row, _ = script.role(number)
    told, placed, met = _told(who), who.placed, dict[float, str]()

    def off(by: str = "", far: float = 0.0) -> float | None:
        aims[number] = Aiming()._replace(**{by: far} if by else {})
        play = _played(stage, script, number, path)
        if play.place is None:
            return None
        away = 0.0 if told is None else (play.place - told + 2.0) % 4.0 - 2.0
        turn = int(play.place) % 4
        share = play.place % 1.0 if turn < 2 else 1.0 - play.place % 1.0
        if abs(away) < 1.0:
            place = f"{CLOCKWISE[turn]} from the {('left', 'front')[turn % 2]}"
            met[abs(away)] = f"{100 * share:.0f} % of its {place}"
        return 0.0 if abs(away) < EXACT else away

    aims[number] = Aiming()
    first = _played(stage, script, number, path)
    beside = -first.ahead if first.ahead is not None and first.place is None else 0.0
    begun = [time for event, time in script.events.items() if event[:3] == ("with", *(who.name or ()))]
    wide = {"along": who.size.length, "aside": who.size.width, "time": 1.0}
    for by in placed.freedoms or ("",):
        middle = beside if by == "along" and placed.course.is_along else 0.0
        middle = min(begun, default=0.0) if by == "time" else middle
        found = _searched(partial(off, by), middle, WIDE.get(by, 0.0) * wide.get(by, 0.0))
        if found is not None:
            return Aiming()._replace(**{by: found} if by else {})
    of = "the tested car's " if who.role.hits in STRUCK else ""
    instead = f"it comes no nearer to that than {met[min(met)]}" if met else "they never touch there"
    said = f"{script.actors[row].name} cannot hit {of}{who.role.hits}"
    raise SceneError(f"{said} with what the scene leaves open: {instead}; change what one of them does")


def _flow(stage: Stage) -> Iterator[Mover]:
    if stage.world.scene.has_flow:
        from roadgpt.traffic.idm import IdmMover

        yield IdmMover(stage)


def _told(who: Performer) -> float | None:
    """Returns the place that is to be hit; None: any."""
    role, kerb = who.role, who.placed.offsets.kerb
    face, share = role.hits or "", who.placed.on_face
    if face not in STRUCK:
        return None
    if face not in CLOCKWISE:
        face, share = role.side if role.side in SIGN else "left" if kerb < 0 else "right", AT_MIRROR
    elif (
        face in ("front", "rear")
        and (kerb if role.where == "oncoming" else SIGN.get(str(role.side), kerb)) < 0
    ):
        share = 1.0 - share
    return _around(face, share)


def _around(face: str, share: float) -> float:
    turn = CLOCKWISE.index(face)
    return turn + (share if turn < 2 else 1.0 - share)


def _searched(off: Callable[[float], float | None], middle: float, wide: float) -> float | None:
    """Returns by how much somebody is to be moved, from a middle on, so that it is 0 ``off``."""
    known = {0: off(middle)}
    if known[0] == 0.0 or not wide:
        return middle if known[0] == 0.0 else None
    for n in range(1, PLAYS + 1):
        if n > BLIND and all(each is None for each in known.values()):
            return None
        for far, before in ((n, n - 1), (-n, 1 - n)):
            if known.get(before) is None and any(each is not None for each in known.values()):
                continue  # it is past whom it is to hit
            ends = middle + before * wide, middle + far * wide
            known[far] = off(ends[1])
            if (found := _between(off, *ends, known[before], known[far])) is not None:
                return found
    return None


def _between(
    off: Callable[[float], float | None], one: float, two: float, here: float | None, there: float | None
) -> float | None:
    """Returns where it is 0 ``off`` between two ends at which it is so much off; None: it touches nobody."""
    for _ in range(HALVINGS):
        if 0.0 in (here, there):
            return one if here == 0.0 else two
        if not _passes(here, there) and (here is None) == (there is None):
            return None
        at = (one + two) / 2
        its = off(at)
        if _passes(here, its) or (not _passes(its, there) and (its is None) == (there is None)):
            two, there = at, its
        else:
            one, here = at, its
    nearest = min((abs(each), where) for each, where in ((here, one), (there, two)) if each is not None)
    return nearest[1] if nearest[0] < CLOSE else None


def _passes(here: float | None, there: float | None) -> bool:
    """Whether the place of the touch passes the one that is told on the way."""
    return here is not None and there is not None and here * there <= 0 and abs(here - there) < 2.0


def _played(stage: Stage, script: Script, number: int, path: Sequence[TestedCar]) -> _Play:
    """Plays the scene, and finds when somebody first touches whom it is to hit."""
    others, states, nearest = Traffic([script, *_flow(stage)]), list[FloatArray](), np.inf
    for n, car in enumerate(path):
        try:
            others.advance(car)
        except SceneError:
            return _Play()
        who, row, foe = script.role(number)
        states.append(others.at(n * STEP))
        its = (car.x, car.y) if foe is None else states[-1][foe, :2]
        far = float(np.hypot(*(states[-1][row, :2] - its)))
        if far < INSIDE or (far > nearest + PASSED and not who.course.is_along):
            break
        nearest = np.fmin(nearest, far)
    two = np.array([each[row, [X, Y, HEADING]] for each in states])
    one = np.array([(car.x, car.y, car.heading) for car in path[: len(states)]])
    size = np.array([path[0][-2:], who.size[:2]])
    if foe is not None:
        one, size[0] = np.array([each[foe, [X, Y, HEADING]] for each in states]), script.actors[foe].size[:2]
    ahead, aside = turned(two[:, :2] - one[:, :2], -one[:, 2]).T
    comes = np.flatnonzero(np.diff((np.abs(aside) < size[:, 1].mean()).astype(int)) > 0)
    beside = float(ahead[comes[0] + 1]) if len(comes) else None
    if foe is not None and row in script.crashed:
        return _Play(0.0, beside)
    if (touch := first_touch(one, two, size)) is None:
        return _Play(ahead=beside)
    place = touch[1]
    how = touching(place[:, :2], place[:, 2], size)
    return _Play(_around(how.faces[0], how.place), beside)
