"""Converts generated and hand-written pairs to batches of numbers for training."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate

import numpy as np
import numpy.typing as npt

from roadgpt.brief.model import Amount
from roadgpt.brief.normal import STRAIGHT, normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.before import TOLD_ON_ROUTES
from roadgpt.brief.readers.model.neural_network import WordPieces
from roadgpt.brief.readers.model.slots import SLOTS, NumberSlot, slot_name, slotted
from roadgpt.brief.readers.model.vocabulary import (
    NUMBER_OF,
    OF_ROADS,
    SLOT_TOKENS,
    TOKENS,
    Compared,
)
from roadgpt.brief.sentence import sentence
from roadgpt_training.asides import with_asides
from roadgpt_training.augmentation import augmented
from roadgpt_training.field import FIELD, composed, parted, varied
from roadgpt_training.generator import draw, draw_change, draw_specified, pairs, series
from roadgpt_training.mentions import names_in, with_mention, with_talk
from roadgpt_training.mirror import is_of_junctions
from roadgpt_training.pair import Pair, grouped, is_held_out
from roadgpt_training.phrasebook import one_of, weighted
from roadgpt_training.routes import draw_route, routes
from roadgpt_training.tokens import tokens_of

Numbers = npt.NDArray[np.int64]
LONGEST_PLAN = 95
MOST_CHUNKS = 4  # of a text
SHARES: Mapping[str, Mapping[str, float]] = {
    "roads": {
        "hand": 0.10,
        "free": 0.20,
        "contrasts": 0.09,
        "changes": 0.22,
        "generated": 0.04,
        "generated contrasts": 0.05,
        "generated changes": 0.11,
        "generated specs": 0.19,
    },
    "routes": {
        "networks": 0.17,
        "field": 0.28,
        "landscape": 0.14,
        "composed": 0.08,
        "scene changes": 0.06,
        "changes": 0.02,
        "generated routes": 0.12,
        "routes": 0.04,
        "hand": 0.04,
        "free": 0.04,
        "contrasts": 0.015,
        "generated": 0.005,
        "generated contrasts": 0.005,
        "generated specs": 0.005,
    },
}
"""The share of each series of pairs in the training of each network. ``networks`` are hand-written routes
with junctions, ``routes`` join these to hand-written roads, ``generated ...`` come from grammars, ``field``
are texts of the field, ``landscape`` those about roads in landscapes, and ``composed`` join those that tell
only a scene to roads; ``scene changes`` are requests that change a scene.
"""
TOKENS_OF = {"roads": OF_ROADS, "routes": TOKENS}
"""The tokens that each network knows."""
NETWORK = "networks/"
"""Prefix of the family names of all pairs with routes or maps."""
OF_LANDSCAPE = f"{FIELD}f_scape"
"""Prefix of the family names of texts of the field about landscapes."""
KINDS_OF_FAMILIES = {"x_": "contrasts", "y_": "free"}
"""Prefixes of family names, and the series in SHARES to which pairs of these families belong. The texts of
``free`` were written first, and their plans were added later.
"""
MENTIONS = 0.15
"""Share of descriptions to which a mention or denial of something beside the road is added."""
TALK = 0.07
"""Share of all pairs that get additional small talk, such as a greeting."""
ASIDES = 0.35
"""Share of change requests to which sentences without a wish are added."""
CAUSED = ("!contradiction", "!impossible")
"""Refusals that can name a cause. A plan that has only one of these words names no cause."""
MOTORWAY = re.compile(r" ?\bmotorway\b")
STRIDE = 8
"""The lengths of texts and plans in a batch are rounded up to a multiple of this number."""
SAID_BACK = 0.06
"""Share of hand-written pairs whose text is replaced by RoadGPT's own sentence for the plan."""
FIELDS = ("degrees", "radius")
FEWEST = 2
"""Values are moved only from at least this many clauses with turns; from fewer, no plan gets shorter."""


@dataclass(frozen=True, slots=True)
class Example:
    """A pair of description and plan as index numbers: the word pieces of the text, and the tokens of the
    plan with start and end token.
    """

    pieces: tuple[tuple[int, ...], ...]
    """Chunk by chunk."""
    tokens: tuple[int, ...]


