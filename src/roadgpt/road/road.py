"""Defines the Road: 3-D geometry that is evaluated at stations and offsets. Also moves and reverses roads.

Source of the distances of a drive from the ends of its road: the simulations of the RoadGPT thesis and of the
SBFT competition."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.brief.words import LONGEST_ROAD
from roadgpt.errors import UsageError
from roadgpt.geometry import (
    CubicProfile,
    ElevationProfile,
    GradeProfile,
    Piece,
    PieceCurve,
    PlanCurve,
    SplineCurve,
    SplineProfile,
    project,
    shifted,
)
from roadgpt.geometry.curve import Array
from roadgpt.road.profile import ONLY_NETWORKS, Profile, profile_from_json, profile_to_json

START = 2.5  # m along the road: station of the car's centre of gravity at the start
GOAL = 8.0  # m from the end of the left edge of the lane; a car that comes this close has arrived
SHORTEST_DRIVE = START + GOAL  # m; on a shorter road a car has arrived before it sets off
CONTROL_SPACING = 2.0  # m, so that SBFT's spline keeps the designed radii (14.8 m nominal is accepted)
MOST_CONTROL_POINTS = 500  # SBFT rule
FARTHEST = 25_000_000.0  # m, of a coordinate; Web Mercator reaches 20,037,508
OF_RADIUS = 0.25  # spacing of the control points of a longer road, as a share of the radius of a bend
WIDEST_SPACING = 4.0  # the same beside wide bends, as a multiple of the mean spacing
GRADUALLY = 0.4  # m of spacing that is gained for each metre along the road
SHORTEST = 1e-3  # m
SHARPEST = 1e3  # 1/m, greatest curvature in a file
STEEPEST = 10.0  # metres up or down for each metre forward
LOOKED_AT = 5000  # number of stations at which the grade of a road is checked
MOST_POINTS = 200_000  # of a road that is given by points
NOT_POINTS = "road points are lists of two or three numbers each, like [[10, 20], [60, 25]]"
BANKED_ROUNDS = 4  # of the iteration that finds the station of a point on a banked road


@dataclass(frozen=True, eq=False)
class Samples:
    """Points, headings, curvatures and grades of a road at stations ``s``. Every array has shape ``(n,)``.
    Lengths are in metres, headings in radians, curvatures in 1/m, and grades are ratios."""

    s: Array
    x: Array
    y: Array
    z: Array
    heading: Array
    curvature: Array
    grade: Array

    @property
    def points(self) -> Array:
        """The centre line ``(n, 3)`` in metres."""
        return np.stack([self.x, self.y, self.z], axis=-1)


@dataclass(frozen=True, eq=False)
class Road:
    """A road, defined by its centre line in plan (a plane curve) and its elevation profile. ``nodes`` are the
    control points ``(n, 2)`` or ``(n, 3)`` in metres if the road was built from points; None otherwise."""

    is_route: ClassVar[bool] = False
    """Whether the road is a Route, which leads through the junctions of a network."""
    plan: PlanCurve
    elevation: ElevationProfile
    nodes: Array | None = None
    road_points: Array | None = None
    """Control points ``(n, 2)`` of the SBFT test from which the road was read, if they differ from ``nodes``.
    """
    profile: Profile | None = None
    """The road's own cross-section; None if the road uses the cross-section of the World."""
    _sampled: dict[float, Samples] = field(default_factory=dict, repr=False)

    @classmethod
    def through(cls, points: ArrayLike, road_points: ArrayLike | None = None) -> Self:
        """Returns the road whose centre line is the SBFT competition's spline through points ``(n, 2)`` or
        ``(n, 3)`` in metres. ``road_points`` are the control points of the test that it was read from, if
        they differ.

        Raises UsageError if there are fewer than two points or more than 200,000, a number is not finite or
        beyond 25,000 km, two neighbouring points are the same, or the road is too long or too steep."""
        nodes = _checked(points)
        control = None if road_points is None else _checked(road_points)[:, :2]
        plan = SplineCurve.through(nodes)
        check_length(plan.length)
        profile = SplineProfile(plan) if nodes.shape[1] == 3 else GradeProfile.level(plan.length)
        check_grade(profile, plan.length)
        return cls(plan, profile, nodes, control)

    def __repr__(self) -> str:
        low, high = self.elevation.height(self.sample().s[[0, -1]])
        (x0, y0), (x1, y1) = self.plan.at(np.array([0.0, self.length]))
        ends = f"({x0:.1f}, {y0:.1f}, {low:.1f}) to ({x1:.1f}, {y1:.1f}, {high:.1f})"
        sharpest = float(np.abs(self.sample().curvature).max())
        bends = f"radius {1 / sharpest:.1f} m or more" if sharpest > 1 / LONGEST_ROAD else "straight"
        return f"Road({self.length:.1f} m, from {ends}, {bends})"

    @property
    def length(self) -> float:
        """The length in plan in metres."""
        return self.plan.length

    @property
    def starts(self) -> tuple[float, ...]:
        """The stations in metres between which the road follows one lane: the start and the end."""
        return 0.0, self.length

    @property
    def passages(self) -> tuple[Any, ...]:
        """The ways through junctions, each a ``roadgpt.network.Passage``, in driving order: none."""
        return ()

    @property
    def crosswalks(self) -> tuple[Any, ...]:
        """The crosswalks on the way, each a ``roadgpt.network.Crosswalk``, in driving order: none."""
        return ()

    @property
    def has_way(self) -> bool:
        """Whether it is known where to drive; False only for a map through which no route was asked for."""
        return True

    def moved(self, x: float, y: float, z: float = 0.0) -> "Road":
        """Returns the road shifted by the given distances in metres along each axis. It must consist of
        lines, arcs and clothoids, or be a spline through nodes, which without heights ignores ``z``."""
        if self.nodes is not None:
            nodes = self.nodes + np.array([x, y, z])[: self.nodes.shape[1]]
            control = None if self.road_points is None else self.road_points + np.array([x, y])
            return Road.through(nodes, control).with_profile(self.profile)
        assert isinstance(self.plan, PieceCurve)
        plan = replace(self.plan, x=self.plan.x + x, y=self.plan.y + y)
        elevation = self.elevation
        if z and isinstance(elevation, GradeProfile):
            elevation = replace(elevation, z0=elevation.z0 + z)
        elif z:
            assert isinstance(elevation, CubicProfile)
            rows = tuple((a + z, b, c, d) for a, b, c, d in elevation.coefficients)
            elevation = replace(elevation, coefficients=rows)
        return Road(plan, elevation, profile=self.profile)

    def at(self, s: ArrayLike, t: ArrayLike = 0.0) -> Array:
        """Returns points ``(..., 3)`` in metres at stations ``s`` and offsets ``t`` to the left, in metres.
        On a road with superelevation, offsets are measured along the surface, which is rotated about the
        centre line. Source: ASAM OpenDRIVE 1.8, reference line coordinate system."""
        s, t = np.broadcast_arrays(np.asarray(s, float), np.asarray(t, float))
        heading = self.plan.heading(s)
        xy, z, back = self.plan.at(s), self.elevation.height(s), None
        if self.profile is not None and self.profile.superelevation_angle is not None:
            t, up, back = self._banked(s, t)
            z = z + up
        sin, cos = np.sin(heading), np.cos(heading)
        x, y = xy[..., 0] - t * sin, xy[..., 1] + t * cos
        return np.stack([x, y, z] if back is None else [x - back * cos, y - back * sin, z], axis=-1)

    def _banked(self, s: Array, t: Array) -> tuple[Array, Array, Array]:
        """Returns how far, in metres, points on the inclined surface lie to the left of, above and behind the
        points of the centre line at ``s``."""
        assert self.profile is not None
        angle, pitch = self.profile.superelevation(s), np.arctan(self.elevation.grade(s))
        up = t * np.sin(angle)
        return t * np.cos(angle), up * np.cos(pitch), up * np.sin(pitch)

    def locate(self, x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Returns the stations and the offsets to the left, in metres, of points given in plan. Each point is
        projected onto the nearest point of the centre line. On a road with superelevation, the offset is that
        of the surface point vertically above or below the given point."""
        points = np.stack(np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float)), -1)
        s, t = project(self.plan, points)
        if self.profile is None or self.profile.superelevation_angle is None:
            return s, t
        for _ in range(BANKED_ROUNDS):
            t = t / np.cos(self.profile.superelevation(s))
            back, heading = self._banked(s, t)[2], self.plan.heading(s)
            ahead = np.stack([back * np.cos(heading), back * np.sin(heading)], -1)
            s, t = project(self.plan, points + ahead)
        return s, np.asarray(t / np.cos(self.profile.superelevation(s)))

    def with_profile(self, profile: Profile | None) -> Self:
        """Returns the road with the given cross-section; with None, it uses that of the World."""
        return replace(self, profile=profile)  # samples are those of the centre line

    @property
    def mirrored(self) -> Self:
        """The road with the sign of y changed: left becomes right, and traffic changes sides. Not for a
        spline."""
        if not isinstance(self.plan, PieceCurve):
            raise TypeError("only roads of lines, arcs and clothoids are mirrored")
        profile = None if self.profile is None else self.profile.mirrored
        return replace(self, plan=self.plan.mirrored, profile=profile, _sampled={})

    def heading(self, s: ArrayLike) -> Array:
        """Returns headings in radians, counter-clockwise from +x."""
        return self.plan.heading(s)

    def curvature(self, s: ArrayLike) -> Array:
        """Returns curvatures in 1/m, positive to the left."""
        return self.plan.curvature(s)

    def grade(self, s: ArrayLike) -> Array:
        """Returns grades as ratios."""
        return self.elevation.grade(s)

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Returns the change of grade in 1/m, negative on a crest."""
        return self.elevation.vertical_curvature(s)

    def sample(self, step: float = 1.0) -> Samples:
        """Returns samples of the road about every ``step`` metres, both ends included; at least two. The
        result is cached."""
        if step not in self._sampled:
            s = np.linspace(0.0, self.length, max(2, round(self.length / step) + 1))
            xy = self.plan.at(s)
            self._sampled[step] = Samples(
                s,
                xy[:, 0],
                xy[:, 1],
                self.elevation.height(s),
                self.heading(s),
                self.curvature(s),
                self.grade(s),
            )
        return self._sampled[step]

    def centreline(self, step: float = 1.0) -> Array:
        """Returns points ``(n, 3)`` of the centre line, about every ``step`` metres, both ends included."""
        return self.sample(step).points

    def control_points(self) -> Array:
        """Returns the road's control points ``(n, 2)`` in metres for the spline of the SBFT competition.

        For a road that was not built from points, the control points are sampled from the centre line at most
        2 m apart, so that the spline preserves the radii of the road. The SBFT rules allow only 500 points;
        on a road longer than 998 m, these points are farther apart, least so in tight bends."""
        if self.road_points is not None:
            return self.road_points
        if self.nodes is not None:
            return self.nodes[:, :2]
        return self.axis(control_stations(self.sample().s, self.sample().curvature))[:, :2]

    def axis(self, s: Array) -> Array:
        """Returns points ``(n, 3)`` in metres of the line between the lanes on the left and those on the
        right. It is the centre line, unless the cross-section has an offset."""
        return self.at(s, 0.0 if self.profile is None else self.profile.centre(s))

    def to_json(self) -> dict[str, Any]:
        """Returns the road as JSON data, from which ``Road.from_json`` restores it exactly."""
        out = self._geometry()
        return out if self.profile is None else {**out, "profile": profile_to_json(self.profile)}

    def _geometry(self) -> dict[str, Any]:
        if self.nodes is not None:
            out: dict[str, Any] = {"nodes": self.nodes.tolist()}
            return out if self.road_points is None else {**out, "road_points": self.road_points.tolist()}
        assert isinstance(self.plan, PieceCurve)
        out = {
            "start": [self.plan.x, self.plan.y, self.plan.heading0],
            "pieces": [[p.length, p.k0, p.k1] for p in self.plan.pieces],
        }
        if isinstance(self.elevation, CubicProfile):
            return {**out, "cubics": [[s, *cubic] for s, cubic in self.elevation.rows]}
        assert isinstance(self.elevation, GradeProfile)
        return {
            **out,
            "height": self.elevation.z0,
            "stations": list(self.elevation.stations),
            "grades": list(self.elevation.grades),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any], in_network: bool = False) -> Self:
        """Restores a road from JSON data as returned by ``to_json``. Traffic may drive on the left only
        ``in_network``. Raises UsageError if a field is missing, is not a number or is not finite, or the road
        is too long or too steep."""
        own = profile_from_json(data["profile"]) if data.get("profile") is not None else None
        if own is not None and own.left_hand and not in_network:
            raise UsageError(f"{ONLY_NETWORKS}; leave left_hand out of the profile")
        if own is not None and not own.along_ids and not in_network:
            raise UsageError("no lane leads along the road; give its profile a driving lane on the right")
        if "nodes" in data:
            return cls.through(data["nodes"], data.get("road_points")).with_profile(own)
        try:
            x, y, heading = (float(v) for v in data["start"])
            pieces = tuple(Piece(*(float(v) for v in row)) for row in data["pieces"])
            numbers = [x, y, heading, *(v for p in pieces for v in (p.length, p.k0, p.k1))]
            profile, more = _profile(data)
            if not np.isfinite([*numbers, *more]).all():
                raise ValueError("a number is not finite")
            sharpest = max((k for p in pieces for k in (p.k0, p.k1)), key=abs, default=0.0)
            told = {"x": x, "y": y, "heading": heading, "elevation": max(more, key=abs)}
            for name, value in (*told.items(), ("curvature", sharpest)):
                if abs(value) > (most := SHARPEST if name == "curvature" else FARTHEST):
                    raise UsageError(f"the road's {name} of {value:,.10g} is beyond {most:,.0f}; correct it")
            check_length(length := sum(p.length for p in pieces))
            check_grade(profile, length)
            return cls(PieceCurve(x, y, heading, pieces), profile, profile=own)
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise UsageError(
                f"the road cannot be read: {error}; it needs start, pieces, height, stations, grades"
            ) from error


