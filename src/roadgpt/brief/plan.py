"""Writes a Brief as one short line, called a plan, and reads it back. Plans are written by models, by people
who label data, and by users who want to state requirements without words that a reader has to interpret.

    turn x3 left up; straight long down; hairpin right | len=300 hard beside(traffic, night)
    straight 80 // crossroads left lights // | up // roundabout exit=3 arms=4 || len=300
    map columns=3 rows=2 lights; junction x2 stop
    straight 200 && truck ahead gap=30 v=50: brake 6; oncoming x3; medium; fog 60

The clauses are in driving order, separated by ``;``. The requirements for the whole road follow after ``|``.
Junctions and the roads between them alternate, separated by ``//``; a road without requirements is left out,
and requirements for the whole route follow after ``||``. A map is a grid, or junctions joined by roads.
Behind ``&&`` stands the scene: who else is on the road, and under which conditions.
A number is exact (``3``), a bound (``3..`` or ``..3``) or a range (``3..5``), in the units of the Brief. The
page docs/reference/plans.md describes the language."""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple, TypeVar, get_args

from pydantic import ValidationError

from roadgpt.brief.amount import amount_text, figure, read_amount
from roadgpt.brief.design_speed import FASTEST, SLOWEST, USUAL
from roadgpt.brief.junctions import LONGEST_ROUTE, MAP, JunctionClause, JunctionCount, MapClause
from roadgpt.brief.model import Amount, Brief, Clause, Frozen, exactly, span
from roadgpt.brief.normal import BUMPS
from roadgpt.brief.refusal import refused
from roadgpt.brief.scene import (
    LAND_KINDS,
    STRUCK,
    Action,
    Air,
    Land,
    Lie,
    Mark,
    Person,
    Roadworks,
    Role,
    Scene,
    Signal,
    SlipperyPlace,
    usual_weather,
)
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP
from roadgpt.errors import BriefError
from roadgpt.language.names import MapJunctionKind, Way
from roadgpt.language.table import (
    COUNTED,
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    NUMBERS,
    PARTS,
    PLACES,
    ROAD_USERS,
    ROADWORKS,
    SCENES,
    SURFACES,
    WEATHER,
    Part,
    named_in,
)

KINDS = frozenset(named_in("features"))
JUNCTIONS: frozenset[str] = frozenset(named_in("junctions"))
SIDES, WAYS = named_in("sides"), named_in("ways")
BETWEEN = "//"
WHOLE = "||"
SCENE = "&&"
BARE: dict[str, str] = dict.fromkeys(("straight", *BUMPS), "length")
"""The field that a number without a key sets, by kind of clause; for turns, the number is their angle."""
OF_WHOLE = {
    "length": "len",
    "left_hand": "left_hand",
    "map_size": "map_size",
    "lane_width": "width",
    "limit": "limit",
    "beside": "beside",
    "comes_from": "from",
    "surroundings": ", ".join(named_in("surroundings")),
    "speed": "speed",
}
"""The fields of a Brief that can be asked of a whole route, with their names in plans; a map has none of the
last three."""
OF_THE_START = ("comes_from", "left_hand")
"""Those that can stand with the first road of a route, too: it begins there."""
INNER = "(starts|ends|beside)"
ALIKE = "alike"
"""A flag of a road. In older plans, and for a whole route or map, the word stands in ``beside(...)``."""
HALFWAY = "halfway"
"""The word for half of the length of the whole route, as in ``| halfway // t_junction left || len=400``."""
SHARES_OF_HALF = (0.45, 0.55)
"""The least and the greatest share of the route's length that count as half of the route."""
WHOLE_LENGTH = re.compile(r"\|\|[^|]*\blen=(\d+(?:\.\d+)?)(?![\d.])")
Model = TypeVar("Model", bound=Frozen)


class Language(NamedTuple):
    """How plans write one kind of thing."""

    parts: Mapping[str, Part]
    """What it can have, in the order in which it is written."""
    words: Mapping[str, tuple[str, object]]
    """The field that a word sets, and its value."""
    keys: Mapping[str, tuple[str, Callable[[str], object]]]
    """The field of what stands behind a key such as "len=", and the function that reads it."""
    of: str = ""
    """The thing, for messages; empty for a road and its parts."""


