"""Descriptions with limits for the whole road, such as 'no steeper than 6 %', in any order."""

from typing import NamedTuple

from roadgpt.learn.compositions.voice import NOUNS, SIDES, Composition, Voice


class _Wish(NamedTuple):
    """The words of a requirement, and what it adds to the plan."""

    said: str
    of_turns: str = ""
    of_road: str = ""


def with_limits(voice: Voice, said: Composition) -> Composition:
    """Returns the composition with one to three limits for the whole road added before or after its text."""
    ways = [_grade, _length, _height]
    if not any(word in said.plan for word in ("sharp", "gentle", "sweeping")):
        ways.append(_radius_of_hairpins if "hairpin" in said.plan else _radius)
    if "deg=" not in said.plan and "hairpin" not in said.plan:
        ways.append(_angle)
    wishes = [ways[int(at)](voice) for at in voice.rng.permutation(len(ways))[: voice.whole(1, 3)]]
    parts = [wish.said for wish in wishes]
    parts.insert(0 if voice.chance(0.7) else voice.whole(0, len(parts)), said.text.rstrip(". "))
    text = _joined(voice, parts)
    road = " ".join(f"{wish.of_turns} {wish.of_road}" for wish in wishes)
    return Composition(text, f"{said.plan}{' ' if '|' in said.plan else ' | '}{road}")


def _joined(voice: Voice, parts: list[str]) -> str:
    """Joins the parts as a sentence, as sentences, or as a list with letters, numbers or dashes."""
    way = voice.rng.random()
    if way < 0.12:
        return "; ".join(f"{letter}) {part}" for letter, part in zip("abcdef", parts, strict=False))
    if way < 0.2:
        return "\n".join(f"- {part}" for part in parts)
    if way < 0.26:
        return "\n".join(f"{number}. {part}" for number, part in enumerate(parts, 1))
    if way < 0.5:
        return ". ".join(part[:1].upper() + part[1:] for part in parts)
    return voice.pick((", ", "; ", ", ", ", and ")).join(parts)


def limited(voice: Voice) -> Composition:
    """Returns a description that gives the number of turns and two to four numerical requirements, in any
    order.
    """
    number = voice.whole(2, 7)
    count, side = voice.pick((voice.turns(number), f"{voice.pick(NOUNS)}: {number}")), ""
    if voice.chance(0.2):
        side = voice.pick(SIDES)
        count += voice.pick((f", all {side}", f" to the {side}"))
    ways = (_radius, _grade, _length, _height, _angle)
    wishes = [ways[int(at)](voice) for at in voice.rng.permutation(len(ways))[: voice.whole(2, 4)]]
    parts = [wish.said for wish in wishes]
    parts.insert(voice.whole(0, len(parts)), count)
    text = _joined(voice, parts)
    clause = " ".join([f"turn x{number}", side, *(wish.of_turns for wish in wishes)])
    road = " ".join(wish.of_road for wish in wishes)
    return voice.framed(text, f"{clause} | {road}" if road.strip() else clause, may_slope=False)


def _radius(voice: Voice) -> _Wish:
    said, value = voice.metres(20, 60)
    if voice.chance(0.7):
        return _Wish(voice.say("least radius", said), f"r={value}..")
    return _Wish(voice.say("largest radius", said), f"r=..{value}")


def _radius_of_hairpins(voice: Voice) -> _Wish:
    said, value = voice.metres(15, 25)
    return _Wish(voice.say("least radius", said), f"r={value}..")


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
