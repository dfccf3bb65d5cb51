"""The world inside the fake BeamNG: roads out of a prefab, ground, and a car that slides where it must.

Plain Python without numpy, so that the fake starts at once. The car is a kinematic bicycle whose yaw is
limited by friction: a bend taken too fast carries it out of its lane, and off the edge it falls.
"""

import json
import math
import re
from dataclasses import dataclass, field

from beamng.fake_server import FakeRefusedError

G = 9.81
GRIP = 0.9  # g, sideways
WHEELBASE = 2.83
LOCK = 0.6  # rad at full steering input
STEER_RATE = 0.8  # rad/s at the wheels
REF_AHEAD, REF_UP = 0.35, -0.15  # m, of the reference node from the centre of gravity
CG_HEIGHT = 0.56
LENGTH, WIDTH, HEIGHT, MIDDLE = 4.70, 1.86, 1.44, -0.10
PHYSICS = 0.01  # s
ARCADE = 2  # the mode of the gearbox in which the throttle alone drives


def objects_of(prefab):
    """The objects of a prefab: one JSON object per line, commas before brackets allowed."""
    found = []
    for line in prefab.splitlines():
        if line.strip():
            try:
                found.append(json.loads(re.sub(r",\s*([}\]])", r"\1", line)))
            except ValueError as error:
                raise FakeRefusedError(f"prefab line cannot be read: {error}") from error
    names = [each.get("name") for each in found]
    for name in names:
        if not name or names.count(name) > 1:
            raise FakeRefusedError(f"object name missing or not unique: {name}")
    for each in found:
        if each["class"] in ("DecalRoad", "MeshRoad"):
            columns = 4 if each["class"] == "DecalRoad" else 8
            nodes = each.get("nodes", [])
            if len(nodes) < 2 or any(len(node) != columns for node in nodes):
                raise FakeRefusedError(f"road {each['name']} needs two nodes or more of {columns} numbers")
            if not all(math.isfinite(value) for node in nodes for value in node):
                raise FakeRefusedError(f"road {each['name']} has a node that is not finite")
    return found


@dataclass
class FakePolyline:
    """A polyline with widths; asked by distance along it."""

    nodes: list
    along: list = field(default_factory=list)

    def __post_init__(self):
        self.along = [0.0]
        for a, b in zip(self.nodes, self.nodes[1:], strict=False):
            self.along.append(self.along[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))

    @property
    def length(self):
        return self.along[-1]

    def place(self, x, y, near=None):
        """(distance along, offset to the left, index) of the nearest point."""
        best = (math.inf, 0.0, 0.0, 0)
        first, last = (0, len(self.nodes) - 1) if near is None else (max(near - 8, 0), near + 8)
        for i in range(first, min(last, len(self.nodes) - 1)):
            (ax, ay), (bx, by) = self.nodes[i][:2], self.nodes[i + 1][:2]
            size = self.along[i + 1] - self.along[i] or 1e-9
            ux, uy = (bx - ax) / size, (by - ay) / size
            u = min(max((x - ax) * ux + (y - ay) * uy, 0.0), size)
            gap = math.hypot(x - ax - u * ux, y - ay - u * uy)
            if gap < best[0]:
                best = (gap, self.along[i] + u, (y - ay) * ux - (x - ax) * uy, i)
        return best[1:]

    def at(self, s, left=0.0):
        """(x, y, z, grade, width) at a distance along."""
        i = 0
        low, high = 0, len(self.nodes) - 2
        while low <= high:
            i = (low + high) // 2
            if s < self.along[i]:
                high = i - 1
            elif s > self.along[i + 1]:
                low = i + 1
            else:
                break
        a, b = self.nodes[i], self.nodes[i + 1]
        size = self.along[i + 1] - self.along[i] or 1e-9
        u = (s - self.along[i]) / size
        ux, uy = (b[0] - a[0]) / size, (b[1] - a[1]) / size
        x, y, z = (a[k] + u * (b[k] - a[k]) for k in range(3))
        return x - left * uy, y + left * ux, z, (b[2] - a[2]) / size, a[3]

    def bends(self, step=2.0):
        """Curvature every ``step`` metres, over 6 m."""
        out, s = [], 0.0
        while s <= self.length:
            p, q, r = (self.at(min(max(s + d, 0.0), self.length))[:2] for d in (-3.0, 0.0, 3.0))
            turn = math.atan2(r[1] - q[1], r[0] - q[0]) - math.atan2(q[1] - p[1], q[0] - p[0])
            turn = (turn + math.pi) % (2 * math.pi) - math.pi
            whole = math.hypot(q[0] - p[0], q[1] - p[1]) + math.hypot(r[0] - q[0], r[1] - q[1])
            out.append(abs(turn) / max(whole / 2, 1.0))
            s += step
        return out


