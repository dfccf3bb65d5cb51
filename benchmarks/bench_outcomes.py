"""What outcomes mean: who keeps the lane on planner roads, by speed limit and friction; prints a table.

python benchmarks/bench_outcomes.py           300 roads of "a road": the figures of the documents
python benchmarks/bench_outcomes.py 60        fewer
python benchmarks/bench_outcomes.py --write   puts the table into docs/explanation/outcomes.md as well
"""

import argparse
import time
from collections import Counter
from pathlib import Path
from typing import Any

from roadgpt.brief.model import Brief
from roadgpt.design import draft
from roadgpt.drive import Command, View, simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.lane_centring import LaneCentring
from roadgpt.drive.drivers.pure_pursuit import PurePursuit
from roadgpt.drive.drivers.reference import Reference
from roadgpt.road import ORACLES, CrossSection, Design, Limits, Road, Site, World, build
from roadgpt.verdict import SEVERITIES, Verdict, judge

PAGE = Path(__file__).resolve().parents[1] / "docs" / "explanation" / "outcomes.md"
BEGIN, END = "<!-- measured by benchmarks/bench_outcomes.py -->", "<!-- end of what was measured -->"
CAUSES = ("out of lane", "fell", "stuck", "timeout")
CASES = ((40, 1.0), (70, 1.0), (100, 1.0), (70, 0.6), (70, 0.35))  # km/h and friction


class RollsStraight:
    """Rolls straight on at 40 km/h."""

    def steer(self, view: View) -> Command:
        wanted = 0.3 * (40 / 3.6 - view.speed)
        return Command(0.0, max(wanted, 0.0), max(-wanted, 0.0))


def planner_roads(count: int) -> list[Road]:
    """Roads of nothing but "a road", of the seeds 0, 1, 2 ..."""
    designs: list[Design] = []
    for seed in range(count):
        designs.append(draft(Brief(words="a road"), World(), earlier=designs, seed=seed))
    return [build(design) for design in designs]


def verdicts(roads: list[Road], driver: type[Any], world: World) -> list[tuple[Verdict, Verdict]]:
    """By the oracle of the world, and where lane departures count as well; of the same drives."""
    watched = world.changed(lane_departure=True)
    drives = [simulate(road, world, driver(), seed=0) for road in roads]
    return [(judge(r, d, world), judge(r, d, watched)) for r, d in zip(roads, drives, strict=True)]


def row(name: str, world: World, pairs: list[tuple[Verdict, Verdict]]) -> tuple[str, int]:
    found = [verdict for verdict, _ in pairs]
    passed = Counter(v.severity for v in found if v.kept)
    departed = sum(not strict.kept for _, strict in pairs)
    failed = Counter(v.cause for v in found if not v.kept)
    sides = Counter(v.side for v in found if v.side)
    margins = sorted(v.margin for v in found)
    cells = [
        name,
        world.limits.oracle,
        f"{world.limits.speed_limit * 3.6:.0f}",
        f"{world.site.friction:g}",
        f"{world.section.shoulder:g}",
        f"{failed.total()} of {len(found)}",
        f"{100 * failed.total() / len(found):.1f} %",
        ", ".join(f"{failed[cause]} {cause}" for cause in CAUSES if failed[cause]) or "none",
        f"{sides['left']} / {sides['right']}",
        f"{margins[len(margins) // 2]:.2f} m",
        " / ".join(str(passed[each]) for each in SEVERITIES),
        f"{100 * departed / len(found):.1f} %",
    ]
    return f"| {' | '.join(cells)} |", failed.total()


TITLES = (
    "driver",
    "oracle",
    "km/h",
    "friction",
    "shoulder (m)",
    "failed",
    "share",
    "causes",
    "left / right",
    "median margin",
    "passed with at most 10 % / partly / mostly outside",
    "failed if a front tyre over the marking fails as well",
)
HEAD = f"| {' | '.join(TITLES)} |\n|{'---|' * len(TITLES)}"


