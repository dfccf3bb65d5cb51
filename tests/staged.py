"""Drives with others on the road, from functions of time: nobody reacts to anybody."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.drive.lane_position import LanePolygon
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.boxes import corners
from roadgpt.road import Road, World
from roadgpt.traffic import STEP, Actor, Tracks
from roadgpt.traffic.actor import SIZES, rounded

BOX = Box(4.7, 1.86, ahead=-0.1)
Motion = Callable[[Any], tuple[Any, Any, Any]]
"""Of times to x, y and heading of the middle of a box."""


def level(start: float, end: float) -> Road:
    """A straight road along x, by pieces, which are quicker than a spline."""
    length = end - start
    return Road(PieceCurve(start, 0.0, 0.0, (Piece(length),)), GradeProfile(0.0, (0.0, length), (0.0, 0.0)))


def driven(motion: Motion, duration: float, road: Road | None = None, ended: str = "goal") -> Drive:
    """A drive by a motion of the middle of the car's box; on a road, with stations and shares outside the
    lane."""
    time = np.round(np.arange(0.0, duration + 1e-9, 0.02), 3)
    x, y, heading = (np.broadcast_to(each, time.shape).astype(float) for each in motion(time))
    x, y = x - BOX.ahead * np.cos(heading), y - BOX.ahead * np.sin(heading)
    vx, vy = np.gradient(x, time), np.gradient(y, time)
    columns = {name: np.zeros(len(time)) for name in COLUMNS}
    columns |= {"time": time, "x": x, "y": y, "heading": heading, "z": np.full(len(time), BOX.height)}
    columns |= {
        "vx": vx * np.cos(heading) + vy * np.sin(heading),
        "vy": vy * np.cos(heading) - vx * np.sin(heading),
        "speed": np.hypot(vx, vy),
        "s": x,
    }
    made = Drive("staged", "paper", 0, Columns(columns), ended, BOX)  # type: ignore[arg-type]
    if road is None:
        return made
    columns["s"], columns["t"] = road.locate(x, y)
    lane = LanePolygon.along(road, World())
    columns["outside"] = shares_outside(made, lane, columns["s"])
    return replace(made, columns=Columns(columns))


def shares_outside(drive: Drive, lane: LanePolygon, stations: NDArray[np.float64]) -> NDArray[np.float64]:
    """What ``lane.outside`` says of each sample of a drive, whose boxes are worked out all at once."""
    boxes = corners(drive.middles[:, :2], drive["heading"], np.array([drive.car.length, drive.car.width]))
    return np.array([lane.outside(box, s) for box, s in zip(boxes, stations, strict=True)])


def tracks(duration: float, **motions: tuple[str, Motion]) -> Tracks:
    """Others by name, such as ``van_1=("van", motion)``."""
    time = np.arange(0.0, duration + STEP / 2, STEP)
    actors, states = [], []
    for name, (kind, motion) in motions.items():
        x, y, heading = (np.broadcast_to(each, time.shape).astype(float) for each in motion(time))
        vx, vy = np.gradient(x, STEP), np.gradient(y, STEP)
        speed = vx * np.cos(heading) + vy * np.sin(heading)
        actors.append(Actor(name.replace("_", " "), kind, SIZES[kind]))  # type: ignore[arg-type,index]
        states.append(np.stack([x, y, np.zeros_like(x), np.unwrap(heading), speed], axis=-1))
    return Tracks(tuple(actors), rounded(np.stack(states, axis=1)))


def straight(x: float, y: float, heading: float, speed: float) -> Motion:
    """Even motion along a straight line."""
    c, s = np.cos(heading), np.sin(heading)
    return lambda time: (x + c * speed * time, y + s * speed * time, heading)


def among(drive: Drive, others: Tracks) -> Drive:
    return replace(drive, others=others)


def box_at(x: float, y: float, heading: float, length: float, width: float) -> NDArray[np.float64]:
    """The corners of a box."""
    c, s = np.cos(heading), np.sin(heading)
    ahead, aside = np.array([c, s]) * length / 2, np.array([-s, c]) * width / 2
    return np.array([x, y]) + np.array([-ahead - aside, ahead - aside, ahead + aside, -ahead + aside])
