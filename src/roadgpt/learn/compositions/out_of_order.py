"""Descriptions that do not name features in driving order. Instead they say, for example, that a feature
comes before another one, lies between two others, or ends the road.
"""

from roadgpt.learn.compositions.voice import SHARPNESS, SIDES, Composition, Voice


def out_of_order(voice: Voice) -> Composition:
    """Returns a description that names two or three features out of driving order."""
    names = "abc" if voice.chance(0.65) else "ab"
    things: list[tuple[str, str]] = []
    for _ in names:
        is_straight = bool(things) and things[-1][1].startswith("straight")
        things.append(_thing(voice, may_be_straight=not is_straight))
    said = {name: thing[0] for name, thing in zip(names, things, strict=True)}
    text = voice.say("three" if len(names) == 3 else "two", **said)
    return voice.framed(text, "; ".join(clause for _, clause in things))


def _thing(voice: Voice, may_be_straight: bool) -> tuple[str, str]:
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
