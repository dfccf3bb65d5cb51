"""How many failures a search finds, and how different they are, beside the field's random walk and drafts.

    python benchmarks/bench_search.py                  the quick look that `make bench` takes
    python benchmarks/bench_search.py --whole -j 2     10 seeds of 200 tests: the figures of the documents
    python benchmarks/bench_search.py --whole --folder FOLDER --referee FILE.py

All have the same number of tests, map, tolerance, driver, car and seeds. What was found is kept in FOLDER,
one file per setting, method and seed, so an interrupted run goes on. With ``--referee`` every road inside a
Brief is held against an outside judge of roads: FILE.py has ``check(points, truth)``, which says by criterion
what holds.

A failing cell is a cell of the field's map in which a test failed: 25 cells of MAX_CURV, from 0 to 0.07 1/m,
times 25 of STD_SA, from 0 to 150 degrees. Besides, MAX_CURV times DIR_COV (0 to 1). Sparseness is the
competition's, over failures.
"""

import argparse
import importlib.util
import itertools
import json
import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from scipy.stats import bootstrap, mannwhitneyu

from roadgpt.campaign import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.columns import cell_of, features_in
from roadgpt.campaign.single_test import Task, execute, result_of
from roadgpt.road import Limits, Road, Site, World, build
from roadgpt.run import Request, Setup, brief_of, prove
from roadgpt_sbft.sparseness import Sparseness, departure
from roadgpt_sbft.validator import sbft_verdict
from roadgpt_search.behaviour import BOUNDS
from roadgpt_search.genetic import Genetic
from roadgpt_search.quality_diversity import QualityDiversity
from roadgpt_search.random_drafts import Random

CELLS = 25
MAPS = (("MAX_CURV", "STD_SA"), ("MAX_CURV", "DIR_COV"))

# The field's walk (Frenetic's, as its successors have it): 17 curvatures, one every 10 m
STEPS, STEP = 17, 10.0
GLOBAL_BOUND, LOCAL_BOUND = 0.07, 0.05  # 1/m: of a curvature, and of its change

TOLERANCE = 0.85
WORLD = World(site=Site(map_size=200.0, z_floor=0.0), limits=Limits(oob_tolerance=TOLERANCE))
USUAL = Setup(rules="sbft")


METHODS: dict[str, Callable[[Cell], Any]] = {
    "random": Random,
    "genetic": Genetic,
    "quality_diversity": QualityDiversity,
}
SEARCHES = ("random", "genetic", "quality_diversity")
AGAINST_DRAFTS = ("random", "quality_diversity")
AGAINST_THE_WALK = ("walk", "genetic", "quality_diversity")
TURN = {"kind": "turn", "deg": [20, 125]}


@dataclass(frozen=True)
class MethodSetting:
    """What several methods are compared on; the first is what the others are compared with."""

    words: str
    methods: tuple[str, ...] = AGAINST_DRAFTS
    driver: str = "beamng_like"
    friction: float = 1.0
    speed_kmh: float = 70.0
    truth: dict[str, Any] | None = None
    """What the referee is asked for."""
    borrows: str = ""
    """Setting of the same world and driver, whose walk is taken."""

    @property
    def world(self) -> World:
        """Flat ground all around, as the competition's level has it."""
        return WORLD.changed(friction=self.friction, speed_limit=self.speed_kmh / 3.6)


