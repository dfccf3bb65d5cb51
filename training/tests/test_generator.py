"""Generated pairs: seeded, sensible, and none of those that are held out."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import Compared
from roadgpt.brief.refusal import refused
from roadgpt_training.data import with_shared_values
from roadgpt_training.generator import assembled, draw, pairs
from roadgpt_training.grammar import Discarded, Speaker, read_grammar
from roadgpt_training.labels import REFUSALS
from roadgpt_training.negative_examples import contradicted, overdone
from roadgpt_training.pair import Pair, is_held_out, makes_sense, standard
from roadgpt_training.tokens import tokens_of


def test_the_same_seed_gives_the_same_pairs_and_another_others() -> None:
    one, again, other = (list(islice(pairs(seed), 50)) for seed in (5, 5, 6))
    assert one == again
    assert one != other


def test_every_generated_plan_is_in_standard_form_and_none_is_held_out(generated: tuple[Pair, ...]) -> None:
    for pair in generated:
        assert not is_held_out(pair.text)
        if not pair.family.startswith("composed"):  # see test_compositions
            assert pair.plan.startswith(REFUSALS) or standard(read_plan(pair.plan)) == pair.plan


@pytest.mark.parametrize("language", ["en", "de", "fr", "es", "it"])
def test_a_language_speaks_in_many_ways(language: str) -> None:
    rng = np.random.default_rng(3)
    found = [pair for pair in (draw(language, rng) for _ in range(600)) if pair]
    assert len({pair.text for pair in found}) > 0.9 * len(found) > 450
    assert len({pair.plan for pair in found}) > 150
    assert {"!nonsense", "!contradiction", "!impossible"} <= {pair.plan.split()[0] for pair in found}


@pytest.mark.parametrize("language", ["en", "de", "fr", "es", "it"])
def test_every_number_of_a_specification_can_be_copied(language: str) -> None:
    rng = np.random.default_rng(9)
    found = [pair for pair in (draw(language, rng, "specs", "specs") for _ in range(100)) if pair]
    assert len({pair.text for pair in found}) > 0.9 * len(found) > 82
    lost = 0
    for pair in found:
        said = slotted(pair.text)
        plan = with_shared_values(pair.plan, said.slots)
        lost += tokens_of(plan, said.slots, Compared.of(said.text)) is None
    assert lost < 0.05 * len(found)


def test_a_grammar_writes_text_and_plan_side_by_side() -> None:
    text = (
        "= top\n<#3-3:n> bends, the last one a <kind>  => turn x<=n-1>; <kind>\n= kind\nhairpin => hairpin\n"
    )
    said, raw = Speaker(read_grammar(text, "en"), np.random.default_rng(0)).say("top")
    assert said in ("3 bends, the last one a hairpin", "three bends, the last one a hairpin")
    assert assembled(raw) == "turn x2; hairpin"


def test_a_sum_that_leaves_nothing_is_discarded() -> None:
    grammar = read_grammar("= top\n<#2-2:n> turns => turn x<=n-2>\n", "en")
    with pytest.raises(Discarded):
        Speaker(grammar, np.random.default_rng(0)).say("top")


@pytest.mark.parametrize(
    "line",
    [
        "turn up | down", "crest | flat", "turn left | lefts=0", "turn x5 | turns=..3", "hairpin deg=20",
        "turn x13", "straight pct=20", "turn r=5", "turn | len=1800", "straight | gentle turns=0",
        "dip | down", "turn x2 | up hills=3..", "hairpin x9 | len=160", "s_bend | lefts=3", "",
    ],
)  # fmt: skip
def test_nonsense_is_not_generated(line: str) -> None:
    assert not makes_sense(read_plan(line))


def test_what_spoils_a_wish_fits_it() -> None:
    rng = np.random.default_rng(2)
    assert contradicted(Pair("a road", "| turns=1..", "f", "en"), rng) is None
    lefts = Pair("three left turns", "turn x3 left", "f", "en")
    spoiled = contradicted(lefts, rng)
    assert spoiled is not None
    assert "three left turns" in spoiled.text.lower()
    assert spoiled.plan in ("!contradiction turns", "!contradiction sides")
    beyond = overdone(lefts, rng)
    assert beyond is not None
    assert "has no refusal" not in str(refused(beyond.plan))
    assert overdone(replace(lefts, plan="!nonsense"), rng) is None
