"""What becomes of two of the others who hit each other.

From where they touch, both have one speed along the line on which they do, by their masses, and each keeps
its own across that: an impact without restitution and without friction between them, as in the program CRASH3
(NHTSA, 1982); ours: nobody turns. From then on they slide with locked wheels until they stand."""

import numpy as np

from roadgpt.geometry.boxes import separation
from roadgpt.language.table import ROAD_USERS
from roadgpt.traffic.actor import HEADING, STEP, FloatArray, X, Y
from roadgpt.traffic.performer import Performer

PARTS = 12  # of a step, at which a touch is looked for
CRUSHED = 0.04  # m of the length and the width of each


def first_touch(one: FloatArray, two: FloatArray, size: FloatArray) -> tuple[float, FloatArray] | None:
    """Returns when two boxes first touch, counted in samples, and their x, y and heading then, shape (2, 3);
    None if they do not. Between two samples of these, (n, 3) for each, they move evenly; ``size`` is (2, 2).
    """
    at = np.arange(len(one) - 1 + 1e-9, step=1 / PARTS)
    both = np.stack(
        [[np.interp(at, np.arange(len(one)), column) for column in each.T] for each in (one, two)]
    )
    sizes = np.broadcast_to(size[:, None], (2, len(at), 2))
    away, heading = (both[1] - both[0])[:2].T, both[:, 2]
    apart = separation(away, heading[0], sizes[0], heading[1], sizes[1]).max(axis=-1)
    inside = np.flatnonzero(apart <= 0.0)
    if not len(inside):
        return None
    k = max(int(inside[0]), 1)
    share = min(max(apart[k - 1] / max(apart[k - 1] - apart[k], 1e-9), 0.0), 1.0)
    return (k - 1 + share) / PARTS, (1 - share) * both[:, :, k - 1] + share * both[:, :, k]


def crash(one: Performer, two: Performer, past: FloatArray) -> bool:
    """Returns whether two touch since STEP ago, when their states were ``past``, (2, 5); then both slide."""
    states = [one.state(), two.state()]
    if None in states or np.isnan(past).any():
        return False
    tracks = np.stack([past, np.array(states, float)])[:, :, [X, Y, HEADING]]
    size = np.array([one.size[:2], two.size[:2]]) - CRUSHED
    if (met := first_touch(tracks[:, 0], tracks[:, 1], size)) is None:
        return False
    share, place = met
    velocity, away = (tracks[1] - tracks[0])[:, :2] / STEP, place[1, :2] - place[0, :2]
    flat, across = divmod(int(separation(away, place[0, 2], size[0], place[1, 2], size[1]).argmax()), 2)
    angle = place[flat, 2] + across * np.pi / 2
    normal = np.array([np.cos(angle), np.sin(angle)]) * np.sign(away @ [np.cos(angle), np.sin(angle)])
    along, mass = velocity @ normal, np.array([ROAD_USERS[each.role.kind].mass for each in (one, two)])
    if along[0] > along[1]:
        velocity += np.outer(mass @ along / mass.sum() - along, normal)
        for who, (x, y, heading), its in zip((one, two), place, velocity, strict=True):
            who.slide(np.array([x, y]), float(heading), its, (1 - share) * STEP)
    return True
