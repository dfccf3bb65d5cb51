"""The test generators of other people that `bench_peers.py` runs, and how each gets through RoadGPT's door.

RoadGPT neither ships nor fetches them: you name a folder with your checkouts of them. A checkout is never
changed: what a generator needs is done to a temporary copy, as the sentence in its entry says.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench_search import CELLS, MAPS, walks
from roadgpt import __version__
from roadgpt.campaign.columns import cell_of
from roadgpt_search.behaviour import BOUNDS

HERE = Path(__file__).resolve().parent
COMPETITION = "tools24"  # folder with the competition's repository of 2024
DOOR = "roadgpt_door"  # module that prepares a generator and imports its class


class CannotRunError(Exception):
    """A generator cannot be started; the message says why."""


@dataclass(frozen=True)
class Tool:
    """One test generator."""

    title: str
    module: str
    class_name: str
    folder: str = ""
    """The package that is copied, in the folder of checkouts; empty for a generator of RoadGPT's."""
    module_path: str = ""
    """Folder of a module of RoadGPT's."""
    adaptation: str = "none"
    files: tuple[str, ...] = ()
    """Empty files that it wants to find in its current folder."""
    names: tuple[tuple[str, str], ...] = ()
    """Further names of files: (the name that it asks for, the file's own), in its current folder."""
    programs: tuple[tuple[str, str], ...] = ()
    """Programs it calls: (the path that it calls, the name of the program)."""
    first: str = ""
    """What runs in its process before its class is imported."""

    @property
    def is_ours(self) -> bool:
        """Is it RoadGPT's own, which needs neither a checkout nor another interpreter?"""
        return not self.folder


FLOATS_FOR_ADAM = """\
import torch

usual = torch.optim.Adam


class Adam(usual):
    def __init__(self, params, betas=(0.9, 0.999), **others):
        super().__init__(params, betas=tuple(float(one) for one in betas), **others)


torch.optim.Adam = Adam
"""

TIME_AND_MODEL = """\
from code_pipeline.beamng_executor import BeamngExecutor
from stable_baselines3 import PPO

usual_time, usual_load = BeamngExecutor.get_remaining_time, PPO.load
for_training = {"learning_rate": 0.0, "lr_schedule": lambda _: 0.0, "clip_range": lambda _: 0.0}


def get_remaining_time(self):
    left = usual_time(self)
    left["time-budget"] += 40.0
    return left


def load(path):
    return usual_load(path, custom_objects=for_training)


BeamngExecutor.get_remaining_time = get_remaining_time
PPO.load = load
"""

PICT = "The program `pict` is put beside its source: the checkout has it for Windows only."

TOOLS = {
    "roadgpt": Tool("RoadGPT's search", "roadgpt_sbft", "RoadGPTTestGenerator"),
    "simple_ga": Tool(
        "the example `simple_ga`",
        "simple_ga",
        "SimpleGA",
        module_path=str(HERE.parent / "examples" / "sbft"),
    ),
    "walk": Tool("random walk in curvature", "peer_doors", "Walk", module_path=str(HERE)),
    "ambiegenvae2024": Tool(
        "AmbieGenVAE 2024",
        "ambiegenvae.ambiegenvae_generator",
        "AmbiegenVAEGenerator",
        f"{COMPETITION}/ambiegenvae",
        names=(
            ("ambiegenvae\\vae_dataset.npy", "ambiegenvae/vae_dataset.npy"),
            ("ambiegenvae\\VAE_models", "ambiegenvae/VAE_models"),
        ),
        adaptation="Its two data files get second names with the backslash of Windows that it asks for.",
    ),
    "crag2024": Tool(
        "CRAG 2024",
        "src.crag",
        "CRAG",
        f"{COMPETITION}/crag-sbft2024/src",
        programs=(("src/pict", "pict"),),
        adaptation=PICT,
    ),
    "crag2023": Tool(
        "CRAG 2023",
        "src.crag",
        "CRAG",
        f"{COMPETITION}/crag-sbft2023/src",
        programs=(("src/pict", "pict"),),
        adaptation=PICT,
    ),
    "optangle2024": Tool(
        "OptAngle 2024", "optangle.src.optangle", "OptAngleGenerator", f"{COMPETITION}/optangle"
    ),
    "frenetic2021": Tool(
        "Frenetic 2021",
        "src.generators.random_frenet_generator",
        "Frenetic",
        "frenetic-sbst21/src",
        files=("simulations/beamng_executor/none.json",),
        adaptation="An empty file stands for the simulator's, whose name it notes; it wants pandas 1.3.",
    ),
    "wogan2023": Tool(
        "WOGAN 2023",
        "src.wogan",
        "WOGAN",
        f"{COMPETITION}/wogan-sbft2023/src",
        first=FLOATS_FOR_ADAM,
        adaptation="Whole numbers that it passes to torch's optimiser become floats, as today's torch wants.",
    ),
    "rigaa2023": Tool(
        "RIGAA 2023",
        "src.rigaa_generator",
        "RIGAATestGenerator",
        f"{COMPETITION}/rigaa-sbft2023/src",
        names=(("rigaa-sbft2023/src/models/rl_model.zip", "src/models/rl_model.zip"),),
        first=TIME_AND_MODEL,
        adaptation="It leaves the last 40 s of its budget unused and would wait for ever with one test left, "
        "which counts as 35 s: it is told of 40 s more. Its model gets a second name, with its folder's, and "
        "is loaded without its schedules for training, which only the Python that wrote it can read. It "
        "wants pymoo 0.6.0 and stable-baselines3 1.6.2.",
    ),
}


