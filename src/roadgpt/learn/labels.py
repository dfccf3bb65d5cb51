"""Reads, checks and splits hand-written pairs; pairs of one family (similar wording) go to the same split."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.vocabulary import REFUSALS
from roadgpt.brief.refusal import refused
from roadgpt.errors import LearnError, RoadGPTError
from roadgpt.learn.generator import Pair
from roadgpt.learn.held_out import is_held_out
from roadgpt.learn.standard import standard
from roadgpt.reading import read_text

LONGEST = 2000  # letters
SPLITS = ("train", "validation", "test")


def read_pairs(paths: Iterable[Path], is_change: bool = False) -> tuple[list[Pair], list[str]]:
    """Returns all usable pairs of JSON-lines files, and one sentence for each line that is not usable.

    A line is not usable if ``read_pair`` rejects it, or if its text is held out or repeats an earlier one.

    Args:
        paths: the files.
        is_change: whether the texts are change requests instead of descriptions.
    """
    good: list[Pair] = []
    problems: list[str] = []
    seen: dict[str, str] = {}
    for path in sorted(paths):
        for number, line in enumerate(read_text(path, 1_000_000_000, "a file of pairs").splitlines(), 1):
            place = f"{path.name}:{number}"
            if not line.strip():
                continue
            try:
                pair = read_pair(line, is_change)
            except LearnError as error:
                problems.append(f"{place}: {error}")
                continue
            key = " ".join(pair.text.lower().split())
            if is_held_out(pair.text):
                problems.append(f"{place}: is held out from training; leave it out")
                continue
            if key in seen:
                problems.append(f"{place}: repeats {seen[key]}; leave one out")
                continue
            seen[key] = place
            good.append(pair)
    return good, problems


def read_pair(line: str, is_change: bool = False) -> Pair:
    """Returns the pair in one line of JSON, with its plan in standard form.

    Raises:
        LearnError: the line is not JSON, lacks a field, has a plan that cannot be read, or a text that is too
            long.
    """
    try:
        fields = json.loads(line)
        text, written = str(fields["text"]), str(fields["plan"])
        family, language = str(fields.get("family", "")), str(fields.get("lang", "en"))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise LearnError(
            f"this is not a pair ({error}); write {{'text', 'plan', 'family', 'lang'}}"
        ) from error
    if not text.strip() or len(text) > LONGEST:
        raise LearnError(f"a text has {len(text)} characters; write 1 to {LONGEST}")
    try:
        written = _standard(written.strip(), is_change)
    except RoadGPTError as error:
        raise LearnError(f"'{text[:40]}': {error}") from error
    return Pair(text, written, family, language, is_change)


def _standard(written: str, is_change: bool) -> str:
    if written.startswith("!"):
        if not written.startswith(REFUSALS) or "has no refusal" in str(refused(written)):
            raise LearnError(f"'{written[:40]}' is no refusal of the language of plans")
        return written
    if is_change:
        return change_plan(read_change_plan(written))
    brief = read_plan(written)
    plan(brief)
    return standard(brief)


def split(
    pairs: Sequence[Pair], test: int = 500, validation: float = 0.12, seed: int = 3
) -> dict[str, list[Pair]]:
    """Splits pairs into test, validation and training sets; all pairs of a family go to the same set.

    Args:
        pairs: the hand-written pairs.
        test: the minimum number of pairs in the test set.
        validation: the minimum share of all pairs that go to the validation set, from 0 to 1.
        seed: seed of the order in which families are assigned.
    """
    families: dict[str, list[Pair]] = {}
    for pair in pairs:
        families.setdefault(pair.family, []).append(pair)
    names = sorted(families)
    np.random.default_rng(seed).shuffle(names)
    out: dict[str, list[Pair]] = {name: [] for name in SPLITS}
    wanted = {"test": test, "validation": int(validation * len(pairs))}
    for name in names:
        side = next((s for s in ("test", "validation") if len(out[s]) < wanted[s]), "train")
        out[side] += families[name]
    return out
