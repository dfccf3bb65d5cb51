"""Lists of turns in five languages whose properties are told by their place in the list: as a row of numbers,
by ordinals, for groups, for one side, or for all but one.
"""

import re
from collections.abc import Sequence

from roadgpt_training.compositions.listed_figures import figures, figures_of_both
from roadgpt_training.compositions.turn_list import UNITS, TurnList
from roadgpt_training.compositions.voice import OTHER, SIDES, Composition, Voice

SLOPES = ("up", "down", "flat")
SHARPNESS = ("sharp", "gentle")
CLASHES = {
    "deg": {"deg", "sharpness", "hairpin"},
    "r": {"r", "sharpness", "hairpin"},
    "hairpin": {"deg", "r", "sharpness", "hairpin"},
    "sharpness": {"deg", "r", "sharpness", "hairpin"},
    "slope": {"slope"},
}
"""Maps each property to the properties that exclude it, if they have been told before."""
LOOSE = r"[:,(] ?\{sides|^\{sides"
"""Pattern of the phrases in which any words can stand for the sides, as in "4 turns: {sides}"."""


def listed(voice: Voice) -> Composition:
    """Returns a description of three to nine turns in a row, in the language of the voice.

    Properties of the turns and the straights between them are told by their place in the list.
    """
    road = TurnList(voice, voice.pick((3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6, 7, 8, 9)))
    is_late = voice.chance(0.12)
    head = _sides(road, is_late)
    said = _properties(road)
    is_open = not any("slope" in turn.mods for turn in road.turns)
    if is_open and not any(road.straights) and (voice.chance(0.45) or not said):
        said += _straights(road)
    order = voice.rng.permutation(len(said)) if voice.chance(0.5) else range(len(said))
    parts = [said[int(at)] for at in order]
    wish = ""
    if is_open and voice.chance(0.1):
        wish = voice.pick(SLOPES)
        parts.append(road.say(f"whole {wish}"))
        wish = f" | {wish}"
    parts.insert(voice.whole(1, len(parts)) if is_late and parts else 0, head)
    return Composition(_written(road, parts), road.plan + wish)


def _written(road: TurnList, parts: list[str]) -> str:
    """Returns the parts as one text: sentences, or phrases with commas or semicolons between them."""
    voice = road.voice
    opening = voice.pick(road.phrases["openings"])
    is_counted = parts[0].startswith(voice.number(road.number) + " ")
    if is_counted:
        parts[0] = opening + parts[0]
    joint = voice.pick((". ", ". ", "; ", "; ", ", "))
    if joint == ". ":
        parts = [part[:1].upper() + part[1:] if voice.chance(0.95) else part for part in parts]
    text = joint.join(parts)
    for pattern, new in road.phrases["polish"]:
        text = re.sub(pattern, new, text)
    return text


def _sides(road: TurnList, is_late: bool) -> str:
    """Gives the turns their sides, and sometimes figures in the same list; returns the words for it."""
    voice, way = road.voice, road.voice.rng.random()
    names = dict(zip(SIDES, road.phrases["sides"][0], strict=True))
    if way < 0.1 and not is_late:
        return road.say("unsided")
    side = voice.pick(SIDES)
    if way < 0.22 and not is_late:
        for at, turn in enumerate(road.turns):
            turn.mods["side"] = OTHER[side] if at % 2 else side
        return road.say("alternating", s=names[side], o=names[OTHER[side]])
    if way < 0.3 and not is_late:
        road.give("side", side, range(road.number))
        return road.say("one side", s=names[side])
    for turn in road.turns:
        turn.mods["side"] = voice.pick(SIDES)
    has_both = all(road.of_side(each) for each in SIDES)
    items = _runs(road) if way < 0.4 and has_both else _items(road)
    head = "head late" if is_late else "head" if voice.chance(0.6) else "head alone"
    has_more = way < 0.4 or any(turn.kind == "hairpin" or len(turn.mods) > 1 for turn in road.turns)
    return road.say(head, False, LOOSE if has_more else "", sides=items)


def _runs(road: TurnList) -> str:
    """Returns the sides as counted runs: 'two lefts, then a right'."""
    voice = road.voice
    one, many = (voice.pick(road.phrases[key]) for key in ("run of one", "run of many"))
    runs: list[tuple[int, int]] = []
    for turn in road.turns:
        side = SIDES.index(turn.mods["side"])
        if runs and runs[-1][0] == side:
            runs[-1] = (side, runs[-1][1] + 1)
        else:
            runs.append((side, 1))
    names = [one[s] if k == 1 else many[s].format(k=voice.number(k)) for s, k in runs]
    if len(runs) == 2:  # "two lefts and a right" might leave the order open
        return str(road.phrases["then"][0]).join(names)
    return road.joined(names) if voice.chance(0.6) else voice.pick(road.phrases["then"]).join(names)


