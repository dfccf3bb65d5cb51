"""Descriptions of features in a row: with straights between them, repeated, named out of driving order,
corrected afterwards, or with words such as 'no more turns' at the end.
"""

from roadgpt_training.compositions.voice import (
    NOUNS,
    SHARPNESS,
    SIDES,
    Composition,
    DescribedTurn,
    Voice,
    clauses,
    give,
)

NOUNS_AND_HAIRPINS = (*NOUNS, "hairpins")


def spaced_turns(voice: Voice) -> Composition:
    """Returns a description of two to eight turns with straights between, after or before them."""
    things, turns, wish = _turns_to_space(voice)
    said, clause = _straight(voice)
    way = voice.pick(("between", "between", "between", "after", "before"))
    parts: list[str] = []
    for at, turn in enumerate(turns):
        is_led = way == "before" or (way == "between" and at > 0)
        parts += [clause, turn.clause] if is_led else [turn.clause]
        parts += [clause] if way == "after" else []
    return voice.framed(voice.say(way, things=things, **said), "; ".join(parts) + wish)


def _turns_to_space(voice: Voice) -> tuple[str, list[DescribedTurn], str]:
    """Returns the words for the turns, the turns, and a requirement for the whole road."""
    number = voice.whole(2, 8)
    if voice.chance(0.35):
        return *_list(voice, min(number, 6)), ""
    noun = voice.pick(NOUNS_AND_HAIRPINS)
    kind = "hairpin" if noun == "hairpins" else "turn"
    turns = [DescribedTurn(kind) for _ in range(number)]
    before, behind, wish = "", "", ""
    way = voice.rng.random()
    if way < 0.3:
        side = voice.pick(SIDES)
        before, behind = (f"{side} ", "") if voice.chance(0.6) else ("", f" to the {side}")
        give(turns, "side", side)
    elif way < 0.5:
        before, wish = "alternating ", " | alternating"
    if kind == "turn" and voice.chance(0.2):
        word, sharpness = voice.pick(SHARPNESS)
        before += f"{word} "
        give(turns, "sharpness", sharpness)
    elif kind == "turn" and voice.chance(0.25):
        angle, value = voice.angle()
        behind += f" of {angle}{voice.pick((' each', ''))}"
        give(turns, "deg", f"deg={value}")
    return f"{voice.number(number)} {before}{noun}{behind}", turns, wish


def _list(voice: Voice, number: int) -> tuple[str, list[DescribedTurn]]:
    """Returns a list like 'left, right, right', with an angle for each, or as letters."""
    sides = [voice.pick(SIDES) for _ in range(number)]
    turns = [DescribedTurn(mods={"side": side}) for side in sides]
    names = list(sides)
    if voice.chance(0.4):
        for at, turn in enumerate(turns):
            value = 5 * voice.whole(5, 22)
            names[at] += f" {value}"
            turn.mods["deg"] = f"deg={value}"
    elif voice.chance(0.3):
        names = [side[0].upper() for side in sides]
    return ", ".join(names), turns


def _straight(voice: Voice) -> tuple[dict[str, str], str]:
    """Returns the words for the straights, in singular and plural, and their clause."""
    said, value = voice.metres(15, 60)
    bound, amount = "", f"len={value}"
    if voice.chance(0.2):
        bound, amount = voice.pick(("at least ", "no less than ", "a minimum of ")), f"len={value}.."
    length = bound + said
    one = voice.pick((f"{length} of straight", f"{length} straight", f"a straight of {length}"))
    many = voice.pick((f"straights of {length}", f"{length} straights", f"{length} of straight"))
    return {"straight": one, "straights": many, "apart": length}, f"straight {amount}"


def repeated(voice: Voice) -> Composition:
    """Returns a description of a pattern of two or three features that is repeated two to four times.

    Sometimes one more feature follows the pattern.
    """
    parts = [_part_of_pattern(voice, may_be_straight=at > 0) for at in range(voice.whole(2, 3))]
    times = voice.pick((2, 2, 3, 3, 4))
    pattern = voice.say("pattern joints").join(said for said, _ in parts)
    way = "again" if times == 2 and voice.chance(0.8) else "times"
    text = voice.say(way, n=voice.number(times), pattern=pattern)
    plan = [clause for _ in range(times) for _, clause in parts]
    if voice.chance(0.3):
        said, clause = _part_of_pattern(voice, may_be_straight=False)
        text += voice.say("one more", said=said)
        plan.append(clause)
    return voice.framed(text, "; ".join(plan))