def example(pair: Pair, pieces: WordPieces, rng: np.random.Generator | None = None) -> Example | None:
    """Returns a pair as numbers; None if its text or plan is too long, or if the plan has a number that is
    not in the text, or a token that is not in the vocabulary.

    A slot token stands for a number in the text. With ``rng``, the slot tokens are chosen at random, so that
    the network learns all of them equally well. A refusal without a labelled cause gets no end token, so that
    the network learns nothing about the token after the refusal.
    """
    taken = slotted(pair.text, pair.is_change)
    is_of_field = pair.family.startswith(FIELD) and not pair.is_change
    plan, told = parted(pair.plan) if is_of_field else (pair.plan, "")
    plan = plan if pair.is_change else with_shared_values(_without_motorway(plan), taken.slots)
    compared = None if pair.is_change else Compared.of(taken.text)
    of_road, of_told = tokens_of(plan, taken.slots, compared, pair.is_change), tokens_of(told, taken.slots)
    if of_road is None or of_told is None:
        return None
    tokens = [*of_road, *of_told]
    if len(tokens) > LONGEST_PLAN - 2 or any(token not in NUMBER_OF for token in tokens):
        return None
    words = [word.text for word in taken.words]
    if rng is not None and taken.slots:
        words, tokens = _reslotted(words, tokens, taken.slots, rng)
    chunks = pieces.encode(words)
    if len(chunks) > MOST_CHUNKS:
        return None
    end = () if plan in CAUSED and not pair.family.startswith(FIELD) else (2,)
    return Example(tuple(map(tuple, chunks)), (1, *(NUMBER_OF[token] for token in tokens), *end))


def _without_motorway(plan: str) -> str:
    """Returns the plan of a single road without "motorway", which ``brief.read`` takes from the words."""
    if is_of_junctions(plan) or not MOTORWAY.search(plan):
        return plan
    return MOTORWAY.sub("", plan).rstrip(" |") or "| turns=0.."


def _reslotted(
    words: list[str], tokens: list[str], slots: Sequence[NumberSlot], rng: np.random.Generator
) -> tuple[list[str], list[str]]:
    """Gives the slots random new numbers, in the same order as before."""
    chosen = np.sort(rng.permutation(SLOTS)[: len(slots)])
    names = {slot_name(index): slot_name(int(new)) for index, new in enumerate(chosen)}
    written = {SLOT_TOKENS[index]: SLOT_TOKENS[int(new)] for index, new in enumerate(chosen)}
    return [names.get(word, word) for word in words], [written.get(token, token) for token in tokens]


def examples(
    seed: int, hand: Sequence[Pair], pieces: WordPieces, network: str = "roads"
) -> Iterator[Example]:
    """Yields an endless series of examples: a mixture of generated pairs and of variations of the
    hand-written pairs, in the shares of a network. Held-out texts and pairs that ``example`` rejects are
    left out.
    """
    streams = _streams(seed, hand)
    names = [name for name in SHARES[network] if name in streams]
    rng = np.random.default_rng([seed, 7])
    shares = tuple(accumulate(SHARES[network][name] for name in names))
    while True:
        name = names[weighted(shares, rng)]
        pair = next(streams[name])
        is_of_field = name in ("field", "landscape", "composed")
        if not (pair.is_change or is_of_field) and rng.random() < MENTIONS:
            pair = with_mention(pair, rng) or pair
        if pair.is_change and name != "scene changes" and rng.random() < ASIDES:
            pair = with_asides(pair, rng)
        elif rng.random() < TALK:
            pair = replace(pair, text=with_talk(pair.text, pair.lang, rng))
        if is_held_out(pair.text) or (network == "routes" and not is_of_field and is_for_roads_only(pair)):
            continue
        made = example(pair, pieces, rng)
        if made and max(made.tokens) < len(TOKENS_OF[network]):
            yield made


def is_for_roads_only(pair: Pair) -> bool:
    """Returns whether only the networks for single roads may be trained with a pair. This is so if its plan
    is for a single road, but names something that only routes have, such as a junction, in ``beside(...)`` or
    in a refusal. Such names teach a network for single roads to pass the description on to the network for
    routes. The network for routes must not learn this.
    """
    if pair.is_change or pair.family.startswith(NETWORK):
        return False
    named = pair.plan.split() if pair.is_refusal else names_in(pair.plan)
    return not TOLD_ON_ROUTES.isdisjoint(named)


def _streams(seed: int, hand: Sequence[Pair]) -> dict[str, Iterator[Pair]]:
    """Returns the series of pairs by name; kinds of which there are no hand-written pairs have no series."""
    found = {
        "generated": pairs(seed),
        "generated contrasts": series(seed, 1, partial(draw, symbol="contrast", phrases="contrasts")),
        "generated changes": series(seed, 2, draw_change),
        "generated specs": series(seed, 3, draw_specified),
        "generated routes": series(seed, 6, draw_route),
    }
    kinds = grouped(hand, _kind)
    for kind, its in kinds.items():
        found[kind] = _varied(its, np.random.default_rng([seed, len(kind)]))
    if "scene changes" in kinds:
        found["scene changes"] = varied(kinds["scene changes"], np.random.default_rng([seed, 11]))
    if "networks" in kinds:
        roads = [pair for kind in ("hand", "free") for pair in kinds.get(kind, ())]
        joined = routes(roads, kinds["networks"], np.random.default_rng([seed, 4]))
        rng = np.random.default_rng([seed, 5])
        found["routes"] = (augmented(pair, {}, rng) for pair in joined)
    if "landscape" in kinds:
        found["landscape"] = varied(kinds["landscape"], np.random.default_rng([seed, 12]))
    if "field" in kinds:
        roads = [pair for kind in ("hand", "free", "networks") for pair in kinds.get(kind, ())]
        found["field"] = varied(kinds["field"], np.random.default_rng([seed, 9]))
        found["composed"] = composed(kinds["field"], roads, np.random.default_rng([seed, 10]))
    return found