SETTINGS = {
    "flat": MethodSetting("a flat road", AGAINST_THE_WALK, truth={"turns": [1, None], "grade": "flat"}),
    "wet": MethodSetting(
        "a flat road",
        AGAINST_THE_WALK,
        driver=f"{Path(__file__).resolve().parent / 'assumes_dry.py'}:AssumesDry",
        friction=0.57,
        truth={"turns": [1, None], "grade": "flat"},
    ),
    "uphill": MethodSetting(
        "an uphill road with 3 turns", truth={"turns": 3, "grade": "up", "sequence": [TURN, TURN, TURN]}
    ),
    "serpentine": MethodSetting(
        "a serpentine road", truth={"turns": [4, None], "alternating": True, "turning": [200, None]}
    ),
    "down_left": MethodSetting(
        "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
        truth={
            "turns": 3,
            "sequence": [
                {"kind": "turn", "grade": "up"},
                {"kind": "turn", "grade": "up"},
                {"kind": "straight", "grade": "down"},
                {"kind": "turn", "dir": "left"},
            ],
        },
    ),
    "centring": MethodSetting(
        "a flat road",
        AGAINST_THE_WALK,
        driver="lane_centring",
        truth={"turns": [1, None], "grade": "flat"},
    ),
    "slopes": MethodSetting(
        "a road", ("walk", "quality_diversity"), truth={"turns": [1, None]}, borrows="flat"
    ),
}


def walks(seed: int) -> Iterator[Road]:
    """The field's random walk in curvature: valid roads, in the middle of the map."""
    rng = np.random.default_rng(seed)
    while True:
        bends = [rng.uniform(-GLOBAL_BOUND, GLOBAL_BOUND)]
        while len(bends) < STEPS:
            low, high = bends[-1] - LOCAL_BOUND, bends[-1] + LOCAL_BOUND
            bends.append(rng.uniform(max(low, -GLOBAL_BOUND), min(high, GLOBAL_BOUND)))
        points = points_of(bends, rng.uniform(0, 2 * math.pi))
        points += WORLD.site.map_size / 2 - (points.min(axis=0) + points.max(axis=0)) / 2
        if sbft_verdict(points, WORLD.site.map_size)[0]:
            yield Road.through(points)


def points_of(bends: Sequence[float], heading: float) -> np.ndarray:
    """Control points of curvatures: the trapezoid rule, twice, as the field's generators have it."""
    x = y = 0.0
    points = [(x, y)]
    for one, other in itertools.pairwise(bends):
        turned = heading + (one + other) * STEP / 2
        x += (math.cos(heading) + math.cos(turned)) * STEP / 2
        y += (math.sin(heading) + math.sin(turned)) * STEP / 2
        heading = turned
        points.append((x, y))
    return np.array(points)


@dataclass(frozen=True)
class MethodRun:
    """One method, on one setting, with one seed."""

    setting: str
    method: str
    seed: int
    tests: int
    referee: str | None

    @property
    def name(self) -> str:
        """Of its file."""
        return f"{self.setting}.{self.method}.{self.seed}.{self.tests}.json"


class SerialPool:
    """A pool of nobody else: each job is a process of its own."""

    def map(self, function: Callable[[Any], Any], items: Sequence[Any]) -> list[Any]:
        return [function(item) for item in items]


def found(job: MethodRun) -> dict[str, Any]:
    """What a job found."""
    setting = SETTINGS[job.setting]
    request = Request(
        words=setting.words,
        seed=job.seed,
        world=setting.world,
        setup=USUAL.model_copy(update={"driver": setting.driver}),
    )
    brief = brief_of(setting.words, request.world, request.setup)
    cell = Cell("c01", request, brief, job.method, "failures", budget=CellBudget(tests=job.tests))
    tried = walked(cell, job) if job.method == "walk" else searched(cell, job)
    return figures(cell, tried, job.referee, setting.truth)


def walked(cell: Cell, job: MethodRun) -> list[tuple[Result, Road]]:
    """Tests of the field's walk."""
    out = []
    for number, road in enumerate(itertools.islice(walks(job.seed), job.tests), 1):
        run = prove(road, job.seed, cell.request.world, cell.request.setup, number)
        task = Task(number, 0, Proposal(None, job.seed, "walk"))
        out.append((result_of(run, task, features_in(run)), road))
    return out