@dataclass
class Ai:
    """What the vehicle's AI was told."""

    mode: str = "disabled"
    target: str = ""
    limit: float = math.inf
    lane: bool = False
    aggression: float = 0.3


class FakeCar:
    """One vehicle. ``steer_sign`` is what a positive steering input does: -1 turns right, as in BeamNG."""

    def __init__(self, world, spec, steer_sign=-1.0):
        self.world, self.spec, self.steer_sign = world, spec, steer_sign
        self.ai = Ai()
        self.shift_mode = self.usual_mode = 0  # realistic_manual, as its player likes it: no gear is in
        self.inputs = {"steering": 0.0, "throttle": 0.0, "brake": 0.0, "parkingbrake": 0.0}
        m = spec["rotationMatrix"]
        self.put(spec["position"], (-m[3], -m[4], -m[5]))

    def put(self, position, ahead):
        """At rest with its reference node here; ``ahead`` is where it looks."""
        self.heading = math.atan2(ahead[1], ahead[0])
        self.x = position[0] - REF_AHEAD * math.cos(self.heading)
        self.y = position[1] - REF_AHEAD * math.sin(self.heading)
        self.z = position[2] - REF_UP
        self.pitch, self.v, self.vz, self.yaw_rate, self.steer = math.asin(ahead[2]), 0.0, 0.0, 0.0, 0.0
        self.plan = self.near = None
        self.pedals = 0.0, 0.0

    def move(self, dt):
        left = dt
        while left > 1e-9:
            self._tick(min(left, PHYSICS))
            left -= PHYSICS

    def _tick(self, dt):
        throttle, brake = self.inputs["throttle"], self.inputs["brake"]
        throttle *= self.shift_mode == ARCADE
        wish = self.inputs["steering"] * self.steer_sign * LOCK
        if self.ai.mode == "manual":
            wish, throttle, brake = self._drive()
        self.pedals = throttle, brake
        wish = min(max(wish, -LOCK), LOCK)
        self.steer += min(max(wish - self.steer, -STEER_RATE * dt), STEER_RATE * dt)
        ground, grade = self.world.ground(self.x, self.y)
        is_down = self.z - CG_HEIGHT <= ground + 0.02
        if is_down and ground > self.z - CG_HEIGHT - 0.5:
            self.z, self.vz = ground + CG_HEIGHT, 0.0
            along = self.world.along(self.x, self.y, self.heading)
            self.pitch = math.atan(grade * along)
            push = 6.0 * throttle - 9.0 * max(brake, self.inputs["parkingbrake"]) * (self.v > 0)
            self.v = max(self.v + (push - 9.81 * math.sin(self.pitch) * (self.v > 0.05)) * dt, 0.0)
            most = GRIP * G / max(self.v, 1.0)
            self.yaw_rate = min(max(self.v * math.tan(self.steer) / WHEELBASE, -most), most)
        else:
            self.vz -= G * dt
            self.z = max(self.z + self.vz * dt, self.world.level_ground + 0.3)
        self.heading += self.yaw_rate * dt
        self.x += self.v * math.cos(self.heading) * math.cos(self.pitch) * dt
        self.y += self.v * math.sin(self.heading) * math.cos(self.pitch) * dt

    def _drive(self):
        """Pure pursuit of the lane, with speeds planned back from every bend."""
        route = self.world.route(self.ai.target)
        if route is None:
            return 0.0, 0.0, 1.0  # nothing to drive on: the AI stands still
        if self.plan is None:
            sideways = G * max(0.64 + 2.0 * (self.ai.aggression - 0.7), 0.2)
            plan = [min(self.ai.limit, math.sqrt(sideways / max(k, 1e-4))) for k in route.bends()]
            for i in reversed(range(len(plan) - 1)):
                plan[i] = min(plan[i], math.sqrt(plan[i + 1] ** 2 + 2 * 6.0 * 2.0))
            self.plan = plan
        s, _, self.near = route.place(self.x, self.y, self.near)
        offset = -route.at(s)[4] / 4 if self.ai.lane else 0.0
        ahead = s + max(0.5 * self.v, 5.0)
        px, py, *_ = route.at(min(ahead, route.length), offset)
        if ahead > route.length:  # past its end it goes straight on
            qx, qy, *_ = route.at(route.length - 1.0, offset)
            px, py = px + (px - qx) * (ahead - route.length), py + (py - qy) * (ahead - route.length)
        angle = math.atan2(py - self.y, px - self.x) - self.heading
        angle = (angle + math.pi) % (2 * math.pi) - math.pi
        steer = math.atan(2 * WHEELBASE * math.sin(angle) / math.hypot(px - self.x, py - self.y))
        error = self.plan[min(int(s / 2.0), len(self.plan) - 1)] - self.v
        return steer, min(max(0.5 * error, 0.0), 1.0), min(max(-0.8 * error, 0.0), 1.0)

    @property
    def ahead(self):
        c = math.cos(self.pitch)
        return [math.cos(self.heading) * c, math.sin(self.heading) * c, math.sin(self.pitch)]

    @property
    def up(self):
        s = math.sin(self.pitch)
        return [-math.cos(self.heading) * s, -math.sin(self.heading) * s, math.cos(self.pitch)]

    def point(self, ahead, left, up):
        """World coordinates of a point of the body, from its centre of gravity."""
        f, u = self.ahead, self.up
        side = [-math.sin(self.heading), math.cos(self.heading), 0.0]
        at = (self.x, self.y, self.z)
        return [at[k] + ahead * f[k] + left * side[k] + up * u[k] for k in range(3)]

    def state(self):
        flat = [self.v * each for each in self.ahead]
        flat[2] += self.vz
        return {
            "pos": self.point(REF_AHEAD, 0.0, REF_UP),
            "dir": self.ahead,
            "up": self.up,
            "vel": flat,
            "rotation": [0.0, 0.0, 0.0, 1.0],
            "time": self.world.time,
        }

    def electrics(self, told_sign):
        return {
            "steering": math.degrees(self.steer) * 15,
            "steering_input": self.steer / LOCK * self.steer_sign * told_sign,
            "throttle": self.pedals[0],
            "throttle_input": self.pedals[0],
            "brake": self.pedals[1],
            "brake_input": self.pedals[1],
            "wheelspeed": self.v,
            "absActive": False,
            "fuelVolume": 50,
        }

    def corners(self):
        """In the order of BeamNG's GetBBoxCorners, as the client names them."""
        front, rear, half = MIDDLE + LENGTH / 2, MIDDLE - LENGTH / 2, WIDTH / 2
        low, high = -CG_HEIGHT + 0.15, HEIGHT - CG_HEIGHT
        order = ((-half, low), (-half, high), (half, high), (half, low))
        return [self.point(ahead, side, up) for ahead in (front, rear) for side, up in order]


