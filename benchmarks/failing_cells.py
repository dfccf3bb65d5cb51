"""How many cells there are in which a driver fails at all, estimated from all runs that are kept.

    python benchmarks/failing_cells.py FOLDER...         folders that `bench_peers.py --folder` filled

For each driver and tolerance: the cells of each map in which any run of any tool failed, how many of these
the runs of RoadGPT's search found, and a lower bound of the number of all failing cells (Chao 1987), from the
cells in which one run failed and those in which two did. The last column tells how the number of cells grows
with the number of runs: the mean over random orders of the runs.
"""

import argparse
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from bench_search import CELLS, MAPS
from peer_doors import tests_in
from roadgpt.campaign.columns import cell_of
from roadgpt_search.behaviour import BOUNDS

OURS = "roadgpt"
ORDERS = 200  # random orders of the runs

Cells = set[tuple[int, ...]]


def cells_in(run: Path, axes: Sequence[str]) -> Cells:
    """Returns the cells in which a run failed."""
    tests = (json.loads(path.read_text(encoding="utf-8")) for path in tests_in(run))
    return {
        cell_of(test["features"], axes, CELLS, BOUNDS) for test in tests if test.get("test_outcome") == "FAIL"
    }


def least(runs: Sequence[Cells]) -> float:
    """Returns Chao's lower bound of the number of all cells, bias-corrected."""
    seen = Counter(cell for run in runs for cell in run)
    once, twice = (sum(count == times for count in seen.values()) for times in (1, 2))
    return len(seen) + (len(runs) - 1) / len(runs) * once * (once - 1) / (2 * (twice + 1))


def growth(runs: Sequence[Cells]) -> list[float]:
    """Returns the mean number of cells that 1, 2, ... of the runs found together."""
    rng = np.random.default_rng(0)
    counts = []
    for _ in range(ORDERS):
        together: Cells = set()
        counts.append([len(together := together | runs[at]) for at in rng.permutation(len(runs))])
    return [float(mean) for mean in np.mean(counts, axis=0)]


def lines(folders: Sequence[Path]) -> Iterator[str]:
    """Yields the lines of the table."""
    jobs: dict[tuple[str, str], list[tuple[str, Path]]] = {}
    for folder in folders:
        for run in sorted(path for path in folder.iterdir() if path.is_dir()):
            tool, driver, tolerance = run.name.split(".", 2)
            jobs.setdefault((driver, tolerance.rsplit(".", 2)[0]), []).append((tool, run))
    yield "| driver | tolerance | map | runs (ours) | cells | ours | at least | 1, 2, 5, 10 ... runs |"
    yield "|---|---|---|---|---|---|---|---|"
    for (driver, tolerance), runs in jobs.items():
        for axes in MAPS:
            every = [cells_in(run, axes) for _, run in runs]
            ours = [cells for cells, (tool, _) in zip(every, runs, strict=True) if tool == OURS]
            union, own = set().union(*every), set().union(*ours)
            grown = growth(every)
            some = ", ".join(f"{grown[n - 1]:.0f}" for n in (1, 2, 5, 10, 20, 40) if n <= len(grown))
            yield (
                f"| {driver} | {tolerance} | {' x '.join(axes)} | {len(runs)} ({len(ours)}) | {len(union)} "
                f"| {len(own)} | {least(every):.0f} (ours alone {least(ours) if ours else 0:.0f}) | {some} |"
            )


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("folders", type=Path, nargs="+")
    print("\n".join(lines(options.parse_args().folders)))


if __name__ == "__main__":
    main()
