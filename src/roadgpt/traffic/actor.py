"""Defines the Actor, somebody or something else on the road, Tracks, how actors moved, and what actors see of
the tested car."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.language.names import ActorKind
from roadgpt.language.table import SIZES as SIZES
from roadgpt.language.table import Size as Size

if TYPE_CHECKING:
    from roadgpt.scene import Body

FloatArray = NDArray[np.float64]
STEP = 0.1  # s, from one sample of a track to the next; UN R157's simulations use the same step
TESTED = "Ego"  # name of the tested car in files of scenes, which no actor may have
STILL = 0.3  # m/s, below which an actor counts as standing
X, Y, Z, HEADING, SPEED = range(5)
"""The columns of a state: the middle of the actor's box on the ground in metres, its heading in radians, and
its speed along its heading in m/s, negative when it reverses."""

PER_UNIT = np.array([1e3, 1e3, 1e3, 1e4, 1e3])  # to these numbers in a m, m, m, rad, m/s states are rounded


class TestedCar(NamedTuple):
    """What the others see of the tested car."""

    x: float
    """Position in metres of the middle of its box, as ``y``."""
    y: float
    heading: float
    speed: float
    s: float
    """Station in metres along the road that it drives, as ``t`` its offset to the left."""
    t: float
    length: float
    width: float


@dataclass(frozen=True)
class Actor:
    """Somebody or something on the road besides the tested car."""

    name: str
    """Unique within a drive, such as "truck 1"."""
    kind: ActorKind
    size: Size


@dataclass(frozen=True, eq=False)
class Tracks:
    """How actors moved: a state for every actor every STEP seconds since the start of the drive.

    Between two samples an actor moves evenly along a straight line: this is how it moved, not an
    approximation. Positions are rounded to a millimetre, angles to 0.0001 rad and speeds to 1 mm/s, so that a
    file holds exactly these values."""

    actors: tuple[Actor, ...]
    states: FloatArray
    """Shape (samples, actors, 5) with the columns X, Y, Z, HEADING (unwrapped) and SPEED; NaN while an actor
    is not there."""

    def at(self, time: ArrayLike, who: Any = slice(None)) -> FloatArray:
        """Returns the states at times in seconds, shape (..., actors, 5); NaN for actors that are not there.
        A time after the last sample counts as the last sample. ``who``, indices of actors that broadcast with
        the times, gives the state of one actor for each time, shape (..., 5)."""
        last = len(self.states) - 1
        place = np.clip(np.asarray(time, float) / STEP, 0.0, last)
        first = np.minimum((place + 1e-9).astype(int), last)
        before, after = self.states[first, who], self.states[np.minimum(first + 1, last), who]
        share = (place - first).reshape(first.shape + (1,) * (before.ndim - first.ndim))
        return np.asarray(np.where(share < 1e-6, before, (1 - share) * before + share * after))

    @property
    def time(self) -> FloatArray:
        """The times of the samples in seconds."""
        return STEP * np.arange(len(self.states), dtype=np.float64)

    def __len__(self) -> int:
        return len(self.states)


def bodies(actors: Sequence[Actor], states: FloatArray) -> "list[Body]":
    """Returns the bodies of actors, for images, from their states, shape (actors, 5)."""
    found = zip(actors, states.tolist(), strict=True)
    return [(each.kind, each.size, state[:SPEED]) for each, state in found if not math.isnan(state[X])]


def rounded(states: FloatArray) -> FloatArray:
    """Returns states as Tracks hold them."""
    return np.asarray(np.rint(states * PER_UNIT) / PER_UNIT + 0.0)
