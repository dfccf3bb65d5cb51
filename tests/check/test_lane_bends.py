"""The tightest bend of a lane whose width varies, against differences of points along its line."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from roadgpt.check.rules.connection_too_tight import tightest_radius
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.pieces import Piece, PieceCurve

LENGTH = 60.0  # m


@dataclass(frozen=True, eq=False)
class Member:
    """What a road through a junction has of this."""

    road: Any
    profile: Any


def member(k0: float, k1: float, width: CubicProfile) -> Member:
    plan = PieceCurve(0.0, 0.0, 0.3, (Piece(LENGTH, k0, k1),))
    return Member(SimpleNamespace(plan=plan), SimpleNamespace(right=[SimpleNamespace(width=width)]))


def curvature_by_differences(seen: Member, share: float) -> np.ndarray:
    """The curvature at stations of the line, without those at its ends."""
    plan, width = seen.road.plan, seen.profile.right[0].width
    s = np.linspace(0, LENGTH, 24_001)
    points, heading = plan.at(s), plan.heading(s)
    aside = -share * width.height(np.minimum(s, LENGTH - 1e-9))
    x, y = points[:, 0] - aside * np.sin(heading), points[:, 1] + aside * np.cos(heading)
    dx, dy = np.gradient(x, s, edge_order=2), np.gradient(y, s, edge_order=2)
    turn = dx * np.gradient(dy, s, edge_order=2) - dy * np.gradient(dx, s, edge_order=2)
    return (turn / np.hypot(dx, dy) ** 3)[3:-3]


@pytest.mark.parametrize(("k0", "k1"), [(0.0, -0.05), (-0.02, 0.04), (0.05, 0.05), (-0.04, 0.0)])
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_the_tightest_bend_is_that_of_the_points(k0: float, k1: float, share: float) -> None:
    # from 3 m to 7 m over the whole road, so that the change of the curvature and of the width both count
    wider = CubicProfile((0.0,), ((3.0, 0.0, 3 * 4 / LENGTH**2, -2 * 4 / LENGTH**3),))
    seen = member(k0, k1, wider)
    curvature = curvature_by_differences(seen, share)
    for only_right, bends in ((False, np.abs(curvature)), (True, -curvature)):
        found = tightest_radius(seen, share, only_right)
        assert 1 / found == pytest.approx(max(bends.max(), 0.0), abs=1e-4)
