"""Finds the words that mention junctions, ramps, lanes and maps, in five languages.

A text without such a word describes a single road; the network for routes does not read it unless the
networks for single roads name a junction or the like. A text with such a word may still describe a single
road ("no junctions, please"): the networks decide.
"""

import re

from roadgpt.brief.readers.model.number_words import word_set

TOLD_ON_ROUTES = frozenset(
    ["junction", "crossroads", "roundabout", "merge", "exit", "lane_change", "traffic_light", "sign", "lanes"]
)
"""Names of parts of routes that the networks for single roads give in ``beside(...)`` or as the cause of a
refusal."""

ENGLISH = (
    r"junction|intersect|cro+s+ro|cros+r[do]|\bx-?(?:ing|roads)|cross(?:ing|es|walk|-?street)?s?\b|"
    r"round-?about|roundabuot|\brbt|\brab\b|rotary|gyratory|(?:traffic|turning) circle|fork|\btees?\b|"
    r"(?<!['’])\bt(?:s|-junction)?\b|\b(?:an?|the) y\b|\by-|\bstar\b|"
    r"\b(?:three|four|five|six|\d)[- ](?:way|arm|leg)|all-?way|"
    r"(?:side|second|third|next|first|main|village) (?:street|road)|streets?\b|turn-?off|turning on|"
    r"(?:five|six|two|three|four) (?:roads|arms|legs)|"
    r"(?:end of the|road (?:[\w\']+ ){0,3}(?:comes to an|ends|end|forks|splits|divides|is finished|"
    r"joins|branches|meets?))|until it ends|road split|\b(?:first|second|third|next) (?:left|right|exit)|"
    r"\bexits?|slip|\bramps?\b|merg|\blanes?\b|one[- ]way|carriageway|divided|median|"
    r"cent(?:re|er) ?-?line|unmarked|\blines?\b|overtak|markings?|\bgrid|\bblocks?\b|\blights?\b|robots|"
    r"\btl\b|signal|\bstop\b|\byield|give way|giving way|priority|right of way|zebra|pedestrian crossing|"
    r"left-hand (?:traffic|drive)|(?:side of the|on british) road|"
    r"(?:drive|driving|keep|traffic) on the left|change (?:to the )?(?:left|right)|freeway|motorway|"
    r"interstate|highway|branch|"
    r"\bwye\b|splits? in two|\bparts\b|\bplain \w* ?x\b|\bisland|\brobots?\b|get over to the|"
    r"pull out|\bcircle|goes off to|ignor|dead[- ]ends\b|culs?-?[- ]de[- ]sacs"
)
GERMAN = (
    r"kreuz|einmünd|einmuend|mündet|gabl?el|gablung|verzweig|\bstern|fünfarm|kreisverk|kreisel|\bkvp|"
    r"abzweig|zweigt|abbieg|\bbieg|abfahrt|ausfahrt|auffahrt|einfahrt|einfädel|rampe|spur|streifen|\bfs\b|"
    r"einbahn|fahrbahn|mittellinie|linie|raster|gitter|schachbrett|blöck|blocks|ampel|lichtsignal|\blsa\b|"
    r"stopp|vorfahrt|vorrang|rechts vor links|fußgängerüber|schutzweg|linksverkehr|seitenstra|querstra|"
    r"straßen? (?:links|rechts|endet|hört|teilt)|(?:weg|straße) (?:sich )?teilt|ende der straße|"
    r"(?:straße|weg) endet|(?:fünf|sechs) straßen|"
    r"\b(?:erste|zweite|dritte|nächste)n? (?:links|rechts|straße)|autobahn|\bbab\b|\bknoten|überhol|"
    r"markierung|"
    r"(?:straße|weg|diese?)[^.]{0,30} (?:aufhört|teilt|endet)|endet auch|\bendet\b|aufhört|"
    r"reißverschluss|wegscheide|strahlig|übernächste|end der straßn|ypsilon|ausfart|(?:rechts|"
    r"links) ab\b|kommt rechts|kommt links|sackgassen"
)
FRENCH = (
    r"carrefour|croisement|intersection|rond-?s?[- ]?points?\b|giratoire|fourche|bifurc|embranch|étoile|"
    r"bretelle|sortie|insertion|voies?\b|sens unique|chaussée|terre-plein|lignes? (?!droite)|lignes?$|"
    r"jonction|patte d|quadrillage|grille|damier|pâtés?|feux?\b|priorit|cédez|passage (?:piéton|pour)|"
    r"autoroute|marquage|\brues?\b|\bfiles?\b|route (?:se termine|finit|se sépare|se divise)|bout de la r|"
    r"conduite à gauche|insère|déboît|dépass|toutes-directions|la route bute|"
    r"(?:première|2e|deuxième|troisième) à (?:droite|gauche)|"
    r"déport|rabat|se (?:partage|dédouble|scinde)|rejoint|\barrêt|échiquier|s'en va|lumière|"
    r"prochaine|croisée|impasses\b|\bl'y\b|à la y\b|change (?:une|deux) fois"
)
SPANISH = (
    r"cruce|cruza|intersecci|glorieta|rotonda|óvalo|isleta|bifurca|horqueta|estrella|ramal|salida|"
    r"incorpor|carril|trenzado|(?:sentido|dirección) única?o?|calzada|mediana|línea|linea|cuadrícula|"
    r"manzana|semáforo|semaforo|prioridad|\bceda|\bpare\b|paso de|\bcalle|bocacalle|autopista|autov|"
    r"desv[ií]o|\bnudo|adelanta|marcas|malla|cuadra|damero|\bdos y\b|una y\b|\balto me|primer alto|"
    r"vía lateral|camino a la|(?:carretera|camino) (?:[^.,;]{0,20}(?:se parte|se divid|termina))|"
    r"transversal|\b(?:la|una|de) tes?\b|desemboca|desvi|\b(?:primera|segunda|tercera|próxima)\b|"
    r"y griega|encrucijada|redondel|rompoy|\balto\b|luces|focos|lateral|\bstops?\b|cremallera|"
    r"esquina|desvía|otra carretera|llegue otra|se abre en|se parte|sin salida|\bla y\b|va a dar a|sale otra"
)
ITALIAN = (
    r"in?c?rocc?i|crocevia|quadrivio|rotatori|rotond|biforc|reticolo|\bnod[oi]\b|piazza|laterale|innest|"
    r"\besc[eo]\b|sorpass|segnaletica|\bbii?vi|rampa|stella|svincol|uscit|immission|immett|corsi[ae]|"
    r"senso unico|carreggiat|spartitraffico|linee|strisci[ae]|intersezion|griglia|isolat|semafor|"
    r"precedenza|attraversament|strisce|autostrad|superstrad|travers|"
    r"(?:strada|via) (?:finisce|termina|si divide|laterale)|finisce su|(?:fine|fondo) alla (?:via|strada)|"
    r"fine della strada|prossima strada|cinque strade|sei strade|"
    r"(?:prima|seconda|terza) (?:via )?a (?:destra|sinistra)|guida a sinistra|"
    r"isola centrale|stradin|stradell|sbatt|spost|crocicchio|sdoppia|forcella|\bincr\b|"
    r"\binc[or]+ci|si apre|rondò|(?:terza|seconda|prima) strada|viuzz|si stacca|confluisc|laterali|"
    r"vicoli ciechi|senza uscita|"
    r"in una strada|(?:rondò|la) (?:seconda|terza)\b"
)
TELLING = re.compile("|".join((ENGLISH, GERMAN, FRENCH, SPANISH, ITALIAN)), re.IGNORECASE)

COMPANIONS = word_set(
    "junction junctions intersection intersections arm arms leg legs branches exits block blocks traffic",
    "ramp road roads street streets sign signs arrangement markings lane lanes grid bear",
    "knoten knotenpunkt arme armen ausfahrten blöcke häuserblöcke rampe straße straßen",
    "schild spur spuren raster gitter",
    "branches sorties pâtés maisons bretelle route routes rue rues panneau voie voies",
    "quadrillage grille croix",
    "brazos ramas salidas manzanas ramal carretera calle calles señal carril carriles",
    "intersección cuadrícula",
    "bracci rami uscite isolati strada strade via vie cartello corsia corsie intersezione griglia",
)
"""Words that add nothing to another word beside them, such as "junction" in "T-junction" or "arms" in "four
arms": the plan stays the same without these words."""


def may_tell_a_route(words: str) -> bool:
    """Returns whether a description has a word that may mention junctions, ramps, lanes or maps."""
    return TELLING.search(words) is not None