def language(parts: Mapping[str, Part], of: str = "", **readers: Callable[[str], object]) -> Language:
    """Returns how plans write a thing with these parts; ``readers`` read what stands behind some keys."""
    words = dict[str, tuple[str, object]]()
    keys = dict[str, tuple[str, Callable[[str], object]]]()
    for field, part in parts.items():
        if part.list or part.unknown or not part.words:
            usual = _sides if part.list else partial(_one_of, part) if part.unknown else read_amount
            keys |= {part.key: (field, readers.get(field, usual))} if part.key not in ("", COUNTED) else {}
        else:
            before = f"{part.key}=" if part.key else ""
            words |= {f"{before}{word}": (field, value) for word, value in part.words.items()}
        if part.zero:
            words[part.zero] = field, exactly(0)
        if part.double:
            keys[part.double] = field, lambda text: read_amount(text).times(0.5)
    return Language(parts, words, keys, of)


def _sides(text: str) -> tuple[str, ...]:
    ways = tuple(text.split("+"))
    if not {*ways} <= {*WAYS}:
        known = " or ".join(WAYS)
        raise BriefError(f"a plan has no ways '{text[:40]}'; ways are {known}, joined by +")
    return ways


def _one_of(part: Part, text: str) -> str:
    if text not in part.words:
        raise BriefError(f"{part.unknown.format(text[:40])}; there are {', '.join(part.words)}")
    return text


def _one_number(what: str, least: float, most: float, unit: str, example: str, text: str) -> float | None:
    number = read_amount(text)
    if not number.exact or not least <= (number.lo or 0) <= most:
        raise BriefError(
            f"a {what} of {least:g} to {most:g} {unit}, not {text[:40]}; write for example {example}"
        )
    return number.lo


def _lane_number(text: str) -> int:
    if not re.fullmatch(r"-?\d", text):
        raise BriefError(f"lane={text[:40]} is no lane; lane=1 is the one at the kerb, lane=-1 the innermost")
    return int(text)


def read_ways(text: str) -> tuple[Way, ...]:
    """Returns the ways that a route takes at junctions, from a text such as "left, straight"; raises
    BriefError unless the text is 1 to 12 of left, right and straight."""
    words = [word for word in re.split(r"[+,\s]+", text) if word]
    ways: list[Way] = [way for word in words for way in WAYS if way == word]
    if not 1 <= len(ways) == len(words) <= LONGEST_ROUTE:
        raise BriefError(
            f"the route '{text[:40]}' through a map cannot be read; give 1 to {LONGEST_ROUTE} of "
            f"{', '.join(WAYS)}, one for each junction that it passes, as in left+straight+right"
        )
    return tuple(ways)


def _of_scene(model: type[Frozen], fields: Iterable[str], **words: tuple[str, ...]) -> dict[str, Part]:
    """Returns what a part of a scene can have: how many it is, words by their fields, and the numbers of some
    fields."""
    parts = {field: Part(words={word: word for word in those}) for field, those in words.items()}
    parts |= {each: Part(NUMBERS[each].key) for each in fields if each in NUMBERS}
    parts = {field: part for field, part in parts.items() if field in model.model_fields}
    return {"count": PARTS["clause"]["count"], **parts} if "count" in model.model_fields else parts


