"""Shapely's polygons against contacts and measures: random boxes that move and turn among each other."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from roadgpt.drive import Drive
from roadgpt.road import World
from roadgpt.traffic import STEP, Tracks
from roadgpt.traffic.actor import SIZES
from roadgpt.verdict.contact import contacts_of
from roadgpt.verdict.measures import measure
from staged import BOX, among, box_at, driven, level, straight, tracks

ROAD = level(-100, 400)
FINE = 0.002  # s


def spinning(x: float, y: float, heading: float, speed: float, turn: float) -> Any:
    c, s = np.cos(heading), np.sin(heading)
    return lambda time: (x + c * speed * time, y + s * speed * time, heading + turn * time)


def crowd(seed: int, duration: float = 2.5) -> Drive:
    """A car that moves and turns among six others who do."""
    rng = np.random.default_rng(seed)
    kinds = rng.choice([*SIZES], 6)
    others = {
        f"{kind}_{n}": (
            str(kind),
            spinning(*rng.uniform(-14, 14, 2), rng.uniform(-3, 3), rng.uniform(-5, 25), rng.uniform(-1, 1)),
        )
        for n, kind in enumerate(kinds)
    }
    own = spinning(0, 0, rng.uniform(-3, 3), rng.uniform(0, 25), rng.uniform(-1, 1))
    return among(driven(own, duration, ROAD), tracks(duration, **others))


def boxes(x: Any, y: Any, heading: Any, length: float, width: float) -> NDArray[Any]:
    return shapely.polygons([box_at(*each, length, width) for each in zip(x, y, heading, strict=True)])


def distances(drive: Drive, at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Between the car and each of the others, shape (times, actors)."""
    assert drive.others is not None
    own = boxes(*(np.interp(at, drive["time"], each) for each in drive.middles.T), BOX.length, BOX.width)
    states = drive.others.at(at)
    found = []
    for k, actor in enumerate(drive.others.actors):
        x, y, _, heading, _ = states[:, k].T
        found.append(shapely.distance(own, boxes(x, y, heading, *actor.size[:2])))
    return np.stack(found, axis=1)


def test_who_touches_the_car_and_when() -> None:
    touched = before = 0
    for seed in range(3, 12):
        drive = crowd(seed)
        assert drive.others is not None
        at = np.arange(0.0, drive.duration + FINE / 2, FINE)
        apart = distances(drive, at)
        found = {each.other: each for each in contacts_of(drive)}
        for k, actor in enumerate(drive.others.actors):
            mine = found.get(actor.name)
            if apart[:, k].min() > 0:
                assert mine is None or apart[:, k].min() < 0.05  # between two samples
                continue
            assert mine is not None
            first = at[np.argmax(apart[:, k] == 0)]
            assert first - FINE - 0.01 <= mine.at_time <= first + 1e-9
            states = drive.others.at(mine.at_time)[k]
            x, y, heading = (np.interp(mine.at_time, drive["time"], each) for each in drive.middles.T)
            own = shapely.Polygon(box_at(x, y, heading, BOX.length, BOX.width))
            other = shapely.Polygon(box_at(states[0], states[1], states[3], *actor.size[:2]))
            assert own.distance(other) < 2e-3 or first == 0
            assert mine.contact is not None
            place = shapely.Point(mine.contact.xy)
            before, touched = before + (first == 0), touched + (first > 0)
            if first > 0:
                assert max(own.boundary.distance(place), other.boundary.distance(place)) < 0.03
                # the side of each that the place is on; near a corner it may be either
                for box, way, face, size in (
                    (own, heading, mine.contact.face, (BOX.length, BOX.width)),
                    (other, states[3], mine.contact.other_face, actor.size[:2]),
                ):
                    corner = shapely.MultiPoint(np.asarray(box.exterior.coords)).distance(place)
                    dx, dy = np.array(mine.contact.xy) - np.asarray(box.centroid.coords)[0]
                    ahead, aside = dx * np.cos(way) + dy * np.sin(way), dy * np.cos(way) - dx * np.sin(way)
                    depth = {
                        "front": size[0] / 2 - ahead, "rear": size[0] / 2 + ahead,
                        "left": size[1] / 2 - aside, "right": size[1] / 2 + aside,
                    }  # fmt: skip
                    assert corner < 0.1 or min(depth, key=depth.__getitem__) == face
    assert touched > 4
    assert before > 0