def control_stations(s: Array, curvature: Array) -> Array:
    """Returns the stations in metres of the control points of a road with the given curvatures in 1/m at
    equally spaced stations ``s`` in metres."""
    length = float(s[-1])
    count = max(4, int(np.ceil(length / CONTROL_SPACING)) + 1)
    if count <= MOST_CONTROL_POINTS:
        return np.linspace(0.0, length, count)
    most = WIDEST_SPACING * length / MOST_CONTROL_POINTS
    spacing = np.clip(OF_RADIUS / np.maximum(np.abs(curvature), 1e-9), CONTROL_SPACING, most)
    # towards a bend, and away from it, points become closer or farther apart only gradually
    ahead = np.minimum.accumulate(spacing - GRADUALLY * s) + GRADUALLY * s
    behind = np.minimum.accumulate((spacing + GRADUALLY * s)[::-1])[::-1] - GRADUALLY * s
    density = 1 / np.minimum(ahead, behind)
    points = np.append(0.0, np.cumsum((density[1:] + density[:-1]) / 2))
    return np.interp(np.linspace(0.0, points[-1], MOST_CONTROL_POINTS), points, s)


def _profile(data: Mapping[str, Any]) -> tuple[ElevationProfile, list[float]]:
    if "cubics" in data:
        rows = [(float(s), (float(a), float(b), float(c), float(d))) for s, a, b, c, d in data["cubics"]]
        return CubicProfile.of_rows(rows), [v for s, cubic in rows for v in (s, *cubic)]
    height = float(data["height"])
    stations, grades = tuple(map(float, data["stations"])), tuple(map(float, data["grades"]))
    return GradeProfile(height, stations, grades), [height, *stations, *grades]


