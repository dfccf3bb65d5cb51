"""Collects what the HTML page of a Run shows of a network: roads, junctions, islands, lines and signs.

The values can be written as JSON.
"""

from typing import Any

import numpy as np

from roadgpt.brief.junctions import NAMES
from roadgpt.geometry.curve import Array
from roadgpt.network import Route
from roadgpt.network.arrows import arrows
from roadgpt.network.ground import ground_of
from roadgpt.network.markings import PaintedStroke, between_crosswalks, signs, strokes
from roadgpt.network.paved import Area
from roadgpt.network.surface import JunctionSurface, NetworkSurface, free_ends, triangulated
from roadgpt.report.view.columns import MILLIMETRES, road_columns, rounded
from roadgpt.scene.junction_signs import faces_of
from roadgpt.scene.network_mesh import near_and_far

CENTIMETRES = 2  # digits, of outlines that are only drawn on the plan
NEAR, ROUGH = 0.01, 0.05  # m, by which outlines may be simplified: in 3-D, and on the plan


def network_values(route: Route) -> dict[str, Any]:
    """Returns everything that the HTML page shows of the network of a route, in metres.

    Raises:
        UsageError: A road of the network has a number that is not finite.
    """
    network, parts = route.network, NetworkSurface.of(route.network)
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
            "ground": _rings(ground_of(network)) if parts.shoulder > 0 else [],
            "paved": _rings(network.paved),
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
        "hasRoute": bool(route.legs),
        "shoulder": round(parts.shoulder, MILLIMETRES),
    }


def _area(area: JunctionSurface) -> dict[str, Any]:
    import shapely
    from shapely.geometry.polygon import orient

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
    """Returns the points of an area as one list x, y, x, y, and its triangles as one list of indices."""
    import shapely

    # corners that are rounded only later would turn thin triangles over
    points, corners = triangulated(shapely.set_precision(shapely.simplify(area, NEAR), 10.0**-MILLIMETRES))
    return {"points": rounded(points.reshape(-1), MILLIMETRES), "corners": corners.reshape(-1).tolist()}


def _simple(stroke: PaintedStroke) -> Array:
    """Returns the points of a stroke; of a long one inside a level junction, only as many as are needed."""
    import shapely

    if stroke.road is not None or len(stroke.points) < 3:
        return stroke.points
    flat = shapely.get_coordinates(shapely.simplify(shapely.LineString(stroke.points[:, :2]), NEAR))
    return np.column_stack([flat, np.full(len(flat), stroke.points[0, 2])])


def _points(points: Array) -> list[float]:
    return rounded(points.reshape(-1), MILLIMETRES)


def _rings(area: Area, tolerance: float = ROUGH) -> list[list[float]]:
    """Returns the outlines of an area and of its holes, each as one list x, y, x, y."""
    import shapely

    parts = shapely.get_parts(shapely.simplify(area, tolerance))
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    return [rounded(np.asarray(ring.coords, float)[:-1, :2].reshape(-1), CENTIMETRES) for ring in rings]
