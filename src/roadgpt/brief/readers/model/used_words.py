"""Finds the words of a text that its plan does not depend on: the plan stays the likeliest without them.

Each word in turn, except function words, is left out, and the network computes how likely the plan is for
the remaining words. If this hardly changes, the word is reported as unused, unless the plan has what the word
usually asks for.
"""

import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.readers.model.denial import NEGATIONS, places_reached
from roadgpt.brief.readers.model.neural_network import NeuralNetwork
from roadgpt.brief.readers.model.slots import SlottedText, Word
from roadgpt.brief.readers.model.vocabulary import KINDS, RING_SIZES, SIDES, SLOT_TOKENS
from roadgpt.brief.readers.model.word_set import word_set
from roadgpt.reading import read_text

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
GROUPS: Mapping[str, frozenset[str]] = {
    "@take": frozenset({"left", "right", "straight", "back", "exit=", "ramp", "main"}),
    "@junction": frozenset(
        {
            *("t_junction", "y_junction", "crossroads", "star", "roundabout", "junction"),
            *("merge", "diverge", "map", "lane_drop", "lane_gain", "lane_change"),
        }
    ),
}
"""Groups of tokens; a word can ask for any token of a group: "go" for a way, "where" for a junction."""
ARMS: Mapping[str, str] = {"t_junction": "3", "y_junction": "3", "crossroads": "4"}
"""The number of roads that meet at a kind of junction, as a token."""
NAMED_IF_DENIED = frozenset({"centre=", "none"})
"""Tokens of things whose absence a plan states with "none": no centre line, no signs."""
MOST_DENIED = 3  # words after a negation that it can deny


def unused_words(
    network: NeuralNetwork,
    text: SlottedText,
    tokens: Sequence[str],
    fillers: frozenset[str],
    meanings: Mapping[str, Collection[str]],
) -> tuple[str, ...]:
    """Returns the words that the plan does not depend on, and the numbers that the plan lacks.

    The words are spelled as in the text, each once, in text order. Function words in ``fillers`` are never
    reported.
    """
    idle = _idle(network, text, tokens, fillers)
    idle -= understood(text, tokens, idle, meanings)
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
    """Returns the indices of the numbers of a text that its plan uses neither as numbers nor as the size of a
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
    turns: left, left, ..."), and readings that ignore such a word were right as often as others.
    """
    numbers = {w.written for w in text.words if w.text.startswith("[unused")}
    return any(word in numbers for word in unused)


def _idle(
    network: NeuralNetwork, text: SlottedText, tokens: Sequence[str], fillers: frozenset[str]
) -> frozenset[int]:
    """Returns the places of the words that the plan does not depend on.

    If two words mean the same ("uphill, climbing all the way"), each of them can be left out, but not both.
    If the plan changes when all such words are left out, a word that alone restores the plan counts as used.
    A word in letters of another script than Latin is in none of the languages that are read: it never counts
    as used, even if the plan happens to be less likely without it.
    """
    content = [place for place, word in enumerate(text.words) if _is_content(word, fillers)]
    foreign = frozenset(place for place in content if not _is_latin(text.words[place].text))
    tried = [place for place in content if place not in foreign][:MOST_WORDS]
    kept = _are_kept(network, text, tokens, [{place} for place in tried])
    idle = [place for place, is_kept in zip(tried, kept, strict=True) if is_kept]
    if len(idle) < 2 or all(_are_kept(network, text, tokens, [{*idle}])):
        return frozenset(idle) | foreign
    restored = _are_kept(network, text, tokens, [{*idle} - {place} for place in idle])
    return foreign.union(place for place, is_back in zip(idle, restored, strict=True) if not is_back)


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


def _is_latin(word: str) -> bool:
    return all(not letter.isalpha() or unicodedata.name(letter, "").startswith("LATIN") for letter in word)


