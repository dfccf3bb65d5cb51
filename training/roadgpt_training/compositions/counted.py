"""Descriptions in which turns have to be counted: by numbers, by parts, or by counts that add up."""

from roadgpt_training.compositions.voice import (
    NOUNS,
    OTHER,
    SHARPNESS,
    SIDES,
    Composition,
    DescribedTurn,
    Voice,
    clauses,
    give,
)

GO = (("go", "goes"), ("turn", "turns"), ("are", "is"), ("bend", "bends"), ("go to the", "goes to the"))


def numbered_sides(voice: Voice) -> Composition:
    """Returns a description of three to eight numbered turns that says which ones go left and which right."""
    total = voice.whole(3, 8)
    side = voice.pick(SIDES)
    names, chosen, is_one = _chosen(voice, total)
    turns = [DescribedTurn(mods={"side": side if at in chosen else OTHER[side]}) for at in range(total)]
    first = f"{names} {voice.pick(GO)[is_one]} {side}"
    second = f"{_rest(voice, total, chosen)} {OTHER[side]}"
    count = voice.turns(total)
    text = voice.say("numbered", count=count, first=first, First=first.capitalize(), second=second)
    return voice.framed(text, clauses(turns))


def numbered_kinds(voice: Voice) -> Composition:
    """Returns a description of three to seven turns in which some turns, named by number or ordinal,
    have a property that the other turns lack: for example, they are hairpins.

    Sometimes all turns go in the same direction.
    """
    total = voice.whole(3, 7)
    names, chosen, is_one = _chosen(voice, total)
    shape, kind, mods = _shape(voice, len(chosen) == 1)
    turns = [DescribedTurn(kind, dict(mods)) if at in chosen else DescribedTurn() for at in range(total)]
    said = f"{names} {'is' if is_one else 'are'} {shape}"
    if "sharpness" not in mods and voice.chance(0.35):
        word, sharpness = voice.pick(SHARPNESS)
        give([turn for at, turn in enumerate(turns) if at not in chosen], "sharpness", sharpness)
        said += f", {_rest(voice, total, chosen)} {word}"
    if voice.chance(0.3):
        side = voice.pick(SIDES)
        give(turns, "side", side)
        said += voice.say("all to", side=side)
    return voice.framed(
        voice.say("kinds", count=voice.turns(total), said=said, Said=said.capitalize()), clauses(turns)
    )


def _chosen(voice: Voice, total: int) -> tuple[str, set[int], bool]:
    """Returns the words for some of the turns, their indices from 0, and whether the words are singular."""
    if voice.chance(0.2):
        word, first = voice.pick((("odd", 0), ("even", 1)))
        its = {*range(first, total, 2)}
        if voice.chance(0.3):
            return f"every {word} one", its, True
        return voice.pick((f"the {word} ones", f"{word} {voice.pick(NOUNS)}")), its, False
    its = {int(at) for at in voice.rng.permutation(total)[: voice.whole(1, max(1, total // 2))]}
    is_one = len(its) == 1
    if voice.chance(0.3):
        word = voice.pick(("turn", "number", "bend", "curve")) + ("" if is_one else "s")
        return f"{word} {voice.listed([str(at + 1) for at in sorted(its)])}", its, is_one
    names = voice.listed([voice.ordinal(at, total) for at in sorted(its)])
    return f"the {names}{voice.pick(('', '', ' one' if is_one else ' ones'))}", its, is_one


def _rest(voice: Voice, total: int, chosen: set[int]) -> str:
    others = [at for at in range(total) if at not in chosen]
    if voice.chance(0.3) and len(others) <= 4:
        return f"the {voice.listed([voice.ordinal(at, total) for at in others])}"
    return voice.say("rest") if len(others) > 1 else "the other one"


def _shape(voice: Voice, is_one: bool) -> tuple[str, str, dict[str, str]]:
    """Returns a random property of turns: its words in the text, the kind of turn, its words in the plan."""
    way = voice.rng.random()
    if way < 0.4:
        return "a hairpin" if is_one else "hairpins", "hairpin", {}
    if way < 0.7:
        word, sharpness = voice.pick((*SHARPNESS, ("sweeping", "sweeping")))
        return word, "turn", {"sharpness": sharpness}
    said, value = voice.angle()
    bound, amount = voice.pick((("", "{}"), ("", "{}"), ("less than ", "..{}"), ("at least ", "{}..")))
    return bound + said, "turn", {"deg": f"deg={amount.format(value)}"}


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
        give(turns[:first], key, one[1])
        give(turns[first:], key, other[1])
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


def sided_sum(voice: Voice) -> Composition:
    """Returns a description that gives the number of turns and how many go left and right.

    Sometimes it also says that the turns to one side come first or last.
    """
    total = voice.whole(2, 9)
    side = voice.pick(SIDES)
    few = voice.whole(1, max(1, total // 2))
    many = total - few
    count = voice.say("totals", n=voice.number(total), noun=voice.pick(NOUNS))
    text = f"{count}, " + voice.say(
        "sums", one=_sided(voice, few, side), other=_sided(voice, many, OTHER[side])
    )
    if voice.chance(0.45):
        left, right = (few, many) if side == "left" else (many, few)
        return voice.framed(text, f"| turns={total} lefts={left} rights={right}")
    place = voice.pick(("last", "last", "first"))
    text += voice.pick((", ", "; ", ", and ")) + voice.say(f"{'one' if few == 1 else 'many'} {place}", s=side)
    own, rest = [DescribedTurn(mods={"side": side})] * few, [DescribedTurn(mods={"side": OTHER[side]})] * many
    return voice.framed(text, clauses([*rest, *own] if place == "last" else [*own, *rest]))


def _sided(voice: Voice, number: int, side: str) -> str:
    return (
        f"{voice.number(number)} {voice.pick((side, side if number == 1 else f'{side}s', f'to the {side}'))}"
    )


def ranged(voice: Voice) -> Composition:
    """Returns a description with a range of counts, such as three to five turns.

    Sometimes it also says how the first or the last turn differs from the others.
    """
    low = voice.whole(2, 5)
    high = low + voice.whole(1, 3)
    numbers = {"low": low, "high": high, "less": low - 1, "more": high + 1}
    count = voice.say(
        "ranges", noun=voice.pick(NOUNS), **{name: voice.number(value) for name, value in numbers.items()}
    )
    if voice.chance(0.35):
        return voice.framed(count, f"| turns={low}..{high}")
    side = voice.pick(SIDES)
    own, said = voice.pick(
        (("turn", f"a {side}"), ("turn", f"a {side}-hander"), ("hairpin", f"a {side} hairpin"))
    )
    rest = f"turn x{low - 1}..{high - 1}"
    if voice.chance(0.5):
        return voice.framed(voice.say("first of", count=count, said=said), f"{own} {side}; {rest}")
    return voice.framed(voice.say("last of", count=count, said=said), f"{rest}; {own} {side}")