class Walk:
    """The field's random walk, as `bench_search.py` has it: only valid roads are submitted."""

    def __init__(self, executor: Any = None, map_size: int | None = None) -> None:
        self.executor = executor
        del map_size  # the walk is one for a map of 200 m

    def start(self) -> None:
        """Submits roads until the budget is used up."""
        from code_pipeline.tests_generation import RoadTestFactory  # exists only in a generator's process

        for road in walks(int(os.environ["GENERATOR_SEED"])):
            if self.executor.is_over():
                return
            points = [(float(x), float(y)) for x, y in road.control_points()]
            self.executor.execute_test(RoadTestFactory.create_road_test(points))


def prepared(tool: Tool, checkouts: Path | None, place: Path, programs: dict[str, str]) -> str:
    """Copies a generator to a folder and does what it needs there.

    Returns:
        The name of the module that has its class.

    Raises:
        CannotRunError: there is no checkout, or a program is missing.
    """
    if tool.is_ours:
        return tool.module
    if checkouts is None:
        raise CannotRunError("no folder of checkouts was named")
    source = checkouts / tool.folder
    if not source.is_dir():
        raise CannotRunError(f"the checkouts have no {tool.folder}")
    shutil.copytree(source, place / source.name)
    for name in tool.files:
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).touch()
    for name, own in tool.names:
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).symlink_to(place / own)
    for called, name in tool.programs:
        found = shutil.which(programs.get(name, name))
        if found is None:
            raise CannotRunError(f"it calls the program {name}, which was not found")
        (place / called).symlink_to(Path(found).resolve())
    if not tool.first:
        return tool.module
    text = f"{tool.first}\nfrom {tool.module} import {tool.class_name}\n"
    (place / f"{DOOR}.py").write_text(text, encoding="utf-8")
    return DOOR


def version_of(tool: Tool, checkouts: Path | None) -> str:
    """The commit of a checkout; without git's data, a hash of its Python files."""
    if tool.is_ours:
        return f"RoadGPT {__version__}"
    if checkouts is None or not (checkouts / tool.folder).is_dir():
        return "-"
    folder = (checkouts / tool.folder).resolve()
    words = ["git", "-C", str(folder), "rev-parse", "--show-toplevel", "--short", "HEAD"]
    try:
        told = subprocess.run(words, capture_output=True, text=True, check=False).stdout.split("\n")
    except OSError:  # there is no git
        told = []
    if len(told) > 1 and Path(told[0]).is_relative_to(checkouts.resolve()):
        return f"commit {told[1]}"
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return f"files {digest.hexdigest()[:10]}"


ANALYSE = """\
import json, sys
from code_pipeline.tests_evaluation import OOBAnalyzer

found = [
    [one["maximum_curvature"], one["stdev_steering"], one["oob_side"]]
    for one in OOBAnalyzer(sys.argv[1]).oobs
    if one["oob_point"] is not None
]
print("FOUND" + json.dumps(found))
"""


def segments_of(results: Path, competition: Path, python: str) -> dict[str, Any] | None:
    """What the competition's own analysis says of the road around each failure: the number of failures that
    it could analyse, of those to the left, and of occupied cells of MAX_CURV x STD_SA.

    Args:
        results: folder with the files test.NNNN.json.
        competition: a checkout of the competition's repository.
        python: an interpreter that has what its analysis imports.

    Returns:
        None if the analysis does not run.
    """
    with tempfile.TemporaryDirectory() as alone:  # their analysis looks into all folders below
        for path in tests_in(results):
            shutil.copy(path, alone)
        words = [python, "-c", ANALYSE, alone]
        done = subprocess.run(words, cwd=competition, capture_output=True, text=True, check=False)
    told = re.search(r"^FOUND(.*)$", done.stdout, flags=re.MULTILINE)
    if told is None:
        return None
    found = json.loads(told[1])
    cells = {
        cell_of({"MAX_CURV": bend, "STD_SA": steering}, MAPS[0], CELLS, BOUNDS) for bend, steering, _ in found
    }
    left = sum(side == "LEFT" for *_, side in found)
    return {"analysed": len(found), "left": left, "cells": len(cells)}


def tests_in(results: Path) -> Iterator[Path]:
    """The competition's files for tests, in order."""
    return iter(sorted(results.glob("test.*.json")))