class FakeWorld:
    """What a loaded scenario holds."""

    def __init__(self, objects, level_ground, steer_sign=-1.0, is_blind=False):
        self.level_ground, self.time, self.is_blind = level_ground, 0.0, is_blind
        self.meshes = [FakePolyline(each["nodes"]) for each in objects if each["class"] == "MeshRoad"]
        self.decals = {each["name"]: each for each in objects if each["class"] == "DecalRoad"}
        self.waypoints = {each["name"]: each for each in objects if each["class"] == "BeamNGWaypoint"}
        self.cars = {
            each["name"]: FakeCar(self, each, steer_sign)
            for each in objects
            if each["class"] == "BeamNGVehicle"
        }

    def step(self, dt):
        self.time += dt
        for car in self.cars.values():
            car.move(dt)

    def ground(self, x, y):
        """(height, grade along the road) under a point: the highest mesh road, else the level's ground."""
        best = (self.level_ground, 0.0)
        for mesh in self.meshes:
            s, left, _ = mesh.place(x, y)
            px, py, z, grade, width = mesh.at(s)
            beyond = math.hypot(x - px, y - py)
            if abs(left) <= width / 2 and beyond <= width / 2 and z > best[0]:
                best = (z, grade)
        return best

    def along(self, x, y, heading):
        """Cosine between the road's direction and a heading."""
        if not self.meshes:
            return 0.0
        mesh = self.meshes[0]
        i = mesh.place(x, y)[2]
        a, b = mesh.nodes[i], mesh.nodes[i + 1]
        return math.cos(math.atan2(b[1] - a[1], b[0] - a[0]) - heading)

    def route(self, target):
        """The drivable decal road that ends near the waypoint."""
        waypoint = self.waypoints.get(target)
        if waypoint is None or self.is_blind:
            return None
        for road in self.decals.values():
            end = road["nodes"][-1]
            x, y, _ = waypoint["position"]
            if road["drivability"] > 0 and math.hypot(end[0] - x, end[1] - y) < 10:
                if "_line" not in road:
                    road["_line"] = FakePolyline(road["nodes"])
                return road["_line"]
        return None
