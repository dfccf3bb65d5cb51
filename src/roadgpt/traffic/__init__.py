"""Moves the others on the road: everybody besides the tested car. Main function: ``begin``.
Plug-ins: ``movers/``; see ``Mover``."""

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
