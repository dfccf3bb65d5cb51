"""Collects what all pages share, as films have it: light, colours, cameras, the car, sky and trees.

Colours are linear and lengths are in metres.
"""

import base64
import io
from functools import cache
from typing import Any

import numpy as np
from PIL import Image

from roadgpt.export.ego import CAR
from roadgpt.export.embankments import FOOT, OUTSIDE, RUN
from roadgpt.report.view.columns import rounded
from roadgpt.scene.camera import MOUNTS
from roadgpt.scene.car import saloon
from roadgpt.scene.light import DIRECT, SUN, daylight
from roadgpt.scene.mesh import PLAIN
from roadgpt.scene.network_mesh import COLOURS
from roadgpt.scene.palette import CONCRETE, GLASS, PAINT, PALETTE, SHINING
from roadgpt.scene.shade import AIR, panorama, to_screen
from roadgpt.scene.surfaces import ASPHALT, DRIER, LUSH, PAINTED, STONES
from roadgpt.scene.textures import noise, screen_table
from roadgpt.scene.trees import SIDE, pictures

LOWEST = -0.03  # rad, elevation of the lowest row of the sky's picture
SKY, QUALITY = (224, 1536, 3), 70  # rows and columns of the sky's picture; its quality as JPEG
SHADES = 32  # colours of the trees' picture
FINE = 4  # digits of a colour


@cache
def scenery() -> dict[str, Any]:
    """Returns what all pages share, as values for JSON."""
    below, above = daylight(np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    plain = [rounded(row[:3] + row[3:], FINE) for row in PALETTE]
    named = {name: plain[kind - PLAIN] for name, kind in [*COLOURS.items(), ("concrete", CONCRETE)]}
    return {
        "light": {"sun": SUN.tolist(), "direct": DIRECT, "above": above - DIRECT * SUN[2], "below": below},
        "colours": named
        | {"asphalt": [ASPHALT] * 3, "paint": PAINTED, "gravel": STONES, "haze": AIR}
        | {"lush": LUSH, "dry": np.add(LUSH, DRIER).tolist()},
        "plain": plain,
        "mounts": {name: MOUNTS[name]._asdict() for name in ("bonnet", "chase")},
        "car": _car(),
        "banks": {"run": RUN, "foot": FOOT, "outside": OUTSIDE},
        "sky": {"lowest": LOWEST, "picture": _sky()},
        "trees": _trees(),
    }


def _car() -> dict[str, Any]:
    """Returns the points of the car's hull in millimetres and, from number ``wheel`` on, those of its first
    wheel; and the hubs of all wheels: x, y, z, and whether the wheel steers."""
    wheels, mesh = saloon().wheels, saloon().mesh
    first = wheels[0][0]
    inside = (mesh.triangles < first.stop).all(axis=1)
    return {
        "points": np.rint(1000 * mesh.points[: first.stop]).astype(int).reshape(-1).tolist(),
        "corners": mesh.triangles[inside].reshape(-1).tolist(),
        "kinds": (mesh.kinds[inside] - PLAIN).tolist(),
        "wheel": first.start,
        "hubs": [[*rounded(hub, FINE), steers] for _, hub, steers in wheels],
        "length": CAR.length,
        "width": CAR.width,
        "braking": SHINING,
        "glossy": [PAINT - PLAIN, GLASS - PLAIN],
    }


def _sky() -> str:
    """Returns a picture of the whole sky as a data URL, in the projection of ``panorama``."""
    sky, shown = np.empty(SKY, np.float32), np.empty(SKY, np.uint8)
    panorama(noise(), LOWEST, sky)
    to_screen(sky, screen_table(), shown)
    return _address(Image.fromarray(shown), "jpeg", quality=QUALITY)


def _trees() -> str:
    """Returns the pictures of all trees side by side as a data URL."""
    table = screen_table()
    drawn = np.concatenate([*pictures()[:, : SIDE * SIDE].reshape(-1, SIDE, SIDE, 4)], axis=1)
    shown = table[np.rint(np.clip(drawn, 0, 1) * (len(table) - 1)).astype(int)]
    is_tree = drawn[..., 3] > 0
    shown[..., 3] = 255 * is_tree
    shown[~is_tree, :3] = shown[is_tree, :3].mean(axis=0)  # no dark rims when filtered
    few = Image.fromarray(shown, "RGBA").quantize(SHADES, method=Image.Quantize.FASTOCTREE)
    return _address(few, "png")


def _address(image: Image.Image, kind: str, **options: Any) -> str:
    data = io.BytesIO()
    image.save(data, kind, optimize=True, **options)
    return f"data:image/{kind};base64,{base64.b64encode(data.getvalue()).decode('ascii')}"
