"""Finds out whether a plan has what a word usually asks for.

The network may be sure of a plan even without a word, because other words say the same. If the plan has what
the word usually asks for, the word counts as understood.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.readers.model.denial import places_reached
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.vocabulary import KINDS, SIDES
from roadgpt.reading import read_text

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
REACH = 3  # words after a negation that it can deny


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
    negators: Collection[str],
) -> frozenset[int]:
    """Returns the places (indices) of the words in ``places`` that the plan takes into account after all.

    A word counts if it usually asks for a token that occurs in the plan at least as often as the word occurs
    in the text. A number counts if the plan has it, as many turns (of a kind, or to a side), straights or
    junctions, or a junction of as many roads. A negation and the words that it denies are added if the plan
    lacks what these words ask for.

    Args:
        text: the description.
        tokens: the tokens of its plan.
        places: the places of the words that the plan does not depend on.
        meanings: the tokens that words usually ask for.
        negators: words that deny something.
    """
    there = with_groups(tokens)
    words = [word.text for word in text.words]
    said = Counter(words)
    found, denied = set[int](), set[int]()
    for at in (n for n, word in enumerate(words) if word in negators):
        nouns = [n for n in places_reached(words, at, REACH) if words[n] in meanings]
        denied.update(nouns)
        if nouns and all(_is_absent(meanings[words[n]], there) for n in nouns):
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
