"""The pairs for routes with junctions: labels (every 16th line) are plans without contradictions that the
reader's network can write, and no text stands twice.
"""

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import pytest

from covering import covering
from roadgpt.brief import feasible
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.grammar import END, PlanAutomaton
from roadgpt.brief.readers.model.slots import NumberSlot, slotted
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, plan_of
from roadgpt.brief.refusal import causes_of
from roadgpt_training.tokens import tokens_of

FOLDER = Path(__file__).parents[1] / "data" / "networks"
FILES = sorted(path for name in ("train", "validation") for path in (FOLDER / name).glob("*.jsonl"))
MOST_UNWRITTEN = 0.003
"""The share of the pairs whose plan may have a number that the text gives in words that are not read."""

plan_read = cache(read_plan)


@pytest.fixture(scope="module", autouse=True)
def same_roads_are_checked_once() -> Iterator[None]:
    """Many routes have the same roads between their junctions."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(feasible, "check", cache(feasible.check))
        yield


def rows(path: Path, step: int = 16) -> list[dict[str, str]]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()[::step]]


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_labels_are_plans_that_do_not_contradict_themselves(path: Path) -> None:
    for pair in rows(path):
        assert set(pair) == {"text", "plan", "family", "lang"}
        assert pair["family"] == path.stem
        assert pair["lang"] in ("en", "de", "fr", "es", "it")
        if pair["plan"].startswith("!"):
            causes_of(pair["plan"])
            continue
        brief = plan_read(pair["plan"])
        feasible.check(brief, map_size=None)
        assert plan_read(plan(brief)) == brief


def test_nearly_every_label_can_be_written_token_by_token() -> None:
    """The grammar is asked for those that have each two tokens in a row, and each unit of a key, twice."""
    written, number = [], 0
    for path in FILES:
        for pair in rows(path, 32):
            wanted = pair["plan"]
            if not wanted.startswith("!"):
                wanted = plan(normal(plan_read(wanted)))
            text = slotted(pair["text"])
            tokens = tokens_of(wanted, text.slots)
            number += 1
            if tokens is None:
                continue
            back = plan_of(tokens, text.slots)
            assert back == wanted or plan(normal(plan_read(back))) == wanted
            written.append((wanted, text, tokens))
    for place in covering([with_units(tokens, text.slots) for _, text, tokens in written], 2):
        wanted, text, tokens = written[place]
        writer = PlanAutomaton(text.slots, frozenset(word.text for word in text.words))
        for token in (*tokens, END):
            assert NUMBER_OF[token] in writer.allowed(), f"{token} in {wanted}"
            writer.push(token)
    assert number - len(written) <= MOST_UNWRITTEN * number


def with_units(tokens: list[str], slots: Sequence[NumberSlot]) -> str:
    """Tokens in a row, with the unit of each number that is copied from the text."""
    units = (f"of_{slots[int(each[1:-1]) - 1].unit or 'none'}" if each[0] == "[" else each for each in tokens)
    return " ".join(units)


def test_no_text_stands_twice() -> None:
    texts = Counter(" ".join(pair["text"].lower().split()) for path in FILES for pair in rows(path, 1))
    assert [text for text, count in texts.items() if count > 1] == []


def test_all_kinds_and_ways_on_are_asked_for() -> None:
    kinds, takes = Counter[str](), Counter[str]()
    for path in FILES:
        for pair in rows(path):
            asked = pair["plan"]
            if not asked.startswith("!"):
                for junction in plan_read(asked).junctions:
                    kinds[junction.kind] += 1
                    takes[junction.take or "none"] += 1
    assert min(kinds[kind] for kind in ("t_junction", "y_junction", "crossroads", "star", "roundabout")) > 10
    assert min(takes[take] for take in ("left", "right", "straight", "back")) > 7
