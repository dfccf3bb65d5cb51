"""Reads and checks hand-written pairs."""

import json
from collections.abc import Iterable
from pathlib import Path

from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.vocabulary import REFUSALS
from roadgpt.brief.refusal import refused
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.reading import read_text
from roadgpt_training.pair import Pair, is_held_out, normal_change, standard

LONGEST = 2000  # letters


def read_pairs(paths: Iterable[Path], is_change: bool = False) -> tuple[list[Pair], list[str]]:
    """Returns all usable pairs of JSON-lines files, of changes or of descriptions, and one sentence for each
    unusable line. A line is unusable if ``read_pair`` rejects it, or its text is held out or repeats
    an earlier text.
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
            except UsageError as error:
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
        UsageError: the line is not JSON, lacks a field, has a plan that cannot be read, or a text that is too
            long.
    """
    try:
        fields = json.loads(line)
        text, written = str(fields["text"]), str(fields["plan"])
        family, language = str(fields.get("family", "")), str(fields.get("lang", "en"))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(
            f"this is not a pair ({error}); write {{'text', 'plan', 'family', 'lang'}}"
        ) from error
    if not text.strip() or len(text) > LONGEST:
        raise UsageError(f"a text has {len(text)} characters; write 1 to {LONGEST}")
    try:
        written = _standard(written.strip(), is_change)
    except RoadGPTError as error:
        raise UsageError(f"'{text[:40]}': {error}") from error
    return Pair(text, written, family, language, is_change)


def _standard(written: str, is_change: bool) -> str:
    if written.startswith("!"):
        if not written.startswith(REFUSALS) or "has no refusal" in str(refused(written)):
            raise UsageError(f"'{written[:40]}' is no refusal of the language of plans")
        return written
    if is_change:
        return normal_change(written)
    brief = read_plan(written)
    plan(brief)
    return standard(brief)
