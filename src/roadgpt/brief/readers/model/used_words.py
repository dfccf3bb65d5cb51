"""Finds the words of a text that its plan does not depend on: the plan stays the likeliest without them.

Each word in turn, except function words, is left out, and the network computes how likely the plan is for
the remaining words. If this hardly changes, the word is reported as unused, unless the plan has what the word
usually asks for.
"""

from collections.abc import Collection, Mapping, Sequence

from roadgpt.brief.readers.model.denial import NEGATIONS
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.slots import SlottedText, Word
from roadgpt.brief.readers.model.vocabulary import RING_SIZES, SLOT_TOKENS
from roadgpt.brief.readers.model.word_meanings import understood
from roadgpt.brief.readers.model.word_set import word_set

NOTICED = 0.02
"""If leaving a word out lowers the log-probability of the plan by more than this, the word counts as used,
even if the plan stays the likeliest."""
NEGATORS = NEGATIONS | word_set(
    "don doesn isn shouldn only except weder nur ausser ni rien seulement sauf nessuna nessuno solo soltanto",
    "tranne salvo excepto",
)
"""Words that deny or limit something: a reading that stays the same without them has ignored them."""
SHORTEST = 3  # letters; shorter words are function words in all five languages
MOST_WORDS = 60
"""The largest number of words that are tried."""


def unused_words(
    network: NeuralNetwork,
    text: SlottedText,
    tokens: Sequence[str],
    fillers: frozenset[str],
    meanings: Mapping[str, Collection[str]],
) -> tuple[str, ...]:
    """Returns the words that the plan does not depend on, and the numbers that the plan lacks.

    They are spelled as in the text, each once, in text order.

    Args:
        network: the network that wrote the plan.
        text: the description or change request.
        tokens: the tokens of its plan.
        fillers: function words, which are never reported.
        meanings: the tokens that words usually ask for.
    """
    idle = _idle(network, text, tokens, fillers)
    idle -= understood(text, tokens, idle, meanings, NEGATORS)
    out: list[str] = []
    missing, slot = lost(tokens, text), 0
    for place, word in enumerate(text.words):
        if word.text.startswith("[unused") and word.written:
            if slot in missing or slot >= len(text.slots):
                out.append(word.written)
            slot += 1
        elif place in idle:
            is_short = [each.text for each in text.words[place + 1 : place + 3]] == ["'", "t"]
            out.append(f"{word.written}'t" if is_short else word.written)
    return tuple(dict.fromkeys(out))


def left_out(tokens: Sequence[str], text: SlottedText) -> list[int]:
    """Returns the indices of those numbers (slots) of a text that its plan does not use."""
    return [index for index in range(len(text.slots)) if SLOT_TOKENS[index] not in tokens]


def lost(tokens: Sequence[str], text: SlottedText) -> set[int]:
    """Returns the indices of the numbers of a text that its plan does not use, also not as the size of a
    roundabout.
    """
    missing = {*left_out(tokens, text)}
    if set(RING_SIZES).isdisjoint(tokens):
        return missing
    from roadgpt.brief.readers.model.ring_sizes import used_diameters  # only for networks

    return missing - used_diameters(tokens, text)


def passes_over(unused: Sequence[str], text: SlottedText) -> bool:
    """Returns whether one of the unused words is a measured number of the text, such as "40 m".

    Counts and words such as "not" are no sign of a wrong reading: another word often says the same ("five
    turns: left, left, ..."), and readings without effect of such a word were right as often as others.
    """
    numbers = {w.written for w in text.words if w.text.startswith("[unused")}
    return any(word in numbers for word in unused)


def _idle(
    network: NeuralNetwork, text: SlottedText, tokens: Sequence[str], fillers: frozenset[str]
) -> frozenset[int]:
    """Returns the places of the words that the plan does not depend on.

    If two words mean the same ("uphill, climbing all the way"), each of them can be left out, but not both.
    If the plan changes when all such words are left out, a word that alone restores the plan counts as used.
    """
    tried = [place for place, word in enumerate(text.words) if _is_content(word, fillers)][:MOST_WORDS]
    kept = _are_kept(network, text, tokens, [{place} for place in tried])
    idle = [place for place, is_kept in zip(tried, kept, strict=True) if is_kept]
    if len(idle) < 2 or all(_are_kept(network, text, tokens, [{*idle}])):
        return frozenset(idle)
    restored = _are_kept(network, text, tokens, [{*idle} - {place} for place in idle])
    return frozenset(place for place, is_back in zip(idle, restored, strict=True) if not is_back)


def _are_kept(
    network: NeuralNetwork, text: SlottedText, tokens: Sequence[str], left_out: Sequence[Collection[int]]
) -> list[bool]:
    """Returns for each set of places whether the plan stays the likeliest without the words there."""
    if not left_out:
        return []
    texts = [
        SlottedText(tuple(w for place, w in enumerate(text.words) if place not in places), text.slots)
        for places in left_out
    ]
    logs, leads = network.chances_of([text, *texts], tokens, text)
    lost = logs[0].sum() - logs[1:].sum(axis=1)
    return [bool(one) for one in (leads[1:] >= 0).all(axis=1) & (lost <= NOTICED)]


def _is_content(word: Word, fillers: frozenset[str]) -> bool:
    if not word.written or word.text in fillers or word.text.startswith("["):
        return False
    is_long = len(word.text) >= SHORTEST or not word.text.isascii()  # a single Chinese character is a word
    return word.text.isdecimal() or (word.text.isalpha() and is_long)
