"""What a campaign costs: processor time from command to last file, words to a valid road, bytes on disk.

python benchmarks/bench_run.py [ROADS]"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from statistics import median

from roadgpt.report import draw
from roadgpt.run import Setup, perform, prove, write_run

WORDS = (
    "a road",
    "an uphill road with 3 turns",
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
)
ROADS = int(sys.argv[1]) if sys.argv[1:] else 100
TIMED = min(ROADS, 60)  # roads for the median
PICTURES = min(ROADS, 5)


def main() -> None:
    """Print every figure beside its target."""
    for words in WORDS:
        _whole_command(words)
    _words_to_road()
    _bytes_and_pictures()


def _whole_command(words: str) -> None:
    """`roadgpt run` as a process of its own, start included."""
    with tempfile.TemporaryDirectory() as home:
        command = [sys.executable, "-c", "from roadgpt.cli import main; main()", "run", words]
        command += [
            "-n",
            str(ROADS),
            "--seed",
            "7",
            "--no-drive",
            "--no-plot",
            "--quiet",
            "--out",
            f"{home}/c",
        ]
        before, begun = getrusage(RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, check=True)
        after, took = getrusage(RUSAGE_CHILDREN), time.perf_counter() - begun
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        size = sum(path.stat().st_size for path in Path(home).rglob("*") if path.is_file())
    print(f"{ROADS} roads, not driven, not drawn: {cpu:.2f} s processor (target 5 s for 100);")
    print(f"    {took:.2f} s clock, {size / ROADS / 1000:.1f} kB per road on disk; '{words}'")


def _words_to_road() -> None:
    """From words to a road that no rule objects to, after start; without files."""
    setup = Setup(drives=False)
    for words in WORDS:
        perform(words, 0, setup=setup)
        took = []
        for seed in range(1, TIMED + 1):
            begun = time.process_time()
            run = perform(words, seed, setup=setup)
            took.append(time.process_time() - begun)
            assert run.is_valid
        print(
            f"words to valid road: {median(took) * 1e3:.2f} ms of processor, median (target 5 ms); '{words}'"
        )


def _bytes_and_pictures() -> None:
    """One driven road on disk, and its pictures."""
    with tempfile.TemporaryDirectory() as home:
        drawn, written = [], []
        for index in range(1, PICTURES + 1):
            design = perform(WORDS[1], index, setup=Setup(drives=False)).design
            assert design is not None
            run = prove(design, index, index=index)
            begun = time.perf_counter()
            folder = write_run(run, Path(home))
            written.append(time.perf_counter() - begun)
            begun = time.perf_counter()
            draw(run, folder)
            drawn.append(time.perf_counter() - begun)
        sizes: dict[str, list[int]] = {}
        for path in (path for path in Path(home).rglob("*") if path.is_file()):
            kind = "test.NNNN.json" if path.name.startswith("test.") else path.name
            sizes.setdefault(kind, []).append(path.stat().st_size)
    print(f"files of a driven road: {median(written) * 1e3:.1f} ms on the clock")
    print(f"its pictures: {median(drawn):.2f} s on the clock (target 1.2 s)")
    total = sum(sum(each) for each in sizes.values()) / PICTURES
    largest = sorted(sizes.items(), key=lambda item: -sum(item[1]))[:6]
    print(f"a driven road on disk: {total / 1000:.0f} kB, of which")
    for name, each in largest:
        print(f"    {name:<22} {sum(each) / PICTURES / 1000:6.1f} kB")


if __name__ == "__main__":
    main()
