"""Defines plane curves and elevation profiles, independent of lanes and other properties of roads.

A plane curve has the methods ``at(s)``, ``heading(s)`` and ``curvature(s)``, where ``s`` is the exact arc
length. An elevation profile has the methods ``height(s)``, ``grade(s)`` and ``vertical_curvature(s)``, where
``s`` is the arc length of the plane curve below it."""

from roadgpt.geometry.curve import ElevationProfile, PlanCurve, wrap_angle
from roadgpt.geometry.elevation import CubicProfile, GradeProfile, shifted
from roadgpt.geometry.nearness import project
from roadgpt.geometry.pieces import Piece, PieceCurve
from roadgpt.geometry.spline import SplineCurve, SplineProfile, interpolate, radii, walked

__all__ = [
    "CubicProfile",
    "ElevationProfile",
    "GradeProfile",
    "Piece",
    "PieceCurve",
    "PlanCurve",
    "SplineCurve",
    "SplineProfile",
    "interpolate",
    "project",
    "radii",
    "shifted",
    "walked",
    "wrap_angle",
]
