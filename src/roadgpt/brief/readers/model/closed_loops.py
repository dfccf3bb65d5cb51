"""Recognises words for a closed circuit, which RoadGPT does not build; the network often overlooks them."""

import re

from roadgpt.brief.plan import is_map
from roadgpt.brief.readers.model.denial import is_denied
from roadgpt.brief.readers.model.numerals import plain

CLOSED = re.compile(
    r"\b(?:closed (?:loop|circuit)"
    r"|(?:start|beginning) and (?:finish|end) (?:are |lie )?(?:at|in|on) the same (?:place|point|spot|line)"
    r"|geschlossene[rns]? (?:rund\w+|kurs|runde|strecke|schleife|ring\w*|kreis\w*)|rundkurs\w*|rundstrecke"
    r"|start und ziel (?:am|im|an der|auf dem) (?:selben|gleichen) (?:punkt|ort|platz|stelle|fleck)"
    r"|(?:circuit|boucle|parcours|trace) fermee?|(?:circuito|bucle|recorrido|trazado) cerrado"
    r"|(?:circuito|anello|percorso|tracciato) chiuso)\b"
    r"(?! (?:a la|al|alla|to|for|fur den) (?:circ|tr|verkehr))"
)
"""Phrases for a road that ends where it starts, in a text without accents."""
NOT_ASKED = re.compile(
    r"\b(?:instead|almost|nearly|like|sections?|parts?|portion|out of|next to|near|beside|on|old"
    r"|unlike|rather|statt|anstatt|anstelle|fast|beinahe|wie|ausschnitt|abschnitt|teil|neben|auf|alte[rn]?"
    r"|lieu|presque|comme|partie|portion|morceau|cote|sur|casi|como|parte|tramo|trozo|vez|junto|en"
    r"|quasi|come|tratto|pezzo|invece|accanto|su)(?: [\w'-]+){0,3} $"
)
"""Words before such a phrase that show that it is no wish: "instead of a closed loop"."""


def asks_for_a_closed_loop(words: str, line: str) -> bool:
    """Returns whether the words ask for a road that ends where it starts, and do not deny it.

    False if the plan ``line`` asks for a map, because the roads of a map may be closed loops.
    """
    if is_map(line):
        return False
    said = " ".join(map(plain, words.split()))
    return any(
        not is_denied(said[: found.start()]) and not NOT_ASKED.search(said[: found.start()])
        for found in CLOSED.finditer(said)
    )