def _kind(pair: Pair) -> str:
    if pair.is_change:
        return "scene changes" if pair.family.startswith(FIELD) else "changes"
    if pair.family.startswith(OF_LANDSCAPE):
        return "landscape"
    if pair.family.startswith((NETWORK, FIELD)):
        return "networks" if pair.family.startswith(NETWORK) else "field"
    return KINDS_OF_FAMILIES.get(pair.family[:2], "hand")


def _varied(hand: Sequence[Pair], rng: np.random.Generator) -> Iterator[Pair]:
    """Yields variations of random pairs."""
    by_language = grouped(hand, lambda pair: pair.lang)
    while True:
        pair = one_of(hand, rng)
        yield _said_back(pair) if rng.random() < SAID_BACK else augmented(pair, by_language, rng)


def _said_back(pair: Pair) -> Pair:
    """Replaces the text by RoadGPT's own sentence for the plan."""
    if pair.is_refusal or pair.is_change or "beside(" in pair.plan:
        return pair
    return replace(pair, text=sentence(read_plan(pair.plan)), lang="en")


def training_batches(
    seed: int, hand: Sequence[Pair], pieces: Sequence[str], network: str, size: int, pool: int
) -> Iterator[tuple[Numbers, Numbers]]:
    """Yields ``batches`` of ``examples`` without end; ``pieces`` is the vocabulary of word pieces."""
    return batches(examples(seed, hand, WordPieces(pieces), network), size, pool, seed)


def batches(stream: Iterator[Example], size: int, pool: int, seed: int) -> Iterator[tuple[Numbers, Numbers]]:
    """Yields batches of ``size`` examples of similar length, padded with zeros.

    Each ``pool`` batches are cut from one group of examples, which is first sorted by length. A batch is the
    word pieces (size, chunks, length of the longest chunk), and the tokens (size, length of the
    longest plan); both lengths are rounded up to a multiple of ``STRIDE``.
    """
    rng = np.random.default_rng([seed, 8])
    while True:
        many = sorted(
            (next(stream) for _ in range(size * pool)),
            key=lambda e: (len(e.pieces), len(e.pieces[0]), len(e.tokens)),
        )
        for index in rng.permutation(pool):
            batch = many[index * size : (index + 1) * size]
            most = max(len(e.pieces) for e in batch)
            chunks = padded([chunk for e in batch for chunk in (*e.pieces, *[()] * (most - len(e.pieces)))])
            yield chunks.reshape(size, most, -1), padded([e.tokens for e in batch])


def padded(rows: Sequence[Sequence[int]]) -> Numbers:
    """Returns the rows as one array, padded with zeros to a width that is a multiple of ``STRIDE``.

    Torch prepares its kernels anew for each shape of its input, which takes longer than a step of training.
    """
    out = np.zeros((len(rows), -(-max(len(row) for row in rows) // STRIDE) * STRIDE), dtype=np.int64)
    for index, row in enumerate(rows):
        out[index, : len(row)] = row
    return out


def with_shared_values(line: str, slots: Sequence[NumberSlot]) -> str:
    """Moves degrees and radii that all turns share to the part of a plan that holds for the whole road. The
    normal form stays the same, and a refusal stays as it is.

    A value is moved only if two or more clauses share the value, and the plan has no such value for the whole
    road yet. Each number of the value must occur exactly once in ``slots``, the numbers of the description.
    """
    if line.startswith("!"):
        return line
    before = brief = read_plan(line)
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    for name in FIELDS:
        amounts = {getattr(clause, name) for clause in turning}
        shared = next(iter(amounts)) if len(amounts) == 1 else None
        if len(turning) < FEWEST or not shared or getattr(brief, name) or not _is_said_once(shared, slots):
            continue
        clauses = tuple(
            clause if clause.kind in STRAIGHT else clause.model_copy(update={name: None})
            for clause in brief.clauses
        )
        brief = brief.model_copy(update={"clauses": clauses, name: shared})
    return plan(brief) if brief is before or normal(brief) == normal(before) else line


def _is_said_once(amount: Amount, slots: Sequence[NumberSlot]) -> bool:
    values = [slot.value for slot in slots]
    return all(values.count(number) == 1 for number in (amount.lo, amount.hi) if number is not None)
