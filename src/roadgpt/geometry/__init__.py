"""Plane curves and elevation profiles. This room knows nothing about roads.

A plane curve answers ``at(s)``, ``heading(s)`` and ``curvature(s)`` at an exact arc length ``s``. An
elevation profile answers ``height(s)``, ``grade(s)`` and ``vertical_curvature(s)`` at the same stations.
"""

from roadgpt.geometry.curve import ElevationProfile, PlanCurve, wrap_angle
from roadgpt.geometry.elevation import CubicProfile, GradeProfile, shifted
from roadgpt.geometry.pieces import Piece, PieceCurve
from roadgpt.geometry.projection import project
from roadgpt.geometry.spline import SplineCurve, SplineProfile, interpolate, walked

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
    "shifted",
    "walked",
    "wrap_angle",
]
