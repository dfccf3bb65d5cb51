"""Our engine beside CommonRoad's multibody model (29 states, BMW 320i), with the same parameters.

M. Althoff, G. Wuersching: CommonRoad: Vehicle Models, 2020. Used by tests/authorities/test_multibody.py and
by bench_drive.py.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from vehiclemodels.init_mb import init_mb
from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

from roadgpt.drive.simulators.mujoco import Axle, Car, Tyre, plane

SPEED = 80 / 3.6  # m/s
STEER_RATE = 0.4  # rad/s, the most that CommonRoad's BMW allows
DURATION = 3.0  # s
START = 0.2  # s


@dataclass(frozen=True)
class Comparison:
    """Both models after the same step of the steering."""

    steer: float
    """rad."""
    time: np.ndarray
    ours: np.ndarray
    """Columns yaw rate (rad/s), speed (m/s), roll (rad)."""
    theirs: np.ndarray

    @property
    def lateral_g(self) -> float:
        """Steady lateral acceleration of their model, in g."""
        return float(self.theirs[-1, 0] * self.theirs[-1, 1] / 9.81)

    @property
    def yaw_error(self) -> float:
        """Root of the mean square difference of the yaw rates, over their peak."""
        gap = self.ours[:, 0] - self.theirs[:, 0]
        return float(np.sqrt(np.mean(gap**2)) / np.abs(self.theirs[:, 0]).max())


def bmw_320i() -> Car:
    """CommonRoad's vehicle 2 as a Car of ours."""
    p = parameters_vehicle2()
    t = p.tire
    # Their axes are SAE's (y to the right, z down), so their turn is the mirror image of ours and camber
    # terms change sign. They have no relaxation; ours is made as short as the step allows. Their yaw inertia
    # is that of the whole car, ours of the body, so the wheels' share is taken off.
    common = {
        "peak_friction_x": t.p_dx1,
        "peak_friction_y": t.p_dy1,
        "friction_load_sensitivity": 0.0,
        "slip_stiffness": t.p_kx1,
        "cornering_stiffness": -t.p_ky1,
        "stiffness_load_sensitivity": 0.0,
        "shape_factor_x": t.p_cx1,
        "shape_factor_y": t.p_cy1,
        "curvature_factor_x": t.p_ex1,
        "curvature_factor_y": t.p_ey1,
        "relaxation_length_x": 0.05,
        "relaxation_length_y": 0.02,
        "camber_horizontal_shift": -t.p_hy3,
        "camber_vertical_shift": -t.p_vy3,
        "camber_friction_loss": t.p_dy3,
        "horizontal_shift": -t.p_hy1,
        "vertical_shift": -t.p_vy1,
        "rolling_resistance": 0.0,
        "vertical_stiffness": p.K_zt,
        "vertical_damping": 0.0,
    }
    tyre = Tyre(**common)
    front = Axle(
        position=p.a,
        tyre=tyre,
        track_width=p.T_f,
        unsprung_mass=p.m_uf / 2,
        wheel_rate=p.K_sf,
        damping=p.K_sdf,
        anti_roll_stiffness=-p.K_tsf,
        roll_centre_height=p.h_raf,
        camber_gain=p.D_f,
        drive_torque_share=p.T_se,
        brake_torque_share=p.T_sb,
    )
    rear = Axle(
        position=-p.b,
        tyre=tyre,
        track_width=p.T_r,
        unsprung_mass=p.m_ur / 2,
        wheel_rate=p.K_sr,
        damping=p.K_sdr,
        anti_roll_stiffness=-p.K_tsr,
        roll_centre_height=p.h_rar,
        camber_gain=p.D_r,
        drive_torque_share=1 - p.T_se,
        brake_torque_share=1 - p.T_sb,
    )
    wheels = p.m_uf * (p.a**2 + p.T_f**2 / 4) + p.m_ur * (p.b**2 + p.T_r**2 / 4)
    return Car(
        front=front,
        rear=rear,
        length=p.l,
        width=p.w,
        sprung_mass=p.m_s,
        roll_inertia=p.I_Phi_s,
        pitch_inertia=p.I_y_s,
        yaw_inertia=p.I_z - wheels,
        cg_height=p.h_s,
        unloaded_radius=p.R_w,
        wheel_inertia=p.I_y_w,
        drag_area=0.0,
        bump_travel=1.0,
        max_steer_angle=1.0,
        max_steer_rate=STEER_RATE,
        ackermann=0.0,
        abs_slip_threshold=0.0,
        tcs_slip_threshold=0.0,
        esc_gain=0.0,
    )


def step_steer(steer: float) -> Comparison:
    """80 km/h straight on, then the steering goes to ``steer`` (rad) as fast as it can; no pedal."""
    time = np.round(np.arange(0.0, DURATION + 0.01, 0.02), 9)
    return Comparison(steer, time, _ours(steer, time), _theirs(steer, time))


def _ours(steer: float, time: np.ndarray) -> np.ndarray:
    vehicle = plane(car=bmw_320i())
    vehicle.put(2500.0, 0.0, SPEED)
    rows = []
    for t in time:
        seen = vehicle.see()
        rows.append((seen["yaw_rate"], seen["vx"], seen["roll"]))
        vehicle.move(steer if t >= START - 1e-9 else 0.0, 0.0, 0.0)
    return np.array(rows)


def _theirs(steer: float, time: np.ndarray) -> np.ndarray:
    p = parameters_vehicle2()
    ends = START + steer / STEER_RATE

    def rates(t: float, state: np.ndarray) -> list[float]:
        return vehicle_dynamics_mb(list(state), [STEER_RATE if START <= t < ends else 0.0, 0.0], p)

    state = np.array(init_mb([0.0, 0.0, 0.0, SPEED, 0.0, 0.0, 0.0], p))
    states = []
    # In three parts, so that no step of the integrator runs over a jump of the steering rate.
    for begin, end in ((0.0, START), (START, ends), (ends, float(time[-1]) + 1e-6)):
        inside = time[(time >= begin) & (time < end)]
        grid = np.append(inside, end)
        solved = solve_ivp(rates, (begin, end), state, t_eval=grid, method="RK45", rtol=1e-6, atol=1e-8)
        if not solved.success:
            raise RuntimeError(f"CommonRoad's model could not be integrated: {solved.message}")
        states.append(solved.y[:, :-1])
        state = solved.y[:, -1]
    every = np.hstack(states)
    return np.column_stack([every[5], every[3], -every[6]])


def table(steers: tuple[float, ...] = (0.01, 0.02, 0.03, 0.04)) -> str:
    """Lines for people: how close the two are at several levels."""
    lines = ["steer rad   ay g   yaw rate rad/s ours/theirs   RMS of peak   roll deg ours/theirs   speed m/s"]
    for steer in steers:
        c = step_steer(steer)
        ours, theirs = c.ours[-1], c.theirs[-1]
        lines.append(
            f"{steer:9.3f} {c.lateral_g:6.2f}   {ours[0]:12.3f} / {theirs[0]:.3f}"
            f" {100 * c.yaw_error:15.1f} %"
            f"   {math.degrees(ours[2]):12.2f} / {math.degrees(theirs[2]):.2f}"
            f"   {ours[1]:8.2f} / {theirs[1]:.2f}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