def searched(cell: Cell, job: MethodRun) -> list[tuple[Result, Road]]:
    """Tests of a generator of ours, told of results as in a campaign: one batch later."""
    generator = METHODS[job.method](cell)
    batches: list[list[Result]] = []
    number = 1
    while number <= job.tests:
        if len(batches) >= 2:
            generator.tell(batches[-2])
        n = min(generator.batch_size, job.tests - number + 1)
        proposals = generator.ask(len(batches), number, n, SerialPool())
        tasks = [Task(at, len(batches), one) for at, one in enumerate(proposals, number)]
        batches.append([execute(task, cell).result for task in tasks])
        number += len(proposals)
    results = [result for batch in batches for result in batch]
    return [(result, build(result.design)) for result in results]


def figures(
    cell: Cell, tried: list[tuple[Result, Road]], referee: str | None, truth: dict[str, Any] | None
) -> dict[str, Any]:
    """All that tables show of a search."""
    spread = Sparseness()
    failures = [(result, road) for result, road in tried if result.outcome == "FAIL"]
    for result, road in failures:
        begin, end = (road.at(s)[:2].tolist() for s in (0.0, result.at_s))
        records = SimpleNamespace(pos=begin, is_oob=False), SimpleNamespace(pos=end, is_oob=True)
        left = departure(road.control_points(), records)
        if left is not None and left.segment is not None:
            spread.add(result.number, left.segment)
    judge = judge_of(referee) if referee else None
    valid = sum(result.outcome in ("PASS", "FAIL") for result, _ in tried)
    out = {
        "tests": len(tried),
        "valid": valid,
        "sbft": sum(
            sbft_verdict(road.control_points(), cell.request.world.site.map_size)[0] for _, road in tried
        ),
        "failures": len(failures),
        "sparseness": spread.mean if len(failures) > 1 else None,
        "first": min((result.number for result, _ in failures), default=None),
        "length": float(np.mean([road.length for _, road in tried])),
        "margins": [result.margin for result, _ in tried],
    }
    for axes in MAPS:
        cells = [cell_of(result.features, axes, CELLS, BOUNDS) for result, _ in tried]
        out["x".join(axes)] = len({c for c, (result, _) in zip(cells, tried, strict=True) if result.failed})
        out["all " + "x".join(axes)] = len(set(cells))
    if judge and truth and cell.generator != "walk":
        judged = [judged_by(judge, road, truth) for _, road in tried]
        out["kept"], out["unjudged"] = judged.count(True), judged.count(None)
    return out


def judged_by(judge: ModuleType, road: Road, truth: dict[str, Any]) -> bool | None:
    """Does a road keep its Brief? None where the judge itself breaks down."""
    try:
        return all(judge.check(road.centreline().round(4), truth)[0].values())
    except Exception:  # of somebody else's file nothing is known
        return None


