"""Writes a Brief as one short line, called a plan, and reads it back. Plans are written by models, by people
who label data, and by users who want to state requirements without words that a reader has to interpret.

    turn x3 left up; straight long down; hairpin right | len=300 hard beside(traffic, night)

The clauses are in driving order, separated by ``;``. The requirements for the whole road follow after ``|``.
A number is exact (``3``), a bound (``3..`` or ``..3``) or a range (``3..5``), in the units of the Brief. The
page docs/reference/plans.md describes the language.
"""

import re
from typing import TypeVar, get_args

from pydantic import ValidationError

from roadgpt.brief.amount import amount_text, figure, read_amount
from roadgpt.brief.junctions import MAP, JunctionKind, Side
from roadgpt.brief.model import Amount, Brief, CentreLine, Clause, exactly, span
from roadgpt.brief.normal import BUMPS
from roadgpt.brief.refusal import refused
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP, Kind, Sharpness, Size, Slope
from roadgpt.errors import BriefError

KINDS = frozenset(get_args(Kind))
JUNCTIONS: frozenset[str] = frozenset(get_args(JunctionKind))
BETWEEN = "//"
WHOLE = "||"
WORDS = {
    **dict.fromkeys(get_args(Side), "side"),
    **dict.fromkeys(get_args(Sharpness), "sharpness"),
    **dict.fromkeys(get_args(Size), "size"),
    **dict.fromkeys(get_args(Slope), "slope"),
}
BARE: dict[str, str] = dict.fromkeys(("straight", *BUMPS), "length")
"""The field that a number without a key sets, by kind of clause; for turns, the number is their angle."""
FLAGS = ("alternating", "alike", "hard", "motorway", "divided", "left_hand")
ONE_WAY = "oneway"
NO_LANE = exactly(0)
CENTRE = "centre="
MAP_SIZE = "map_size="
KEYS = {"deg": "degrees", "r": "radius", "len": "length", "pct": "incline"}
CLAUSE_KEYS = {**KEYS, "climb": "climb"}
ROAD_KEYS = {
    "turns": "turns",
    "lefts": "left",
    "rights": "right",
    "turning": "turning",
    "steepest": "steepest",
    "climb": "climb",
    "hills": "hills",
    "lanes": "lanes",
    "against": "against",
    **KEYS,
}
OF_WHOLE = ("length", "left_hand", "map_size", "beside")
"""The fields of a Brief that can be asked of a whole route or map."""
PLACES = ("starts", "ends")
INNER = "(starts|ends|beside)"
ALIKE = "alike"
"""A flag of a road. In older plans, and for a whole route or map, the word stands in ``beside(...)``."""
ONE = Amount(lo=1, hi=1)
HALFWAY = "halfway"
"""The word for half of the length of the whole route, as in ``| halfway // t_junction left || len=400``."""
HALF = re.compile(rf"\b{HALFWAY}\b")
SHARES_OF_HALF = (0.45, 0.55)
"""The least and the greatest share of the route's length that count as half of the route."""
WHOLE_LENGTH = re.compile(r"\|\|[^|]*\blen=(\d+(?:\.\d+)?)(?![\d.])")
Model = TypeVar("Model", Brief, Clause)


def plan(brief: Brief) -> str:
    """Returns the plan of a Brief, without ``words``, ``unused``, ``confidence`` and ``other``."""
    mark, wishes = WHOLE, _wishes(brief)
    if brief.junctions:
        from roadgpt.brief.junction_plan import junction_plan  # only for networks

        parts = [plan(brief.stretches[0])]
        for junction, stretch in zip(brief.junctions, brief.stretches[1:], strict=True):
            parts += [junction_plan(junction), plan(stretch)]
        line = f" {BETWEEN} ".join(filter(None, parts))
    elif brief.map is not None:
        from roadgpt.brief.map_plan import map_plan  # only for maps

        line = map_plan(brief.map)
    else:
        mark, line = "|", "; ".join(map(_clause, brief.clauses))
    return f"{line} {mark} {' '.join(wishes)}".strip() if wishes else line


