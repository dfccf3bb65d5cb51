"""Makes an HTML page that shows one or two roads in 3-D and replays their drives. Main function: ``write``.

The page needs no server and no network: it contains its scripts, styles and data, and its content security
policy forbids requests. The scripts are in ``page/`` and are joined in the order of SCRIPTS; three.js is in
``three/``, with its licence."""

import base64
import html
import io
import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from PIL import Image
from shapely.geometry.polygon import orient

from roadgpt.brief import sentence
from roadgpt.brief.junctions import NAMES
from roadgpt.brief.scene import Scene, scene_text
from roadgpt.brief.visibility import amount_in
from roadgpt.check.describing import describe
from roadgpt.errors import ExportError, RoadGPTError, UsageError, explained
from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array
from roadgpt.ground.mesh import GroundMesh, mesh_of, water_of
from roadgpt.language.table import ROAD_USERS, WEATHER
from roadgpt.network import network_of, only_road
from roadgpt.network.markings import PaintedStroke, arrows, between_crosswalks, signs, strokes
from roadgpt.network.paved import Area, bays_of
from roadgpt.network.route import area_with_verges
from roadgpt.network.structures import solids
from roadgpt.network.surface import JunctionSurface, NetworkSurface, free_ends, triangulated
from roadgpt.report.birds_eye import minor_places_of, places_of
from roadgpt.report.canvas import INK, LETTERS, OUTCOMES, SEVERE, VERMILLION, origin, outcome_of
from roadgpt.report.others import look_of
from roadgpt.report.plan_view import rings_of
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import stations
from roadgpt.road.profile import DASH, GAP, LINE
from roadgpt.run import Run
from roadgpt.run.atomic import write_whole
from roadgpt.scene.camera import MOUNTS
from roadgpt.scene.car import saloon
from roadgpt.scene.light import (
    CONCRETE,
    DIRECT,
    GLASS,
    PAINT,
    PALETTE,
    SHINING,
    SUN,
    WATER,
    daylight,
    screen_table,
)
from roadgpt.scene.mesh import PLAIN
from roadgpt.scene.network_mesh import COLOURS, ROCK, faces_of, near_and_far
from roadgpt.scene.patterns import noise
from roadgpt.scene.scene import landscape
from roadgpt.scene.shade import AIR, ASPHALT, DRIER, LUSH, PAINTED, ROCKS, STONES, panorama, to_screen
from roadgpt.scene.trees import SIDE, pictures
from roadgpt.scene.weather import Weather
from roadgpt.traffic.actor import STEP
from roadgpt.verdict.measures import measure
from roadgpt.verdict.oracle import is_outside
from roadgpt.verdict.verdict import MOSTLY, PARTLY

__all__ = ["page", "page_of", "scene", "write"]

MOST = 2  # roads on one page
HERE = Path(__file__).parent
SCRIPTS = (
    "numbers.js",
    "trip.js",
    "grain.js",
    "ribbon.js",
    "network.js",
    "land.js",
    "signs.js",
    "car.js",
    "others.js",
    "weather.js",
    "stage.js",
    "cameras.js",
    "plan.js",
    "strip.js",
    "panel.js",
    "controls.js",
    "main.js",
)


def page(runs: Sequence[Run]) -> str:
    """Returns the whole page, to be written as UTF-8; the same Runs give the same text."""
    if not 1 <= len(runs) <= MOST:
        raise UsageError(f"a page shows one road or two side by side; {len(runs)} are given")
    return page_of([scene(run) for run in runs])


def page_of(scenes: Sequence[Mapping[str, Any]]) -> str:
    """Returns the page for one or two scenes made by ``scene``; empty parts of a scene are not shown."""
    title = " and ".join(dict.fromkeys(each["title"] for each in scenes))
    parts = {
        "TITLE": html.escape(title.encode("ascii", "xmlcharrefreplace").decode()).replace("&amp;#", "&#"),
        "STYLE": _part("page/style.css"),
        "LICENCE": _part("three/LICENSE"),
        "THREE": _part("three/three.min.js"),
        "SCRIPT": "\n".join(_part(f"page/{name}") for name in SCRIPTS),
        "SCENERY": embedded(scenery()),
        "DATA": embedded(scenes),
    }
    # in one pass, so that no text in a description is mistaken for a placeholder
    return re.sub("@@([A-Z]+)@@", lambda found: parts[found[1]], _part("page/page.html"))


