"""Test generators of the SBFT tool competition beside RoadGPT's search, all through `roadgpt compete sbft`.

    python benchmarks/bench_peers.py                   the quick look that `make bench` takes: RoadGPT's own
    python benchmarks/bench_peers.py --tests 200 --seeds 5 --checkouts FOLDER --python PYTHON \
        --folder FOLDER --markdown FILE.md

The generators of other people are yours to fetch; `peer_doors.py` says where in the folder of checkouts each
is looked for, and what is done to a copy of it. `--python TOOL=PYTHON` names the interpreter of one of them.
CRAG needs the program `pict`, on the PATH or as `--program pict=FILE`.

Every run has the same budget of tests (invalid ones included), a map of 200 m, 70 km/h and one thread for
numerics. Seeds number the runs: RoadGPT's own generators take them as seeds, the others draw their own. What
was found stays in `--folder`, so an interrupted benchmark goes on.

A failing cell is a cell of 25 x 25 in which a test failed: MAX_CURV from 0 to 0.07 1/m times STD_SA from 0 to
150 degrees, or times DIR_COV from 0 to 1, over the whole road. Segments: cells of MAX_CURV x STD_SA as the
competition's own analysis computes them, of the road from 30 m before to 30 m after each failure; for it, the
checkouts need the competition's repository. CPU: seconds of all processes, RoadGPT's and the generator's.
"""

import argparse
import ctypes
import itertools
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench_search import CELLS, MAPS
from peer_doors import COMPETITION, TOOLS, CannotRunError, prepared, segments_of, tests_in, version_of
from roadgpt.campaign.columns import cell_of
from roadgpt_search.behaviour import BOUNDS

DRIVERS = ("beamng_like", "lane_centring")
MAP_SIZE = 200  # m
LAST_WAIT = 30.0  # s in which processes must end that a generator left behind
SUBREAPER = 36  # Linux: processes whose parents have ended become ours, so that their seconds count

Figures = dict[str, Any]


@dataclass(frozen=True)
class Kit:
    """What is there to run generators with."""

    checkouts: Path | None
    pythons: dict[str, str]
    """Interpreters by the names of tools; under "", the one of all others."""
    programs: dict[str, str]
    versions: dict[str, str]

    def python(self, tool: str) -> str:
        """The interpreter of a tool."""
        asked = self.pythons.get(tool) or self.pythons.get("") or sys.executable
        return str(Path(shutil.which(asked) or asked).absolute())

    def version(self, tool: str) -> str:
        """What the user says, or what the checkout tells."""
        return self.versions.get(tool) or version_of(TOOLS[tool], self.checkouts)


@dataclass(frozen=True)
class ToolRun:
    """One run of one tool."""

    tool: str
    driver: str
    tolerance: float
    seed: int
    tests: int

    @property
    def name(self) -> str:
        """Of its results."""
        driver = re.sub(r"\W+", "-", self.driver)
        return f"{self.tool}.{driver}.{self.tolerance:g}.{self.seed}.{self.tests}"

    def words(self, module: str, out: Path, python: str) -> list[str]:
        """The command of this run."""
        tool = TOOLS[self.tool]
        words = [sys.executable, "-P", "-m", "roadgpt", "compete", "sbft"]
        words += ["--module-name", module, "--class-name", tool.class_name]
        words += ["--test-budget", str(self.tests), "--map-size", str(MAP_SIZE)]
        words += ["--oob-tolerance", f"{self.tolerance:g}"]
        words += ["--driver", self.driver, "--no-plot", "--out", str(out)]
        words += ["--module-path", tool.module_path] if tool.module_path else []
        return words + ([] if tool.is_ours else ["--python", python])


def run(job: ToolRun, kit: Kit, folder: Path) -> Figures:
    """Runs a generator, unless the folder already has what it found.

    Raises:
        CannotRunError: it cannot be started, or did not submit a single test.
    """
    kept, out = folder / f"{job.name}.json", folder / job.name
    if kept.is_file():
        found: Figures = json.loads(kept.read_text(encoding="utf-8"))
    else:
        shutil.rmtree(out, ignore_errors=True)
        found = run_generator(job, kit, out) | figures(out)
    competition = kit.checkouts / COMPETITION if kit.checkouts else None
    if not found.get("segments") and competition and competition.is_dir():
        found["segments"] = segments_of(out, competition, kit.python(""))
    kept.write_text(json.dumps(found), encoding="utf-8")
    return found


