"""Change requests: how many are honoured, and what becomes of 26 usual changes on random roads.

    python benchmarks/bench_edit.py [ROADS]

The first figures are of the requests with truths in tests/edit/edits.jsonl, read from their words. Then
every one of the usual changes below, given as plans, is made of ROADS (default 40) random roads: changed, so
already, refused, or changed with the help of a repair of the rest of the road.
"""

import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from edit_truth import changed_besides, misses, ours, requests, roads
from roadgpt.brief import read
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.design import draft
from roadgpt.errors import EditError
from roadgpt.road import Design, World
from roadgpt_edit.editing import edit

PLANS = (
    "turn x4",
    "winding | up",
    "turn x5 | hills=3..",
    "hairpin x2; turn left",
    "turn x6 | down",
    "serpentine",
    "chicane; hairpin",
    "turn x3 sharp",
)
USUAL = (
    "turn 2: angle more",
    "turn 1: angle less",
    "turn -1: angle slightly more",
    "turn 2: angle =90",
    "turn 2: radius less",
    "turn -1: radius =40",
    "turn 2: side other",
    "turn 1: side other",
    "straight 2: length +20",
    "straight longest: length less",
    "end: slope down",
    "start: slope up =5",
    "turn 2: slope flat",
    "add turn left at_end",
    "add turn right after(turn 1)",
    "add hairpin at_start",
    "add turn gentle between(turn 1, turn 2)",
    "turn 2: remove",
    "turn 1: remove",
    "turn -1: remove",
    "road: length +40",
    "road: length -30",
    "road: mirror",
    "turn all: angle less",
    "turn all: angle more",
    "road: slope flat",
)


def outcome(design: Design, plan: str) -> str:
    """What becomes of one plan of changes."""
    try:
        made = edit(design, read_change_plan(plan), World())
    except EditError as error:
        return "so already" if "so already" in str(error) else "refused"
    repaired = any(sentence.startswith("to keep it valid") for sentence in made.changes)
    return "with a repair of the rest" if repaired else "changed"


def main() -> None:
    """Prints all figures."""
    known, honoured, alone = roads(), 0, 0
    rows = requests()
    for row in rows:
        old = known[row["road"]]
        try:
            new = edit(old, row["request"], World()).design
        except EditError as error:
            honoured += "refused" in row and all(word in str(error) for word in row["refused"])
            alone += 1
            continue
        honoured += "refused" not in row and not misses(row, old, new, ours)
        alone += not changed_besides(old, new, row.get("touched", []))
    print(f"requests with truths: {honoured} of {len(rows)} honoured, the rest untouched in {alone}")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    begun, counts = time.perf_counter(), Counter[str]()
    for number in range(count):
        line = PLANS[number % len(PLANS)]
        seed = 1000 + 10 * (number // len(PLANS)) + number % len(PLANS)
        design = draft(read(line, "plan"), World(), seed=seed)
        counts.update(outcome(design, change) for change in USUAL)
    seconds = (time.perf_counter() - begun) / max(counts.total(), 1)
    told = ", ".join(f"{number} {what}" for what, number in counts.most_common())
    print(f"usual changes on {count} random roads: {counts.total()}: {told}; {1000 * seconds:.0f} ms each")


if __name__ == "__main__":
    main()