def write(runs: Sequence[Run], path: Path | str) -> Path:
    """Writes the page into a file, which is replaced if it exists, and returns the path."""
    path = Path(path)
    text = page(runs)
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
    return path


def embedded(data: object) -> str:
    """Returns data as JSON that is safe inside a script element: ASCII without ``<``, ``>`` and ``&``."""
    try:
        text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"), sort_keys=True)
    except ValueError as error:
        raise UsageError("the road has a number that is not finite; check it before it is shown") from error
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


@cache
def _part(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


MOST_STEPS = 6000  # of a drive; drives of up to 2 minutes are complete, longer drives are thinned
MILLIMETRES, FINE = 3, 5  # digits
CENTIMETRES = 2  # digits, of outlines that are only drawn on the plan
DRIVE = {
    **dict.fromkeys(("time", "x", "y", "z", "speed", "s", "t"), MILLIMETRES),
    **dict.fromkeys(("heading", "pitch", "roll", "steer"), FINE),
    **dict.fromkeys(("throttle", "brake"), 2),
    "outside": 4,
}
"""Columns of a drive that the page uses, and their decimals."""
OF_LOOKS = ("group", "look", "paint", "lamps", "blue_light")
OF_OTHERS = {"x": CENTIMETRES, "y": CENTIMETRES, "z": CENTIMETRES, "heading": 3, "speed": 2}
"""Columns of the states of others, and their decimals."""
LONGEST, CRITICAL = 20.0, 1.5
"""The longest time to collision in seconds that the page is told; and below which time it is usually called
critical (van der Horst 1990)."""
WORLD = ("map_size", "friction", "speed_limit", "z_floor")
SCALE = {"partly": PARTLY, "mostly": MOSTLY, "colours": [*SEVERE.values()][1:], "failed": VERMILLION}
"""The colours that show how far the car is outside its lane, and the shares of the car outside from which the
page says "partly" and "mostly"."""
OF_FIRST_ROAD = "; height and curvature are those of the first road of the map"
"""Text that the page adds for a map without a route."""
NEAR, ROUGH = 0.01, 0.05  # m, by which outlines may be simplified: in 3-D, and on the plan
CHORD = 0.01  # m, largest distance between the road and the drawn lines


def scene(run: Run) -> dict[str, Any]:
    """Returns everything that the HTML page shows of a Run, in metres, seconds and radians."""
    if run.road is None:
        raise UsageError(f"there is no road to show: {run.description}")
    is_only = only_road(run.road, run.world) is not None
    more = {} if is_only else {"network": network_values(run.road, run.world)}
    conditions = {name: getattr(run.world.scene, name) for name in ("weather", "light")}
    if weather := Weather.of(run.world.scene, run.road):
        falls = [(WEATHER[air.kind].falls, amount_in(air)) for air in run.world.scene.weather]
        drops = [{**kind._asdict(), "amount": amount} for kind, amount in falls if kind]
        more["weather"] = {**weather._asdict(), "falls": drops}
    return {
        "title": run.title,
        "outcome": outcome_of(run),
        "colour": OUTCOMES.get(outcome_of(run), INK),
        "letters": LETTERS.get(OUTCOMES.get(outcome_of(run), INK), "#ffffff"),
        "description": run.description,
        "about": "; ".join(filter(None, [origin(run), scene_text(Scene(**conditions))]))
        + ("" if run.road.has_way else OF_FIRST_ROAD),
        "words": _words(run.road),
        "road": _road(run.road, run.world, is_only),
        "land": _land(run.world.lay(run.road), run.world),
        "world": {name: run.world.values()[name] for name in WORLD},
        "marking": {"width": LINE, "dash": DASH, "gap": GAP},
        "severe": SCALE,
        "drive": _drive(run),
        **_others(run),
        "places": _places(run),
        "events": [vars(each) for each in (run.verdict and run.verdict.events) or ()],
        **more,
    }


def _words(road: Road) -> str:
    if not road.has_way:
        return ""
    try:
        return sentence(describe(road))
    except UsageError:
        return ""


def _road(road: Road, world: World, is_only: bool) -> dict[str, Any]:
    """Returns the values of a road; a route's edges stand for its rims, as the ground is the network's."""
    profile = world.profile_of(road)
    if is_only:
        return road_columns(road, profile)
    made = road_columns(road, profile, profile.paved_reach)
    bounds = made["lanes"]["bounds"]
    made["lanes"]["rims"] = {"left": bounds[0]["t"], "right": bounds[-1]["t"]}
    return made


def _land(road: Road, world: World) -> dict[str, Any]:
    """Returns the ground, its water, and bridges and tunnels as points and corners of triangles; and of each
    tree x, y, z, height and width in decimetres, the number of its picture, and its brightness in percent."""
    ground, trees = landscape(road, world)
    built = [*solids(network_of(road, world), ground), np.empty((0, 3, 3))]
    corners = np.concatenate(built).reshape(-1, 3)
    of_trees = [10 * trees.places, 10 * trees.sizes, trees.looks[:, None], 100 * trees.tints[:, None]]
    (x0, x1), (y0, y1) = ground.x[[0, -1]], ground.y[[0, -1]]
    return {
        "ground": _mesh(mesh_of(ground)),
        "water": _mesh(water_of(ground)),
        "solids": _mesh(GroundMesh(corners, np.arange(len(corners)).reshape(-1, 3))),
        "isLaid": bool(ground.pavement.rims),
        "middle": rounded(np.array([x0 + x1, y0 + y1]) / 2, 1),
        "wide": round(max(x1 - x0, y1 - y0) / 2 + 1.0, 1),
        "trees": np.rint(np.concatenate(of_trees, axis=1)).astype(int).reshape(-1).tolist(),
    }


def _mesh(mesh: GroundMesh) -> dict[str, str]:
    """Returns triangles as text: whole numbers of 32 bits in base 64, the points in centimetres."""
    parts = {"points": np.rint(100 * mesh.points), "corners": mesh.triangles}
    return {name: base64.b64encode(part.astype("<i4").tobytes()).decode() for name, part in parts.items()}


def _drive(run: Run) -> dict[str, Any] | None:
    drive, road = run.drive, run.road
    if drive is None or road is None:
        return None
    every = -(-len(drive) // MOST_STEPS)
    kept = np.unique(np.r_[np.arange(0, len(drive), every), len(drive) - 1])
    columns = {name: drive[name][kept] for name in DRIVE}
    columns["heading"] = np.unwrap(columns["heading"])
    failed = is_outside(road, drive, run.world)[kept]
    middle = run.world.profile_of(drive.followed(road, run.world)).middle(columns["s"])
    height = drive["z"][0] - float(road.at(drive["s"][0], drive["t"][0])[2])
    return {
        "driver": drive.driver,
        "simulator": drive.simulator,
        "ended": drive.ended,
        "car": {**drive.car._asdict(), "height": round(float(height), MILLIMETRES)},
        "columns": {name: rounded(column, DRIVE[name]) for name, column in columns.items()}
        | {"failed": failed.astype(int).tolist()}
        | ({"middle": rounded(middle, MILLIMETRES)} if drive.moves else {}),
    }


def _others(run: Run) -> dict[str, Any]:
    """Returns how the others on the road moved, each from the first sample in which it is there."""
    tracks = None if run.drive is None else run.drive.others
    if tracks is None:
        return {}
    actors = []
    for number, actor in enumerate(tracks.actors):
        there = np.flatnonzero(~np.isnan(tracks.states[:, number, 0]))
        states = tracks.states[there[0] : there[-1] + 1, number]
        columns = zip(OF_OTHERS.items(), states.T, strict=True)
        actors.append({
            **actor.size._asdict(),
            "name": actor.name,
            "colour": look_of(actor.kind)[1],
            **{name: getattr(ROAD_USERS[actor.kind], name) for name in OF_LOOKS},
            "first": int(there[0]),
            **{name: rounded(column, digits) for (name, digits), column in columns},
        })  # fmt: skip
    return {"others": {"step": STEP, "actors": actors, **_closest(run)}} if actors else {}


def _closest(run: Run) -> dict[str, Any]:
    """Returns the smallest conflict time with anybody at each sample, and who it is; the smallest time to
    collision; the gap to who is ahead in the lane, or else the distance to who is nearest, who it is, and
    which of both; and where the tested car touched somebody."""
    assert run.road is not None
    assert run.drive is not None
    assert run.drive.others is not None
    measured = measure(run.world.lay(run.road), run.drive, run.world)
    near = {name: getattr(measured, name).min(axis=1) for name in ("conflict", "ttc")}
    height = np.interp(measured.time, run.drive["time"], run.drive["z"]) - run.drive.car.height
    told: dict[str, Any] = {
        name: [round(float(each), CENTIMETRES) if each < LONGEST else None for each in times]
        for name, times in near.items()
    }
    contacts = []
    for each in (run.verdict and run.verdict.incidents) or ():
        if each.contact:
            z = float(np.interp(each.at_time, measured.time, height))
            place = zip("xyz", rounded(np.array([*each.contact.xy, z]), CENTIMETRES), strict=True)
            contacts.append({**dict(place), "time": round(each.at_time, MILLIMETRES)})
    told |= {"who": measured.conflict.argmin(axis=1).tolist(), "critical": CRITICAL}
    is_ahead = np.asarray(np.isfinite(measured.gap).any(axis=1))
    away = np.where(is_ahead.reshape(-1, 1), measured.gap, measured.distance)
    told |= {"whom": away.argmin(axis=1).tolist(), "isAhead": is_ahead.tolist()}
    told["away"] = [round(m, 1) if np.isfinite(m) else None for m in away.min(axis=1).tolist()]
    return {"near": told, "contacts": contacts}


def _places(run: Run) -> list[dict[str, Any]]:
    found = []
    for place in [*minor_places_of(run), *places_of(run)]:  # the last one is drawn on top
        time = None if run.drive is None or place.step is None else float(run.drive["time"][place.step])
        named = {name: getattr(place, name) for name in ("x", "y", "s", "text", "colour", "letters")}
        found.append({**named, "time": time, "isMinor": place.is_minor})
    return found


def network_values(route: Road, world: World) -> dict[str, Any]:
    """Returns everything that the HTML page shows of the network of a route, in metres."""
    network = network_of(route, world)
    parts = NetworkSurface.of(network)
    bays = bays_of([each.road for each in network.roads_outside])
    roads = []
    for each in parts.roads:
        columns = road_columns(each.road, each.profile, median=between_crosswalks(network, each))
        roads.append({**columns, "ends": list(free_ends(network, each))})
    return {
        "roads": roads,
        "areas": [_area(area) for area in parts.areas],
        "strokes": [
            {"kind": stroke.kind, "width": stroke.width, "points": _points(_simple(stroke))}
            for stroke in strokes(network)
        ],
        "arrows": [
            {"points": _points(arrow.points), "corners": arrow.corners.reshape(-1).tolist()}
            for arrow in arrows(network)
        ],
        "signs": [
            {"colour": face.colour, "points": _points(face.points)}
            for sign in signs(network)
            for face in faces_of(sign)
        ],
        "plan": {
            "ground": _rings(area_with_verges(network)) if parts.shoulder > 0 else [],
            "paved": [ring for area in (network.paved, *bays) for ring in _rings(area)],
            "kerbed": [ring for area in parts.areas for island in area.kerbed for ring in _rings(island)],
            "green": [ring for area in parts.areas for island in area.green for ring in _rings(island)]
            if parts.shoulder > 0
            else [],
        },
        "stretches": [
            {
                "from": round(each.start, MILLIMETRES),
                "to": round(each.end, MILLIMETRES),
                "name": NAMES[each.entered.kind][0],
            }
            for each in route.passages
        ],
        "hasRoute": route.has_way,
        "shoulder": round(parts.shoulder, MILLIMETRES),
    }


def _area(area: JunctionSurface) -> dict[str, Any]:
    has_ground = not area.shoulder.is_empty
    whole = shapely.union_all([area.paved, area.shoulder, *area.kerbed, *area.green])
    rims = [orient(shapely.Polygon(part.exterior)) for part in shapely.get_parts(whole)]
    return {
        "z": round(area.height, MILLIMETRES),
        "paved": _triangles(area.paved),
        "shoulder": [_triangles(part) for part in near_and_far(area) if not part.is_empty],
        "green": [_triangles(island) for island in area.green] if has_ground else [],
        "kerbed": [{**_triangles(island), "rim": _rings(orient(island), NEAR)[0]} for island in area.kerbed],
        "rims": [_rings(rim, NEAR)[0] for rim in rims],
    }


def _triangles(area: Area) -> dict[str, Any]:
    # corners that are rounded only later would turn thin triangles over
    points, corners = triangulated(shapely.set_precision(shapely.simplify(area, NEAR), 10.0**-MILLIMETRES))
    return {"points": rounded(points.reshape(-1), MILLIMETRES), "corners": corners.reshape(-1).tolist()}


def _simple(stroke: PaintedStroke) -> Array:
    if stroke.road is not None or len(stroke.points) < 3:
        return stroke.points
    flat = shapely.get_coordinates(shapely.simplify(shapely.LineString(stroke.points[:, :2]), NEAR))
    return np.column_stack([flat, np.full(len(flat), stroke.points[0, 2])])


def _points(points: Array) -> list[float]:
    return rounded(points.reshape(-1), MILLIMETRES)


def _rings(area: Area, tolerance: float = ROUGH) -> list[list[float]]:
    rings = rings_of(shapely.simplify(area, tolerance))
    return [rounded(ring[:-1].reshape(-1), CENTIMETRES) for ring in rings]


def road_columns(
    road: Road, profile: Profile, reach: float | None = None, median: tuple[float, float] | None = None
) -> dict[str, Any]:
    """Returns a road's cross-section, and its geometry at stations close enough to draw the road. Values are
    in metres and radians, the curvature is in 1/m, and the grade is a ratio.

    ``reach`` is the largest offset of any line that is drawn along the road; None: the profile's ``reach``.
    ``median`` is the first and the last station of grass on the profile's median; None: the whole road."""
    try:
        s = stations(road, profile.reach if reach is None else reach, CHORD)
    except ExportError as error:
        raise UsageError("the road has a number that is not finite; check it before it is shown") from error
    points = road.at(s)
    return {
        "length": road.length,
        "s": rounded(s, MILLIMETRES),
        "x": rounded(points[:, 0], MILLIMETRES),
        "y": rounded(points[:, 1], MILLIMETRES),
        "z": rounded(points[:, 2], MILLIMETRES),
        "heading": rounded(np.unwrap(road.heading(s)), FINE),
        "curvature": rounded(road.curvature(s), FINE),
        "grade": rounded(road.grade(s), FINE),
        "lanes": {**_lanes(profile, s), "median": _median(profile, median or (0.0, road.length))},
    }


def _median(profile: Profile, span: tuple[float, float]) -> dict[str, float] | None:
    if not profile.is_divided:
        return None
    left, right = profile.carriageway
    kinds = [lane.kind for lane in (*profile.left[:left][::-1], *profile.right[:right])]
    first, last = (round(each, MILLIMETRES) for each in span)
    return {"strip": kinds.index("median"), "from": first, "to": last}


def _lanes(profile: Profile, s: Array) -> dict[str, Any]:
    rims, edges = profile.rims(s), profile.edges(s)
    shoulder = min((rims.left - edges.left).min(), (edges.right - rims.right).min())
    return {
        "bounds": [{"marking": mark, "t": _offsets(t)} for mark, t in profile.boundaries(s)],
        "driven": profile.boundaries_to_left,
        "bays": [
            [_offsets(t) for t in profile.edges_of(number, s)]
            for number, lane in profile.lanes.items()
            if lane.kind == "parking"
        ],
        "middle": _offsets(profile.middle(s)),
        "rims": {"left": _offsets(rims.left), "right": _offsets(rims.right)},
        "shoulder": round(float(shoulder), MILLIMETRES),
        "reach": round(profile.reach, MILLIMETRES),
        "bank": None if profile.superelevation_angle is None else rounded(profile.superelevation(s), FINE),
    }


def _offsets(t: Array) -> float | list[float]:
    found = rounded(t, MILLIMETRES)
    return found[0] if len(set(found)) == 1 else found


def rounded(values: Array, digits: int) -> list[float]:
    """Returns the values as a list of numbers rounded to ``digits`` decimals."""
    return [round(float(value), digits) for value in values]


LOWEST = -0.03  # rad, elevation of the lowest row of the sky's picture
SKY, QUALITY = (224, 1536, 3), 70  # rows and columns of the sky's picture; its quality as JPEG
HUES = 32  # colours of the trees' picture
COLOUR = 4  # digits of a colour


@cache
def scenery() -> dict[str, Any]:
    """Returns what all pages share, as values for JSON."""
    below, above = daylight(np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]))
    plain = [rounded(row[:3] + row[3:], COLOUR) for row in PALETTE]
    named = {
        name: plain[kind - PLAIN]
        for name, kind in [*COLOURS.items(), ("concrete", CONCRETE), ("water", WATER)]
    }
    return {
        "light": {"sun": SUN.tolist(), "direct": DIRECT, "above": above - DIRECT * SUN[2], "below": below},
        "colours": named
        | {"asphalt": [ASPHALT] * 3, "paint": PAINTED, "gravel": STONES, "haze": AIR}
        | {"rock": ROCKS, "lush": LUSH, "dry": np.add(LUSH, DRIER).tolist()},
        "plain": plain,
        "mounts": {name: MOUNTS[name]._asdict() for name in ("bonnet", "chase")},
        "car": _car(),
        "rock": {"from": ROCK[0], "to": ROCK[1]},
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
        "hubs": [[*rounded(hub, COLOUR), steers] for _, hub, steers in wheels],
        "length": CAR.length,
        "width": CAR.width,
        "braking": SHINING,
        "glossy": [PAINT - PLAIN, GLASS - PLAIN],
    }


def _sky() -> str:
    sky, shown = np.empty(SKY, np.float32), np.empty(SKY, np.uint8)
    panorama(noise(), LOWEST, sky)
    to_screen(sky, screen_table(), shown)
    return _address(Image.fromarray(shown), "jpeg", quality=QUALITY)


def _trees() -> str:
    table = screen_table()
    drawn = np.concatenate([*pictures()[:, : SIDE * SIDE].reshape(-1, SIDE, SIDE, 4)], axis=1)
    shown = table[np.rint(np.clip(drawn, 0, 1) * (len(table) - 1)).astype(int)]
    is_tree = drawn[..., 3] > 0
    shown[..., 3] = 255 * is_tree
    shown[~is_tree, :3] = shown[is_tree, :3].mean(axis=0)  # no dark rims when filtered
    few = Image.fromarray(shown, "RGBA").quantize(HUES, method=Image.Quantize.FASTOCTREE)
    return _address(few, "png")


def _address(image: Image.Image, kind: str, **options: Any) -> str:
    data = io.BytesIO()
    image.save(data, kind, optimize=True, **options)
    return f"data:image/{kind};base64,{base64.b64encode(data.getvalue()).decode('ascii')}"
