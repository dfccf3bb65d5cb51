"""Adds to a Brief what the words say about a route or a map, where the neural network left it out.

For the whole route, these are traffic on the left, the centre line, the lanes, and priority to the right. For
a part of it, these are the T-junction where a side street ends, and a one-way road that the route takes.
"""

import re
from collections.abc import Callable

from roadgpt.brief.amount import exactly
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.left_hand import NEGATED, may_mean_left_hand, says_left_hand
from roadgpt.brief.model import Brief, CentreLine
from roadgpt.brief.readers.model.denial import says
from roadgpt.brief.readers.model.exit_words import COUNTS
from roadgpt.brief.readers.model.numerals import plain

LINES: dict[CentreLine, re.Pattern[str]] = {
    "double": re.compile(
        r"double (?:\w+ )?(?:centre |center )?lines?|doppellinie|doppelte linie|double ligne|lignes? double|"
        r"doble linea|linea doble|doppi[ae] (?:line[ae]|strisci[ae])|linea doppia"
    ),
    "solid": re.compile(
        r"no overtaking|no passing|overtaking (?:is )?(?:forbidden|prohibited|not allowed|banned)|"
        r"solid (?:\w+ )?(?:centre |center )?line|uberholverbot|uberholen (?:ist )?verboten|kein uberholen|"
        r"nicht uberholt|durchgezogene|sperrlinie|sicherheitslinie|interdi\w+ de (?:depasser|doubler)|"
        r"depassement interdit|ligne (?:\w+ )?continue|prohibido adelantar|adelanta\w+ prohibido|"
        r"linea (?:\w+ )?continua|divieto di sorpasso|sorpasso vietato|vietato (?:il )?sorpass|"
        r"striscia continua"
    ),
    "none": re.compile(
        r"(?:no|without (?:an?|any|the)?) ?(?:centre|center|middle) ?lines?|no (?:road |lane )?markings|"
        r"unmarked road|(?:ohne|keine) mittellinie|sans (?:ligne (?:centrale|mediane)|marquage)|"
        r"sin (?:linea central|marcas)|senza (?:line[ae] (?:centrale|di mezzeria)|segnaletica orizzontale)"
    ),
    "broken": re.compile(
        r"(?:dashed|broken) (?:\w+ )?(?:centre |center )?line|overtaking (?:is )?allowed|gestrichelte|"
        r"leitlinie|ligne (?:\w+ )?(?:discontinue|pointillee)|linea discontinua|linea tratteggiata"
    ),
}
PLACED = re.compile(
    r"\b(?:until|till|before|after|behind|first|second|third|last|then|from there|up to|"
    r"bis|vor|nach|danach|dahinter|dann|"
    r"jusqu|avant|apres|puis|ensuite|hasta|antes|despues|luego|fino|prima|dopo|poi)"
)
"""Words that limit a statement to a part of the route."""
ALL_THE_WAY = re.compile(
    r"\b(?:all the way|throughout|everywhere|(?:the|my|our|this) (?:whole|entire|complete)(?! \d)|"
    r"from start to (?:finish|end)|(?:all|every|each)(?: of)?(?: the| my)? roads?|"
    r"uberall|durchgehend|durchweg|(?:ganze|gesamte)[nr]? (?:strecke|route|fahrt|weg)|"
    r"(?:alle|allen|jede|jeder) stra(?:ss|ß)en?|partout|tou(?:t|te) (?:le|la|du)|d'un bout a l'autre|"
    r"(?:toutes les|chaque) (?:routes?|rues?)|tod[oa] (?:el|la) (?:recorrido|trayecto|ruta|camino)|"
    r"en todas partes|todas las (?:calles|carreteras|vias)|"
    r"ovunque|dappertutto|tutt[oa] (?:il|la|l') ?(?:percorso|tragitto|strada|giro)|tutte le strade)\b"
)
"""Words that say that something holds on every road of the route."""
ALL_FLAT = re.compile(
    r"\b(?:all|everything|it all)(?: is| of it| roads?)? (?:flat|level)\b|"
    r"\b(?:flat|level) (?:all the way|throughout)|\balles (?:ist )?(?:eben|flach)|"
    r"\btout (?:est )?(?:a )?plat|\btodo (?:es )?(?:llano|plano)|\btutto (?:e )?(?:in )?pian"
)
NO_BENDS_BETWEEN = re.compile(
    r"\b(?:(?:no|without(?: any)?) (?:bends?|turns?|curves?)|keine kurven?|ohne kurven?|"
    r"(?:pas de|sans) virages?|sin curvas|ninguna curva|senza curve|nessuna curva|dead straight|straight) "
    r"(?:in )?(?:between|dazwischen|zwischen|entre|tra)\b"
)
LANES_EACH_WAY = re.compile(
    rf"\b({'|'.join(COUNTS)}) "
    r"(?:lanes (?:per direction|in each direction|each (?:way|direction)|either way)|"
    r"(?:fahr)?(?:spuren|streifen) (?:je|pro) (?:fahrt)?richtung|"
    r"voies (?:par|dans chaque) (?:sens|direction)|"
    r"carriles (?:por|en cada) sentido|corsie per (?:senso(?: di marcia)?|direzione))"
)
"""A road with the same number of lanes in both directions."""
OWN_PRIORITY = re.compile(
    r"\b(?:i|we|you|and|with) (?:have |has |the )?(?:priority|right of way)\b(?! to)|"
    r"\b(?:ich|wir|man) vorfahrt hab|"
    r"\b(?:habe|haben|hat) (?:ich |wir |man )?vorfahrt|\b(?:j'ai|nous avons|on a) (?:la )?priorite\b(?! a)|"
    r"\b(?:tengo|tenemos) (?:la )?(?:prioridad|preferencia)(?! a)|\b(?:ho|abbiamo) (?:la )?precedenza(?! a)"
)
"""Words for a route that has priority."""
GIVES_WAY = re.compile(
    r"\byield|giv\w+ way|main road|\bgewahr|wartepflicht|\bced\w+|\bdare\b|"
    r"\bd(?:o|a|ai|iamo) (?:la )?precedenza"
)
LANES = re.compile(r"\blanes?\b|spur|streifen|\bvoies?\b|carril|corsi[ae]\b")
OF_LANES = ("lanes", "against", "divided")
SIDE_STREET = re.compile(
    r"\b(?:out of|from|leav\w+) (?:an?|the|my|our) side (?:street|road)|"
    r"\baus (?:einer|der|meiner|unserer) (?:neben|seiten)stra(?:ss|ß)e|"
    r"\b(?:d'une|de la|de ma) (?:petite )?(?:rue|route) (?:laterale|secondaire)|"
    r"\b(?:de|desde) (?:una|la|mi) (?:calle|carretera|via) (?:lateral|secundaria)|"
    r"\bda(?:lla| una) (?:strada|via|stradina) (?:laterale|secondaria)"
)
"""Phrases for a route that begins on a side street, which ends at the next junction, a T-junction."""
RIGHT_FIRST = re.compile(
    r"right[- ]?before[- ]?left|(?:priority|precedence) (?:to|from) the right|give[- ]way to the right|"
    r"rechts[- ]?vor[- ]?links|rechtsvor(?:tritt|rang)|priorite a (?:la )?droite|"
    r"(?:precedenza|priorita) a(?:lla)? destra|(?:preferencia|prioridad|preferente) (?:a|de|por) la derecha"
)
"""Phrases for priority to the right, the rule at junctions without signs."""
SIGNED = re.compile(
    r"\byields?\b|give[- ]way(?! to the right)|main road|\bgewahr|vorfahrt|wartepflicht|hauptstr|"
    r"\bced(?:er?|ere|ez|a|o|iamo)\b|principal|"
    r"\bd(?:o|are|ai|ando|ata?) (?:la )?precedenza(?! a(?:lla)? destra)"
)
"""Words that suggest that some junction has a give-way sign."""
INSTEAD = re.compile(
    r"\b(?:\w+n't|instead of|(?:an)?statt|au lieu de|en vez de|invece (?:di|della))(?: \w+)?\s*$"
)
UNSIGNED = (*RAMPS, *LANE_KINDS, "roundabout")
"""The kinds of junctions that never have priority to the right."""
DUAL_CARRIAGEWAY = re.compile(
    r"dual carriage ?ways?|\bdivided (?:road|highway|street)|zweibahnig\w*|"
    r"getrennte\w* (?:richtungs)?fahrbahn\w*|baulich getrennt\w*|chaussees? separees?|"
    r"doble calzada|calzadas separadas|doppia carreggiata|carreggiate separate"
)
NOT_FIRST = re.compile(
    r"cross|junction|roundabout|fork|\bturn|exit|kreuz|kreis|einmund|abzweig|gabel|carrefour|rond|giratoire|"
    r"croisement|bifurc|cruce|rotonda|glorieta|incroc|rotatoria|bivio|third|second|last|\bon ?to\b|\binto\b|"
    r"\bjoin|\breach|\bbecome|\bmeet|\b(?:then|after|dann|danach|nach|puis|ensuite|apres|luego|despues|poi|vers|"
    r"hasta|fino|auf (?:die|eine))\b"
)
"""Words before a dual carriageway that is not the first road of the route."""
AT_ALL = re.compile(
    r"\b(?:everywhere|throughout|all(?!['’])|both|every|each|uberall|alle[nrm]?|beide[nrm]?|jede[nrm]?|partout|tous|"
    r"toutes|chaque|tod[ao]s|amb[ao]s|cada|ovunque|dappertutto|tutt[ie]|entramb[ie]|ogni)\b"
)