def _wishes(brief: Brief) -> list[str]:
    """Returns the requirements for the whole road as parts of a plan."""
    wishes = _mods(brief, ROAD_KEYS)
    if brief.against == NO_LANE:
        wishes[wishes.index("against=0")] = ONE_WAY
    for place in PLACES:
        clause = getattr(brief, place)
        if clause:
            wishes.append(f"{place}({_clause(clause)})")
    if brief.beside:
        wishes.append(f"beside({', '.join(brief.beside)})")
    if brief.centre is not None:
        wishes.append(f"{CENTRE}{brief.centre}")
    if brief.map_size is not None:
        wishes.append(f"{MAP_SIZE}{brief.map_size:g}")
    return wishes


def _clause(clause: Clause) -> str:
    count = [] if clause.count == ONE else [f"x{amount_text(clause.count)}"]
    return " ".join([clause.kind, *count, *_mods(clause, CLAUSE_KEYS)])


def _mods(thing: Clause | Brief, keys: dict[str, str]) -> list[str]:
    """Returns the words, flags and numbers of a clause or of the whole road, in one fixed order."""
    fields = ("side", "sharpness", "size", "slope")
    out = [value for name in fields if (value := getattr(thing, name, None))]
    out += [flag for flag in FLAGS if getattr(thing, flag, False)]
    return out + [
        f"{key}={amount_text(a)}" for key, name in keys.items() if (a := getattr(thing, name)) is not None
    ]


def read_plan(line: str) -> Brief:
    """Returns the Brief that a plan describes.

    Raises BriefError if a word, key or number is not part of the plan language, a field is given twice, roads
    and junctions do not alternate, or the plan is a refusal.
    """
    if line.lstrip().startswith("!"):
        raise refused(line)
    if BETWEEN in line or is_junction(line):
        return _read_network(_without_halfway(line))
    road, _, whole = line.partition(WHOLE)
    if is_map(line):
        from roadgpt.brief.map_plan import read_map  # only for maps

        return _made(Brief, {"map": read_map(road), **_read_whole(whole)}, line)
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
    for word in re.sub(rf"{INNER}\([^()]*\)", " ", wishes).split():
        _read_mod(fields, word, ROAD_KEYS)
    return _made(Brief, fields, line)


def _half_of_route(line: str) -> str:
    """Returns the lengths that are half of the route of a plan, such as "len=180..220"; "" if the plan does
    not give the length of the whole route as one number.
    """
    found = WHOLE_LENGTH.search(line)
    return "len=" + "..".join(figure(share * float(found[1])) for share in SHARES_OF_HALF) if found else ""


def _without_halfway(line: str) -> str:
    """Returns a plan with a range of lengths in place of each word "halfway"."""
    half = _half_of_route(line)
    if HALF.search(line) and not half:
        raise BriefError("'halfway' in a plan needs the length of the whole route, as in || len=400")
    return HALF.sub(half, line)


def with_halfway(line: str) -> str:
    """Returns a plan with the word "halfway" in place of each length that means half of the whole route."""
    half = _half_of_route(line)
    return re.sub(rf"{re.escape(half)}(?![\d.])", HALFWAY, line) if half else line


def is_junction(text: str) -> bool:
    """Returns whether part of a plan begins with a kind of junction."""
    return (text.split() or [""])[0] in JUNCTIONS


def is_map(line: str) -> bool:
    """Returns whether a plan asks for a map."""
    return (line.split() or [""])[0] == MAP


def _read_network(line: str) -> Brief:
    """Returns the Brief of a plan with junctions."""
    from roadgpt.brief.junction_plan import read_junction  # only for networks

    route, _, whole = line.partition(WHOLE)
    junctions: list[str] = []
    roads = [""]
    for part in filter(None, map(str.strip, route.split(BETWEEN))):
        if is_junction(part):
            junctions.append(part)
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
    fields: dict[str, object] = {
        "junctions": tuple(map(read_junction, junctions)),
        "stretches": tuple(map(read_plan, roads)),
        **_read_whole(whole),
    }
    return _made(Brief, fields, line)


def _read_whole(text: str) -> dict[str, object]:
    """Returns the fields of a Brief that are asked of a whole route or map."""
    asked = read_plan(f"| {text}") if text.strip() else Brief()
    if asked.alike:  # which of several roads are alike is not said
        asked = asked.model_copy(update={"alike": False, "beside": (*asked.beside, ALIKE)})
    fields = {name: getattr(asked, name) for name in OF_WHOLE}
    if asked != Brief.model_validate(fields):
        *names, last = ("len" if name == "length" else name for name in OF_WHOLE)
        known = f"{', '.join(names)} and {last}"
        raise BriefError(
            f"after {WHOLE}, only {known} can be asked; what holds for one road stands with it, after |"
        )
    return fields