def run_generator(job: ToolRun, kit: Kit, out: Path) -> Figures:
    """Runs a generator; its results are in ``out`` then.

    Raises:
        CannotRunError: it cannot be started, or did not submit a single test.
    """
    seeds = {"ROADGPT_SEED": str(job.seed), "GENERATOR_SEED": str(job.seed)}
    env = {**os.environ, **seeds, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as named:
        place = Path(named).resolve()
        module = prepared(TOOLS[job.tool], kit.checkouts, place, kit.programs)
        before, begun = cpu_seconds(), time.monotonic()
        words = job.words(module, out.resolve(), kit.python(job.tool))
        done = subprocess.run(words, cwd=place, env=env, capture_output=True, text=True, check=False)
        wait_for_orphans()
        seconds, wall = cpu_seconds() - before, time.monotonic() - begun
    ending = ending_of(done.stdout + done.stderr)
    if next(tests_in(out), None) is None:
        raise CannotRunError(ending)
    version = kit.version(job.tool)
    return {"version": version, "cpu": seconds, "wall": wall, "ending": ending, "status": done.returncode}


def ending_of(printed: str) -> str:
    """How a generator ended, in RoadGPT's words, without the folders of this machine."""
    said = re.findall(r"^(?:the generator|roadgpt): (.*)$", printed, flags=re.MULTILINE)
    text = said[-1] if said else "RoadGPT ended without a word"
    return re.sub(r"(?<![\w.])(?:[A-Za-z]:)?[/\\](?:[^\s/\\]+[/\\])+", "", text)


def cpu_seconds() -> float:
    """Processor time of all child processes that have ended, and of theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def adopt_orphans() -> None:
    """Makes processes whose parents have ended ours, where the system can."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(SUBREAPER, 1, 0, 0, 0)


def wait_for_orphans() -> None:
    """Waits until all processes that a generator left behind have ended, so that their seconds count."""
    last = time.monotonic() + LAST_WAIT
    with suppress(ChildProcessError):
        while time.monotonic() < last:
            if os.waitpid(-1, os.WNOHANG)[0] == 0:
                time.sleep(0.05)


def figures(out: Path) -> Figures:
    """What the files of a run tell."""
    tests = [json.loads(path.read_text(encoding="utf-8")) for path in tests_in(out)]
    failed = [test["features"] for test in tests if test.get("test_outcome") == "FAIL"]
    cells = {"x".join(axes): len({cell_of(one, axes, CELLS, BOUNDS) for one in failed}) for axes in MAPS}
    valid = sum(test["is_valid"] for test in tests)
    return {"tests": len(tests), "valid": valid, "failures": len(failed), **cells}


COLUMNS = (
    "tool", "version", "driver", "tolerance", "runs", "valid", "failures",
    *(f"failing cells {' x '.join(axes)}" for axes in MAPS),
    "segments", "CPU s", "remarks",
)  # fmt: skip


def said(job: ToolRun, found: Sequence[Figures], version: str, errors: Sequence[str]) -> str:
    """A row of the table, in Markdown: medians over runs that differ only in the seed."""
    cells = [TOOLS[job.tool].title, " / ".join(sorted({one["version"] for one in found})) or version]
    cells += [job.driver.rpartition(":")[2], f"{job.tolerance:g}", str(len(found))]
    for key in ("valid", "failures", *("x".join(axes) for axes in MAPS)):
        cells.append(median([one[key] for one in found]))
    cells.append(median([one["segments"]["cells"] for one in found if one.get("segments")]))
    cells.append(median([round(one["cpu"]) for one in found]))
    remarks = [f"does not run: {error}" for error in dict.fromkeys(errors)]
    remarks += dict.fromkeys(
        f"{one['tests']} of {job.tests} tests: {one['ending']}" for one in found if one["tests"] < job.tests
    )
    if any(one.get("segments", {}) is None for one in found):
        remarks.append("the competition's own analysis did not run")
    return "| " + " | ".join([*cells, "; ".join(remarks).replace("|", "/")]) + " |"


def median(values: Sequence[float]) -> str:
    """'41 [38-43]'."""
    if not values:
        return "-"
    text = f"{np.median(values):g}"
    return text + (f" [{min(values):g}-{max(values):g}]" if len(set(values)) > 1 else "")


def header() -> list[str]:
    """The head of the table."""
    return ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]