def with_whole_drive(brief: Brief, words: str) -> Brief:
    """Returns the Brief with requirements that the words state and the Brief lacks.

    The Brief of a single road is returned unchanged. These requirements are added:

    - Traffic drives on the left, if the words say so; it does not if no word may mean that.
    - Every road with oncoming traffic on the same carriageway gets a centre line, if the words name one kind
      of line without a place, and no road of the Brief has a line yet.
    - The first road gets a median if it is a dual carriageway, and no road of the Brief has one.
    - If the words say that all roads have the same lanes or centre line, roads without them get those of the
      other roads.
    - If the words begin with the lanes of both directions, the first road has them.
    - Junctions with priority to the right get no give-way signs; those where the words say that the route has
      priority get none either, unless some words tell of giving way.
    - A junction at the end of a side street is a T-junction.
    - If the route takes a one-way road at a junction, the road behind the junction is one-way.
    """
    if not brief.junctions and brief.map is None:
        return brief
    brief = _with_own_priority(brief, words)
    brief = _out_of_side_street(_with_one_way_behind(_without_signs(brief, words)), words)
    line = None if any(each.centre for each in brief.stretches) else _line_said(words)
    roads = tuple(
        each.model_copy(update={"centre": line}) if line and _has_centre_line(each) else each
        for each in _with_lanes_each_way(_with_dual_carriageway(brief.stretches, words), words)
    )
    roads = _without_bends_between(roads) if says(NO_BENDS_BETWEEN, plain(words)) else roads
    roads = _with_shared(roads, ("slope",), lambda road: True) if ALL_FLAT.search(plain(words)) else roads
    return brief.model_copy(
        update={
            "left_hand": (brief.left_hand and may_mean_left_hand(words))
            or says_left_hand(words, by_place=True),
            "stretches": _alike(brief, roads, words),
        }
    )