def _read_clause(text: str) -> Clause:
    kind, *words = text.split() or [""]
    if kind not in KINDS:
        raise BriefError(
            f"a plan has no clause '{kind[:40]}'; on a road, a clause begins with one of "
            f"{', '.join(sorted(KINDS))}, and a junction with one of {', '.join(sorted(JUNCTIONS))}"
        )
    fields: dict[str, object] = {"kind": kind}
    for word in words:
        if word.startswith("x") and word[1:2] in "0123456789.":
            _set(fields, "count", read_amount(word[1:]))
        elif word[0] in "0123456789.":
            _set(fields, BARE.get(kind, "degrees"), read_amount(word))
        elif word[0] == "r" and word[1:2] in "0123456789." and word[1:]:
            _set(fields, "radius", read_amount(word[1:]))
        else:
            _read_mod(fields, word, CLAUSE_KEYS)
    return _made(Clause, _with_side_of_climb(fields), text)


def _with_side_of_climb(fields: dict[str, object]) -> dict[str, object]:
    """Returns the fields of a clause with a positive climb: the slope says whether it is up or down."""
    climb = fields.get("climb")
    if not isinstance(climb, Amount):
        return fields
    falls = span(climb).hi <= 0 and climb != exactly(0)
    if falls and fields["kind"] in BUMPS:
        raise BriefError(f"a {fields['kind']} has a height above 0; leave out the minus of {climb}")
    if falls and str(fields.get("slope", "down")).endswith("up"):
        raise BriefError(f"a plan gives '{fields['slope']}' and a climb of {climb} m; leave out the minus")
    if falls:
        climb = climb.times(-1)
    elif span(climb).lo < 0 < span(climb).hi and climb.lo is not None:
        raise BriefError(
            f"a part cannot both rise and fall: 'climb={amount_text(climb)}'; give one of the two"
        )
    way = {} if fields["kind"] in BUMPS else {"slope": fields.get("slope", "down" if falls else "up")}
    return {**fields, **way, "climb": climb}


def _read_mod(fields: dict[str, object], word: str, keys: dict[str, str]) -> None:
    key, equals, value = word.partition("=")
    if equals and key in keys:
        _set(fields, keys[key], read_amount(value))
    elif word in FLAGS and (keys is ROAD_KEYS or word != ALIKE):
        _set(fields, word, True)
    elif word == ONE_WAY and keys is ROAD_KEYS:
        _set(fields, "against", NO_LANE)
    elif word.startswith(CENTRE) and keys is ROAD_KEYS:
        if value not in get_args(CentreLine):
            known = ", ".join(get_args(CentreLine))
            raise BriefError(f"a plan has no centre line '{value[:40]}'; there are {known}")
        _set(fields, "centre", value)
    elif word.startswith(MAP_SIZE) and keys is ROAD_KEYS:
        amount = read_amount(value)
        if not amount.exact:
            raise BriefError(f"a map has one size, not '{value[:40]}'; write for example {MAP_SIZE}500")
        if not SMALLEST_MAP <= (amount.lo or 0) <= LARGEST_MAP:
            raise BriefError(
                f"a map is {SMALLEST_MAP:g} to {LARGEST_MAP:g} m wide, not {value[:40]}; write for example "
                f"{MAP_SIZE}500"
            )
        _set(fields, "map_size", amount.lo)
    elif word in WORDS:
        _set(fields, WORDS[word], word)
    else:
        raise BriefError(
            f"a plan has no word '{word[:40]}' here; what is asked of the whole road stands behind |, and "
            "the page 'Plans' of the reference describes the language"
        )


def _set(fields: dict[str, object], name: str, value: object) -> None:
    if name in fields:
        said = f": '{value}'" if isinstance(value, Amount | str) else ""
        raise BriefError(f"a plan gives {name} twice{said}; give it once")
    fields[name] = value


def _made(model: type[Model], fields: dict[str, object], text: str) -> Model:
    try:
        return model.model_validate(fields)
    except ValidationError as error:
        problem = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise BriefError(f"the plan '{text.strip()[:60]}' is not a Brief: {problem}") from error