CLAUSE = language(PARTS["clause"])
ROAD = language(
    PARTS["road"],
    map_size=partial(_one_number, "map has one size", SMALLEST_MAP, LARGEST_MAP, "m", "map_size=500"),
    lane_width=partial(_one_number, "lane has one width", 2, 10, "m", "width=3"),
    limit=partial(_one_number, "road has one speed limit", 5, 300, "km/h", "limit=50"),
    speed=partial(_one_number, "road has one design speed", SLOWEST, FASTEST, "km/h", "speed=80"),
)
JUNCTION, JUNCTIONS_OF_MAP = language(PARTS["junction"], "junction"), language(PARTS["junctions"])
MAP_OF_ROADS = language(PARTS["map"], "map", route=read_ways)
TESTED_CAR = "ego"
OF_ACTORS = _of_scene(Role, NUMBERS, where=tuple(PLACES), side=(*SIDES, "opposite")) | {"hits": Part("hits")}
AN_ACTOR = language(OF_ACTORS, "road user", hits=lambda text: text.replace("-", " "))
AN_ACTION = language(_of_scene(Action, NUMBERS, side=SIDES), "manoeuvre")
OF_ITSELF = _of_scene(Scene, {*NUMBERS} - {"angle"}, turn=WAYS, person=get_args(Person)) | {
    "lane": Part("lane"), "parks": Part("parked", {side: side for side in SIDES}),
}  # fmt: skip
ITSELF = language(OF_ITSELF, "tested car", lane=_lane_number)
A_LAND = language(_of_scene(Land, Land.model_fields, lie=get_args(Lie), side=SIDES), "landscape")
SIGNAL = "lights"
A_SIGNAL = language(_of_scene(Signal, NUMBERS, shows=tuple(SCENES["signals"]["rows"])), "state of lights")
SLIPPERY = "slippery"
A_PATCH = language(_of_scene(SlipperyPlace, SlipperyPlace.model_fields), "slippery place")
WORKS = "roadworks"
A_SITE = language(_of_scene(Roadworks, Roadworks.model_fields, kind=tuple(ROADWORKS), side=SIDES), "site")
A_ROW = language({"angle": Part("angle")}, "row of parked cars")
CLOCK = "clock"
CONDITIONS: Mapping[str, tuple[str, str]] = {
    str(word): (field, str(word))
    for field, words in (("flow", FLOWS), ("light", LIGHTS), ("surface", SURFACES), ("land", LAND_KINDS))
    for word in words
}
MARK = re.compile(
    r"\b(?:(?:after|before|in) (?:turn|junction|crosswalk) (?:-1|[1-9]\d?)|(?:after|with) "
    rf"(?:{TESTED_CAR}|(?:{'|'.join(ROAD_USERS)}) [1-9]\d?) (?:{'|'.join(MANEUVERS)}))(?!\S)"
)
"""A part of the route, or what another actor does, as in "after turn 1" and "with truck 1 brake"."""


def _pattern_of_parts() -> str:
    number = r"-?[0-9]+(\.[0-9]+)?"
    amount = rf"(\.\.)?{number}(\.\.({number})?)?"
    kinds, does = "|".join(ROAD_USERS), "|".join(MANEUVERS)
    event = rf"(after|with) ({TESTED_CAR}|({kinds}) [1-9][0-9]?) ({does})"
    place = "(after|before|in) (turn|junction|crosswalk) (-1|[1-9][0-9]?)"
    hits = rf"hits=({'|'.join(STRUCK)}|({kinds}) [1-9][0-9]?)"

    def words(language: Language, *more: str) -> str:
        keys = (f"{key}={amount}" for key in language.keys if key != "hits")
        return f"( ({'|'.join([*language.words, *keys, *more])}))*"

    action = rf"({does})( ({kinds}) [1-9][0-9]?)?{words(AN_ACTION, amount, place, event)}"
    actor = rf"({kinds}|{'|'.join(PLACES)}){words(AN_ACTOR, f'x{amount}', place, hits)}"
    itself = f"{TESTED_CAR}{words(ITSELF, 'parked left', 'parked right')}"
    flows = rf"oncoming ({'|'.join(FLOWS)}|none)|parked ({'|'.join(SIDES)}){words(A_ROW)}"
    patches = f"{SIGNAL}{words(A_SIGNAL)}|{SLIPPERY}{words(A_PATCH)}|{WORKS}{words(A_SITE)}"
    air = f"({'|'.join(WEATHER)})( {amount})?|{CLOCK} [0-9]{{1,2}}:[0-9]{{2}}|{'|'.join(CONDITIONS)}"
    land = f"({'|'.join(LANDFORMS)}){words(A_LAND, f'x{amount}')}"
    return f"^(({actor}|{itself})(: {action}(, {action})*)?|{flows}|{patches}|{air}|{land})$"


SCENE_PART = _pattern_of_parts()
"""The regular expression of a part of a scene, for servers that hold language models to one: who, where, what
and with which numbers, in the words of the table."""


