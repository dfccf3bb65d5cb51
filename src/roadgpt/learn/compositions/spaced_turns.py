"""Descriptions of turns and straights: a straight between any two turns, before each, or after each."""

from roadgpt.learn.compositions.voice import SHARPNESS, SIDES, Composition, DescribedTurn, Voice

NOUNS = (
    ("turns", "turn"),
    ("bends", "turn"),
    ("curves", "turn"),
    ("corners", "turn"),
    ("hairpins", "hairpin"),
)


def spaced_turns(voice: Voice) -> Composition:
    """Returns a description of two to eight turns with straights between, after or before them."""
    things, turns, wish = _things(voice)
    said, clause = _straight(voice)
    way = voice.pick(("between", "between", "between", "after", "before"))
    parts: list[str] = []
    for at, turn in enumerate(turns):
        is_led = way == "before" or (way == "between" and at > 0)
        parts += [clause, turn.clause] if is_led else [turn.clause]
        parts += [clause] if way == "after" else []
    return voice.framed(voice.say(way, things=things, **said), "; ".join(parts) + wish)


def _things(voice: Voice) -> tuple[str, list[DescribedTurn], str]:
    """Returns the words for the turns, the turns, and a requirement for the whole road."""
    number = voice.whole(2, 8)
    if voice.chance(0.35):
        return *_list(voice, min(number, 6)), ""
    noun, kind = voice.pick(NOUNS)
    turns = [DescribedTurn(kind) for _ in range(number)]
    before, behind, wish = "", "", ""
    way = voice.rng.random()
    if way < 0.3:
        side = voice.pick(SIDES)
        before, behind = (f"{side} ", "") if voice.chance(0.6) else ("", f" to the {side}")
        _all(turns, "side", side)
    elif way < 0.5:
        before, wish = "alternating ", " | alternating"
    if kind == "turn" and voice.chance(0.2):
        word, sharpness = voice.pick(SHARPNESS)
        before += f"{word} "
        _all(turns, "sharpness", sharpness)
    elif kind == "turn" and voice.chance(0.25):
        angle, value = voice.angle()
        behind += f" of {angle}{voice.pick((' each', ''))}"
        _all(turns, "deg", f"deg={value}")
    return f"{voice.number(number)} {before}{noun}{behind}", turns, wish


def _all(turns: list[DescribedTurn], key: str, word: str) -> None:
    for turn in turns:
        turn.mods[key] = word


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
