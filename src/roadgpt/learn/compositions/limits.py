"""Wishes for the whole road in any order: bounds by denial, lengths beside radii beside heights."""

from typing import NamedTuple

from roadgpt.learn.compositions.said import NOUNS, SIDES, Said, Voice


class _Wish(NamedTuple):
    """How a wish is said, and where it stands in the plan."""

    said: str
    of_turns: str = ""
    of_road: str = ""


def limited(voice: Voice) -> Said:
    """A number of turns and two to four wishes with numbers, in any order."""
    number = voice.whole(2, 7)
    count, side = voice.pick((voice.turns(number), f"{voice.pick(NOUNS)}: {number}")), ""
    if voice.chance(0.2):
        side = voice.pick(SIDES)
        count += voice.pick((f", all {side}", f" to the {side}"))
    ways = (_radius, _grade, _length, _height, _angle)
    wishes = [ways[int(at)](voice) for at in voice.rng.permutation(len(ways))[: voice.whole(2, 4)]]
    parts = [wish.said for wish in wishes]
    parts.insert(voice.whole(0, len(parts)), count)
    if voice.chance(0.25):
        text = "; ".join(f"{letter}) {part}" for letter, part in zip("abcde", parts, strict=False))
    else:
        text = voice.pick((", ", "; ", ", ", ". ")).join(parts)
    clause = " ".join([f"turn x{number}", side, *(wish.of_turns for wish in wishes)])
    road = " ".join(wish.of_road for wish in wishes)
    return voice.framed(text, f"{clause} | {road}" if road.strip() else clause, may_slope=False)


def _radius(voice: Voice) -> _Wish:
    said, value = voice.metres(20, 60)
    if voice.chance(0.7):
        return _Wish(voice.say("least radius", said), f"r={value}..")
    return _Wish(voice.say("largest radius", said), f"r=..{value}")


def _grade(voice: Voice) -> _Wish:
    said, value = voice.percent(4, 12)
    if voice.chance(0.75):
        return _Wish(voice.say("steepest", said), of_road=f"steepest=..{value}")
    return _Wish(voice.say("at steepest", said), of_road=f"steepest={value}..")


def _length(voice: Voice) -> _Wish:
    said, value = voice.metres(250, 600)
    if voice.chance(0.7):
        return _Wish(voice.say("lengths", said), of_road=f"len={value}")
    return _Wish(voice.say("shorter", said), of_road=f"len=..{value}")


def _height(voice: Voice) -> _Wish:
    value = voice.whole(5, 15)
    said = f"{voice.number(value)} {'metres' if voice.spells else voice.pick(('m', 'metres'))}"
    if voice.chance(0.5):
        return _Wish(voice.say("gains", said), of_road=f"climb={value}")
    return _Wish(voice.say("falls", said), of_road=f"climb=-{value}")


def _angle(voice: Voice) -> _Wish:
    said, value = voice.angle(35, 90)
    if voice.chance(0.65):
        return _Wish(voice.say("angles below", said), f"deg=..{value}")
    return _Wish(voice.say("angles above", said), f"deg={value}..")
