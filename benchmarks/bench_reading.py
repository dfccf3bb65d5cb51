"""How well the trained reader reads, and what it costs.

    python benchmarks/bench_reading.py [ROADS]

Prints the scores on the hand-written splits and on the exam (inputs that must be refused, and honest ones
that sound dangerous), the share of valid roads for the three prompts of RoadGPT's evaluation with
Clopper-Pearson intervals and a test of independence, and time and memory of the trained reader in a process
of its own.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.stats import beta, chi2_contingency

from roadgpt import check
from roadgpt.brief import check as check_brief
from roadgpt.brief import read, reader_of
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model import ModelReader
from roadgpt.design import draft
from roadgpt.errors import DesignError
from roadgpt.learn.calibrate import normal_change
from roadgpt.learn.evaluate import HEAD, readings, score
from roadgpt.learn.labels import read_pairs
from roadgpt.road import Design, World, build

HAND = Path(__file__).parents[1] / "data" / "descriptions"
CHANGES = HAND.parent / "changes" / "validation"
SPLITS = ("validation", "contrasts_validation", "free_validation", "test", "exam")
READERS = ("model",)
PROMPTS = (
    "a road",
    "an uphill road with 3 turns",
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
)
RECENT = 20  # designs that a new one is told not to repeat; all of a thousand would cost most of the time
COST = """
import json, resource, sys, time
begun = time.process_time()
from roadgpt.brief import reader_of
reader = reader_of("model")
reader.read("a road")
loaded = time.process_time() - begun
took = []
for text in json.load(sys.stdin):
    begun = time.process_time()
    try:
        reader.read(text)
    except Exception:
        pass
    took.append(1000 * (time.process_time() - begun))
took.sort()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(f"imported, loaded and read once in {loaded:.2f} s; "
      f"a description {took[len(took) // 2]:.1f} ms (median), "
      f"{took[int(0.95 * len(took))]:.1f} ms (95 %), {took[-1]:.1f} ms (slowest); {peak:.0f} MB at most")
"""


def main(roads: int = 1000) -> None:
    """All tables, one after another."""
    _scores()
    _changes()
    _validity(roads)
    _cost()


def _scores() -> None:
    print(HEAD)
    for split in SPLITS:
        pairs, _ = read_pairs((HAND / split).glob("*.jsonl"))
        for name in READERS:
            reader = reader_of(name)

            def asked(words: str, reader=reader) -> Brief:  # type: ignore[no-untyped-def]
                brief: Brief = reader.read(words)
                check_brief(brief, 250.0)  # as every command does
                return brief

            print(score(readings(pairs, asked if split == "exam" else reader.read)).row(f"{name}, {split}"))


def _changes() -> None:
    """Change requests that are read as labelled: the same changes, or refused for the same kind of reason."""
    pairs, _ = read_pairs(CHANGES.glob("*.jsonl"), is_change=True)
    reader = ModelReader()
    right = 0
    for pair in pairs:
        got = reader.read_change(pair.text, normal_change).plan
        if got.startswith("!") or pair.plan.startswith("!"):
            right += got.split()[0] == pair.plan.split()[0]
        else:
            right += normal_change(got) == normal_change(pair.plan)
    print(f"change requests of the validation split read as labelled: {right} of {len(pairs)}")


def _validity(roads: int) -> None:
    """Valid roads of each prompt; whether the prompts differ."""
    table = [(valid := _valid(words, roads), roads - valid) for words in PROMPTS]
    for words, (valid, _) in zip(PROMPTS, table, strict=True):
        low = beta.ppf(0.025, valid, roads - valid + 1) if valid else 0.0
        high = beta.ppf(0.975, valid + 1, roads - valid) if valid < roads else 1.0
        print(f"{valid} of {roads} valid, 95 % interval {100 * low:.2f} to {100 * high:.2f} %: '{words}'")
    counts = np.array(table)[:, np.sum(table, axis=0) > 0]
    if counts.shape[1] < 2:
        print("test of independence: all roads have one outcome, so the prompts do not differ")
    else:
        found = chi2_contingency(counts)
        print(f"test of independence: chi-squared {found.statistic:.2f}, p {found.pvalue:.3g}")


def _valid(words: str, roads: int) -> int:
    brief, designs, world, valid = read(words), list[Design](), World(), 0
    for seed in range(roads):
        try:
            design = draft(brief, world, earlier=designs[-RECENT:], seed=seed)
        except DesignError:
            continue
        designs.append(design)
        valid += not check.inspect(build(design), brief, world)
    return valid


def _cost() -> None:
    pairs, _ = read_pairs((HAND / "test").glob("*.jsonl"))
    texts = json.dumps([pair.text for pair in pairs])
    subprocess.run([sys.executable, "-c", COST], input=texts, text=True, check=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
