"""Names the class of areas in the plane; shapely is loaded when the first area is computed."""

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon

Area: TypeAlias = "Polygon | MultiPolygon"
"""One or more polygons, with holes where there are islands."""