def judge_of(path: str) -> ModuleType:
    """An outside judge of roads, from its file."""
    spec = importlib.util.spec_from_file_location("judge", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def done(jobs: Sequence[MethodRun], folder: Path, workers: int) -> dict[MethodRun, dict[str, Any]]:
    """What all jobs found; what a file knows is not done again."""
    missing = [job for job in jobs if not (folder / job.name).is_file()]
    with ProcessPoolExecutor(workers) as pool:
        futures = {pool.submit(found, job): job for job in missing}
        for number, future in enumerate(as_completed(futures), 1):
            job = futures[future]
            (folder / job.name).write_text(json.dumps(future.result()), encoding="utf-8")
            print(f"{number} of {len(missing)}: {job.name}", flush=True)
    return {job: json.loads((folder / job.name).read_text(encoding="utf-8")) for job in jobs}


def table(setting: str, results: dict[MethodRun, dict[str, Any]]) -> list[str]:
    """Rows of Markdown: medians over seeds, with bootstrap intervals of 95 %."""
    what = SETTINGS[setting]
    own = {
        job: one
        for job, one in results.items()
        if job.setting == setting or (job.setting == what.borrows and job.method == "walk")
    }
    base = {
        key: [one[key] for job, one in own.items() if job.method == what.methods[0]]
        for key in ("failures", "x".join(MAPS[0]))
    }
    tests = next(iter(own)).tests
    seeds = len({job.seed for job in own})
    driver = what.driver.rpartition(":")[2]
    lines = [
        f'**{setting}**: "{what.words}", {tests} tests, {seeds} seeds, driver {driver}'
        + (f", friction {what.friction:g}" if what.friction != 1 else "")
        + (f", {what.speed_kmh:g} km/h" if what.speed_kmh != 70 else ""),
        "",
        "| method | failures | failing cells (MAX_CURV x STD_SA) | failing cells (MAX_CURV x DIR_COV) "
        "| sparseness | first failure at test | valid | keeps the Brief | mean length |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for method in what.methods:
        rows = [one for job, one in own.items() if job.method == method]
        if not rows:
            continue
        cells = [
            method,
            *(said([row[key] for row in rows], base.get(key), method == what.methods[0])
              for key in ("failures", *("x".join(axes) for axes in MAPS))),
            middle([row["sparseness"] for row in rows]),
            middle([row["first"] for row in rows], "{:.0f}"),
            f"{100 * sum(r['valid'] for r in rows) / sum(r['tests'] for r in rows):.1f} %",
            kept(rows),
            f"{np.mean([row['length'] for row in rows]):.0f} m",
        ]  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
    return [*lines, ""]


def kept(rows: Sequence[dict[str, Any]]) -> str:
    """'2,000 of 2,000', by the outside judge; roads on which it broke down itself are named."""
    if not all("kept" in row for row in rows):
        return "-"
    broke = sum(row.get("unjudged", 0) for row in rows)
    judged = sum(row["tests"] for row in rows) - broke
    text = f"{sum(row['kept'] for row in rows):,} of {judged:,}"
    return text + (f", {broke} not judged" if broke else "")


def said(values: Sequence[float], base: Sequence[float] | None, is_base: bool) -> str:
    """'61.5 [58, 66], 4.1 times, p = 1.8e-04'."""
    median = float(np.median(values))
    text = f"{median:g}"
    if len(set(values)) > 1:
        interval = bootstrap(
            (np.array(values),), np.median, method="percentile", rng=np.random.default_rng(0)
        ).confidence_interval
        text += f" [{interval.low:g}, {interval.high:g}]"
    if not base or is_base:
        return text
    p = mannwhitneyu(values, base, alternative="greater").pvalue
    usual = float(np.median(base))
    times = f"{median / usual:.1f} times" if usual else "from none"
    return f"{text}, {times}, p = {p:.1e}"


def middle(values: Sequence[float | None], form: str = "{:.1f}") -> str:
    """The median of those that are known."""
    known = [value for value in values if value is not None]
    return form.format(float(np.median(known))) if known else "-"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--whole", action="store_true", help="all settings, 10 seeds of 200 tests")
    parser.add_argument("--seeds", type=int)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--tests", type=int)
    parser.add_argument("--settings", nargs="+", choices=list(SETTINGS))
    parser.add_argument("--methods", nargs="+", choices=["walk", *SEARCHES])
    parser.add_argument("--folder", type=Path, help="where results are kept; none: nowhere")
    parser.add_argument("--referee", help="FILE.py of an outside judge")
    parser.add_argument("-j", "--jobs", type=int, default=2)
    asked = parser.parse_args()
    seeds, tests = asked.seeds or (10 if asked.whole else 2), asked.tests or (200 if asked.whole else 60)
    settings = asked.settings or (list(SETTINGS) if asked.whole else ["flat"])
    jobs = {
        MethodRun(
            (method == "walk" and SETTINGS[setting].borrows) or setting, method, seed, tests, asked.referee
        ): 0
        for setting in settings
        for seed in range(asked.first_seed, asked.first_seed + seeds)
        for method in SETTINGS[setting].methods
        if not asked.methods or method in asked.methods
    }
    with tempfile.TemporaryDirectory() as nowhere:
        folder = asked.folder or Path(nowhere)
        folder.mkdir(parents=True, exist_ok=True)
        results = done([*jobs], folder, asked.jobs)
    print("\n".join(line for setting in settings for line in table(setting, results)))


if __name__ == "__main__":
    main()