def plan(brief: Brief) -> str:
    """Returns the plan of a Brief, without ``words``, ``unused``, ``confidence`` and ``other``."""
    is_usual = brief.surroundings is not None and brief.speed == USUAL[brief.surroundings]
    mark, wishes = WHOLE, written(brief.model_copy(update={"speed": None}) if is_usual else brief, ROAD)
    if brief.junctions:
        parts = [plan(brief.stretches[0])]
        for junction, stretch in zip(brief.junctions, brief.stretches[1:], strict=True):
            parts += [junction_plan(junction), plan(stretch)]
        line = f" {BETWEEN} ".join(filter(None, parts))
    elif brief.map is not None:
        line = map_plan(brief.map)
    else:
        mark, line = "|", "; ".join(map(_clause, brief.clauses))
    line = f"{line} {mark} {' '.join(wishes)}".strip() if wishes else line
    return f"{line} {SCENE} {scene_plan(brief.scene)}".strip() if brief.scene != Scene() else line


def written(thing: Any, language: Language) -> list[str]:
    """Returns what a thing has, as it is written in plans."""
    said = list[str]()
    for field, part in language.parts.items():
        value, usual = getattr(thing, field), part.usual
        if (value or isinstance(value, float)) and (not usual or value not in (usual, exactly(usual))):
            said.append(_text(field, part, value))
    return said


def _text(field: str, part: Part, value: Any) -> str:
    if part.brackets:
        return f"{field}({_clause(value) if isinstance(value, Clause) else ', '.join(value)})"
    if part.zero and value == exactly(0):
        return part.zero
    if isinstance(value, Amount):
        said = amount_text(value)
    elif part.list:
        said = "+".join(value)
    elif part.words:
        said = next((word for word, its in part.words.items() if its == value), "")
    else:
        said = value if isinstance(value, str) else figure(value, 6)
    return said if not part.key else f"{part.key}{said}" if part.key == COUNTED else f"{part.key}={said}"


def _clause(clause: Clause) -> str:
    return " ".join([clause.kind, *written(clause, CLAUSE)])


def junction_plan(junction: JunctionClause) -> str:
    """Returns a junction as part of a plan, such as "crossroads left lights"."""
    return " ".join([junction.kind, *written(junction, JUNCTION)])


def map_plan(asked: MapClause) -> str:
    """Returns a map as a plan, such as "map columns=3 rows=2"."""
    kinds = [_counted(each) for each in sorted(asked.junctions, key=lambda each: each.control is None)]
    line = " ".join(filter(None, [MAP, "; ".join(kinds), *written(asked, MAP_OF_ROADS)]))
    return "; ".join([line, *map(_counted, asked.signed)])


def _counted(each: JunctionCount) -> str:
    return " ".join([each.kind, *written(each, JUNCTIONS_OF_MAP)])


def read_plan(line: str) -> Brief:
    """Returns the Brief that a plan describes.

    Raises BriefError if a word, key or number is not part of the plan language, a field is given twice, roads
    and junctions do not alternate, or the plan is a refusal."""
    if line.lstrip().startswith("!"):
        raise refused(line)
    if SCENE in line:
        line, _, scene = line.partition(SCENE)
        return read_plan(line).model_copy(update={"scene": read_scene(scene)})
    half, word = half_of_route(line), rf"\b{HALFWAY}\b"
    if re.search(word, line) and not half:
        raise BriefError("'halfway' in a plan needs the length of the whole route, as in || len=400")
    if BETWEEN in line or is_junction(line):
        return _read_network(re.sub(word, half, line))
    road, _, whole = line.partition(WHOLE)
    if is_map(line):
        return _made(Brief, {"map": _read_map(road), **_read_whole(whole)}, line)
    clauses, _, own = road.partition("|")  # for a single road, | and || mean the same
    wishes = f"{own} {whole}"
    fields: dict[str, object] = {
        "clauses": tuple(_read_clause(part) for part in clauses.split(";") if part.strip())
    }
    for place, inner in re.findall(rf"{INNER}\(([^()]*)\)", wishes):
        names = tuple(name.strip() for name in inner.split(","))
        if place == "beside" and ALIKE in names:
            _set(fields, ALIKE, True)
            names = tuple(name for name in names if name != ALIKE)
        if names:
            _set(fields, place, names if place == "beside" else _read_clause(inner))
    _read_words(fields, re.sub(rf"{INNER}\([^()]*\)", " ", wishes).split(), ROAD)
    return _made(Brief, fields, line)


