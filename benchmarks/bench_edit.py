"""Change requests: how many are honoured, and what becomes of 26 usual ones on random roads.

    python benchmarks/bench_edit.py [ROADS]

The first figures are of the requests with truths in tests/design/edits.jsonl. Then every one of the usual
requests below is made of ROADS (default 40) random roads: changed, so already, refused, or changed with the
help of a repair of the rest of the road.
"""

import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from edit_truth import changed_besides, misses, ours, requests, roads
from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.design.edit import edit
from roadgpt.errors import EditError
from roadgpt.road import Design, World

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
    "make the second turn sharper",
    "make the first turn gentler",
    "make the last turn a bit sharper",
    "make the second turn 90 degrees",
    "make the second turn tighter",
    "make the last turn with a radius of 40 m",
    "flip the second turn",
    "make the first turn go the other way",
    "make the second straight 20 m longer",
    "make the longest straight shorter",
    "make the end downhill",
    "make the start uphill at 5 %",
    "make the second turn level",
    "add a left turn at the end",
    "add a right turn after the first turn",
    "add a hairpin at the start",
    "add a gentle turn between the first and the second turn",
    "remove the second turn",
    "remove the first turn",
    "remove the last turn",
    "make the road 40 m longer",
    "make the road 30 m shorter",
    "mirror the road",
    "make all turns gentler",
    "make all turns sharper",
    "make the whole road level",
)


def outcome(design: Design, words: str) -> str:
    """What becomes of one request."""
    try:
        made = edit(design, words, World())
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
        counts.update(outcome(design, request) for request in USUAL)
    seconds = (time.perf_counter() - begun) / max(counts.total(), 1)
    told = ", ".join(f"{number} {what}" for what, number in counts.most_common())
    print(f"usual requests on {count} random roads: {counts.total()}: {told}; {1000 * seconds:.0f} ms each")


if __name__ == "__main__":
    main()
