"""Writes a Brief as one plain English sentence, which the model reader can read back."""

from collections.abc import Iterator, Mapping

from roadgpt.brief.junctions import LANE_KINDS, NAMES, SIGNS, JunctionClause, JunctionCount, MapClause
from roadgpt.brief.model import Amount, Brief, Clause, at_least, exactly
from roadgpt.brief.normal import BUMPS, STRAIGHT, normal
from roadgpt.brief.scene import scene_text
from roadgpt.brief.words import FEATURE, KINDS, OVER, SLOPES
from roadgpt.language.names import Slope, Way
from roadgpt.language.table import ROADS, SURFACES

KINDS_OF_ROADS: Mapping[str | None, str] = {
    None: "road",
    **{name: row["names"][0] for name, row in ROADS["surroundings"].items()},
}
WAVY = [kind for kind, row in KINDS.items() if row.turns and row.turns.lo > 1 and not row.whole]
"""The kinds whose name stands for several turns; their ``count`` is the number of these turns."""


def sentence(brief: Brief) -> str:
    """Returns a sentence that states the requirements of a Brief, such as 'An uphill road with 3 turns.'"""
    said, scene = _road_sentence(brief), scene_text(brief.scene)
    return f"{said.removesuffix('.')}; {scene}." if scene else said


def _road_sentence(brief: Brief) -> str:
    if brief.junctions:
        return _route_sentence(brief)
    if brief.map is not None:
        return _map_sentence(brief.map, brief)
    said = normal(brief)
    noun = "motorway" if said.motorway else KINDS_OF_ROADS[said.surroundings]
    road = _joined(_exact_metres(said.length), _slope(said), noun)
    if said.clauses:
        road += " with " + ", then ".join(clause_text(clause) for clause in said.clauses)
    elif said.turns and said.turns not in (at_least(1), exactly(0)):
        road += f" with {_counted(said.turns, 'turn')}"
    text = "; ".join([_article(road) + road, *_wishes(said)])
    return text[0].upper() + text[1:] + "."


def _route_sentence(brief: Brief) -> str:
    parts = [_stretch(brief.stretches[0])]
    for junction, stretch in zip(brief.junctions, brief.stretches[1:], strict=True):
        parts += [junction_text(junction), _stretch(stretch)]
    way = ", then ".join(part for part in parts if part)
    length = f"{brief.length} metres in all" if brief.length else ""
    others = "other roads" if any(stretch.speed for stretch in brief.stretches) else "roads"
    where = f"its {others} {KINDS_OF_ROADS[brief.surroundings]}s" if brief.surroundings else f"its {others}"
    speed = f"{where} designed for {brief.speed:g} km/h" if brief.speed else ""
    apart = {"junctions": (), "stretches": (), "length": None, "speed": None}
    text = "; ".join(filter(None, [way, *_wishes(brief.model_copy(update=apart)), speed, length]))
    return text[0].upper() + text[1:] + "."


def _map_sentence(asked: MapClause, brief: Brief) -> str:
    if asked.junctions:
        text = f"A map with {' and '.join(_map_kind(asked, each) for each in asked.junctions)}"
    else:
        text = f"A grid of {asked.columns} by {asked.rows} blocks"
    text += f" of {asked.length} metres" if asked.length else ""
    is_said = any(each.control for each in asked.junctions)
    sign = SIGNS[asked.control] if asked.control and not is_said else ""
    text += f" with {sign}" if sign and not asked.signed else ""
    text += "".join(f"; {_map_kind(asked, each)}" for each in asked.signed)
    text += f"; {sign} at the other junctions" if sign and asked.signed else ""
    text += f"; {_counted(asked.blocks, 'block')}" if asked.blocks else ""
    text += f"; {_counted(asked.dead_ends, 'dead end')}" if asked.dead_ends else ""
    text += f"; the route goes {', '.join(asked.route)}" if asked.route else ""
    text += f"; {brief.length} metres of roads in all" if brief.length else ""
    return "; ".join([text, *_wishes(brief.model_copy(update={"length": None}))]) + "."


def _map_kind(asked: MapClause, each: JunctionCount) -> str:
    """Returns a number of junctions of a map, with their signs if the kinds have signs of their own."""
    is_said = any(one.control for one in (*asked.junctions, *asked.signed))
    control = asked.control_of(each) if is_said else None
    text = _counted(each.count, NAMES[each.kind][0])
    return f"{text} with {SIGNS[control]}" if control else text


def _stretch(brief: Brief) -> str:
    if brief.is_open:
        return ""
    text = sentence(brief).removesuffix(".")
    return text[0].lower() + text[1:] if not text.startswith("S-") else text


