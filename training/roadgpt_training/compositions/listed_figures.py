"""Tells the angles or the radii of a list of turns: in a row, by groups, by side, by ordinals, or for all but
one.
"""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

from roadgpt_training.compositions.turn_list import UNITS, PlaceInList, TurnList
from roadgpt_training.compositions.voice import SIDES


def figures(road: TurnList, key: str) -> str:
    """Tells the angles or the radii in one of many ways."""
    ways: list[Callable[[TurnList, str], str]] = [
        _by_groups,
        _by_groups,
        _but,
        _but,
        _by_ordinals,
        _by_ordinals,
    ]
    if road.number <= road.room:
        ways += [_row, _row, _row, _enumerated]
    if all(road.of_side(side) for side in SIDES):
        ways += [_by_side, _by_side]
    ways += [_odd_and_even] if road.number > 3 else []
    ways += [] if road.voice.spells else [_in_runs]
    ways += [_patterned, _patterned] if road.number % 2 == 0 and road.number <= road.room else []
    ways += [_for_all] if road.voice.chance(0.3) else []
    return road.voice.pick(ways)(road, key)


def figures_of_both(road: TurnList) -> str:
    """Tells an angle and a radius for each of two or three groups, or for a few turns by ordinals."""
    if road.voice.chance(0.5):
        places = road.groups(are_short=True)
    else:
        chosen = road.chosen(1)
        places = [chosen, road.others(chosen.at)] if road.voice.chance(0.5) else [chosen]
    said: list[str] = []
    angles, radii = road.draw("deg", len(places)), road.draw("r", len(places))
    for place, angle, radius in zip(places, angles, radii, strict=True):
        road.give("deg", angle, place.at)
        road.give("r", radius, place.at)
        figures = {"A": road.measure(angle, "degrees"), "B": road.measure(radius, "metres")}
        said.append(road.say("more both" if said else "is both", place.is_one, x=place.name, **figures))
    return (", " if road.voice.chance(0.5) else "; ").join(said)


def _is(road: TurnList, key: str, place: PlaceInList, value: int, is_first: bool = True) -> str:
    """Gives a place one value; returns the phrase, shorter if it follows another of its kind."""
    road.give(key, value, place.at)
    figures = {"a": road.voice.number(value), "d": str(value), "A": road.measure(value, UNITS[key])}
    return road.say(f"{'is' if is_first else 'more'} {key}", place.is_one, x=place.name, **figures)


def _each(road: TurnList, key: str, places: Iterable[PlaceInList], values: Sequence[int]) -> list[str]:
    """Gives each place its value; returns the phrases."""
    both = zip(places, values, strict=True)
    return [_is(road, key, place, value, not at) for at, (place, value) in enumerate(both)]


def _by_groups(road: TurnList, key: str) -> str:
    places = road.groups(are_short=True)
    said = _each(road, key, places, road.draw(key, len(places)))
    return ", ".join(said) if road.voice.chance(0.6) else road.joined(said)


def _by_side(road: TurnList, key: str) -> str:
    sides = SIDES if road.voice.chance(0.5) else SIDES[::-1]
    return _two_places(road, key, [road.sided(side) for side in sides])


def _odd_and_even(road: TurnList, key: str) -> str:
    return _two_places(road, key, road.odd_and_even())


def _two_places(road: TurnList, key: str, places: Sequence[PlaceInList]) -> str:
    said = _each(road, key, places, road.draw(key, 2))
    return road.joined(said) if road.voice.chance(0.5) else ", ".join(said)


def _by_ordinals(road: TurnList, key: str) -> str:
    """Gives one to three turns a value of their own, and sometimes the others one, too."""
    voice = road.voice
    number = min(voice.whole(1, 3), road.number - 1, road.room - 1)
    chosen = sorted(int(at) for at in voice.rng.permutation(road.number)[:number])
    values = road.draw(key, number)
    said = _each(road, key, (road.one(at) for at in chosen), values)
    if voice.chance(0.4):
        said.append(_is(road, key, road.others(chosen), road.draw(key)[0], is_first=False))
    return ", ".join(said) if voice.chance(0.6) else road.joined(said)


