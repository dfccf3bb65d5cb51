"""Refuses what the network overlooks: closed circuits, and negative lengths, radii and counts.

Grades and climbs may be negative, and a dash may be just punctuation, so only negative numbers that are
certainly lengths, radii or counts are refused.
"""

import re
from collections.abc import Sequence

from roadgpt.brief.readers.model.number_words import COUNTED, ONE_TURN, plain, word_set
from roadgpt.brief.readers.model.slots import SlottedText, slot_name

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
DENIED = re.compile(
    r"(?:\b(?:no|not|none|never|cannot|nor|without|kein\w*|nicht|nie|ohne|pas|ni|aucune?|jamais|sans|ningun\w*|"
    r"nunca|sin|non|ne|nessun\w*|mai|senza)|n['’]t)\b[^.,;:!?]*$"
)
"""The beginning of a sentence that denies what follows."""
MINUS = frozenset(["minus", "negative", "negativ", "negativen", "negatif", "negativo"])
BEFORE_DASH = word_set(
    "of with has have having exactly precisely is are = : radius length mit von hat avec de con tiene",
    "di r",
)
"""Words after which a dash right before a number is a minus sign."""
LENGTHS = word_set(
    "straight straights radius radii r length long lang gerade geraden lange kurvenradius longueur",
    "droite rayon recta longitud radio rettilineo lunghezza raggio tangent",
)
NEAR = 4


def asks_for_a_closed_loop(words: str) -> bool:
    """Returns whether the words ask for a road that ends where it starts, and do not deny it."""
    said = " ".join(map(plain, words.split()))
    return any(
        not DENIED.search(said[: found.start()]) and not NOT_ASKED.search(said[: found.start()])
        for found in CLOSED.finditer(said)
    )


def negative_number(text: SlottedText) -> str | None:
    """Returns the first negative length, radius or count, for example "minus three turns"; None if there is
    none.
    """
    words = [word.text for word in text.words]
    for at, word in enumerate(words):
        if not _is_number(word) or not _is_below_nothing(words, at):
            continue
        after = words[at + 1 : at + 3]
        said = text.words[at].written
        noun = next((word for word in after if word in COUNTED | ONE_TURN), None)
        if noun:
            return f"minus {said} {noun}"
        if after[:1] == ["metres"] and LENGTHS.intersection(words[max(at - NEAR, 0) : at + 1 + NEAR]):
            return f"minus {said}"
    return None


def _is_number(word: str) -> bool:
    return word.isdecimal() or word.startswith(slot_name(0)[:-2])


def _is_below_nothing(words: Sequence[str], at: int) -> bool:
    before = words[at - 1] if at else ""
    if before in MINUS:
        # "five minus two", "5 plus or minus 1" are sums
        return at < 2 or not (_is_number(words[at - 2]) or words[at - 2] in ("or", "/", "plus"))
    return before == "-" and at > 1 and words[at - 2] in BEFORE_DASH
