"""Curves and frames of reference: makes planar curves and height profiles, and knows no roads.

A plan curve answers ``at(s)``, ``heading(s)`` and ``curvature(s)`` by exact arc length; a profile answers
``height(s)``, ``grade(s)`` and ``vertical_curvature(s)`` at the same stations.
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
