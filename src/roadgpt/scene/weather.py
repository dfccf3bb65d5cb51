"""Changes an image to what a camera sees in fog, in rain, at night, or against a low sun.

Fog and rain weaken contrasts by Koschmieder's law: at the visual range, 5 % of them are left. At night the
headlights give light, below their cut-off. Against a low sun, a veil of stray light lies over the image; it
falls with the square of the angle to the sun (Stiles and Holladay). How strong it is, how dark the night and
rain are, and how rain blurs, are choices."""

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter

from roadgpt.brief.scene import Scene
from roadgpt.brief.visibility import CONTRAST, LOW_SUN, amount_in, clear_range, falling
from roadgpt.compiled import compiled
from roadgpt.export.ego import CAR, start_of
from roadgpt.geometry.curve import Array
from roadgpt.language.table import WEATHER
from roadgpt.road import Road
from roadgpt.scene.camera import Pose, axes_of
from roadgpt.scene.mesh import PLAIN
from roadgpt.scene.raster import OFFSETS, RenderBuffers
from roadgpt.scene.shade import Colour, ray

NIGHT = 0.012  # share of daylight that is left at night
LEVEL = 0.66, 0.58, 0.46  # share of the usual light, red to blue, that a low sun gives
DISC, VEIL, LEAST = 4.0, 6.0, 2.0
"""Brightness of the sun; that of its veil at 1 degree; degrees below which the veil grows no more."""
BLOOM = math.cos(math.radians(0.6))  # of the angle within which the sun is white
WARM = 1.0, 0.86, 0.62  # colour of a low sun
RAINY, BLURRED = 40.0, 10.0  # mm/h of rain that halves the light; that blurs to 1 - 1/e of the most
MOST = 0.6  # share of a pixel that may come from its neighbours
LAMP, CUT, SOFT = 0.65, -0.01, 0.004
"""Height of headlights in metres; slope of their cut-off, 1 % down; and that within which it fades."""
STRAY, BROAD, BRIGHT = 0.03, 0.35, 14.0
"""Share of the light above the cut-off; angle in radians at which the light aside has fallen to 1/e; and the
distance in metres up to which what the headlights meet is as bright as by day."""


class Weather(NamedTuple):
    """The conditions of a scene as images show them."""

    extinction: float  # 1/m: contrasts fall by the factor e in the distance 1 / extinction
    light: Colour  # share of daylight on what is seen
    sky: float  # the same of the sky
    haze: Colour  # linear brightness of what hides the distance
    beam: float  # 1 if the headlights are on, else 0
    sun: Colour  # unit vector towards a low sun; 0 if there is none
    blur: float  # share of each pixel that comes from around it

    @classmethod
    def of(cls, scene: Scene, road: Road) -> "Weather | None":
        """Returns the weather of a scene on a road; None for clear daylight. A haze hides a low sun."""
        if not (scene.weather or scene.light):
            return None
        rain, is_night, is_low = falling(scene), scene.light == "night", scene.light == "low_sun"
        dim = (NIGHT if is_night else 1.0) / (1.0 + rain / RAINY)
        red, green, blue = LEVEL if is_low else (1.0, 1.0, 1.0)
        hazes = [(amount_in(air), tint) for air in scene.weather if (tint := WEATHER[air.kind].tint)]
        haze = min(hazes, default=(0.0, WEATHER["fog"].tint or LEVEL))[1]  # that of the thickest
        turn, level = float(road.heading(start_of(road))), math.cos(LOW_SUN)
        sun = level * math.cos(turn), level * math.sin(turn), math.sin(LOW_SUN)
        return cls(
            -math.log(CONTRAST) / clear_range(scene),
            (dim * red, dim * green, dim * blue),
            dim,
            (haze[0] * dim, haze[1] * dim, haze[2] * dim),
            float(is_night),
            sun if is_low and not hazes else (0.0, 0.0, 0.0),
            MOST * (1.0 - math.exp(-rain / BLURRED)),
        )

    def change(self, buffers: RenderBuffers, palette: Array, eye: Array, car: Pose) -> None:
        """Changes the image in the buffers, of which the headlights are those of ``car``."""
        axes = axes_of(car.heading, car.pitch, car.roll)
        lamp = np.array([car.x, car.y, car.z]) + (LAMP - CAR.gravity_height) * axes[2]
        lamp += (CAR.middle + CAR.length / 2) * axes[0]
        _change(buffers, palette, eye, np.concatenate([lamp, axes.ravel()]), self)
        if self.blur > 0:
            around = uniform_filter(buffers.picture, (3, 3, 1), mode="nearest")
            buffers.picture[:] += np.float32(self.blur) * (around - buffers.picture)