def _part_of_pattern(voice: Voice, may_be_straight: bool) -> tuple[str, str]:
    way = voice.rng.random()
    if may_be_straight and way < 0.35:
        said, value = voice.metres(15, 60)
        straight = voice.pick((f"{said} straight", f"a straight of {said}", f"{said} of straight"))
        return straight, f"straight len={value}"
    side = voice.pick(SIDES)
    if way < 0.6:
        said, value = voice.angle()
        turn = voice.pick((f"{said} {side}", f"{side} {said}", f"a {side} of {said}"))
        return turn, f"turn {side} deg={value}"
    if way < 0.7:
        return f"a {side} hairpin", f"hairpin {side}"
    return voice.pick((f"a {side}", f"{side} turn", f"a bend to the {side}", side)), f"turn {side}"


def lettered(voice: Voice) -> Composition:
    """Returns a description whose turns are given as letters ('L, L, R').

    Sometimes it also states one angle for all left turns, one for all right turns, or both.
    """
    turns = [DescribedTurn(mods={"side": voice.pick(SIDES)}) for _ in range(voice.whole(3, 7))]
    text = voice.pick((", ", "-", " ", ", ")).join(turn.mods["side"][0].upper() for turn in turns)
    said = []
    for side in SIDES:
        own = [turn for turn in turns if turn.mods["side"] == side]
        if own and voice.chance(0.75):
            angle, value = voice.angle()
            said.append(voice.say("letters", letter=side[0].upper(), angle=angle))
            give(own, "deg", f"deg={value}")
    return voice.framed("; ".join([text, *([", ".join(said)] if said else [])]), clauses(turns))


def out_of_order(voice: Voice) -> Composition:
    """Returns a description that names two or three features out of driving order."""
    names = "abc" if voice.chance(0.65) else "ab"
    things: list[tuple[str, str]] = []
    for _ in names:
        is_straight = bool(things) and things[-1][1].startswith("straight")
        things.append(_feature(voice, may_be_straight=not is_straight))
    said = {name: thing[0] for name, thing in zip(names, things, strict=True)}
    text = voice.say("three" if len(names) == 3 else "two", **said)
    return voice.framed(text, "; ".join(clause for _, clause in things))


def _feature(voice: Voice, may_be_straight: bool) -> tuple[str, str]:
    way = voice.rng.random()
    side = voice.pick(SIDES)
    if may_be_straight and way < 0.3:
        said, value = voice.metres()
        word, slope = voice.pick(
            (("", ""), ("level ", "flat "), ("climbing ", "up "), ("downhill ", "down "))
        )
        straight = voice.pick((f"a {word}straight of {said}", f"a {said} {word}straight"))
        return straight, f"straight {slope}len={value}"
    if way < 0.5:
        said, value = voice.angle()
        turn = voice.pick((f"a {side} of {said}", f"a {value} degree {side}", f"a {said} turn to the {side}"))
        return turn, f"turn {side} deg={value}"
    if way < 0.65:
        return voice.pick((f"a {side} hairpin", f"a hairpin to the {side}")), f"hairpin {side}"
    if way < 0.78:
        number = voice.whole(2, 4)
        return f"{voice.number(number)} {side}s", f"turn x{number} {side}"
    word, sharpness = voice.pick((*SHARPNESS, ("", "")))
    return f"a {word} {side}{voice.pick((' turn', ' bend', ''))}", f"turn {side} {sharpness}".strip()


def corrected(voice: Voice) -> Composition:
    """Returns a description in which one number is corrected afterwards, with the plan for the corrected
    number.
    """
    side, other = voice.pick(SIDES), voice.pick(SIDES)
    wrong, angle = (5 * voice.whole(5, 22) for _ in range(2))
    said, length = voice.metres()
    if voice.chance(0.5):
        right = voice.say("sorry", voice.pick((f"{angle}", f"{angle} degrees")))
        text = f"a {wrong} degree {side}{right}, then {said} straight and a {other}"
        return voice.framed(text, f"turn {side} deg={angle}; straight len={length}; turn {other}")
    kept = 5 * voice.whole(3, 16)
    right = voice.say("sorry", voice.pick((f"{kept}", f"{kept} m")))
    text = f"a {side}, {said} of straight{right}, then a {other} of {angle} degrees"
    return voice.framed(text, f"turn {side}; straight len={kept}; turn {other} deg={angle}")


def nothing_more(voice: Voice) -> Composition:
    """Returns a description that lists features and states that the road has no further features."""
    said: list[str] = []
    parts: list[str] = []
    for _ in range(voice.whole(1, 4)):
        if parts and not parts[-1].startswith("straight") and voice.chance(0.4):
            length, value = voice.metres()
            word, slope = voice.pick((("", ""), ("", ""), ("uphill ", "up "), ("flat ", "flat ")))
            said.append(f"a {word}straight of {length}")
            parts.append(f"straight {slope}len={value}")
        else:
            kind, noun = voice.pick((("turn", "turn"), ("turn", "bend"), ("hairpin", "hairpin")))
            side = voice.pick(SIDES)
            said.append(f"a {side} {noun}")
            parts.append(f"{kind} {side}")
    text = voice.say("joints").join(said) + voice.say("enough")
    return voice.framed(text, "; ".join(parts), may_slope=False)
