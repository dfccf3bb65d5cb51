"""Our engine beside CommonRoad's multibody model, both with the parameters of its BMW 320i."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

_PATH = Path(__file__).parents[2] / "benchmarks" / "multibody.py"
_spec = importlib.util.spec_from_file_location("multibody", _PATH)
multibody = importlib.util.module_from_spec(_spec)
sys.modules["multibody"] = multibody
_spec.loader.exec_module(multibody)


@pytest.mark.parametrize(
    ("steer", "least", "most"), [(0.01, 0.15, 0.25), (0.02, 0.35, 0.42), (0.034, 0.62, 0.70)]
)
def test_a_step_of_the_steering_at_80_kmh(steer, least, most):
    compared = multibody.step_steer(steer)
    assert least <= compared.lateral_g <= most
    assert compared.yaw_error <= 0.06
    ours, theirs = compared.ours[-1], compared.theirs[-1]
    assert ours[1] == pytest.approx(theirs[1], abs=0.15)  # m/s lost on the way
    assert ours[2] == pytest.approx(theirs[2], rel=0.10)  # rad of roll


def test_both_are_the_same_car():
    car = multibody.bmw_320i()
    p = multibody.parameters_vehicle2()
    assert car.mass == pytest.approx(p.m, rel=1e-6)
    assert car.wheelbase == pytest.approx(p.a + p.b)
    # The whole car's yaw inertia: the body's, and the wheels' masses at their places.
    wheels = sum(
        2 * axle.unsprung_mass * (axle.position**2 + axle.track_width**2 / 4)
        for axle in (car.front, car.rear)
    )
    assert car.yaw_inertia + wheels == pytest.approx(p.I_z)


def test_before_the_step_both_go_straight():
    compared = multibody.step_steer(0.02)
    before = compared.time < multibody.START
    # Their tyre has ply forces that change sign with the camber: even on the straight both rock a little.
    assert np.abs(compared.ours[before, 0]).max() < 5e-4
    assert np.abs(compared.theirs[before, 0]).max() < 5e-4
