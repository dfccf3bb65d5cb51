"""Roads with lanes of another width or number: cars keep to their lane, and verdicts are those of shapely."""

import math

import numpy as np
import pytest
import shapely

from roadgpt.drive import simulate
from roadgpt.drive.simulators.mujoco.vehicle import Vehicle
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Road, World
from roadgpt.verdict import judge
from roadgpt.verdict.oracle import margins

PIECES = (
    Piece(50, 0, 0),
    Piece(25, 0, 0.025),
    Piece(40, 0.025, 0.025),
    Piece(50, 0.025, -0.02),
    Piece(40, -0.02, -0.02),
    Piece(25, -0.02, 0),
    Piece(30, 0, 0),
)
PLAN = PieceCurve(40.0, 30.0, 0.7, PIECES)
LENGTH = PLAN.length
ROAD = Road(PLAN, GradeProfile(3.0, (0.0, 120.0, 260.0), (0.06, -0.05, 0.0)))


def width(world: World, s: np.ndarray) -> np.ndarray:
    """3 u^2 - 2 u^3 from the first width to the last."""
    u = np.asarray(s) / LENGTH
    end = world.section.lane_width if world.section.lane_width_end is None else world.section.lane_width_end
    return world.section.lane_width + (end - world.section.lane_width) * u * u * (3 - 2 * u)


def inner(world: World, s: np.ndarray) -> np.ndarray:
    """Distance from the centre line to the left edge of the rightmost lane."""
    return (int(world.section.lanes[0]) - 1) * width(world, s)


WORLDS = {
    "3 m": World(section=CrossSection(lane_width=3.0)),
    "4 m": World(section=CrossSection(lane_width=4.0)),
    "3 to 4 m": World(section=CrossSection(lane_width=3.0, lane_width_end=4.0)),
    "2+1": World(section=CrossSection(lanes="2+1", lane_width=3.5)),
    "3+2": World(section=CrossSection(lanes="3+2", lane_width=3.25)),
    "1+0": World(section=CrossSection(lanes="1+0", lane_width=3.75)),
    "2+0, widening": World(section=CrossSection(lanes="2+0", lane_width=2.75, lane_width_end=3.5)),
}
BANKS = {
    "3 m, 8 %": World(section=CrossSection(lane_width=3.0, bank=0.08)),
    "2+1, CD 109": World(section=CrossSection(lanes="2+1", bank="auto")),
}
EVERY = {**WORLDS, **BANKS}