def _out_of_side_street(brief: Brief, words: str) -> Brief:
    """Returns the Brief with a T-junction where a side street ends and the kind of the junction is open."""
    first = brief.junctions[0] if brief.junctions else None
    is_open = first is not None and first.kind == "junction" and first.take in ("left", "right")
    if first is None or not is_open or first.arms or not SIDE_STREET.search(plain(words)):
        return brief
    known = first.model_copy(update={"kind": "t_junction"})
    return brief.model_copy(update={"junctions": (known, *brief.junctions[1:])})


def _with_own_priority(brief: Brief, words: str) -> Brief:
    """Returns the Brief with priority instead of give-way signs, if the words tell of priority only."""
    said = plain(words)
    if not says(OWN_PRIORITY, said) or GIVES_WAY.search(said):
        return brief
    junctions = tuple(
        each.model_copy(update={"control": "priority"}) if each.control == "yield" else each
        for each in brief.junctions
    )
    return brief.model_copy(update={"junctions": junctions})


def _with_lanes_each_way(roads: tuple[Brief, ...], words: str) -> tuple[Brief, ...]:
    """Returns the roads; if none has lanes, the first gets those of both directions that the words give."""
    parts = [part for part in _parts(words)[:2] if LANES_EACH_WAY.search(part)]
    has_lanes = any(road.lanes or road.against or road.divided or road.motorway for road in roads)
    if not roads or has_lanes or len(parts) != 1 or PLACED.search(parts[0]):
        return roads
    found = LANES_EACH_WAY.search(parts[0])
    assert found is not None
    number = exactly(COUNTS[found[1]])
    return (roads[0].model_copy(update={"lanes": number, "against": number}), *roads[1:])


def _with_one_way_behind(brief: Brief) -> Brief:
    """Returns the Brief with one-way roads behind junctions at which the route takes a road that is said to
    lead away only.
    """
    junctions, roads = list(brief.junctions), list(brief.stretches)
    for n, each in enumerate(junctions):
        if each.take in each.only_out:
            rest = tuple(side for side in each.only_out if side != each.take)
            junctions[n] = each.model_copy(update={"only_out": rest})
            if roads[n + 1].against is None:
                roads[n + 1] = roads[n + 1].model_copy(update={"against": exactly(0)})
    return brief.model_copy(update={"junctions": tuple(junctions), "stretches": tuple(roads)})


