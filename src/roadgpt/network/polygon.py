"""Defines the type ``Area`` for areas in the plane, without loading shapely."""

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon

Area: TypeAlias = "Polygon | MultiPolygon"
"""One or more polygons, with holes where there are islands."""
