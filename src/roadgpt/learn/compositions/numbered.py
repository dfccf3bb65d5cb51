"""Descriptions that refer to turns by number, such as 'turns 2 and 4 go left' or 'the third is a hairpin'."""

from roadgpt.learn.compositions.voice import (
    NOUNS,
    OTHER,
    SHARPNESS,
    SIDES,
    Composition,
    DescribedTurn,
    Voice,
    clauses,
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
    """Returns a description of three to seven turns in which some turns, given by number, have a property
    of their own: for example, they are hairpins.

    Sometimes all turns go in the same direction.
    """
    total = voice.whole(3, 7)
    names, chosen, is_one = _chosen(voice, total)
    shape, kind, mods = _shape(voice, len(chosen) == 1)
    turns = [DescribedTurn(kind, dict(mods)) if at in chosen else DescribedTurn() for at in range(total)]
    said = f"{names} {'is' if is_one else 'are'} {shape}"
    if "sharpness" not in mods and voice.chance(0.35):
        word, sharpness = voice.pick(SHARPNESS)
        for at in {*range(total)} - chosen:
            turns[at].mods["sharpness"] = sharpness
        said += f", {_rest(voice, total, chosen)} {word}"
    if voice.chance(0.3):
        side = voice.pick(SIDES)
        for turn in turns:
            turn.mods["side"] = side
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
