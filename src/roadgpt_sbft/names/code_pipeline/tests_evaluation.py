"""Analyses failures as the competition does. The module needs shapely in the generator's interpreter."""

from __future__ import annotations

import json
import logging
import os
from pathlib import Path
from typing import Any, Dict, Iterator, Sequence, Tuple

from code_pipeline import test_analysis as features
from roadgpt_inside import ask
from self_driving.simulation_data import SimulationDataRecord

BEFORE_THRESHOLD = 60.0
AFTER_THRESHOLD = 20.0
HEADER = "total_oob,left_oob,right_oob,avg_sparseness,stdev_sparseness"


class RoadTestEvaluator:
    """Cuts out the part of a road around the place where a car left its lane."""

    def __init__(
        self, road_length_before_oob: float = BEFORE_THRESHOLD, road_length_after_oob: float = AFTER_THRESHOLD
    ) -> None:
        self.road_length_before_oob = road_length_before_oob
        self.road_length_after_oob = road_length_after_oob

    def identify_interesting_road_segments(
        self, road_nodes: Sequence[Sequence[float]], execution_data: Sequence[Any]
    ) -> Tuple[Any, ...]:
        """Returns the point where the car left its lane, the road before and after it, the side ("LEFT" or
        "RIGHT"), the index of the first record outside, and the records before it on the returned road; six
        times None if the car did not leave its lane."""
        from shapely.geometry import LineString, Point

        limits = {"before": self.road_length_before_oob, "after": self.road_length_after_oob}
        found = ask("left_lane", points=road_nodes, records=execution_data, **limits)
        if found is None:
            return (None,) * 6
        assert found["before"] is not None, "the road around the place cannot be cut out"
        number = found["number"]
        before, after = LineString(found["before"]), LineString(found["after"])
        place = Point(execution_data[number].pos[:2])
        return place, before, after, found["side"].upper(), number, execution_data[found["first"] : number]


class OOBAnalyzer:
    """Analyses the failures among the test files in a folder and its subfolders."""

    def __init__(
        self, result_folder: str, road_length_before_oob: float = 30, road_length_after_oob: float = 30
    ) -> None:
        self.logger = logging.getLogger("OOBAnalyzer")
        self._evaluator = RoadTestEvaluator(road_length_before_oob, road_length_after_oob)
        names = [
            (Path(place, name), name) for place, _, files in os.walk(result_folder) for name in sorted(files)
        ]
        tests = [path for path, name in names if "test." in name and name.endswith(".json")]
        self.oobs = [found for path in tests for found in self._found(path)]

    def _found(self, path: Path) -> Iterator[Dict[str, Any]]:
        test = json.loads(path.read_text(encoding="utf-8"))
        if not test["is_valid"] or test["test_outcome"] != "FAIL":
            return
        records = [SimulationDataRecord(*record) for record in test["execution_data"]]
        names = {"test id": test["id"], "simulation file": str(path)}
        try:
            parts = self._evaluator.identify_interesting_road_segments(test["road_points"], records)
        except AssertionError as error:
            self.logger.warning("%s: %s", path, error)
            yield {**names, "oob point": None, "oob side": None, "interesting segment": []}
            return
        place, before, after, side, _, driven = parts
        if place is None:
            return
        segment = [*before.coords, *after.coords]
        yield {
            **names,
            "oob point": place,
            "oob side": side,
            "road segment before oob": before,
            "road segment after oob": after,
            "interesting segment": segment,
            "direction coverage": features.direction_coverage(segment)[1],
            "maximum curvature": features.max_curvature(segment)[1],
            "stdev steering": features.sd_steering(driven)[1],
            "mean lateral position": features.mean_lateral_position(driven)[1],
            "max lateral position": features.max_lateral_position(driven)[1],
        }

    def create_summary(self) -> str:
        """Returns the content of the competition's file oob_stats.csv."""
        left = sum(oob["oob side"] == "LEFT" for oob in self.oobs)
        segments = [oob["interesting segment"] for oob in self.oobs if oob["oob point"] is not None]
        mean, deviation = ask("spread", segments=segments)
        total = len(self.oobs)
        return f"{HEADER}\n{total},{left},{total - left},{mean:.3f},{deviation:3.0f}"

    def create_oob_report(self) -> str:
        return self.create_summary()
