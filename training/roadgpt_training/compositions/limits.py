"""Descriptions with limits for the whole road, such as 'no steeper than 6 %', in any order."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from roadgpt_training.compositions.voice import NOUNS, SIDES, Composition, Voice


class _Limit(NamedTuple):
    """A kind of requirement: its two wordings, and what each of them adds to the plan for the number."""

    measure: Callable[[Voice, int, int], tuple[str, int]]
    low: int
    high: int
    one: tuple[str, str]
    other: tuple[str, str] | None
    share: float
    """How often it is the first wording, 0 to 1."""


def _height(voice: Voice, low: int, high: int) -> tuple[str, int]:
    value = voice.whole(low, high)
    return f"{voice.number(value)} {'metres' if voice.spells else voice.pick(('m', 'metres'))}", value


RADIUS = _Limit(Voice.metres, 20, 60, ("least radius", "r={}.."), ("largest radius", "r=..{}"), 0.7)
RADIUS_OF_HAIRPINS = _Limit(Voice.metres, 15, 25, ("least radius", "r={}.."), None, 1.0)
GRADE = _Limit(Voice.percent, 4, 12, ("steepest", "steepest=..{}"), ("at steepest", "steepest={}.."), 0.75)
LENGTH = _Limit(Voice.metres, 250, 600, ("lengths", "len={}"), ("shorter", "len=..{}"), 0.7)
HEIGHT = _Limit(_height, 5, 15, ("gains", "climb={}"), ("falls", "climb=-{}"), 0.5)
ANGLE = _Limit(Voice.angle, 35, 90, ("angles below", "deg=..{}"), ("angles above", "deg={}.."), 0.65)
OF_TURNS = (RADIUS, RADIUS_OF_HAIRPINS, ANGLE)


def with_limits(voice: Voice, said: Composition) -> Composition:
    """Returns the composition with one to three limits for the whole road added before or after its text."""
    ways = [GRADE, LENGTH, HEIGHT]
    if not any(word in said.plan for word in ("sharp", "gentle", "sweeping")):
        ways.append(RADIUS_OF_HAIRPINS if "hairpin" in said.plan else RADIUS)
    if "deg=" not in said.plan and "hairpin" not in said.plan:
        ways.append(ANGLE)
    parts, of_turns, of_road = _wishes(voice, ways, 1, 3)
    parts.insert(0 if voice.chance(0.7) else voice.whole(0, len(parts)), said.text.rstrip(". "))
    wishes = " ".join([*of_turns, *of_road])
    return Composition(_joined(voice, parts), f"{said.plan}{' ' if '|' in said.plan else ' | '}{wishes}")


def _wishes(
    voice: Voice, ways: Sequence[_Limit], least: int, most: int
) -> tuple[list[str], list[str], list[str]]:
    """Returns the words of a random number of limits, and what they ask of the turns and of the road."""
    said: list[str] = []
    of_turns: list[str] = []
    of_road: list[str] = []
    for at in voice.rng.permutation(len(ways))[: voice.whole(least, most)]:
        limit = ways[int(at)]
        words, value = limit.measure(voice, limit.low, limit.high)
        way = limit.one if limit.other is None or voice.chance(limit.share) else limit.other
        said.append(voice.say(way[0], words))
        (of_turns if limit in OF_TURNS else of_road).append(way[1].format(value))
    return said, of_turns, of_road


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
    parts, of_turns, of_road = _wishes(voice, (RADIUS, GRADE, LENGTH, HEIGHT, ANGLE), 2, 4)
    parts.insert(voice.whole(0, len(parts)), count)
    text = _joined(voice, parts)
    clause = " ".join([f"turn x{number}", side, *of_turns])
    return voice.framed(text, f"{clause} | {' '.join(of_road)}" if of_road else clause, may_slope=False)
