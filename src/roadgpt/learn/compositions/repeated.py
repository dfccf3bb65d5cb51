"""Describes repeated patterns, and turns whose directions are given as letters, such as 'L, L, R'."""

from roadgpt.learn.compositions.voice import SIDES, Composition, DescribedTurn, Voice, clauses


def repeated(voice: Voice) -> Composition:
    """Returns a description of a pattern of two or three features that is repeated two to four times.

    Sometimes one more feature follows the pattern.
    """
    parts = [_part(voice, may_be_straight=at > 0) for at in range(voice.whole(2, 3))]
    times = voice.pick((2, 2, 3, 3, 4))
    pattern = voice.say("pattern joints").join(said for said, _ in parts)
    way = "again" if times == 2 and voice.chance(0.8) else "times"
    text = voice.say(way, n=voice.number(times), pattern=pattern)
    plan = [clause for _ in range(times) for _, clause in parts]
    if voice.chance(0.3):
        said, clause = _part(voice, may_be_straight=False)
        text += voice.say("one more", said=said)
        plan.append(clause)
    return voice.framed(text, "; ".join(plan))


def _part(voice: Voice, may_be_straight: bool) -> tuple[str, str]:
    way = voice.rng.random()
    if may_be_straight and way < 0.35:
        said, value = voice.metres(15, 60)
        straight = voice.pick((f"{said} straight", f"a straight of {said}", f"{said} of straight"))
        return straight, f"straight len={value}"
    side = voice.pick(SIDES)
    if way < 0.6:
        said, value = voice.angle()
        return voice.pick(
            (f"{said} {side}", f"{side} {said}", f"a {side} of {said}")
        ), f"turn {side} deg={value}"
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
            for turn in own:
                turn.mods["deg"] = f"deg={value}"
    return voice.framed("; ".join([text, *([", ".join(said)] if said else [])]), clauses(turns))
