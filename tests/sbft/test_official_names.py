"""Every public name of the competition's pipeline is there, with its parameters, from Python 3.8 on."""

import ast
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from roadgpt_sbft.generator_process import NAMES as FOLDER
from sbft.interpreters import old_pythons
from sbft.official_names import ELSEWHERE, NAMES

PYTHONS = [sys.executable, *old_pythons()[:1]]  # what the oldest understands, those between do as well
HEAD = f"import sys; sys.path.insert(0, {str(FOLDER)!r})\n"
PRESENT = """
import importlib, inspect, json
names = json.loads(sys.stdin.read())

def made(owner):
    nodes = [(float(i), 0.0, -28.0, 8.0) for i in range(20)]
    name = owner.__name__
    if name in ("RoadPoints", "RoadPolygon"):
        return owner.from_nodes(nodes)
    if name == "BeamNGRoadImagery":
        return owner.from_sample_nodes(nodes)
    if name == "AbstractTestExecutor":
        from code_pipeline.beamng_executor import BeamngExecutor as owner
    values = {"RoadTest": ([(10.0, 10.0), (40.0, 10.0), (60.0, 20.0)],), "RoadBoundingBox": ((0, 0, 9, 9),),
              "BeamngExecutor": ("results", 200), "BeamNGWaypoint": ("goal", (1, 2, 3)),
              "DecalRoad": ("road",),
              "OutOfBoundsMonitor": (None, None), "SimulationData": ("drive",), "TestValidator": (200,),
              "RoadTestVisualizer": (200,), "OOBAnalyzer": (".",)}
    more = {"connection": object(), "time_budget": 9} if owner.__name__ == "BeamngExecutor" else {}
    return owner(*values.get(owner.__name__, ()), **more)

wrong = []
for module, listed in names.items():
    for name in listed.split():
        path, call, rest = name.partition("(")
        value = importlib.import_module(module)
        for part in path.split("."):
            owner = value
            try:
                value = getattr(owner, part)
            except ImportError as error:  # shapely's, in an interpreter that has none
                assert "shapely" in str(error), error
                break
            except AttributeError:
                if not inspect.isclass(owner):
                    wrong.append((module, name))
                    break
                try:
                    value = getattr(made(owner), part)
                except ImportError as error:
                    assert "shapely" in str(error), error
                    break
                except AttributeError:
                    wrong.append((module, name))
                    break
        else:
            if call:
                given = [one for one in inspect.signature(value).parameters if one != "self"]
                asked = [one for one in rest.rstrip(")").split(",") if one]
                if given[: len(asked)] != asked:
                    wrong.append((module, name, given))
print(json.dumps(wrong))
"""
SUMS = """
import json, math
from code_pipeline.tests_generation import RoadTestFactory
from code_pipeline.validation import TestValidator, min_radius
from code_pipeline.test_analysis import compute_all_features
from self_driving.edit_distance_polyline import iterative_levenshtein
points = [(40.0 + 60 * math.sin(a / 10), 120 - 60 * math.cos(a / 10)) for a in range(12)]
test = RoadTestFactory.create_road_test(points)
loop = RoadTestFactory.create_road_test([(50, 50), (90, 50), (90, 90), (70, 20), (50, 90)])
print(json.dumps([
    test.interpolated_points, test.get_road_length(True), compute_all_features(test, []),
    test.get_road_polygon().is_valid(),
    [TestValidator(size).validate_test(one) for size in (75, 200) for one in (test, loop)],
    min_radius(loop.interpolated_points),
    iterative_levenshtein(points, [(x, y + x * x / 900) for x, y in points]),
]))
"""


def run_in(python: str, code: str, given: str = "", folder: Path | None = None) -> str:
    env = {**os.environ, "ROADGPT_PYTHON": sys.executable}
    done = subprocess.run(
        [python, "-c", HEAD + code],
        input=given,
        env=env,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@cache
def told_in(python: str) -> tuple[list[object], str]:
    """Names that are not as they should be in an interpreter, and its sums; one process takes seconds."""
    with TemporaryDirectory() as folder:
        wrong, sums = run_in(python, PRESENT + SUMS, json.dumps(NAMES), Path(folder)).splitlines()
    return json.loads(wrong), sums


@pytest.mark.parametrize("python", PYTHONS)
def test_every_public_name_is_there(python: str) -> None:
    assert told_in(python)[0] == []


def test_what_takes_beamng_is_told_by_name(tmp_path: Path) -> None:
    modules = [*ELSEWHERE, "self_driving.vehicle_state_reader"]
    tries = "".join(
        f"try:\n    from {module} import VehicleStateReader\nexcept ImportError as error:\n    print(error)\n"
        for module in modules
    )
    for module, told in zip(modules, run_in(sys.executable, tries).splitlines(), strict=True):
        assert f"RoadGPT has no stand-in for {module}" in told
        assert "PYTHONPATH" in told
    for module in modules:
        package, _, stem = module.partition(".")
        (tmp_path / package).mkdir(exist_ok=True)
        (tmp_path / package / "__init__.py").write_text("")
        (tmp_path / package / f"{stem}.py").write_text(f"VehicleStateReader = 'their {stem}'\n_private = 7")
    words = "from {} import VehicleStateReader, _private; print(VehicleStateReader, _private)\n"
    told = run_in(sys.executable, "".join(map(words.format, modules)), folder=tmp_path)
    assert told.splitlines() == [f"their {module.partition('.')[2]} 7" for module in modules]


def test_this_half_is_python_3_8_and_the_standard_library() -> None:
    own = {entry.stem for entry in FOLDER.iterdir()}
    for path in FOLDER.rglob("*.py"):
        for node in ast.parse(path.read_text(encoding="utf-8"), feature_version=(3, 8)).body:
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            modules += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for module in modules:  # what the file needs to be imported at all
                assert module.split(".")[0] in {*sys.stdlib_module_names, *own}, f"{path}: {module}"


@pytest.mark.skipif(not PYTHONS[1:], reason="no Python of 3.8 to 3.10 is installed")
def test_sums_are_the_same_in_an_old_interpreter() -> None:
    one, other = (told_in(python)[1] for python in PYTHONS)
    assert one == other