def objections(line: str) -> tuple[str, ...]:
    """Returns all that is wrong with a plan, in sentences: with its parts, or else with the whole."""
    route, _, scene = ("" if line.lstrip().startswith("!") else line).partition(SCENE)
    roads, _, whole = re.sub(rf"\b{HALFWAY}\b", half_of_route(route), route).partition(WHOLE)
    said: list[str] = []

    def ask(read: Callable[[str], object], *texts: str) -> bool:
        before = len(said)
        for text in filter(str.strip, texts):
            try:
                read(text)
            except BriefError as error:
                said.append(str(error))
        return len(said) > before

    is_network = BETWEEN in roads or is_junction(roads)
    for part in map(str.strip, [] if is_map(roads) else roads.split(BETWEEN)):
        clauses, _, wishes = part.partition("|")
        if is_junction(part):
            ask(_read_junction, part)
        else:
            ask(_read_clause, *clauses.split(";"))
            ask(lambda own: read_plan(f"| {own}"), wishes)
    ask(_read_whole if is_network else lambda own: read_plan(f"| {own}"), whole)
    for part in scene.split(";"):
        head, _, actions = part.partition(":")
        if ask(scene_fields, part):
            of_part = said.pop()
            said += [] if ask(scene_fields, head) | ask(read_action, *actions.split(",")) else [of_part]
    if not said:
        ask(read_plan, line)
    return tuple(dict.fromkeys(said))


def half_of_route(line: str) -> str:
    """Returns the lengths that are half of the route of a plan, such as "len=180..220"; "" if the plan does
    not give the length of the whole route as one number."""
    found = WHOLE_LENGTH.search(line)
    return "len=" + "..".join(figure(share * float(found[1])) for share in SHARES_OF_HALF) if found else ""


def is_junction(text: str) -> bool:
    """Returns whether part of a plan begins with a kind of junction."""
    return (text.split() or [""])[0] in JUNCTIONS


def is_map(line: str) -> bool:
    """Returns whether a plan asks for a map."""
    return (line.split() or [""])[0] == MAP


def _read_network(line: str) -> Brief:
    route, _, whole = line.partition(WHOLE)
    junctions: list[JunctionClause] = []
    roads = [""]
    for part in filter(None, map(str.strip, route.split(BETWEEN))):
        if is_junction(part):
            junctions.append(_read_junction(part))
            roads.append("")
        elif roads[-1]:
            raise BriefError(
                f"a junction is missing between '{roads[-1][:40]}' and '{part[:40]}': roads and junctions "
                f"alternate, as in straight 80 {BETWEEN} crossroads left {BETWEEN} turn right"
            )
        else:
            roads[-1] = part
    if not junctions:
        raise BriefError(f"a plan with {BETWEEN} needs a junction, such as crossroads left")
    first, *others = map(read_plan, roads)
    fields, at_start = _read_whole(whole), {name: getattr(first, name) for name in OF_THE_START}
    for name, value in at_start.items():
        if value and fields[name] not in (None, False, value):
            raise BriefError(
                f"a plan gives {OF_WHOLE[name]}= twice: '{value}' and '{fields[name]}'; give it once"
            )
        fields[name] = fields[name] or value
    unsaid = {name: Brief.model_fields[name].default for name in OF_THE_START}
    stretches = first.model_copy(update=unsaid), *others
    return _made(Brief, {"junctions": tuple(junctions), "stretches": stretches, **fields}, line)


def _read_junction(text: str) -> JunctionClause:
    kind, *words = text.split()
    return _made(JunctionClause, _read_words({"kind": kind}, words, JUNCTION), text)


def _read_whole(text: str) -> dict[str, object]:
    asked = read_plan(f"| {text}") if text.strip() else Brief()
    if asked.alike:  # which of several roads are alike is not said
        asked = asked.model_copy(update={"alike": False, "beside": (*asked.beside, ALIKE)})
    fields = {name: getattr(asked, name) for name in OF_WHOLE}
    if asked != Brief.model_validate(fields):
        *names, last = OF_WHOLE.values()
        known = f"{', '.join(names)} and {last}"
        raise BriefError(
            f"after {WHOLE}, only {known} can be asked; what holds for one road stands with it, after |"
        )
    return fields