def _items(road: TurnList) -> str:
    """Returns the sides one by one, as words or letters, sometimes with angles, radii or hairpins."""
    voice, way = road.voice, road.voice.rng.random()
    are_letters = voice.chance(0.3)
    pair = voice.pick(road.phrases["letters" if are_letters else "sides"])
    if 0.1 < way < 0.35 and not are_letters and voice.chance(0.4):
        pair = voice.pick(road.phrases["side nouns"])
    names = [pair[SIDES.index(turn.mods["side"])] for turn in road.turns]
    if way < 0.35:
        keys = ("deg",) if way < 0.2 else ("r",) if way < 0.26 else ("deg", "r")
        if len(keys) * road.number <= road.room:
            if are_letters:  # a small "r" before a number means a radius
                pair = voice.pick([each for each in road.phrases["letters"] if each[1] != "r"])
                names = [pair[SIDES.index(turn.mods["side"])] for turn in road.turns]
            return _with_figures(road, names, keys, are_letters)
    if are_letters:
        return voice.pick((" ", " ", ", ", "-", "")).join(names) if len(pair[0]) == 1 else " ".join(names)
    if way > 0.9:
        hairpins = voice.pick(road.phrases["hairpin"])
        for at in voice.rng.permutation(road.number)[: voice.whole(1, 2)]:
            road.turns[int(at)].kind = "hairpin"
            names[int(at)] = hairpins[SIDES.index(road.turns[int(at)].mods["side"])]
    return _strung(road, _with_straights(road, names) if voice.chance(0.12) else names)


def _strung(road: TurnList, names: Sequence[str]) -> str:
    if road.voice.chance(0.4):
        return road.joined(names)
    return str(road.voice.pick((", ", ", ", " - ", " / ", ", ", *road.phrases["then"]))).join(names)


def _with_figures(road: TurnList, names: list[str], keys: tuple[str, ...], are_letters: bool) -> str:
    """Returns the sides, each with its angle, its radius or both."""
    voice = road.voice
    pools = {key: road.pool(key) for key in keys}
    key = "item both" if len(keys) > 1 else f"item {keys[0]}"
    ways = road.phrases[key]
    form = ways[0] if are_letters else voice.pick(ways)
    if are_letters and voice.chance(0.5):
        form = form.replace("{s} {a}", "{s}{a}")
    number = str if are_letters or "{b}" in form else road.voice.number
    items = []
    for at, name in enumerate(names):
        figures: dict[str, str] = {}
        for key, small, large in (("deg", "a", "A"), ("r", "b", "B")):
            if key in keys:
                value = voice.pick(pools[key])
                road.give(key, value, [at])
                figures |= {small: number(value), large: road.measure(value, UNITS[key])}
        items.append(form.format(s=name, **figures))
    road.room -= len(keys) * road.number
    if are_letters:
        return voice.pick((" ", ", ")).join(items)
    if voice.chance(0.12):
        return voice.pick((" ", ", ")).join(f"{at}) {item}" for at, item in enumerate(items, 1))
    return _strung(road, _with_straights(road, items) if voice.chance(0.2) else items)


def _with_straights(road: TurnList, items: Sequence[str]) -> list[str]:
    """Returns the items with one or two straights among them."""
    number = min(road.voice.whole(1, 2), road.room)
    chosen = {int(at) for at in road.voice.rng.permutation(road.number)[:number]}
    out: list[str] = []
    for at, item in enumerate(items):
        if at in chosen:
            (value,) = road.draw("len")
            road.straights[at] = f"straight len={value}"
            out.append(road.say("item straight", **road.straight(value)))
        out.append(item)
    return out


def _properties(road: TurnList) -> list[str]:
    """Gives the turns one to three properties; returns the phrases for them."""
    voice = road.voice
    taken = {key for turn in road.turns for key in (*turn.mods, turn.kind)}
    keys = ["deg", "deg", "deg", "r", "r", "hairpin", "sharpness", "slope"]
    said: list[str] = []
    if voice.chance(0.08) and not taken & {"hairpin", *UNITS}:
        said.append(figures_of_both(road))
        taken |= {*UNITS}
    for _ in range(voice.pick((1, 1, 2, 2, 2, 3))):
        key = voice.pick(keys)
        if taken & CLASHES[key] or (key == "slope" and any(road.straights)):
            continue
        if key in UNITS:
            if road.room < 4:
                continue
            said.append(figures(road, key))
        else:
            said.append(_words(road, key))
        taken.add(key)
    return said


