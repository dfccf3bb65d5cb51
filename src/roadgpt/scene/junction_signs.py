"""Builds the signs and lights of junctions from flat polygons with one colour each."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.network.markings import JunctionSign

SignColour = Literal["grey", "white", "red", "yellow", "green", "black", "dim red", "dim yellow"]

POLE, POLE_SIDES = 0.04, 6  # radius of a post in m, and number of its sides
FOOT = 0.5  # m by which a post reaches into the ground
LAYER = 0.012  # m between two colours of a sign
MIDDLE = {"stop": 2.45, "yield": 2.4, "priority": 2.35, "lights": 2.75}
"""Height in metres of the middle of each sign above the foot of its post."""
OCTAGON = np.pi / 8 + np.arange(8) * np.pi / 4
TRIANGLE = np.pi / 2 + np.arange(3) * 2 * np.pi / 3 + np.pi
DIAMOND = np.arange(4) * np.pi / 2
CIRCLE = np.arange(24) * np.pi / 12
BAR = 0.045  # m, width of the bars of letters
TALL, WIDE = 0.26, 0.13  # m, of a letter
LETTERS = {
    "S": ("top", "upper left", "middle", "lower right", "foot"),
    "T": ("top", "centre"),
    "O": ("top", "upper left", "lower left", "upper right", "lower right", "foot"),
    "P": ("top", "upper left", "lower left", "upper right", "middle"),
}
"""The bars of the letters of a stop sign, in the order of the word."""
APART = 0.18  # m, from the middle of a letter to that of the next
BOX, LENS = (0.42, 1.2, 0.25), 0.15  # m: width, height and depth of a traffic light; radius of a lens
LENS_APART, BOARD, RIM = 0.38, 0.09, 0.13  # m: lens to lens; board and its white rim, beyond the box


class SignFace(NamedTuple):
    """One flat polygon of a sign."""

    colour: SignColour
    points: Array
    """Corners ``(n, 3)`` in metres, counter-clockwise as seen from the visible side; the polygon is
    convex."""


def faces_of(sign: JunctionSign) -> Iterator[SignFace]:
    """Yields the faces of a sign and of its post. Of two overlapping faces, the rear one is yielded first."""
    top = MIDDLE[sign.control]
    yield from _tube(sign, POLE, -FOOT, top)
    if sign.control == "lights":
        yield from _lights(sign, top)
        return
    for layer, (colour, outline) in enumerate(_layers(sign)):
        ahead = POLE + LAYER * (min(layer, 2) + 1)
        if not layer:
            yield SignFace("grey", _placed(sign, outline[::-1], top, ahead))
        yield SignFace(colour, _placed(sign, outline, top, ahead))


def _layers(sign: JunctionSign) -> list[tuple[SignColour, Array]]:
    """Returns the colours of a sign's front, from back to front, each with its outline ``(n, 2)``."""
    if sign.control == "stop":
        letters: list[tuple[SignColour, Array]] = [("white", bar) for bar in _word()]
        return [("white", _polygon(OCTAGON, 0.48)), ("red", _polygon(OCTAGON, 0.44)), *letters]
    if sign.control == "yield":
        return [("red", _polygon(TRIANGLE, 0.52)), ("white", _polygon(TRIANGLE, 0.33))]
    return [("white", _polygon(DIAMOND, 0.45)), ("yellow", _polygon(DIAMOND, 0.33))]


def _word() -> Iterator[Array]:
    half, wide, tall = BAR / 2, WIDE / 2, TALL / 2
    up, across = tall - half, wide - half
    boxes = {  # left, right, lower and upper edge
        "top": (-wide, wide, up - half, tall),
        "middle": (-wide, wide, -half, half),
        "foot": (-wide, wide, -tall, half - up),
        "centre": (-half, half, -tall, tall),
        "upper left": (-wide, half - across, 0.0, tall),
        "lower left": (-wide, half - across, -tall, 0.0),
        "upper right": (across - half, wide, 0.0, tall),
        "lower right": (across - half, wide, -tall, 0.0),
    }
    for number, bars in enumerate(LETTERS.values()):
        for left, right, low, high in map(boxes.__getitem__, bars):
            corners = np.array([[left, low], [right, low], [right, high], [left, high]])
            yield corners + [(number - (len(LETTERS) - 1) / 2) * APART, 0.0]


def _polygon(angles: Array, radius: float) -> Array:
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _placed(sign: JunctionSign, outline: Array, height: float, ahead: float) -> Array:
    """Returns a polygon that faces the traffic; x of the outline points to the right as drivers see it."""
    c, s = np.cos(sign.heading), np.sin(sign.heading)
    right, towards = np.array([s, -c, 0.0]), np.array([-c, -s, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    foot = np.array(sign.place)
    return np.asarray(foot + outline[:, :1] * right + (outline[:, 1:] + height) * up + ahead * towards)


def _tube(sign: JunctionSign, radius: float, low: float, high: float) -> Iterator[SignFace]:
    angles = np.arange(POLE_SIDES + 1) * 2 * np.pi / POLE_SIDES
    ring = np.array(sign.place) + np.column_stack(
        [radius * np.cos(angles), radius * np.sin(angles), 0 * angles]
    )
    for one, two in pairwise(ring):
        down, up = np.array([0, 0, low]), np.array([0, 0, high])
        yield SignFace("grey", np.array([one + down, two + down, two + up, one + up]))


def _lights(sign: JunctionSign, middle: float) -> Iterator[SignFace]:
    """Yields a box before a black board with a white rim, and three lenses, of which the green one is lit."""
    wide, high, deep = BOX
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    board, rim = (corners * [wide / 2 + more, high / 2 + more] for more in (BOARD, RIM))
    yield SignFace("grey", _placed(sign, rim[::-1], middle, POLE))
    yield SignFace("white", _placed(sign, rim, middle, POLE))
    yield SignFace("black", _placed(sign, board, middle, POLE + LAYER))
    back, front = (_placed(sign, corners * [wide / 2, high / 2], middle, ahead) for ahead in (POLE, deep))
    yield SignFace("black", front)
    for k in range(4):
        n = (k + 1) % 4
        yield SignFace("black", np.array([back[k], back[n], front[n], front[k]]))
    lens = _polygon(CIRCLE, LENS)
    colours: tuple[SignColour, ...] = ("green", "dim yellow", "dim red")
    for k, colour in enumerate(colours):
        yield SignFace(colour, _placed(sign, lens + [0.0, (k - 1) * LENS_APART], middle, deep + LAYER))
