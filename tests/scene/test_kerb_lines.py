"""Where the edge line along a kerb lies in camera images, to a millimetre."""

import numpy as np
import pytest

from roadgpt.scene.network_mesh import _kerb_line


def test_along_a_kerb_lie_30_cm_of_asphalt_from_the_outer_edge_of_a_line_of_12_cm() -> None:
    """The carriageway is on the left; both ends overlap the road's own line by 5 cm, and all lies 6 mm up."""
    x = np.linspace(2.0, 12.0, 21)
    patch = _kerb_line(np.column_stack([x, np.full(21, 7.0), np.full(21, 1.5)]), 40.0)
    edge, inner = patch.points.reshape(-1, 2, 3).swapaxes(0, 1)
    along = np.r_[1.95, x[1:-1], 12.05]
    for side, y in ((edge, 6.94), (inner, 7.24)):
        assert side == pytest.approx(np.column_stack([along, np.full(21, y), np.full(21, 1.506)]), abs=1e-9)
    station, offset, _ = patch.attributes.reshape(-1, 2, 3).T
    assert pytest.approx(40.0 + np.stack([along, along], axis=1) - 1.95) == station.T
    assert offset[0] == pytest.approx(0.0)
    assert offset[1] == pytest.approx(-0.3)
    a, b, c = (patch.points[patch.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()  # seen from above
    assert patch.triangles.shape == (40, 3)


def test_around_an_island_the_line_is_closed_and_no_end_overlaps() -> None:
    angle = np.linspace(0.0, -2 * np.pi, 721)
    ring = np.column_stack([8 * np.cos(angle), 8 * np.sin(angle), np.zeros(721)])
    ring[-1] = ring[0]
    edge, inner = _kerb_line(ring, 0.0).points.reshape(-1, 2, 3).swapaxes(0, 1)
    assert np.hypot(*edge[:, :2].T) == pytest.approx(8 - 0.06, abs=1e-3)
    assert np.hypot(*inner[:, :2].T) == pytest.approx(8 + 0.24, abs=1e-3)
    assert edge[0] == pytest.approx(edge[-1], abs=0.02)