def _wishes(brief: Brief) -> list[str]:
    is_one_way = brief.against == exactly(0)
    against = f"{_counted(brief.against, 'oncoming lane')}" if brief.against else ""
    apart = {
        "turns": _turns(brief),
        **{name: _in_all(getattr(brief, name), f"{name} turn") for name in ("left", "right")},
        "alike": _alike(brief),
        "incline": f"{_slope_at(brief.slope or 'up', brief.incline)} all the way" if brief.incline else "",
        **{name: _said(name, amount) for name in ("climb", "hills") if (amount := getattr(brief, name))},
        "lanes": f"{_counted(brief.lanes, 'lane')} along" if brief.lanes else "",
        "against": "one-way" if is_one_way else against,
        "centre": ROADS["centres"].get(brief.centre, ""),
    }
    if _exact_metres(brief.length):
        apart["length"] = ""
    surfaces = (surface.said for name, surface in SURFACES.items() if name in brief.beside)
    return [*_asked("road", brief, apart), *surfaces]


def _asked(what: str, thing: Brief | JunctionClause, apart: Mapping[str, str]) -> Iterator[str]:
    """Yields in words what is asked of a road or a junction; ``apart`` has what depends on more than one of
    its fields."""
    for name, said in ROADS["said"][what].items():
        value = getattr(thing, name)
        plain = said.format(clause_text(value) if isinstance(value, Clause) else value) if value else ""
        if text := apart.get(name, plain):
            yield text


def _turns(brief: Brief) -> str:
    if brief.turns == at_least(0):
        return "with or without turns"
    return _in_all(brief.turns, "turn") if brief.clauses or brief.turns == exactly(0) else ""


def _alike(brief: Brief) -> str:
    if not brief.alike:
        return ""
    turning = [at for at, clause in enumerate(brief.clauses) if clause.kind not in STRAIGHT]
    kinds = {brief.clauses[at].kind for at in turning}
    inner = brief.clauses[turning[0] : turning[-1]] if turning else ()
    is_spaced = all(clause.kind not in STRAIGHT for clause in inner)
    straights = sum(clause.kind == "straight" for clause in brief.clauses)
    said = "turns of one kind equal" if len(kinds) > 1 else "all turns equal"
    said += " and evenly spaced" if is_spaced else ""
    return said + (", and the straights equally long" if straights > 1 else "")


def _in_all(amount: Amount | None, noun: str) -> str:
    if amount == exactly(0):
        return f"no {noun}s"
    return f"{_counted(amount, noun)} in all" if amount else ""


def _said(name: str, amount: Amount) -> str:
    """Returns a requirement for the whole road; a negative climb is a drop."""
    said: str = ROADS["said"]["road"][name]
    if name == "hills" and _is_one(amount):
        said = said.replace("changes", "change")
    falls = amount.hi is not None and amount.hi <= 0 and amount.lo != 0
    if name == "climb" and (falls or (amount.hi is None and (amount.lo or 0) < 0)):
        said, amount = said.replace("climb", "drop"), amount.times(-1)
    return said.format(amount)


def _slope(thing: Brief | Clause) -> str:
    """Returns the slope as an adjective; empty for a slope with a number, which is written after the noun."""
    has_figure = thing.incline or (isinstance(thing, Clause) and thing.climb)
    return SLOPES[thing.slope].names[0] if thing.slope and not has_figure else ""


def _slope_at(slope: Slope, incline: Amount) -> str:
    by = "by" if incline.lo is None or incline.hi is None else "at"
    return f"{SLOPES[slope].names[0]} {by} {FEATURE['grade'].said.format(incline)}"


def clause_text(clause: Clause) -> str:
    """Returns the text of one clause, such as 'a sharp left turn of 90 degrees uphill at 5 percent'."""
    count = exactly(1) if clause.kind in WAVY else clause.count
    text = _joined(*_adjectives(clause), _plural(_noun(clause), count))
    return _joined((_article(text) if count == exactly(1) else f"{count} ") + text, *_tails(clause))


def _height(clause: Clause) -> str:
    """Returns how much a feature rises or falls, such as 'that falls by 4 metres'."""
    if clause.kind in BUMPS:
        text = f"{clause.climb} metres {'high' if clause.kind == 'crest' else 'deep'}"
        return f"that is {text}" if clause.length or clause.incline else text
    verb = "fall" if (clause.slope or "up").endswith("down") else "rise"
    height = FEATURE["climb"].said.format(clause.climb)
    is_one = clause.kind in WAVY or clause.count == exactly(1)
    return f"that {verb}s {height}" if is_one else f"that {verb} {height} each"


def clause_columns(clause: Clause) -> tuple[str, str]:
    """Returns the text of one clause as two columns of a table: ('2 turns', 'sharp, uphill, left')."""
    is_one = clause.kind in WAVY or clause.count == exactly(1)
    what = _noun(clause) if is_one else _counted(clause.count, _noun(clause))
    how = (*_adjectives(clause), *_tails(clause))
    return what, ", ".join(words.removeprefix("of ").removeprefix("that ") for words in how if words)


def road_words(brief: Brief) -> str:
    """Returns the requirements for the whole road as text, such as 'uphill, 3 turns'; empty if there are
    none."""
    turns = ""
    if not brief.clauses and brief.turns and brief.turns not in (at_least(1), exactly(0), at_least(0)):
        turns = _counted(brief.turns, "turn")
    length = _exact_metres(brief.length)
    said = [f"{length}s long" if length else "", _slope(brief), turns, *_wishes(brief)]
    return ", ".join(words for words in said if words)