def check_length(length: float) -> None:
    """Raises UsageError if the length in plan of a road is below 1 mm or above 50 km."""
    if not SHORTEST <= length <= LONGEST_ROAD:
        longest = f"give one of up to {LONGEST_ROAD / 1000:g} km"
        raise UsageError(f"the road is {length:.7g} m long in plan; {longest}")


def check_grade(profile: ElevationProfile, length: float) -> None:
    """Raises UsageError if a road somewhere climbs or falls more than ten metres per metre in plan."""
    with np.errstate(all="ignore"):
        s = np.linspace(0.0, length, LOOKED_AT)
        grades = np.abs(profile.grade(s))
    steepest, place = float(grades.max()), float(s[grades.argmax()])
    if not steepest <= STEEPEST:
        raise UsageError(
            f"the road has a grade of {steepest:.4g}, metres up or down for each metre forward, at "
            f"s = {place:.1f} m; the limit is {STEEPEST:g}"
        )


def _checked(points: ArrayLike) -> Array:
    if isinstance(points, (list, tuple)) and len(points) > MOST_POINTS:
        raise UsageError(f"the road has {len(points):,} points; give {MOST_POINTS:,} at most, a metre apart")
    try:
        if isinstance(points, (list, tuple)) and _has_truths(points):
            raise TypeError("true and false are not numbers")
        nodes = np.array(points, float)
    except (TypeError, ValueError, OverflowError) as error:
        raise UsageError(NOT_POINTS) from error
    if nodes.ndim != 2 or nodes.shape[1] not in (2, 3):
        raise UsageError(NOT_POINTS)
    if not np.isfinite(nodes).all() or np.abs(nodes).max(initial=0) > FARTHEST:
        wrong = int(np.argmin((np.abs(nodes) <= FARTHEST).all(axis=1)))
        told = ", ".join(f"{v:.10g}" for v in nodes[wrong].tolist())
        raise UsageError(
            f"road point {wrong + 1} is ({told}), not finite or beyond {FARTHEST / 1000:,.0f} km; correct or "
            "remove it"
        )
    return nodes


