"""Collects the data of the HTML page of a Run: its road, world, drive and marked places, as JSON values."""

from typing import Any

import numpy as np

from roadgpt.brief import sentence
from roadgpt.check.describing import describe
from roadgpt.errors import UsageError
from roadgpt.network import Route, has_no_route
from roadgpt.report.canvas import INK, LETTERS, OUTCOMES, SEVERE, VERMILLION, origin, outcome_of
from roadgpt.report.places import minor_places_of, places_of
from roadgpt.report.view.columns import FINE, MILLIMETRES, road_columns, rounded
from roadgpt.report.view.network import network_values
from roadgpt.road import Road, World
from roadgpt.road.land import Land
from roadgpt.road.profile import DASH, GAP, LINE
from roadgpt.run import Run
from roadgpt.scene.scene import landscape
from roadgpt.scene.trees import Trees
from roadgpt.verdict.severity import MOSTLY, PARTLY

FINEST = 400  # heights of the land are told to this part of the distance between two of its columns
MOST_STEPS = 6000  # of a drive; drives of up to 2 minutes are complete, longer drives are thinned
DRIVE = {
    "time": 3,
    "x": MILLIMETRES,
    "y": MILLIMETRES,
    "z": MILLIMETRES,
    "heading": FINE,
    "pitch": FINE,
    "roll": FINE,
    "speed": MILLIMETRES,
    "steer": FINE,
    "throttle": 2,
    "brake": 2,
    "s": MILLIMETRES,
    "t": MILLIMETRES,
    "outside": 4,
}
"""Columns of a drive that the page uses, and their decimals."""
WORLD = ("map_size", "friction", "speed_limit", "oob_tolerance", "z_floor")


SCALE = {"partly": PARTLY, "mostly": MOSTLY, "colours": [*SEVERE.values()][1:], "failed": VERMILLION}
"""The colours that show how far the car is outside its lane, and the shares of the car outside from which the
page says "partly" and "mostly".
"""
OF_FIRST_ROAD = "; height and curvature are those of the first road of the map"
"""Text that the page adds for a map without a route."""


def scene(run: Run) -> dict[str, Any]:
    """Returns everything that the HTML page shows of a Run, in metres, seconds and radians.

    Raises:
        UsageError: the Run has no road, or a number in the Run is not finite.
    """
    if run.road is None:
        raise UsageError(f"there is no road to show: {run.description}")
    more = {"network": network_values(run.road)} if isinstance(run.road, Route) else {}
    return {
        "title": run.title,
        "outcome": outcome_of(run),
        "colour": OUTCOMES.get(outcome_of(run), INK),
        "letters": LETTERS.get(OUTCOMES.get(outcome_of(run), INK), "#ffffff"),
        "description": run.description,
        "about": origin(run) + (OF_FIRST_ROAD if has_no_route(run.road) else ""),
        "words": _words(run.road),
        "road": _road(run.road, run.world),
        "land": _land(*landscape(run.world.lay(run.road), run.world)),
        "world": {name: run.world.values()[name] for name in WORLD},
        "marking": {"width": LINE, "dash": DASH, "gap": GAP},
        "severe": SCALE,
        "drive": _drive(run),
        "places": _places(run),
        **more,
    }


def _words(road: Road) -> str:
    """Returns the geometry in words; empty for a road that cannot be measured or a map without a route."""
    if has_no_route(road):
        return ""
    try:
        return sentence(describe(road))
    except UsageError:
        return ""


def _road(road: Road, world: World) -> dict[str, Any]:
    """Returns the values of a road; for a route, its edges stand for its rims, as the ground is the
    network's."""
    profile = world.profile_of(road)
    if not isinstance(road, Route):
        return road_columns(road, profile)
    made = road_columns(road, profile, profile.paved_reach)
    bounds = made["lanes"]["bounds"]
    made["lanes"]["rims"] = {"left": bounds[0]["t"], "right": bounds[-1]["t"]}
    return made


def _land(land: Land, trees: Trees) -> dict[str, Any]:
    """Returns heights row by row from south to north, each in units of ``unit`` metres as its difference from
    west + south - south-west, which is short; and of each tree x, y, z, height and width in decimetres, the
    number of its picture, and its brightness in percent."""
    unit = land.cell / FINEST
    steps = np.diff(np.diff(np.rint(land.heights / unit), axis=0, prepend=0), axis=1, prepend=0)
    of_trees = [10 * trees.places, 10 * trees.sizes, trees.looks[:, None], 100 * trees.tints[:, None]]
    return {
        "x": rounded(land.x, 1),
        "y": rounded(land.y, 1),
        "unit": unit,
        "heights": steps.astype(int).reshape(-1).tolist(),
        "trees": np.rint(np.concatenate(of_trees, axis=1)).astype(int).reshape(-1).tolist(),
    }


def _drive(run: Run) -> dict[str, Any] | None:
    drive, road = run.drive, run.road
    if drive is None or road is None:
        return None
    every = -(-len(drive) // MOST_STEPS)
    kept = np.unique(np.r_[np.arange(0, len(drive), every), len(drive) - 1])
    columns = {name: drive[name][kept] for name in DRIVE}
    columns["heading"] = np.unwrap(columns["heading"])
    height = drive["z"][0] - float(road.at(drive["s"][0], drive["t"][0])[2])
    return {
        "driver": drive.driver,
        "simulator": drive.simulator,
        "ended": drive.ended,
        "car": {**drive.car._asdict(), "height": round(float(height), MILLIMETRES)},
        "columns": {name: rounded(column, DRIVE[name]) for name, column in columns.items()},
    }


def _places(run: Run) -> list[dict[str, Any]]:
    found = []
    for place in [*minor_places_of(run), *places_of(run)]:  # the last one is drawn on top
        time = None if run.drive is None or place.step is None else float(run.drive["time"][place.step])
        named = {name: getattr(place, name) for name in ("x", "y", "s", "text", "colour", "letters")}
        found.append({**named, "time": time, "isMinor": place.is_minor})
    return found