def main(count: int = 300, write: bool = False) -> None:
    start = time.process_time()
    roads = planner_roads(count)
    bent = [road for road in roads if abs(road.curvature(road.sample(1.0).s)).max() > 1e-3]
    lines = [f'{count} roads of the planner ("a road", seeds 0 to {count - 1}).', "", HEAD]
    failures: dict[tuple[str, int, float], int] = {}
    print("\n".join(lines), flush=True)

    def add(
        name: str,
        driver: type[Any],
        kmh: int,
        friction: float,
        verge: float = 3.0,
        oracle: str = "half",
        some: list[Road] = roads,
    ) -> None:
        world = World(
            limits=Limits(speed_limit=kmh / 3.6, **ORACLES[oracle]),
            site=Site(friction=friction),
            section=CrossSection(shoulder=verge),
        )
        line, failed = row(name, world, verdicts(some, driver, world))
        lines.append(line)
        print(line, flush=True)
        if verge:
            failures[name, kmh, friction] = failed

    add("never steers", RollsStraight, 40, 1.0, some=bent)
    add("reference", Reference, 40, 1.0)
    add("reference", Reference, 70, 1.0)
    for name, driver, oracle in (
        ("lane_centring", LaneCentring, "half"),
        ("beamng_like", BeamngLike, "thesis"),
    ):
        for kmh, friction in CASES:
            add(name, driver, kmh, friction, oracle=oracle)
        add(name, driver, 70, 1.0, verge=0.0, oracle=oracle)
    add("pure_pursuit", PurePursuit, 70, 1.0)
    add("pure_pursuit", PurePursuit, 70, 1.0, verge=0.0)
    for driver in (Reference, LaneCentring, BeamngLike, PurePursuit):
        print(f"{driver.name}: {microseconds(driver, roads[0]):.1f} microseconds per answer (wanted: 15)")
    checks = _checks(failures, len(bent), count)
    print("\n" + "\n".join(checks) + f"\n{time.process_time() - start:.0f} s of process time")
    if write:
        text = PAGE.read_text(encoding="utf-8")
        before, after = text.split(BEGIN)[0], text.split(END)[1]
        PAGE.write_text("\n".join([before + BEGIN, *lines, END + after]), encoding="utf-8")


def _checks(failures: dict[tuple[str, int, float], int], bent: int, count: int) -> list[str]:
    limits = [failures["beamng_like", kmh, 1.0] for kmh in (40, 70, 100)]
    grip = [failures["beamng_like", 70, friction] for friction in (1.0, 0.6, 0.35)]
    kept = count - failures["reference", 40, 1.0]
    never = failures["never steers", 40, 1.0]
    said = (
        (never == bent, f"never steering fails every road with a turn: {never} of {bent}"),
        (kept >= 0.99 * count, f"reference at 40 km/h keeps {kept} of {count} (wanted: 99 %)"),
        (limits == sorted(set(limits)), f"beamng_like fails more often at a higher limit: {limits}"),
        (grip == sorted(set(grip)), f"beamng_like fails more often on a slippery road: {grip}"),
    )
    return [f"{'met   ' if met else 'MISSED'} {sentence}" for met, sentence in said]


def microseconds(driver: type[Any], road: Road) -> float:
    """Median time of one answer, over a drive."""
    seen: list[View] = []

    class KeepsViews(driver):  # type: ignore[misc]
        def steer(self, view: View) -> Command:
            seen.append(view)
            return super().steer(view)

    simulate(road, World(), KeepsViews())
    one = driver()
    one.start(road, World(), 0)
    times = []
    for view in seen:
        begun = time.perf_counter()
        one.steer(view)
        times.append(time.perf_counter() - begun)
    return sorted(times)[len(times) // 2] * 1e6


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", nargs="?", type=int, default=300)
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    main(asked.count, asked.write)