def with_groups(tokens: Iterable[str]) -> Counter[str]:
    """Returns how often each token, and each group of tokens in ``GROUPS``, occurs in a plan."""
    found = Counter(tokens)
    for name, members in GROUPS.items():
        if count := sum(found[member] for member in members):
            found[name] = count
    return found


def read_meanings(path: Path) -> dict[str, tuple[str, ...]]:
    """Returns the tokens that words usually ask for, the most usual one first, from a file with a word and
    its tokens in each line.

    The result is empty if the file is missing, as in readers that were exported before such files existed.
    """
    rows = [line.split() for line in read_text(path).split("\n")] if path.is_file() else []
    return {word: tuple(tokens) for word, *tokens in rows}


def understood(
    text: SlottedText,
    tokens: Sequence[str],
    places: Collection[int],
    meanings: Mapping[str, Collection[str]],
) -> frozenset[int]:
    """Returns the places (indices) of the words in ``places`` that the plan takes into account after all.

    A word counts if it usually asks for a token that occurs in the plan at least as often as the word occurs
    in the text. A number counts if it is in the plan, or if the plan has this number of turns (of a kind or
    to a side), straights or junctions, or a junction where this number of roads meets. In a description, a
    negation and the words that it denies are added if the plan lacks what these words ask for; in a change
    request they may say what is to stay, so they are not.
    """
    there = with_groups(tokens)
    words = [word.text for word in text.words]
    said = Counter(words)
    found, denied = set[int](), set[int]()
    for at in (n for n, word in enumerate(words) if word in NEGATORS):
        nouns = [n for n in places_reached(words, at, MOST_DENIED) if words[n] in meanings]
        denied.update(nouns)
        if nouns and not text.is_change and all(_is_absent(meanings[words[n]], there) for n in nouns):
            found |= {at, *nouns}
    for place in set(places) - denied:
        word = words[place]
        asked = meanings.get(word, frozenset())
        if word.isdecimal():
            if _is_counted(word, tokens, there):
                found.add(place)
        elif any(there[token] >= said[word] for token in asked) or _is_of_length(words, place, asked, there):
            found.add(place)
    return frozenset(found)


def _is_of_length(words: Sequence[str], place: int, asked: Collection[str], there: Mapping[str, int]) -> bool:
    """Returns whether a word such as "long" stands beside a length in metres, which the plan has."""
    beside = words[max(place - 1, 0) : place + 3]
    return "long" in asked and there.get("len=", 0) > 0 and "metres" in beside


def _is_absent(asked: Collection[str], there: Mapping[str, int]) -> bool:
    """Returns whether a plan lacks some of what a denied word asks for, or says that there is none.

    Groups of tokens count if the word asks for nothing else.
    """
    if not NAMED_IF_DENIED.isdisjoint(asked):
        return there.get("none", 0) > 0
    own = [token for token in asked if token not in GROUPS]
    return not all(there.get(token) for token in own or asked)


def _is_counted(number: str, tokens: Sequence[str], there: Mapping[str, int]) -> bool:
    """Returns whether a plan has a number, as many junctions, or a kind of junction with as many roads."""
    kinds = GROUPS["@junction"]
    return (
        number in tokens
        or int(number) in _counts_of_roads(tokens)
        or any(str(there.get(kind, 0)) == number for kind in (*kinds, "@junction"))
        or any(ARMS.get(kind) == number for kind in kinds if there.get(kind))
    )


def _counts_of_roads(tokens: Sequence[str]) -> frozenset[int]:
    """Returns how many turns, straights, and things of one kind or to one side the clauses of a plan have."""
    counts: Counter[str] = Counter()
    kind, number = "", 1
    for place, word in enumerate(tokens):
        if word == "|":
            break
        if word in KINDS:
            kind, number = word, 1
            after = tokens[place + 1 : place + 3]
            if len(after) == 2 and after[0] == "x" and after[1].isdecimal():
                number = int(after[1])
            counts[kind] += number
            counts["turns"] += 0 if kind in STRAIGHT else number
        elif word in SIDES and kind:
            counts[word] += number
    return frozenset(counts.values())
