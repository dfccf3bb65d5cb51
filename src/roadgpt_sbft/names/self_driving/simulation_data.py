"""Stores the records of a drive in files that have the competition's format."""

from __future__ import annotations

import datetime
import json
import platform
import shutil
import uuid
from collections import namedtuple
from pathlib import Path
from typing import Any, List, Optional, Union

SimulationDataRecordProperties = [
    "timer", "pos", "dir", "vel", "steering", "steering_input", "brake", "brake_input", "throttle",
    "throttle_input", "wheelspeed", "vel_kmh", "is_oob", "oob_counter", "max_oob_percentage", "oob_distance",
    "oob_percentage",
]  # fmt: skip
"""Names of the fields of a record; the docstring of roadgpt.run.execution explains the fields."""

SimulationDataRecord = namedtuple("SimulationDataRecord", SimulationDataRecordProperties)  # type: ignore[misc]
SimulationDataRecords = List[SimulationDataRecord]
SimulationParams = namedtuple("SimulationParams", ["beamng_steps", "delay_msec"])


def delete_folder_recursively(path: Union[str, Path]) -> None:
    if Path(path).exists():
        assert Path(path).is_dir(), str(path)
        shutil.rmtree(path)


class SimulationInfo:
    """Times and result of a drive; each attribute exists only after its value is known."""

    start_time: str
    end_time: str
    success: Optional[bool]
    exception_str: str
    computer_name: str
    ip_address: str
    id: str


class SimulationData:
    """A drive with the competition's fields. Its files are in ``simulations/NAME`` below the current
    directory.
    """

    f_info = "info"
    f_params = "params"
    f_road = "road"
    f_records = "records"

    def __init__(self, simulation_name: str) -> None:
        assert len(simulation_name) >= 3, "the name of a simulation has three letters or more"
        self.name = simulation_name
        self.simulations = Path.cwd() / "simulations"
        self.path_root = self.simulations / simulation_name
        self.path_json = self.path_root / "simulation.full.json"
        self.path_partial = self.path_root / "simulation.partial.tsv"
        self.path_road_img = self.path_root / "road"
        self.id: Optional[str] = None
        self.params: Any = None
        self.road: Any = None
        self.states: Any = None
        self.info: Any = None
        self.exception_str: Optional[str] = None

    @property
    def n(self) -> int:
        return len(self.states)

    def set(self, params: Any, road: Any, states: Any, info: Optional[SimulationInfo] = None) -> None:
        self.params, self.road, self.states = params, road, states
        if info is None:
            info = SimulationInfo()
            info.id = str(uuid.uuid4())
        self.info = info

    def clean(self) -> None:
        delete_folder_recursively(self.path_root)

    def __str__(self) -> str:
        return json.dumps(
            {
                self.f_params: self.params._asdict(),
                self.f_info: self.info.__dict__,
                self.f_road: self.road.to_dict(),
                self.f_records: [record._asdict() for record in self.states],
            }
        )

    def save(self) -> None:
        from self_driving.beamng_road_imagery import BeamNGRoadImagery

        self.path_root.mkdir(parents=True, exist_ok=True)
        self.path_json.write_text(str(self), encoding="utf-8")
        rows = [SimulationDataRecordProperties, *self.states]
        text = "".join("\t".join(map(str, row)) + "\n" for row in rows)
        self.path_partial.write_text(text, encoding="utf-8")
        imagery = BeamNGRoadImagery.from_sample_nodes(self.road.nodes)
        for suffix in (".jpg", ".svg"):
            imagery.save(self.path_road_img.with_suffix(suffix))

    def load(self) -> SimulationData:
        from self_driving.decal_road import DecalRoad

        read = json.loads(self.path_json.read_text(encoding="utf-8"))
        info = SimulationInfo()
        info.__dict__.update(read.get(self.f_info, {}))
        records = [SimulationDataRecord(**record) for record in read[self.f_records]]
        road = DecalRoad.from_dict(read[self.f_road])
        self.set(SimulationParams(**read[self.f_params]), road, records, info)
        return self

    def complete(self) -> bool:
        return self.path_json.exists()

    def min_oob_distance(self) -> float:
        return float(min(state.oob_distance for state in self.states))

    def start(self) -> None:
        self.info.success = None
        self.info.start_time = str(datetime.datetime.now())
        self.info.computer_name = platform.node()

    def end(self, success: bool, exception: Any = None) -> None:
        self.info.end_time = str(datetime.datetime.now())
        self.info.success = success
        if exception:
            self.exception_str = str(exception)