def _with_dual_carriageway(roads: tuple[Brief, ...], words: str) -> tuple[Brief, ...]:
    """Returns the roads; the first has a median if the words tell of a dual carriageway there."""
    said = plain(words)
    found = DUAL_CARRIAGEWAY.search(said)
    if not roads or found is None or any(road.divided or road.motorway for road in roads):
        return roads
    if NOT_FIRST.search(said[: found.start()]) or not says(DUAL_CARRIAGEWAY, said):
        return roads
    return (roads[0].model_copy(update={"divided": True}), *roads[1:])


def _alike(brief: Brief, roads: tuple[Brief, ...], words: str) -> tuple[Brief, ...]:
    """Returns the roads of a route with the lanes and the centre line of those that have any, where the words
    say that all have the same. Where lanes end, begin or lead to ramps, roads have different lanes.
    """
    parts = [part for part in _parts(words) if not PLACED.search(part)]
    whole = [part for part in parts if says(ALL_THE_WAY, part)]
    has_changes = any(each.kind in (*RAMPS, *LANE_KINDS) for each in brief.junctions)
    if not has_changes and any(LANES.search(part) for part in whole):
        roads = _with_shared(roads, OF_LANES, lambda road: not road.motorway)
    if any(_lines_in(part) for part in whole):
        roads = _with_shared(roads, ("centre",), _has_centre_line)
    return roads


def _without_bends_between(roads: tuple[Brief, ...]) -> tuple[Brief, ...]:
    """Returns the roads of a route; those between junctions have no turns, if they have no features."""
    inner = (
        road if road.clauses or road.turns else road.model_copy(update={"turns": exactly(0)})
        for road in roads[1:-1]
    )
    return (*roads[:1], *inner, *roads[1:][-1:])


def _with_shared(
    roads: tuple[Brief, ...], names: tuple[str, ...], can_have: Callable[[Brief], bool]
) -> tuple[Brief, ...]:
    """Returns the roads; those that have no values in these fields, but can have some, get the values of the
    other roads. If these values differ or ask for a one-way road, all roads are returned unchanged.
    """
    usual = Brief()
    values = [{name: getattr(road, name) for name in names} for road in roads]
    none = {name: getattr(usual, name) for name in names}
    given = [each for each in values if each != none]
    if not given or any(each != given[0] for each in given) or given[0].get("against") == exactly(0):
        return roads
    return tuple(
        road.model_copy(update=given[0]) if own == none and can_have(road) else road
        for road, own in zip(roads, values, strict=True)
    )


def _without_signs(brief: Brief, words: str) -> Brief:
    """Returns the Brief with no signs at junctions where cars from the right go first, unless the words also
    tell of signs to give way.
    """
    said = plain(words)
    before = [said[: each.start()] for each in RIGHT_FIRST.finditer(said)]
    is_said = any(not NEGATED.search(each) and not INSTEAD.search(each) for each in before)
    if not is_said or SIGNED.search(said):
        return brief
    if brief.map is not None:
        control = brief.map.control if brief.map.control not in (None, "yield") else "none"
        return brief.model_copy(update={"map": brief.map.model_copy(update={"control": control})})
    parts = [part for part in _parts(words) if RIGHT_FIRST.search(part)]
    is_open = len(brief.junctions) == 1 or any(AT_ALL.search(part) for part in parts)
    junctions = tuple(_uncontrolled(each, is_open) for each in brief.junctions)
    return brief.model_copy(update={"junctions": junctions})


def _uncontrolled(junction: JunctionClause, is_open: bool) -> JunctionClause:
    is_meant = junction.control == "yield" or (is_open and junction.control is None)
    if not is_meant or junction.kind in UNSIGNED:
        return junction
    return junction.model_copy(update={"control": "none"})


def _line_said(words: str) -> CentreLine | None:
    found = set[CentreLine]()
    for part in _parts(words):
        kinds = _lines_in(part)
        if kinds and PLACED.search(part):
            return None
        found.update(kinds[:1])
    return found.pop() if len(found) == 1 else None


def _lines_in(part: str) -> list[CentreLine]:
    return [line for line, pattern in LINES.items() if pattern.search(part)]


def _parts(words: str) -> list[str]:
    return re.split(r"[.,;:!?\n]", plain(words))


def _has_centre_line(road: Brief) -> bool:
    return not (road.divided or road.motorway or (road.against is not None and road.against.hi == 0))
