# ruff: noqa: N802 - methods are named for the messages that they answer
"""A fake BeamNG.tech: speaks its protocol, refuses what it refuses, drives a car, and fails on demand.

with FakeBeamNG() as fake: BeamNGpy("127.0.0.1", fake.port).open(launch=False)
fake_home(folder, faults=[...])         a folder that can be given as home=: its binary is this file
"""

import argparse
import json
import os
import sys
import threading
import time
from dataclasses import asdict
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
from beamng.fake_car import FakeWorld, objects_of
from beamng.fake_server import LEVELS, FakeFault, FakeRefusedError, FakeServer, FakeSettings

VEHICLES = ("etk800", "pickup")
VERSIONS = {"v1.24": "0.37", "v1.26": "0.38", "v1.27": "0.39"}  # folders of the user


class FakeBeamNG(FakeServer):
    """The game: levels, scenarios, and the cars in the one that is loaded."""

    def __init__(self, port=0, user="", **settings):
        self.scenarios, self.cameras, self._vehicles = {}, {}, {}
        self.world = self.loaded = self.fps = None
        self.is_running = self.is_even = False
        self.user = user
        super().__init__(FakeSettings(**settings), port)

    # --- the game engine ---------------------------------------------------------------------------------

    def ge_GetSystemInfo(self, message):
        return {"type": "SystemInfo", "os": {"type": "Linux"}, "tech": self.settings.tech}

    def ge_GetEnvironmentPaths(self, message):
        version = VERSIONS.get(self.settings.protocol, "current")
        return {"type": "Paths", "home": "/fake", "user": f"{self.user or '/fake/user'}/{version}"}

    def ge_GetLevels(self, message):
        return {"type": "GetLevels", "result": [self._level(name) for name in self._levels()]}

    def _levels(self):
        """Those that come with the game, and those in the user folder, with their objects."""
        found = {name: [] for name in self.settings.levels}
        folder = Path(self.ge_GetEnvironmentPaths({})["user"], "levels")
        for info in sorted(folder.glob("*/info.json")) if folder.is_dir() else ():
            json.loads(info.read_text())
            json.loads((info.parent / "main.materials.json").read_text())
            files = sorted((info.parent / "main").rglob("items.level.json"))
            found[info.parent.name] = objects_of("".join(path.read_text() for path in files))
        return found

    def _level(self, name):
        return {"levelName": name, "title": name, "dir": f"/levels/{name}", "size": [256, 256]}

    def ge_CreateScenario(self, message):
        self.made += 1
        self._remember()
        level, name = message["level"], message["name"]
        if level not in self._levels():
            raise FakeRefusedError(f"level {level} not found")
        if not name or "/" in name or " " in name:
            raise FakeRefusedError(f"'{name}' is no name of a scenario")
        path = f"/levels/{level}/scenarios/{name}/{name}.json"
        self.scenarios[path] = (level, objects_of(message["prefab"]), message["info"])
        return {"type": "CreateScenario", "result": path}

    def ge_DeleteScenario(self, message):
        self.scenarios.pop(message["path"], None)
        return {"type": "DeleteScenario"}

    def ge_LoadScenario(self, message):
        if message["path"] not in self.scenarios:
            raise FakeRefusedError(f"scenario {message['path']} not found")
        level, objects, _ = self.scenarios[message["path"]]
        objects = objects + self._levels()[level]
        for each in objects:
            if each["class"] == "BeamNGVehicle" and each["jBeam"] not in VEHICLES:
                raise FakeRefusedError(f"vehicle {each['jBeam']} not found")
        self.world = FakeWorld(
            objects, LEVELS.get(level, -28.0), self.settings.steer_sign, self.settings.is_blind
        )
        self.loaded, self.is_running = message["path"], False
        self.fps, self.is_even = None, False  # a level may bring settings of its own
        return {"type": "MapLoaded"}

    def ge_GetCurrentVehicles(self, message):
        if self.world is None:
            return {"type": "GetCurrentVehicles", "result": {}}
        found = {
            name: {"id": i, "name": name, "model": car.spec["jBeam"]}
            for i, (name, car) in enumerate(self.world.cars.items(), 1)
        }
        return {"type": "GetCurrentVehicles", "result": found}

    def ge_GetPlayerVehicleID(self, message):
        if self.world is None or not self.world.cars:
            raise FakeRefusedError("no player vehicle")
        return {"type": "getPlayerVehicleID", "id": 1, "vid": next(iter(self.world.cars))}

    def ge_StartVehicleConnection(self, message):
        vid = message["vid"]
        self._car(vid)
        if vid not in self._vehicles:
            self._vehicles[vid] = self._serve(vid)
        return {"type": "StartVehicleConnection", "vid": vid, "result": self._vehicles[vid]}

    def ge_StartScenario(self, message):
        if self.loaded is None:
            raise FakeRefusedError("no scenario is loaded")
        self.is_running = True
        return {"type": "ScenarioStarted"}

    def ge_StopScenario(self, message):
        self.world = self.loaded = None
        self.is_running = False
        return {"type": "ScenarioStopped"}

    def ge_Pause(self, message):
        return {"type": "Paused"}

    def ge_Step(self, message):
        if self.world is not None and self.is_running:
            self.world.step(message["count"] / (self.fps if self.fps and self.is_even else 60.0))
        return {"type": "Stepped"} if message["ack"] else None

    def ge_SetPhysicsDeterministic(self, message):
        self.is_even = True
        return {"type": "SetPhysicsDeterministic"}

    def ge_FPSLimit(self, message):
        self.fps = float(message["fps"])
        return {"type": "SetFPSLimit"}

    def ge_QueueLuaCommandGE(self, message):
        return {"type": "ExecutedLuaChunkGE"}

    def ge_GetBBoxCorners(self, message):
        return {"type": "BBoxCorners", "points": self._car(message["vid"]).corners()}

    def ge_Teleport(self, message):
        x, y, z, w = message["rot"]
        ahead = (-2 * (x * y + z * w), -(1 - 2 * (x * x + z * z)), -2 * (y * z - x * w))
        car = self._car(message["vehicle"])
        car.put(message["pos"], ahead)
        if message.get("reset"):
            car.shift_mode = car.usual_mode
        return {"type": "Teleported", "success": True}

    def ge_OpenCamera(self, message):
        self._car(message["vid"])
        self.cameras[message["name"]] = message
        return {"type": "OpenedCamera"}

    def ge_CloseCamera(self, message):
        self.cameras.pop(message["name"], None)
        return {"type": "ClosedCamera"}

    def ge_PollCamera(self, message):
        if message["name"] not in self.cameras:
            raise FakeRefusedError(f"no camera {message['name']}")
        width, height = (int(side) for side in self.cameras[message["name"]]["size"])
        shade = int(self.world.time * 50) % 256
        return {"type": "PollCamera", "data": {"colour": bytes([shade, 20, 30, 255]) * (width * height)}}

    def ge_SensorRequest(self, message):
        return {"type": "SensorData", "data": {}}

    def ge_Quit(self, message):
        threading.Timer(0.05, self.stop).start()
        return {"type": "Quit"}

    # --- a vehicle ---------------------------------------------------------------------------------------

    def _car(self, name):
        if self.world is None or name not in self.world.cars:
            raise FakeRefusedError(f"vehicle {name} not found")
        return self.world.cars[name]

    def veh_SensorRequest(self, car, message):
        known = {
            "State": lambda: {"state": car.state()},
            "Electrics": lambda: {"values": car.electrics(self.settings.told_sign)},
        }
        data = {}
        for name, wish in message["sensors"].items():
            if wish["type"] not in known:
                raise FakeRefusedError(f"no sensor {wish['type']}")
            data[name] = known[wish["type"]]()
        return {"type": "SensorData", "data": data}

    def veh_Control(self, car, message):
        for name, value in message.items():
            if name in car.inputs:
                low = -1.0 if name == "steering" else 0.0
                car.inputs[name] = min(max(float(value), low), 1.0)
        return {"type": "Controlled"}

    def veh_SetShiftMode(self, car, message):
        car.shift_mode = int(message["mode"])
        return {"type": "ShiftModeSet"}

    def veh_GetCenterOfGravity(self, car, message):
        return {"type": "CenterOfGravity", "data": [car.x, car.y, car.z]}

    def veh_SetAiMode(self, car, message):
        car.ai.mode = message["mode"]
        return {"type": "AiModeSet"}

    def veh_SetAiSpeed(self, car, message):
        car.ai.limit = float(message["speed"])
        return {"type": "AiSpeedSet"}

    def veh_SetAiAggression(self, car, message):
        car.ai.aggression = float(message["aggression"])
        return {"type": "AiAggressionSet"}

    def veh_SetDriveInLane(self, car, message):
        car.ai.lane = message["lane"] == "on"
        return {"type": "AiDriveInLaneSet"}

    def veh_SetAiWaypoint(self, car, message):
        if message["target"] not in self.world.waypoints:
            raise FakeRefusedError(f"no waypoint {message['target']}")
        car.ai.target = message["target"]
        return {"type": "AiWaypointSet"}


