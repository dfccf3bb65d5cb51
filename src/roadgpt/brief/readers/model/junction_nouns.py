"""Nouns for junctions, side roads and the lanes of ramps, in five languages."""

import re
from collections.abc import Mapping

from roadgpt.brief.junctions import MapJunctionKind

LANE = (
    r"(?:(?:acceleration|deceleration|accel|decel|merging|merge|speed - change) lanes?|"
    r"(?:einfadel|ausfadel|beschleunigungs|verzogerungs)(?:ungs)?(?:spur|streifen)|"
    r"voie d ' (?:insertion|acceleration)|voie de deceleration|"
    r"carril(?:es)? de (?:aceleracion|deceleracion|desaceleracion|incorporacion)|"
    r"corsia di (?:accelerazione|decelerazione|immissione))"
)
PLURAL = (
    r"(?:(?:[ty] - )?(?:junctions|crossings|intersections)|cross ?- ?roads|crossroads|forks|roundabouts|"
    r"traffic circles|kreuzungen|kreisverkehren?|kreisel|einmundungen|abzweigungen|gabelungen|carrefours|"
    r"croisements|ronds - points|giratoires|bifurcations|cruces|intersecciones|rotondas|glorietas|"
    r"bifurcaciones|incroci|rotonde|rotatorie|bivi)"
)
ANY_KIND = (
    r"junctions|intersections|nodes|knoten(?:punkte?n?)?|jonctions|noeuds|intersecciones|nudos|nodos|"
    r"intersezioni|nodi"
)
CROSSING_NOUNS = rf"{ANY_KIND}|crossings|cross ?-? ?roads|kreuzungen|carrefours|croisements|cruces|incroci"
OF_THESE = (
    r"(?:of (?:them|which|these)|davon|dont|de (?:ellos|ellas|los cuales|las cuales)|d(?:ei|elle) quali|"
    r"di quest[ie])"
)
EITHER_NOUNS = "(?:crossings|intersections|kreuzungen|carrefours|croisements|cruces|incroci)"
EITHER = re.compile(rf"\b{EITHER_NOUNS}\b")
"""Nouns that mean crossroads, or junctions of any kind."""
NUMBER = rf"\b(\d+) (?:{OF_THESE}(?: (?:are|being|sind|son|sean|sont|sono|siano))? )?"
KINDS_IN_PLURAL: Mapping[MapJunctionKind, re.Pattern[str]] = {
    "roundabout": re.compile(
        NUMBER + r"(?:small |large |big |mini - ?)?(?:roundabouts|kreisverkehren?|kreisel|rotatorie|rotonde|"
        r"glorietas|rotondas|ronds - points|giratoires)\b"
    ),
    "crossroads": re.compile(NUMBER + r"(?:cross ?-? ?roads|kreuzungen)\b"),
    "t_junction": re.compile(
        NUMBER + r"(?:t (?:- )?(?:junctions|crossings|intersections|kreuzungen|einmundungen)|einmundungen|"
        r"(?:cruces|intersecciones) en t|(?:incroci|intersezioni) a t|"
        r"(?:carrefours|intersections|croisements) en t)\b"
    ),
    "y_junction": re.compile(NUMBER + r"(?:forks|gabelungen|fourches|bifurcations|bifurcaciones|bivi)\b"),
    "star": re.compile(NUMBER + r"(?:stars|sterne|etoiles|estrellas|stelle)\b"),
}
"""A number before the plural noun of a kind of junction."""
KINDS_IN_SINGULAR: Mapping[MapJunctionKind, re.Pattern[str]] = {
    "crossroads": re.compile(
        r"\b(?:cross ?-? ?roads?|intersection|crossing(?! roads?| streets?| traffic)|kreuzung|carrefour|"
        r"croisement|cruce|interseccion|incrocio)\b"
    ),
    "roundabout": re.compile(
        r"\b(?:(?:mini)?roundabout|rotary|traffic circle|(?:mini)?kreisverkehr|(?:mini)?kreisel|rond - point|"
        r"giratoire|glorieta|rotonda|rotatoria)\b"
    ),
    "y_junction": re.compile(r"\b(?:fork|y - junction|gabelung|bifurcation|fourche|bifurcacion|bivio)\b"),
    "star": re.compile(r"\bstar\b"),
}
"""The singular nouns for junctions of each kind, in a text without accents."""
SINGLE_T = re.compile(r"\b(?:t - (?:junction|crossing|intersection|kreuzung|einmundung)|einmundung)\b")
SIDE_STREETS = re.compile(
    r"side (?:streets?|roads?)|(?:seiten|neben)stra(?:ss|ß)en?|rues? (?:laterale|secondaire|transversale)s?|"
    r"calles? (?:lateral|secundaria)(?:e?s)?|(?:strad[ae]|vi[ae]) (?:lateral|secondari)[aei]|laterali"
)
SIDE_ROAD = re.compile(
    r"\b(?:side (?:road|street)|t - junction|(?:neben|seiten)stra(?:ss|ß)e|einmundung|rue laterale|"
    r"calle lateral|strada laterale)\b"
)
RAMP_LANE = re.compile(rf"\b{LANE}\b")
"""A lane that only merges and exits have."""
ANY_PLURAL = re.compile(rf"\b{PLURAL}\b")


def names_a_junction(said: str) -> bool:
    """Returns whether a noun of some words can only mean a junction, a merge or an exit."""
    nouns = (
        KINDS_IN_SINGULAR["crossroads"],
        KINDS_IN_SINGULAR["roundabout"],
        SIDE_ROAD,
        RAMP_LANE,
        ANY_PLURAL,
    )
    return any(noun.search(said) for noun in nouns)
