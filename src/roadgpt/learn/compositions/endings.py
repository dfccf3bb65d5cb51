"""Descriptions that correct one of their numbers, or end with words such as 'no more turns'."""

from roadgpt.learn.compositions.voice import SIDES, Composition, Voice


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