def _read_map(line: str) -> MapClause:
    """Returns the map that a plan describes. A sign behind the last kind of junction is that of the whole
    map, except in a grid."""
    fields: dict[str, object] = {}
    counts: list[dict[str, object]] = []
    words = line.replace(";", " ").split()
    is_grid = any(word.startswith("columns=") for word in words)
    places = [place for place, word in enumerate(words) if word in get_args(MapJunctionKind)]
    last = len(words) if is_grid else max(places, default=0)
    for place, word in enumerate(words[1:], 1):
        if place in places:
            counts.append({"kind": word})
        elif counts and re.match(r"x[\d.]", word):
            _set(counts[-1], "count", read_amount(word[1:]))
        else:
            is_of_kind = bool(counts) and place < last and word in named_in("controls")
            _read_words(counts[-1] if is_of_kind else fields, [word], MAP_OF_ROADS)
    kinds = tuple(_made(JunctionCount, each, line) for each in counts)
    return _made(MapClause, {**fields, "signed" if is_grid else "junctions": kinds}, line)


def with_route(asked: MapClause | None, text: str) -> MapClause:
    """Returns the map ``asked`` with the route that a text such as "left,straight" describes. Raises
    BriefError if the description asks for no map (None), or the text cannot be read."""
    if asked is None:
        raise BriefError(
            "a route can be named through a map only, such as 'a grid of 3 by 2 blocks'; this description "
            "has a route or a road of its own, so leave --route out"
        )
    return asked.model_copy(update={"route": read_ways(text)})


def _read_clause(text: str) -> Clause:
    kind, *words = text.split() or [""]
    if kind not in KINDS:
        raise BriefError(
            f"a plan has no clause '{kind[:40]}'; on a road, a clause begins with one of "
            f"{', '.join(sorted(KINDS))}, and a junction with one of {', '.join(sorted(JUNCTIONS))}"
        )
    keyed = (re.sub(r"^r(?=[0-9.])", "r=", word) for word in words)
    fields = _read_words({"kind": kind}, keyed, CLAUSE, BARE.get(kind, "degrees"))
    return _made(Clause, _with_side_of_climb(fields), text)


def _with_side_of_climb(fields: dict[str, object]) -> dict[str, object]:
    """Returns the fields of a clause with a positive climb: the slope says whether it is up or down."""
    climb = fields.get("climb")
    if not isinstance(climb, Amount):
        return fields
    bump = fields["kind"] if fields["kind"] in BUMPS else fields.get("bump")
    falls = span(climb).hi <= 0 and climb != exactly(0)
    is_torn = span(climb).lo < 0 < span(climb).hi and climb.lo is not None
    if is_torn or (falls and (bump or str(fields.get("slope", "down")).endswith("up"))):
        raise BriefError(
            f"'climb={amount_text(climb)}' contradicts '{fields.get('slope', bump or fields['kind'])}'; leave"
            f" out the minus{'' if bump else ', and say up or down'}"
        )
    climb = climb.times(-1) if falls else climb
    way = {} if bump else {"slope": fields.get("slope", "down" if falls else "up")}
    return {**fields, **way, "climb": climb}


def _read_words(
    fields: dict[str, object], words: Iterable[str], language: Language, bare: str = ""
) -> dict[str, object]:
    """Sets the fields that words name, and returns them; ``bare`` is the field of a number without a key."""
    for word in words:
        key, equals, value = word.partition("=")
        if bare and word[0] in "0123456789.":
            _set(fields, bare, read_amount(word))
        elif word in language.words:
            _set(fields, *language.words[word])
        elif equals and key in language.keys:
            name, read = language.keys[key]
            _set(fields, name, read(value))
        elif "count" in language.parts and word.startswith(COUNTED) and word[1:2] in "0123456789.":
            _set(fields, "count", read_amount(word[1:]))
        elif language.of:
            known = ", ".join(sorted((*language.words, *(f"{key}=" for key in language.keys))))
            known += "; a place is for example before junction 1" * (word in ("before", "after", "in"))
            raise BriefError(f"a plan has no word '{word[:40]}' for a {language.of}; there are {known}")
        else:
            raise BriefError(
                f"a plan has no word '{word[:40]}' here; what is asked of the whole road stands behind |, "
                "and the page 'Plans' of the reference describes the language"
            )
    return fields


