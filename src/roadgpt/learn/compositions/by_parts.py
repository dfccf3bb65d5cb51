"""Descriptions in which the first few turns have one property and the rest another."""

from roadgpt.learn.compositions.voice import SHARPNESS, Composition, DescribedTurn, Voice, clauses

Words = tuple[tuple[str, str], ...]
ASPECTS: tuple[tuple[str, Words, float], ...] = (
    (
        "slope",
        (("uphill", "up"), ("climbing", "up"), ("downhill", "down"), ("falling", "down"), ("level", "flat")),
        0.7,
    ),
    ("side", (("left", "left"), ("to the left", "left"), ("right", "right")), 0.4),
    ("sharpness", SHARPNESS, 0.25),
)
"""The property in which the two parts differ, the words for its values, and how often it is used (0 to 1)."""


def by_parts(voice: Voice) -> Composition:
    """Returns a description of three to eight turns in which the first turns differ from the rest.

    Sometimes the first turn, the last turn or both are hairpins.
    """
    total = voice.whole(3, 8)
    first = voice.whole(1, total - 1)
    turns = [DescribedTurn() for _ in range(total)]
    said = []
    for key, words, share in ASPECTS:
        if not voice.chance(share):
            continue
        one = voice.pick(words)
        other = voice.pick([word for word in words if word[1] != one[1]])
        for at, turn in enumerate(turns):
            turn.mods[key] = one[1] if at < first else other[1]
        said.append(_two_parts(voice, first, total - first, one[0], other[0]))
    if not said or voice.chance(0.3):
        said.append(_hairpins(voice, turns))
    joint = voice.pick((", ", "; "))
    text = f"{voice.turns(total)}{voice.pick((', ', ': '))}{joint.join(said)}"
    return voice.framed(text, clauses(turns), may_slope=False)


def _hairpins(voice: Voice, turns: list[DescribedTurn]) -> str:
    way = voice.pick(("first", "last", "both ends"))
    for turn in (*turns[: way != "last"], *turns[len(turns) - (way != "first") :]):
        turn.kind = "hairpin"
    return voice.say(way) if way == "both ends" else f"the {way} is a hairpin"


def _two_parts(voice: Voice, first: int, rest: int, one: str, other: str) -> str:
    head = f"the first {voice.number(first)}" if first > 1 else "the first"
    if voice.chance(0.3):
        head = head.removeprefix("the ")
    word = voice.pick(("other", "last", "remaining", "next"))
    tail = f"the {word} {voice.number(rest)}" if rest > 1 else "the last one"
    if voice.chance(0.3):
        tail = "the rest"
    return f"{head} {one}{voice.pick((', ', ' and ', ', then '))}{tail} {other}"
