"""How well the trained reader reads, and what it costs.

    python benchmarks/bench_reading.py [ROADS]

Prints the scores on the hand-written splits and on the exam (inputs that must be refused, and honest ones
that sound dangerous), how many descriptions of routes with junctions and texts of the field are read exactly,
by manner and language, how sure the reader is of the latter, the share of valid
roads for the three prompts of RoadGPT's evaluation with Clopper-Pearson intervals and a test of independence,
and time and memory of the trained reader in a process of its own.
"""

import json
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.stats import beta, chi2_contingency

from roadgpt import check
from roadgpt.brief import SURE, AnotherRoadError, normal, read, reader_of
from roadgpt.brief import check as check_brief
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.scene import Scene
from roadgpt.design import draft
from roadgpt.errors import BriefError, DesignError
from roadgpt.road import Design, World, build
from roadgpt_training.data import is_for_roads_only
from roadgpt_training.evaluate import HEAD, readings, score
from roadgpt_training.labels import read_pairs
from roadgpt_training.pair import Pair, normal_change

HAND = Path(__file__).parents[1] / "data" / "descriptions"
CHANGES, SCENE_CHANGES = (HAND.parent / "changes" / name for name in ("validation", "scenes_validation"))
FIELD = HAND.parent / "field" / "validation"
NETWORKS = HAND.parent / "networks"
SPLITS = ("validation", "contrasts_validation", "free_validation", "test", "exam")
READERS = ("model",)
READER = ModelReader()
PARTS = (
    *("road", "actors", "scene", "all", "sure", "all, sure", "all, words not used"),
    *("different, sure, no word named", "wrongly refused", "rightly refused", "built"),
)
PROMPTS = (
    "a road",
    "an uphill road with 3 turns",
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
)
EXACT, DOUBTED, SILENT = "exact", "different, with a doubt", "silently different"
REFUSED, ASKED = "refused though it can be built", "refused, another plan offered"
RIGHTLY, BUILT = "rightly refused", "built though it must be refused"
VERDICTS = (EXACT, DOUBTED, SILENT, REFUSED, ASKED, RIGHTLY, BUILT)
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
    for place in (CHANGES, SCENE_CHANGES):
        _changes(place)
    for group in ("manner", "lang"):
        _field(group)
    for split in ("validation", "test"):
        _networks(split)
    _validity(roads)
    _cost()


def _scores() -> None:
    """The hand-written splits, without the pairs whose labels are older than the language of junctions."""
    print(HEAD)
    for split in SPLITS:
        every, _ = read_pairs((HAND / split).glob("*.jsonl"))
        pairs = [pair for pair in every if not is_for_roads_only(pair)]
        for name in READERS:
            reader = reader_of(name)

            def asked(words: str, reader=reader) -> Brief:  # type: ignore[no-untyped-def]
                brief: Brief = reader.read(words)
                check_brief(brief, 250.0)  # as every command does
                return brief

            found = score(readings(pairs, asked if split == "exam" else reader.read))
            print(found.row(f"{name}, {split}"), f"{len(every) - len(pairs)} pairs left out")


def _changes(place: Path) -> None:
    """Change requests that are read as labelled: the same changes, or refused for the same kind of reason."""
    pairs, _ = read_pairs(place.glob("*.jsonl"), is_change=True)
    reader = ModelReader()
    right = 0
    for pair in pairs:
        got = reader.read_change(pair.text, normal_change).plan
        if got.startswith("!") or pair.plan.startswith("!"):
            right += got.split()[0] == pair.plan.split()[0]
        else:
            right += normal_change(got) == normal_change(pair.plan)
    print(f"change requests of {place.name} read as labelled: {right} of {len(pairs)}")


def _networks(split: str) -> None:
    """Descriptions of routes with junctions by language: how many plans are exactly those of the labels, and
    what the others are.
    """
    pairs, _ = read_pairs((NETWORKS / split).glob("*.jsonl"))
    counts: dict[str, Counter[str]] = {}
    took = []
    for pair in pairs:
        begun = time.process_time()
        verdict = _verdict(pair)
        took.append(1000 * (time.process_time() - begun))
        for group in (pair.lang, "all"):
            counts.setdefault(group, Counter())[verdict] += 1
    print(f"routes, {split} | texts | " + " | ".join(VERDICTS))
    for group in sorted(counts, key=lambda name: (name == "all", name)):
        its = counts[group]
        print(f"{group} | {its.total()} | " + " | ".join(str(its[verdict]) for verdict in VERDICTS))
    print(f"{np.median(took):.1f} ms of processor time (median), {np.quantile(took, 0.95):.1f} ms (95 %)")


def _field(group: str) -> None:
    """Texts of the field by manner or language: how many are read with the road, the actors, the scene and
    all of the label, and of how many of these the reader is sure, or names words as not used.
    """
    counts: dict[str, Counter[str]] = {}
    lines = [line for path in FIELD.glob("*.jsonl") for line in path.read_text(encoding="utf-8").splitlines()]
    for row in map(json.loads, lines):
        found = _parts_right(row["text"], row["plan"])
        for name in (row[group], "all"):
            counts.setdefault(name, Counter(dict.fromkeys(PARTS, 0))).update(["texts", *found])
    print(f"field, {group} | texts | " + " | ".join(PARTS))
    for name in sorted(counts, key=lambda name: (name == "all", name)):
        print(f"{name} | " + " | ".join(str(counts[name][part]) for part in ("texts", *PARTS)))


def _parts_right(text: str, label: str) -> list[str]:
    """Which parts of a text of the field are read as its label has them."""
    try:
        brief = READER.read(text)
    except BriefError:
        return ["rightly refused"] if label.startswith("!") else ["wrongly refused"]
    if label.startswith("!"):
        return ["built"]
    free = {"beside": (), "words": "", "unused": (), "confidence": 1.0, "other": ""}
    got, wanted = (normal(each).model_copy(update=free) for each in (brief, read_plan(label)))
    bare = {"scene": Scene()}
    found = ["road"] if got.model_copy(update=bare) == wanted.model_copy(update=bare) else []
    found += ["actors"] if _roles(got.scene) == _roles(wanted.scene) else []
    found += ["scene"] if got.scene == wanted.scene else []
    is_right, is_sure = got == wanted, brief.confidence >= SURE
    found += ["sure"] if is_sure else []
    found += ["all"] if is_right else []
    found += ["all, sure"] if is_right and is_sure else []
    found += ["all, words not used"] if is_right and brief.unused else []
    return [*found, "different, sure, no word named"] if is_sure and not (is_right or brief.unused) else found


def _roles(scene: Scene) -> list[object]:
    return [(r.kind, r.where, r.side, r.count, [action.what for action in r.actions]) for r in scene.actors]


def _as_labelled(brief: Brief) -> Brief:
    """A Brief as labels are written: with the size of a roundabout instead of its diameter."""
    junctions = tuple(each.model_copy(update={"outer": None}) for each in brief.junctions)
    return brief.model_copy(update={"beside": tuple(sorted(brief.beside)), "junctions": junctions})


def _verdict(pair: Pair) -> str:
    honest = not pair.plan.startswith("!")
    try:
        brief = read(pair.text, map_size=None)
    except AnotherRoadError:
        return ASKED if honest else RIGHTLY
    except BriefError:
        return REFUSED if honest else RIGHTLY
    if not honest:
        return BUILT
    wanted, got = (_as_labelled(each) for each in (normal(read_plan(pair.plan)), normal(brief)))
    if got == wanted:
        return EXACT
    return DOUBTED if brief.confidence < SURE or brief.unused else SILENT


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