@compiled
def _change(buffers: RenderBuffers, palette: Array, eye: Array, lamp: Array, weather: Weather) -> None:
    """Changes each pixel by the mean of what the weather does to its four samples. ``lamp`` has the place of
    the headlights and the unit vectors forward, to the left and up."""
    ids, depth, kinds, picture = buffers.ids, buffers.depth, buffers.kinds, buffers.picture
    rows, columns, pixel = picture.shape[0], picture.shape[1], 1.0 / eye[12]
    sun, kept, added = weather.sun, np.empty(3), np.empty(3)
    for row in range(rows):
        for i in range(columns):
            kept[:], added[:], open_sky = 0.0, 0.0, 0.0
            for k in range(4):
                near, n = depth[4 * row + k, i], ids[4 * row + k, i]
                if near <= 0.0:
                    clear = 1.0 if weather.extinction == 0.0 else 0.0
                    open_sky += 0.25
                    for c in range(3):
                        kept[c] += 0.25 * clear * weather.sky
                        added[c] += 0.25 * (1.0 - clear) * weather.haze[c]
                    continue
                dx, dy, dz = ray(eye, i + OFFSETS[k], row + (k + 0.5) * 0.25, rows, columns, pixel)
                far = math.sqrt(dx * dx + dy * dy + dz * dz) / near
                clear = math.exp(-weather.extinction * far)
                x, y, z = eye[0] + dx / near, eye[1] + dy / near, eye[2] + dz / near
                beam = 0.0 if weather.beam == 0.0 else _beam(lamp, x, y, z)
                for c in range(3):
                    light = weather.light[c] + beam
                    kept[c] += 0.25 * clear * light
                    added[c] += 0.25 * (1.0 - clear) * weather.haze[c]
                    if n >= 0 and kinds[n] >= PLAIN:  # lamps are as bright as ever
                        added[c] += 0.25 * clear * (1.0 - light) * palette[kinds[n] - PLAIN, 3 + c]
            dx, dy, dz = ray(eye, i + 0.5, row + 0.5, rows, columns, pixel)
            toward = (dx * sun[0] + dy * sun[1] + dz * sun[2]) / math.sqrt(dx * dx + dy * dy + dz * dz)
            glare = 0.0
            if toward > 0.0:
                glare = VEIL / max(math.degrees(math.acos(min(toward, 1.0))), LEAST) ** 2
                glare += DISC * open_sky if toward > BLOOM else 0.0
            for c in range(3):
                picture[row, i, c] = picture[row, i, c] * kept[c] + max(added[c], 0.0) + glare * WARM[c]


@compiled
def _beam(lamp: Array, x: float, y: float, z: float) -> float:
    """Returns the light of the headlights on a point, as a share of daylight."""
    dx, dy, dz = x - lamp[0], y - lamp[1], z - lamp[2]
    ahead = dx * lamp[3] + dy * lamp[4] + dz * lamp[5]
    left = dx * lamp[6] + dy * lamp[7] + dz * lamp[8]
    up = dx * lamp[9] + dy * lamp[10] + dz * lamp[11]
    level = math.sqrt(ahead * ahead + left * left)
    if ahead <= 0.0:
        return 0.0
    below = min(max((CUT - up / level) / SOFT + 0.5, 0.0), 1.0)
    shape = (STRAY + (1.0 - STRAY) * below) * math.exp(-((math.atan2(left, ahead) / BROAD) ** 2))
    found: float = shape * min(1.0, BRIGHT * BRIGHT / (level * level + up * up))
    return found