def offset_line(road: Road, offsets: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Points in plan at offsets, from normals of the centre line worked out by differences."""
    if road.profile is not None and road.profile.superelevation_angle is not None:
        return road.at(s, offsets)[:, :2]
    way = (road.at(s + 1e-4)[:, :2] - road.at(s - 1e-4)[:, :2]) / 2e-4
    way /= np.hypot(*way.T)[:, None]
    return road.at(s)[:, :2] + offsets[:, None] * np.column_stack([-way[:, 1], way[:, 0]])


def lane_of(road: Road, world: World) -> shapely.Polygon:
    s = np.linspace(1e-3, LENGTH - 1e-3, 1200)
    left = offset_line(road, -inner(world, s), s)
    right = offset_line(road, -inner(world, s) - width(world, s), s)
    return shapely.Polygon([*left, *right[::-1]])


class Wanders:
    """Drives like the reference driver and lets the steering swing, so that the car uses all of its lane."""

    def __init__(self, swing: float) -> None:
        from roadgpt.drive.drivers.reference import Reference

        self.swing, self.inner = swing, Reference(risk=0.3)

    def start(self, road, world, seed):
        self.inner.start(road, world, seed)

    def steer(self, view):
        command = self.inner.steer(view)
        return command._replace(steer=command.steer + self.swing * math.sin(view.s / 10))


@pytest.mark.parametrize("name", EVERY)
def test_cars_keep_to_the_middle_of_their_own_lane(name: str) -> None:
    world = EVERY[name]
    drive = simulate(ROAD, world, "reference")
    assert drive.ended == "goal"
    off = drive["t"] + inner(world, drive["s"]) + width(world, drive["s"]) / 2
    assert abs(off[0]) < 0.02
    assert np.abs(off).max() < 0.35
    assert drive.max_outside == 0.0
    assert judge(world.lay(ROAD), drive, world).kept


@pytest.mark.parametrize("name", EVERY)
def test_the_share_outside_is_that_of_shapely(name: str) -> None:
    world = EVERY[name]
    road = world.lay(ROAD)
    drive = simulate(ROAD, world, Wanders(0.15), keep_driving=True)
    lane, compared = lane_of(road, world), []
    for step in range(100, len(drive) - 50, 20):
        box = shapely.Polygon(drive.corners(step))
        share = box.difference(lane).area / box.area
        # corners() is level: pitch and roll move the car's floor by some centimetres.
        assert drive["outside"][step] == pytest.approx(share, abs=0.04)
        compared.append(share)
    assert max(compared) > 0.1


@pytest.mark.parametrize(("name", "tolerance"), [*zip(EVERY, [0.05, 0.5, 0.95] * 3, strict=True)])
def test_the_margin_is_the_way_to_the_failure(name: str, tolerance: float) -> None:
    """Shifts the box of the car across the road until shapely says that it fails."""
    world = EVERY[name].changed(oob_tolerance=tolerance)
    road = world.lay(ROAD)
    drive = simulate(ROAD, world, Wanders(0.04), keep_driving=True)
    found, lane = margins(road, drive, world), lane_of(road, world)
    forward, backward = int(world.section.lanes[0]), int(world.section.lanes[2])
    s = np.linspace(1e-3, LENGTH - 1e-3, 1200)
    rims = [
        offset_line(road, side * (n * width(world, s) + 3.0), s) for side, n in ((1, backward), (-1, forward))
    ]
    ground = shapely.Polygon([*rims[0], *rims[1][::-1]])
    for step in range(150, len(drive) - 100, 90):
        if found[step] <= 0.0:
            continue
        heading = float(road.heading(drive["s"][step]))
        across = np.array([-math.sin(heading), math.cos(heading)])
        # On a bank, the car stands on the higher side of the point right below its centre of gravity.
        angle = 0.0 if road.profile is None else float(road.profile.superelevation(drive["s"][step]))
        standing = drive.corners(step) + drive.car.height * math.sin(angle) * across

        def fails(shift: float, standing: np.ndarray = standing, across: np.ndarray = across) -> bool:
            box = shapely.Polygon(standing + shift * across)
            return box.difference(lane).area > tolerance * box.area or not ground.contains(box)

        ways = []
        for side in (1, -1):
            low, high = 0.0, 12.0
            while high - low > 1e-4:
                middle = (low + high) / 2
                low, high = (low, middle) if fails(side * middle) else (middle, high)
            ways.append(low)
        assert found[step] * math.cos(angle) == pytest.approx(min(ways), abs=0.01), (step, drive["s"][step])


def test_the_next_lane_of_the_same_direction_is_outside() -> None:
    world = World(section=CrossSection(lanes="2+1", lane_width=3.5))

    class Leaves:
        def steer(self, view):
            from roadgpt.drive import Command

            return Command(0.05 if view.s > 20 else 0.0, 0.3)

    verdict = judge(world.lay(ROAD), simulate(ROAD, world, Leaves()), world)
    assert (verdict.cause, verdict.side) == ("out of lane", "left")
    assert verdict.description.startswith(
        "left its lane to the left, into the next lane of its direction, after"
    )
    usual = judge(ROAD, simulate(ROAD, World(), Leaves()), World())
    assert usual.description.startswith("left its lane to the left after")


@pytest.mark.parametrize(
    ("world", "left", "right"),
    [
        (World(section=CrossSection(lanes="1+0", shoulder=0.0)), 0.0, -4.0),
        (World(section=CrossSection(lanes="2+1", lane_width=3.0, shoulder=0.0)), 3.0, -6.0),
        (World(section=CrossSection(lanes="1+0", lane_width=3.0, shoulder=1.5)), 1.5, -4.5),
        (
            World(section=CrossSection(lane_width=3.0, lane_width_end=4.0, shoulder=0.0)),
            3.1544,
            -3.1544,
        ),  # at a quarter: 3 + 5/32
    ],
)
def test_the_ground_ends_at_the_rim_of_its_own_side(world: World, left: float, right: float) -> None:
    plan = PieceCurve(0.0, 0.0, 0.0, (Piece(200.0, 0.0, 0.0),))
    road = world.lay(Road(plan, GradeProfile(0.0, (0.0, 200.0), (0.0, 0.0))))
    for t, stays in ((left - 0.95, True), (left + 0.3, False), (right + 0.95, True), (right - 0.3, False)):
        if stays and not right + 0.9 < t < left - 0.9:
            continue
        car = Vehicle.on(road, world)
        car.put(50.0, t)
        for _ in range(150):
            car.move(0.0, 0.0, 1.0)
        assert (not car.mishap and abs(car.see()["roll"]) < 0.02) == stays, t
