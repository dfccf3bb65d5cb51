"""Roads with cross-sections of their own, drawn by a seed."""

import numpy as np

from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Design, Profile, Road, Segment, World, build
from roadgpt.road.profile import LaneStrip, superelevation

LANES = ("1+1", "2+1", "2+2", "3+2", "1+0", "2+0", "3+1")
BANKS = (None, 0.025, 0.05, 0.08)


def random_road(seed: int, steepest: float = 8.0) -> Road:
    """A road with 1+1 to 3+2 lanes of 2.75 to 4 m, of which some widen, and with bends of up to 8 %.

    Its grades are up to ``steepest`` percent; a fifth of the roads are splines.
    """
    rng = np.random.default_rng(seed)
    segments = tuple(
        _segment(rng, str(kind), steepest) for kind in rng.choice(["straight", "left", "right"], 4)
    )
    design = Design(starting_point=(100, 100, 0), theta=float(rng.uniform(-90, 90)), segments=segments)
    road = build(design, geometry="spline" if seed % 5 == 4 else "arcs")
    forward, backward = map(int, str(rng.choice(LANES)).split("+"))
    first, last = (float(each) for each in rng.uniform(2.75, 4.0, 2).round(3))
    width = first if rng.random() < 0.4 else smooth(first, last, road.length)
    profile = Profile.of(forward, backward, width, float(rng.choice([0.0, 0.5, 2.0])))
    if forward < 3 and rng.random() < 0.3:  # the outer lane begins on the way
        begins = CubicProfile(
            (0.0, road.length / 3, road.length / 2),
            ((0.0, 0.0, 0.0, 0.0), taper(0.0, 3.0, road.length / 6), (3.0, 0.0, 0.0, 0.0)),
        )
        right = (*profile.right[:forward], LaneStrip("driving", begins, "solid"), *profile.right[forward:])
        profile = Profile(profile.left, right, profile.driven, profile.centre_marking)
    bank = BANKS[seed % len(BANKS)] if seed % 8 else World(section=CrossSection(bank="auto"))
    if bank is None:
        return road.with_profile(profile)
    ratio = None if isinstance(bank, World) else bank
    angle = superelevation(road.plan, profile.paved_reach, 70 / 3.6, ratio)
    return road.with_profile(
        Profile(profile.left, profile.right, profile.driven, profile.centre_marking, angle)
    )


def _segment(rng: np.random.Generator, kind: str, steepest: float) -> Segment:
    turn = float(rng.uniform(15, 60)) * (1 if kind == "left" else -1)
    bend = {} if kind == "straight" else {"turn_degrees": turn}
    return Segment(
        distance=float(rng.uniform(40, 80)),
        direction=kind,
        incline=float(rng.uniform(-steepest, steepest)),
        **bend,
    )


def taper(first: float, last: float, length: float) -> tuple[float, float, float, float]:
    """The cubic that leads from one value to another without a kink."""
    return first, 0.0, 3 * (last - first) / length**2, -2 * (last - first) / length**3


def smooth(first: float, last: float, length: float) -> CubicProfile:
    """A width that changes from the start of the road to its end."""
    return CubicProfile((0.0, length), (taper(first, last, length), (last, 0.0, 0.0, 0.0)))


def outer_edges(profile: Profile, s: np.ndarray) -> dict[int, np.ndarray]:
    """The offset of the outer edge of every lane, by its id in OpenDRIVE."""
    left, right = profile.lane_edges(s)
    return {0: np.zeros(len(s)), **dict(enumerate(left, 1)), **{-n: t for n, t in enumerate(right, 1)}}


def missed(road: Road, lane: int, points: np.ndarray) -> tuple[float, float]:
    """How far points of another reader are from the outer edge of a lane, and from the road's surface."""
    assert road.profile is not None
    s, t = road.locate(points[:, 0], points[:, 1])
    aside = np.abs(t - outer_edges(road.profile, s)[lane])
    above = np.abs(road.at(s, t)[:, 2] - points[:, 2])
    return float(aside.max()), float(above.max())


def bend(radius: float, width: float = 3.5, side: int = -1, lanes: int = 2, ends: bool = False) -> Road:
    """30 m straight, an arc of 90 degrees, 40 m straight; lanes to the right, one to the left."""
    k = side / radius
    plan = PieceCurve(100.0, 100.0, 0.3, (Piece(30.0), Piece(np.pi / 2 * radius, k, k), Piece(40.0)))
    narrowing = CubicProfile.smooth([(0.0, width), (20.0, width), (28.0, 0.0), (plan.length, 0.0)])
    right = [LaneStrip("driving", width, "broken")] * (lanes - 1) + [
        LaneStrip("driving", narrowing if ends else width, "solid")
    ]
    profile = Profile((LaneStrip("driving", width, "solid"),), tuple(right))
    return Road(plan, GradeProfile.level(plan.length), profile=profile)
