"""Recognises change requests that only ask to reverse the road, for which the network has no word."""

import re

from roadgpt.brief.readers.model.numerals import plain

POLITE = (
    r"please|now|can you|could you|would you|just|simply|bitte|jetzt|einfach|mal|s'il (?:te|vous) plait|"
    r"maintenant|por favor|ahora|per favore|adesso|ora"
)
WHOLE = r"(?:whole |entire |ganze |gesamte |toute |tout |entera |intera )?"
ENGLISH = (
    rf"(?:reverse|turn around|flip around) (?:the )?{WHOLE}(?:road|route|course|track|direction)"
    r"(?: of (?:the )?(?:road|route|travel|driving))?|"
    r"reverse the (?:driving|travel) direction|"
    r"(?:swap|exchange|switch) (?:the )?(?:start|beginning) and (?:the )?(?:end|finish)|"
    r"(?:let )?(?:the )?start and (?:the )?(?:end|finish) (?:should |shall )?(?:change|trade|swap) places|"
    r"(?:drive|run|take|make|do)(?: it| this| the (?:same )?(?:road|route))?"
    r" (?:backwards|in reverse|the other way(?: a?round)?|in the (?:other|opposite|reverse) direction|"
    r"from (?:the )?(?:end|finish) to (?:the )?(?:start|beginning))"
)
GERMAN = (
    rf"(?:(?:dreh|kehr)e? )?(?:die )?{WHOLE}(?:stra(?:ss|ß)e|strecke|fahrtrichtung|richtung)"
    r" (?:um|umdrehen|umkehren|andersherum|rueckwaerts|ruckwarts)|"
    r"(?:(?:tausche?|vertausche?) )?start und (?:ziel|ende)(?: (?:ver)?tauschen)?|"
    r"(?:fahre? |das ganze )?(?:sie |es |die(?:selbe| gleiche)? (?:strecke|route) )?"
    r"(?:in (?:der |die )?(?:gegenrichtung|umgekehrte[rn]? richtung|"
    r"andere[rn]? richtung)|andersherum|ruckwarts)(?: fahren)?"
)
FRENCH = (
    rf"(?:invers|renvers|retourn)e[rz]? (?:la |le |l')?{WHOLE}(?:route|parcours|trace|sens)"
    r"(?: de (?:la )?(?:route|marche|parcours|circulation))?|"
    r"(?:parcour\w+|prend\w*|roule[rz]?) ?-? ?(?:l[ae] )?(?:meme )?(?:route |parcours )?(?:en sens inverse|"
    r"dans l'autre sens|a l'envers)|echange[rz]? (?:le )?depart et (?:l')?arrivee"
)
SPANISH = (
    rf"(?:invierte|invertir|dale la vuelta a|da la vuelta a) (?:la |el )?{WHOLE}"
    r"(?:carretera|ruta|recorrido|sentido)(?: de (?:la )?(?:marcha|carretera|circulacion))?|"
    r"(?:recorre\w*|conduce\w*|haz\w*) (?:la |el )?(?:misma )?(?:carretera |ruta )?"
    r"(?:al reves|en sentido contrario|en sentido inverso)|"
    r"intercambia (?:la )?salida y (?:la )?(?:meta|llegada)"
)
ITALIAN = (
    rf"(?:inverti|invertire|capovolgi) (?:la |il )?{WHOLE}(?:strada|percorso|senso|direzione|tracciato)"
    r"(?: di (?:marcia|percorrenza))?|"
    r"(?:percorri|guida|fai)(?:la|lo)? (?:la (?:stessa )?strada )?(?:al contrario|"
    r"in senso (?:inverso|opposto|contrario))|"
    r"scambia (?:la )?partenza e (?:l')?arrivo"
)
REVERSE = re.compile("|".join((ENGLISH, GERMAN, FRENCH, SPANISH, ITALIAN)))


def asks_to_reverse(words: str) -> bool:
    """Returns whether a change request asks to reverse the whole road, and for nothing else."""
    said = re.sub(rf"\b(?:{POLITE})\b|[.,!?]", " ", plain(words))
    return REVERSE.fullmatch(" ".join(said.split())) is not None
