"""Moves the others on the road: everybody besides the tested car. Main function: ``begin``.

Movers are plug-ins (``movers/``), each of which moves some of the others:

class Mover:
    def __init__(self, stage: Stage)
    actors: list[Actor]                       # its own; may grow
    def start(self, car) -> states            # at time 0
    def move(self, time, car, bodies) -> states    # at ``time + STEP``"""

from roadgpt.traffic.actor import SIZES, STEP, STILL, Actor, Size, TestedCar, Tracks
from roadgpt.traffic.traffic import Mover, Stage, Traffic, begin

__all__ = [
    "SIZES",
    "STEP",
    "STILL",
    "Actor",
    "Mover",
    "Size",
    "Stage",
    "TestedCar",
    "Tracks",
    "Traffic",
    "begin",
]