def adaptations(tools: Sequence[str]) -> list[str]:
    """What was done to copies of the generators, as a list in Markdown."""
    theirs = [TOOLS[tool] for tool in tools if not TOOLS[tool].is_ours]
    return [f"- {tool.title}: {tool.adaptation}" for tool in theirs]


def table(asked: argparse.Namespace, kit: Kit, folder: Path) -> list[str]:
    """All rows, and what was done to the generators; the rows so far are written after each."""
    lines = header()
    seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
    for what in itertools.product(asked.tools, asked.drivers, asked.tolerances):
        lines.append(row([ToolRun(*what, seed, asked.tests) for seed in seeds], kit, folder))
        write(asked.markdown, lines)
    return [*lines, "", *adaptations(asked.tools)]


def row(jobs: Sequence[ToolRun], kit: Kit, folder: Path) -> str:
    """Runs a tool, and returns its row of the table."""
    found: list[Figures] = []
    errors: list[str] = []
    for job in jobs:
        try:
            found.append(run(job, kit, folder))
            print(f"{job.name}: {found[-1]}", file=sys.stderr, flush=True)
        except CannotRunError as error:
            errors.append(str(error))
            print(f"{job.name}: {error}", file=sys.stderr, flush=True)
    return said(jobs[0], found, kit.version(jobs[0].tool), errors)


def write(file: Path | None, lines: Sequence[str]) -> None:
    """Writes the table into a file, if there is one."""
    if file:
        file.write_text("\n".join([*lines, ""]), encoding="utf-8")


def pairs(given: Sequence[str]) -> dict[str, str]:
    """NAME=TEXT, by name; a text alone has the name ''."""
    return {name if mark else "": text if mark else name for name, mark, text in
            (one.partition("=") for one in given)}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--checkouts", type=Path, help="folder with checkouts of the generators")
    parser.add_argument("--python", nargs="+", default=[], help="PATH, or TOOL=PATH: interpreters of theirs")
    parser.add_argument("--program", nargs="+", default=[], help="NAME=FILE: a program that a tool calls")
    parser.add_argument(
        "--version", nargs="+", default=[], help="TOOL=TEXT, where the checkout has no commit"
    )
    parser.add_argument("--tools", nargs="+", choices=list(TOOLS))
    parser.add_argument("--drivers", nargs="+", default=list(DRIVERS), help="NAME, or /PATH/FILE.py:CLASS")
    parser.add_argument("--tolerances", nargs="+", type=float, default=[0.85])
    parser.add_argument("--seeds", type=int, default=1, help="runs of each")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--tests", type=int, default=20)
    parser.add_argument("--folder", type=Path, help="where results are kept; none: nowhere")
    parser.add_argument("--markdown", type=Path, help="file for the table")
    asked = parser.parse_args()
    asked.tools = asked.tools or [name for name, tool in TOOLS.items() if asked.checkouts or tool.is_ours]
    kit = Kit(
        asked.checkouts and asked.checkouts.resolve(),
        pairs(asked.python),
        pairs(asked.program),
        pairs(asked.version),
    )
    adopt_orphans()
    with tempfile.TemporaryDirectory() as nowhere:
        folder = asked.folder or Path(nowhere)
        folder.mkdir(parents=True, exist_ok=True)
        lines = table(asked, kit, folder)
    print("\n".join(lines))
    write(asked.markdown, lines)


if __name__ == "__main__":
    main()
