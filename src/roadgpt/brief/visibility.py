"""Says how far one can see under the conditions of a scene, and draws these conditions for a drive.

Sources: WMO-No. 8, part I, chapter 9 (meteorological optical range, Koschmieder's law); ITU-R P.1814 (loss of
light in rain); UN Regulations No. 48, 112 and 149 (passing beams); Vienna Convention on Road Traffic 1968,
Annex 5 (lamps of vehicles)."""

import math
from random import Random
from statistics import mean
from typing import Literal

from roadgpt.brief.amount import exactly
from roadgpt.brief.scene import Air, Scene
from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS, WEATHER

CONTRAST = 0.05
"""Contrast of a dark object before the horizon at the visual range, as a share of its contrast nearby."""
RAIN, GROWTH = 1.076, 0.67  # dB/km in rain of 1 mm/h, and the power with which it grows
LOW_BEAM = 50.0
"""Metres up to which a passing beam shows what has no lamps: to the point 50V of the regulations, the middle
of the lane 50 m ahead. With the least that they allow, 5,100 cd, two headlamps throw 4 lx there. Farther
ahead a beam may be darker, and its cut-off falls by 1 %, from 0.5 to 0.8 m above the road."""
LOW_SUN = math.radians(8.0)  # elevation of a low sun
LAMPS = 300.0  # m from which position lamps have to be visible at night in clear weather


def clear_range(scene: Scene) -> float:
    """Returns the distance in metres at which the weather leaves CONTRAST, by Koschmieder's law; infinite
    without any."""
    lost = 0.0
    for air in scene.weather:
        if WEATHER[air.kind].falls:
            decibels = RAIN * amount_in(air) ** GROWTH
            lost += decibels / 10 * math.log(10) / -math.log(CONTRAST) / 1000
        else:
            lost += 1.0 / amount_in(air)
    return 1.0 / lost if lost else math.inf


def amount_in(air: Air) -> float:
    """Returns the visual range in metres, or how much falls in mm/h; of a range its middle."""
    return mean(_ends(air))


def falling(scene: Scene) -> float:
    """Returns how much falls in all, in mm/h."""
    return sum(amount_in(air) for air in scene.weather if WEATHER[air.kind].falls)


def visual_range(scene: Scene, kind: ActorKind | Literal["lane", "lights"]) -> float:
    """Returns the metres from which a driver with passing beams can see an actor of a kind, the lane or
    traffic lights, if nothing hides it; infinite by day without fog and rain.

    A low sun takes nothing away here. Measure from the driver to the nearest point of the other."""
    at_night = LAMPS if kind == "lights" or (kind != "lane" and ROAD_USERS[kind].lamps) else LOW_BEAM
    return min(clear_range(scene), at_night if scene.light == "night" else math.inf)


def weather_drawn(scene: Scene, seed: int) -> Scene:
    """Returns the scene with one number for each kind of weather, drawn evenly from its range by the seed of
    the drive; the scene itself if each has one number."""
    for air in scene.weather:
        if not air.amount.exact:
            value = Random(f"{air.kind} {seed}").uniform(*_ends(air))
            scene = scene.with_weather(air.kind, exactly(round(value, 1)))
    return scene


def _ends(air: Air) -> tuple[float, float]:
    row, amount = WEATHER[air.kind], air.amount
    return row.least if amount.lo is None else amount.lo, row.most if amount.hi is None else amount.hi