def _set(fields: dict[str, Any], name: str, value: object) -> None:
    if name in fields:
        said = f": '{value}'" if isinstance(value, Amount | str) else ""
        raise BriefError(f"a plan gives {name} twice{said}; give it once")
    fields[name] = value


def _made(model: type[Model], fields: dict[str, object], text: str) -> Model:
    try:
        return model.model_validate(fields)
    except ValidationError as error:
        first = error.errors()[0]
        problem = first["msg"].removeprefix("Value error, ")
        if first["type"] == "missing":
            field = str(first["loc"][-1])
            key = f"{NUMBERS[field].key}=" if field in NUMBERS else " or ".join(SCENES["signals"]["rows"])
            problem = f"it lacks {key}"
        raise BriefError(f"the plan '{text.strip()[:60]}' cannot be read: {problem}") from error


def scene_plan(scene: Scene) -> str:
    """Returns a scene as it stands in a plan, such as "truck ahead gap=30: brake; medium"; "" for none."""
    itself, own = written(scene, ITSELF), ", ".join(map(action_plan, scene.actions))
    line = [" ".join([TESTED_CAR, *itself]) + f": {own}" * bool(own)] if itself or own else []
    for role in scene.actors:
        actor = _marked(role.kind, role, AN_ACTOR)
        actions = ", ".join(map(action_plan, role.actions))
        line.append(f"{actor}: {actions}" if actions else actor)
    line += [" ".join([SIGNAL, *written(scene.signal, A_SIGNAL)])] if scene.signal else []
    line += [scene.flow or "", f"oncoming {scene.oncoming}" if scene.oncoming else ""]
    slant = "".join(f" {each}" for each in written(scene, A_ROW))
    line += [f"parked {side}" + slant * (side == scene.parked[-1]) for side in scene.parked]
    line += [f"{air.kind} {amount_text(air.amount)}" for air in scene.weather]
    patches = [" ".join([SLIPPERY, *written(patch, A_PATCH)]) for patch in scene.slippery]
    patches += [" ".join([WORKS, *written(each, A_SITE)]) for each in scene.roadworks]
    lands = [" ".join([each.kind, *written(each, A_LAND)]) for each in scene.landscape]
    clock = f"{CLOCK} {scene.clock}" if scene.clock else ""
    return "; ".join(filter(None, [*line, clock, scene.light, scene.surface, *patches, scene.land, *lands]))


def action_plan(action: Action) -> str:
    """Returns an action as it stands in a plan, such as "brake decel=6 after turn 1"."""
    return _marked(f"{action.what} {action.whom}" if action.whom else action.what, action, AN_ACTION)


def _marked(head: str, thing: Role | Action, language: Language) -> str:
    return " ".join([head, *written(thing, language), *([str(thing.at)] if thing.at else [])])


def read_scene(text: str) -> Scene:
    """Returns the scene that stands in a plan behind &&. Raises BriefError if a word, key or number is not
    part of the language, or the scene contradicts itself."""
    return _made(Scene, scene_fields(text), text)