def fake_home(folder, **settings):
    """A folder that can be given as BeamNG's home; its binary starts this fake with these settings."""
    folder = Path(folder)
    binary = folder / "BinLinux" / "BeamNG.tech.x64"
    binary.parent.mkdir(parents=True)
    settings["faults"] = [asdict(fault) for fault in settings.get("faults", ())]
    settings["state"] = str(folder / "state.json")
    (folder / "settings.json").write_text(json.dumps(settings))
    binary.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{Path(__file__).resolve()}" "{folder}" "$@"\n')
    binary.chmod(0o755)
    return folder


def main():
    """As the binary: takes the options that BeamNG takes, and no others."""
    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("home", type=Path)
    for flag in ("-nosteam", "-tcom", "-console", "-headless", "-tcom-debug"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("-tport", type=int, required=True)
    parser.add_argument("-tcom-listen-ip", default="127.0.0.1")
    parser.add_argument("-gfx", choices=["null", "dx11", "vk"])
    parser.add_argument("-lua")
    parser.add_argument("-userpath", default="")
    given = parser.parse_args()
    if not given.tcom:
        parser.error("without -tcom nobody can connect")
    with (given.home / "started.jsonl").open("a") as log:
        log.write(json.dumps({"pid": os.getpid(), "words": sys.argv[2:]}) + "\n")
    settings = json.loads((given.home / "settings.json").read_text())
    settings["faults"] = tuple(FakeFault(**each) for each in settings["faults"])
    time.sleep(settings.get("slow_start", 0.0))
    FakeBeamNG(given.tport, given.userpath, **settings).quit.wait()


if __name__ == "__main__":
    main()