def _but(road: TurnList, key: str) -> str:
    """Gives all turns one value, except for one or two of them."""
    value, other = road.draw(key, 2)
    place = road.chosen(2 if road.number > 4 and road.voice.chance(0.4) else 1)
    road.give(key, value, range(road.number))
    road.give(key, other, place.at)
    figures = {"A": road.measure(value, UNITS[key]), "B": road.measure(other, UNITS[key])}
    return road.say(f"except {key}", place.is_one, x=place.name, ox=place.oblique, **figures)


def _for_all(road: TurnList, key: str) -> str:
    (value,) = road.draw(key)
    road.give(key, value, range(road.number))
    return road.say(f"all {key}", A=road.measure(value, UNITS[key]))


def _enumerated(road: TurnList, key: str) -> str:
    """Tells one value for each turn by its number: 'turn 1: 40 degrees, turn 2: 60 degrees'."""
    voice, pool = road.voice, road.pool(key)
    road.room -= road.number
    values = [voice.pick(pool) for _ in road.turns]
    by_number = (
        road.phrases["numbered"][0] + ": " if key == "deg" and not voice.spells and voice.chance(0.6) else ""
    )
    said = [
        (by_number.format(noun1=road.noun, k=at + 1) or f"{road.ordinals[at]} ")
        + road.measure(value, UNITS[key])
        for at, value in enumerate(values)
    ]
    whole = _row_of(road, key, values, ", ".join(said), r": \{row\}$")
    return ", ".join(said) if key == "deg" else whole


def _row(road: TurnList, key: str) -> str:
    pool = road.pool(key)
    values = [road.voice.pick(pool) for _ in road.turns]
    road.room -= road.number
    return _row_of(road, key, values, road.row(values, key), like="")


def _patterned(road: TurnList, key: str) -> str:
    """Tells an even number of values as a pair that alternates, or as half of a row and 'the same again'."""
    voice, half = road.voice, road.number // 2
    way = voice.pick(("turns about", "again", "mirrored"))
    if way == "turns about":
        one, other = road.draw(key, 2)
        values = [one, other] * half
        said = {"one": road.voice.number(one), "other": road.measure(other, UNITS[key])}
    else:
        row = road.draw(key, half)
        back = row[::-1] if way == "mirrored" else row
        values = [*row, *back]
        road.room -= half
        said = {"row": road.row(row, key), "back": road.row(back, key)}
    return _row_of(road, key, values, road.say(way, **said), r": \{row\}$")


def _in_runs(road: TurnList, key: str) -> str:
    """Tells a row in which equal values follow each other: '3 x 40, 2 x 65 degrees'."""
    cuts = sorted(1 + int(at) for at in road.voice.rng.permutation(road.number - 1)[: road.voice.whole(1, 2)])
    ends = [0, *cuts, road.number]
    sizes = [end - start for start, end in pairwise(ends)]
    runs = road.draw(key, len(sizes))
    way = road.voice.pick(road.phrases["several times"])
    names = [
        way.format(k=road.voice.number(size), a=road.voice.number(value))
        if size > 1
        else road.voice.number(value)
        for size, value in zip(sizes, runs, strict=True)
    ]
    values = [value for size, value in zip(sizes, runs, strict=True) for _ in range(size)]
    return _row_of(road, key, values, road.joined(names) + road.units[UNITS[key]])


def _row_of(road: TurnList, key: str, values: Sequence[int], said: str, like: str = r"\{row\}$") -> str:
    """Gives each turn its value; returns the phrase that ends with ``said``."""
    for at, value in enumerate(values):
        road.give(key, value, [at])
    return road.say(f"row {key}", False, like, row=said)