def scene_fields(text: str) -> dict[str, object]:
    """Returns the fields of the scene that stands in a plan, which are not yet checked against each other."""
    fields: dict[str, object] = {}
    several: dict[str, list[Any]] = {
        name: [] for name in ("actors", "actions", "slippery", "roadworks", "landscape", "parked")
    }
    airs = dict[str, Air]()
    for part in filter(None, map(str.strip, text.split(";"))):
        first, *words = part.replace(":", " : ").split()
        if first == "parked":
            if not words or words[0] not in {*SIDES} - {*several["parked"]}:
                raise BriefError(
                    f"'{part[:40]}' is no row of parked cars; write parked left or parked right, each once, "
                    "or for a single car with numbers of its own: car parked right gap=40"
                )
            several["parked"].append(words[0])
            _read_words(fields, words[1:], A_ROW)
        elif first == "oncoming" and len(words) == 1 and words[0] in (*FLOWS, "none"):
            _set(fields, first, words[0])
        elif first in (*ROAD_USERS, *PLACES):
            several["actors"].append(_read_role(part))
        elif first == TESTED_CAR:
            head, _, rest = part.partition(":")
            _read_words(fields, head.replace("parked ", "parked=").split()[1:], ITSELF)
            several["actions"] += [read_action(each) for each in rest.split(",") if each.strip()]
        elif first == SIGNAL:
            _set(fields, "signal", _made(Signal, _read_words({}, words, A_SIGNAL), part))
        elif first == SLIPPERY:
            several["slippery"].append(_made(SlipperyPlace, _read_words({}, words, A_PATCH), part))
        elif first == WORKS:
            several[WORKS].append(_made(Roadworks, _read_words({}, words, A_SITE), part))
        elif first in LANDFORMS:
            several["landscape"].append(_made(Land, _read_words({"kind": first}, words, A_LAND), part))
        elif first in WEATHER and len(words) < 2:
            usual = next(usual_weather(kind) for kind in WEATHER if kind == first)
            amount = {"amount": read_amount(words[0])} if words else dict[str, object]()
            _set(airs, first, _made(Air, {**dict(usual), **amount}, part))
        elif first == CLOCK:
            time = part.partition(" ")[2].strip().zfill(len("00:00"))
            if not re.fullmatch(r"([01]\d|2[0-3]):[0-5]\d", time):
                raise BriefError(f"'{part[:40]}' is no time; write for example {CLOCK} 14:15")
            _set(fields, CLOCK, time)
        elif first in CONDITIONS and not words:
            _set(fields, *CONDITIONS[first])
        else:
            known = (*ROAD_USERS, TESTED_CAR, SIGNAL, "oncoming", "parked", SLIPPERY, WORKS, *WEATHER, CLOCK)
            known += (*CONDITIONS, *LANDFORMS)
            raise BriefError(
                f"a scene has no '{part[:40]}'; its parts, divided by ; (actions of one by commas), "
                f"begin with one of {', '.join(known)}"
            )
    several["parked"].sort()
    several["weather"] = [airs[kind] for kind in WEATHER if kind in airs]
    return fields | {name: tuple(each) for name, each in several.items() if each}


def _read_role(text: str) -> Role:
    head, _, rest = text.partition(":")
    fields: dict[str, object] = {}
    told = re.findall(r"\bhits=\w+(?: \d+)?", text)  # also behind the colon
    head, rest = (re.sub(r"\bhits=\w+(?: \d+)?", "", each) for each in (head, rest))
    head = " ".join([head, *(each.replace(" ", "-") for each in told)])  # one word, as its others
    kind, *words = _without_mark(head, fields)
    if kind not in ROAD_USERS:
        kind, words = "car", [kind, *words]
    _read_words(fields, words, AN_ACTOR)
    if "where" not in fields:
        raise BriefError(
            f"'{text[:40]}' does not say where the {kind} is at first; there are {', '.join(PLACES)}"
        )
    actions = tuple(read_action(part) for part in rest.split(",") if part.strip())
    return _made(Role, {"kind": kind, **fields, "actions": actions}, text)


def read_action(text: str) -> Action:
    """Returns the action that a plan describes, such as "brake 6 after turn 1"."""
    fields: dict[str, object] = {}
    what, *words = _without_mark(text, fields) or [""]
    doing = next((doing for name, doing in MANEUVERS.items() if name == what), None)
    if doing is None:
        raise BriefError(f"a plan has no manoeuvre '{what[:40]}'; there are {', '.join(MANEUVERS)}")
    if words[:1] and words[0] in ROAD_USERS and words[1:2] and words[1].isdigit():
        fields["whom"], words = " ".join(words[:2]), words[2:]
    _read_words(fields, words, AN_ACTION, next(iter(doing.numbers), ""))
    return _made(Action, {"what": what, **fields}, text)


def _without_mark(text: str, fields: dict[str, object]) -> list[str]:
    """Returns the words of a text without its places and events, which are put into the fields."""
    for found in MARK.findall(text):
        words = found.replace(f" {TESTED_CAR} ", f" {TESTED_CAR} 1 ").split()
        mark = dict(zip(("word", "of", "number", "what"), words, strict=False))
        _set(fields, "at", Mark.model_validate(mark))
    return MARK.sub(" ", text).split()