def _has_truths(points: Sequence[Any]) -> bool:
    return any(isinstance(value, bool) for row in points if isinstance(row, (list, tuple)) for value in row)


def reversed_road(road: Road) -> Road:
    """Returns a road that leads from the end of the given road to its start. The given road must consist of
    lines, arcs and clothoids, or be a spline through nodes. The result has no ``profile`` of its own."""
    if road.nodes is not None:
        return Road.through(road.nodes[::-1])
    assert isinstance(road.plan, PieceCurve)
    x, y = road.plan.at(road.length).tolist()
    heading = float(road.plan.heading(road.length)) + math.pi
    pieces = tuple(Piece(piece.length, -piece.k1, -piece.k0) for piece in reversed(road.plan.pieces))
    return Road(PieceCurve(x, y, heading, pieces), _turned(road.elevation, road.length))


def _turned(profile: ElevationProfile, length: float) -> ElevationProfile:
    if isinstance(profile, GradeProfile):
        stations = np.array([0.0, *(s for s in profile.stations if 0 < s < length), length])
        grades = -profile.grade(stations)[::-1]
        return GradeProfile(
            float(profile.height(length)), tuple((length - stations[::-1]).tolist()), tuple(grades.tolist())
        )
    assert isinstance(profile, CubicProfile)
    return reversed_cubics(profile, length)


def reversed_cubics(profile: CubicProfile, length: float) -> CubicProfile:
    """Converts cubics of the station on a road of ``length`` metres to those of the distance from its end."""
    stations = np.array([0.0, *(s for s in profile.stations if 0 < s < length), length])
    at_ends = shifted(profile.cubics(stations[:-1]), np.diff(stations)) * np.array([1.0, -1.0, 1.0, -1.0])
    return CubicProfile.of_table((length - stations[:0:-1]).tolist(), at_ends[::-1])