def _words(road: TurnList, key: str) -> str:
    """Tells which turns are hairpins, which are sharp or gentle, or which climb, fall or are level."""
    voice = road.voice
    if key == "hairpin":
        has_both = all(road.of_side(side) for side in SIDES)
        place = road.sided(voice.pick(SIDES)) if has_both and voice.chance(0.2) else road.chosen(2)
        for at in place.at:
            road.turns[at].kind = "hairpin"
        return road.say("is hairpin", place.is_one, x=place.name)
    values = list(SLOPES if key == "slope" else SHARPNESS)
    values = [values[int(at)] for at in voice.rng.permutation(len(values))]
    way = voice.rng.random()
    if way < 0.45:
        places = road.groups()
        values = (values * 2)[: len(places)]
    elif way < 0.6 and all(road.of_side(side) for side in SIDES):
        places = [road.sided(side) for side in SIDES]
    elif way < 0.68 and road.number > 3:
        places = road.odd_and_even()
    else:
        places = [road.chosen(3)]
        places += [road.others(places[0].at)] if voice.chance(0.35) else []
    said = []
    for place, value in zip(places, values, strict=False):
        road.give(key, value, place.at)
        said.append(road.say(f"is {value}", place.is_one, x=place.name))
    return ", ".join(said) if voice.chance(0.6) else road.joined(said)


def _straights(road: TurnList) -> list[str]:
    """Puts straights between the turns, at both ends, or both; returns the phrases for them."""
    voice = road.voice
    said: list[str] = []
    if voice.chance(0.7) and road.room > 1:
        said.append(_between(road))
    if road.straights[-1]:
        return said
    if (voice.chance(0.4) or not said) and road.room > 1:
        said += _ends(road)
    return said


def _between(road: TurnList) -> str:
    voice, inner = road.voice, range(1, road.number)
    ways = ["gap all", "gap all", "gap all", "gap at", "gap at", "gap at", "gap only", "gap but"]
    ways += [
        "gap bare",
        "gap least",
        "gap after",
        *(["gap by side"] if all(map(road.of_side, SIDES)) else []),
    ]
    ways += ["gap row", "gap row"] if road.number - 1 <= min(road.room, 5) else []
    way = voice.pick(ways)
    if way == "gap row":
        values = [voice.pick(road.pool("len")) for _ in inner]
        road.room -= len(values)
        for at, value in zip(inner, values, strict=True):
            road.straights[at] = f"straight len={value}"
        return road.say(way, row=road.row(values, "len"))
    if way == "gap by side":
        return _behind_a_side(road)
    first, second = road.draw("len", 2)
    if way == "gap after":
        place = road.some(sorted(int(at) for at in voice.rng.permutation(road.number - 1)[:2]))
        for at in place.at:
            road.straights[at + 1] = f"straight len={first}"
        return road.say(way, x=place.name, ox=place.oblique, **road.straight(first))
    everywhere = {
        "gap all": f" len={first}",
        "gap but": f" len={first}",
        "gap least": f" len={first}..",
        "gap bare": "",
    }
    if way in everywhere:
        for at in inner:
            road.straights[at] = f"straight{everywhere[way]}"
    at = voice.pick(inner)
    if way in ("gap at", "gap only", "gap but"):
        road.straights[at] = f"straight len={second if way == 'gap but' else first}"
    return road.say(way, **road.neighbours(at), **road.straight(first), M=road.measure(second, "metres"))


def _behind_a_side(road: TurnList) -> str:
    """Puts a straight behind each turn to one side."""
    side = road.voice.pick(SIDES)
    (value,) = road.draw("len")
    for at in road.of_side(side):
        road.straights[at + 1] = f"straight len={value}"
    name = road.voice.pick(road.phrases["every"])[SIDES.index(side)]
    return road.say("gap by side", y=name, **road.straight(value))


def _ends(road: TurnList) -> list[str]:
    """Puts a straight before the first turn, behind the last one, or both."""
    way = road.voice.pick(("lead", "out", "both", "in and out", "lead out"))
    first, second = road.draw("len", 2)
    if way != "out":
        road.straights[0] = f"straight len={first}"
    if way != "lead":
        road.straights[-1] = f"straight len={first if way in ('out', 'both') else second}"
    names = road.ends()
    if way == "lead out":
        return [
            road.say("lead", **names, **road.straight(first)),
            road.say("out", **names, **road.straight(second)),
        ]
    return [road.say(way, **names, **road.straight(first), M=road.measure(second, "metres"))]