def test_somebody_thin_and_fast_is_not_missed_between_two_steps() -> None:
    # a bicycle that crosses a car's front corner within one step, both at 40 m/s
    for late in np.linspace(-0.05, 0.05, 11):
        own = straight(0, 0, 0, 40)
        bicycle = straight(60.0 + BOX.length / 2, -60 + late * 40, np.pi / 2, 40)
        drive = among(driven(own, 3.0, ROAD), tracks(3.0, bicycle_1=("bicycle", bicycle)))
        at = np.arange(1.4, 1.6, 1e-4)
        assert bool(contacts_of(drive)) == bool((distances(drive, at) == 0).any())


def test_the_tracks_of_many_times_are_those_of_each() -> None:
    others = crowd(3).others
    assert others is not None
    holes = np.where(np.arange(len(others)) % 7 < 5, 1.0, np.nan)[:, None, None] * others.states
    gappy = Tracks(others.actors, holes)
    at = np.concatenate([np.linspace(-0.1, 3.0, 500), np.arange(30) * STEP])
    many = gappy.at(at)
    np.testing.assert_array_equal(many, np.stack([gappy.at(each) for each in at]))
    np.testing.assert_array_equal(gappy.at(at, 2), many[:, 2])


def test_distances_are_shapelys() -> None:
    for seed in range(4):
        drive = crowd(seed)
        found = measure(ROAD, drive, World())
        np.testing.assert_allclose(found.distance, distances(drive, found.time), atol=1e-9)


def until_contact(own: Any, other: Any, size: Any, longest: float) -> float:
    """Until two boxes that move evenly, without turning, touch, by small steps."""
    at = np.arange(0.0, longest, FINE)
    x, y, heading, speed = own
    mine = boxes(x + speed[0] * at, y + speed[1] * at, np.full_like(at, heading), BOX.length, BOX.width)
    x, y, heading, speed = other
    its = boxes(x + speed[0] * at, y + speed[1] * at, np.full_like(at, heading), *size)
    near = np.flatnonzero(shapely.distance(mine, its) == 0)
    return float(at[near[0]]) if len(near) else np.inf


def test_conflict_times_are_those_of_boxes_that_go_straight_on() -> None:
    rng = np.random.default_rng(5)
    met = 0
    for _ in range(16):
        heading, v, w = rng.uniform(-0.3, 0.3), rng.uniform(2, 20), rng.uniform(0, 12)
        place, turned = (rng.uniform(6, 25), rng.uniform(-7, 3)), rng.uniform(-3, 3)
        kind = str(rng.choice(["car", "adult", "truck"]))
        drive = among(
            driven(straight(0, -2, heading, v), 0.2, ROAD),
            tracks(0.2, it=(kind, straight(*place, turned, w))),
        )
        found = float(measure(ROAD, drive, World()).conflict[0, 0])
        slow = until_contact(
            (0.0, -2.0, heading, (v * np.cos(heading), v * np.sin(heading))),
            (*place, turned, (w * np.cos(turned), w * np.sin(turned))),
            SIZES[kind][:2],  # type: ignore[index]
            4.0,
        )
        if slow < 4.0 or found < 4.0:
            met += 1
            assert found == pytest.approx(slow, abs=FINE + 0.01)
    assert met > 2


def test_many_others_take_little_time() -> None:
    rng = np.random.default_rng(0)
    others: dict[str, tuple[str, Callable[[Any], Any]]] = {
        f"car_{k}": (
            "car",
            straight(rng.uniform(20, 850), (-5.2, 2, 6)[k % 3], (0, np.pi, 0)[k % 3], (0, 14, 13)[k % 3]),
        )
        for k in range(50)
    }
    drive = among(driven(straight(10, -2, 0, 14), 60.0), tracks(60.0, **others))
    assert contacts_of(drive) == ()
    took = []
    for _ in range(5):
        begun = time.process_time()
        contacts_of(drive)
        took.append(time.process_time() - begun)
    assert min(took) < 0.05
