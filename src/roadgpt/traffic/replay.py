"""The mover ``replay``: others who move as they were recorded."""

import numpy as np

from roadgpt.traffic.actor import SPEED, STEP, STILL, Actor, FloatArray, TestedCar, Tracks


class ReplayMover:
    """Moves actors along recorded tracks, whatever anybody else does. Who stands at the end of the tracks
    stays there; all others are gone."""

    def __init__(self, tracks: Tracks) -> None:
        self.actors: list[Actor] = [*tracks.actors]
        self._states = tracks.states

    def start(self, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the first sample of the tracks."""
        del car, bodies
        return np.asarray(self._states[0])

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the next sample of the tracks."""
        del car, bodies
        following = round(time / STEP) + 1
        if following < len(self._states):
            return np.asarray(self._states[following])
        last = np.array(self._states[-1])
        last[np.abs(last[:, SPEED]) >= STILL] = np.nan
        return last