def _noun(clause: Clause) -> str:
    return KINDS[clause.kind].names[0] + (" stretch" if clause.kind == "winding" else "")


def _adjectives(clause: Clause) -> tuple[str, ...]:
    alternating = "alternating" if clause.alternating else ""
    side = "" if clause.alternating and clause.kind not in STRAIGHT else clause.side or ""
    return (alternating, clause.sharpness or "", clause.size or "", _slope(clause), side)


def _tails(clause: Clause) -> list[str]:
    tails = []
    if clause.degrees:
        tails.append(FEATURE["degrees"].said.format(clause.degrees))
    if clause.length:
        each = " each" if clause.count != exactly(1) else ""
        tails.append(FEATURE["length"].said.format(clause.length) + each)
    if clause.kind in BUMPS and clause.incline:
        tails.append(f"with slopes of {FEATURE['grade'].said.format(clause.incline)}")
    elif clause.slope and clause.incline:
        tails.append(_slope_at(clause.slope, clause.incline))
    if clause.radius:
        tails.append(FEATURE["radius"].said.format(clause.radius))
    if clause.kind in WAVY and clause.count != exactly(1):
        tails.append(f"with {_counted(clause.count, 'turn')}")
    if clause.alternating and clause.side:
        tails.append(f"starting to the {clause.side}")
    if clause.bump:
        tails.append(_bump(clause))
    elif clause.climb:
        tails.append(_height(clause))
    return tails


def _bump(clause: Clause) -> str:
    """Returns what lies inside each turn, such as 'over a crest 2 metres high with slopes of 5 percent'."""
    assert clause.bump is not None
    high = f"{clause.climb} metres {'high' if clause.bump == 'crest' else 'deep'}" if clause.climb else ""
    slopes = f"with slopes of {FEATURE['grade'].said.format(clause.incline)}" if clause.incline else ""
    return _joined("" if clause.count == exactly(1) else "each", OVER[clause.bump], high, slopes)


def _exact_metres(amount: Amount | None) -> str:
    return f"{amount} metre" if amount and amount.exact else ""


def _counted(amount: Amount, noun: str) -> str:
    return f"{amount} {_plural(noun, amount)}"


def _is_one(amount: Amount) -> bool:
    return (amount.lo, amount.hi) in ((1, 1), (1, None), (None, 1))


def _plural(noun: str, amount: Amount) -> str:
    if _is_one(amount) or noun.endswith("s"):
        return noun
    return noun + ("es" if noun.endswith("ch") else "s")


def _joined(*words: str) -> str:
    return " ".join(word for word in words if word)


def _article(text: str) -> str:
    vowel = text[:1].lower() in "aei" or text.startswith(("up", "ur", "S-", "8", "11 ", "18 ", "11.", "18."))
    return "an " if vowel else "a "


ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")


def junction_text(junction: JunctionClause) -> str:
    """Returns a junction and what the route does there, such as 'at a crossroads with traffic lights turn
    left'."""
    apart = {
        "ways": f"with ways on {_listed(junction.ways, 'to')}" if junction.ways else "",
        "only_in": _one_way(junction.only_in, "come", "from"),
        "only_out": _one_way(junction.only_out, "lead", "to"),
        "control": ROADS["controls"][junction.control]["met"] if junction.control else "",
        "turn_lanes": " and ".join(f"with a {side}-turn lane" for side in junction.turn_lanes),
        "take": _way_on(junction),
    }
    head = ("at a", junction.size, "skew" if junction.skew else "", junction.name)
    return " ".join(filter(None, [*head, *_asked("junction", junction, apart)]))


def _way_on(junction: JunctionClause) -> str:
    if junction.kind in LANE_KINDS:
        return f"to the {junction.take}" if junction.take else ""
    if junction.exit is not None:
        way = "straight on" if junction.take == "straight" else (junction.take or "").replace("_", " ")
        return f"take {exit_text(junction.exit)}" + (f", which leads {way}" if way else "")
    otherwise = "go on somewhere" if junction.degrees is None else "turn"
    way = ROADS["takes"][junction.take] if junction.take is not None else otherwise
    return way if junction.degrees is None else f"{way} by {junction.degrees} degrees"


def exit_text(number: Amount) -> str:
    """Returns the number of an exit as text, such as 'the third exit'."""
    if number.exact and number.lo is not None and number.lo.is_integer() and 1 <= number.lo <= len(ORDINALS):
        return f"the {ORDINALS[int(number.lo) - 1]} exit"
    return f"exit {number}"


def _listed(ways: tuple[Way, ...], how: str) -> str:
    return " and ".join(ROADS["ways"][way][how] for way in ways)


def _one_way(ways: tuple[Way, ...], verb: str, how: str) -> str:
    roads = f"a one-way road that {verb}s" if len(ways) == 1 else f"one-way roads that {verb}"
    return f"with {roads} {_listed(ways, how)}" if ways else ""
