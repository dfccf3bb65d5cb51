"""Recognises change requests that ask two turns to change places, for which the network has no word."""

import re

from roadgpt.brief.readers.model.ordinals import PLACE, place_of
from roadgpt.brief.readers.model.slots import SlottedText

TURNS = (
    r"(?:turns?|bends?|curves?|corners?|kurven?|kehren?|bogen|virages?|courbes?|curvas?|curve?|tornanti|"
    r"giros?)"
)
NUMBER = rf"(?:(?:the|die|der|le|la|les|las|el|il) )?(\d|{PLACE})(?:st|nd|rd|th| \.|e|eme|a)?"
AND = r"(?:and|with|und|mit|et|avec|y|con|e)"


TWO = re.compile(
    rf"\b{TURNS} (?:no |nr |number )?{NUMBER} {AND} (?:{TURNS} )?{NUMBER}\b|"
    rf"\b{NUMBER} (?:{TURNS} )?{AND} {NUMBER} {TURNS}\b|"
    rf"\b{NUMBER} {TURNS} {AND} {NUMBER}(?= |$)"
)
"""Two turns that are named by their numbers, such as "turn 1 and the third"."""
BOTH = re.compile(
    rf"\b(?:the (?:two|2|both)|both|die (?:2|zwei|beiden)|les (?:2|deux)|las (?:2|dos)|le (?:2|due)) "
    rf"{TURNS}\b"
)
SWAP = re.compile(
    r"\b(?:swap|exchange|switch|interchange|trade places|change places|(?:ver)?tausch\w*|echang\w*|"
    r"intervert\w*|permut\w*|intercambi\w*|scambi\w*|invertendo di posto)\b"
)
MORE = re.compile(
    r"\b(?:left|right|links|rechts|gauche|droite|izquierda|derecha|sinistra|destra|start|end|finish|anfang|ziel|"
    r"lengths?|sharpness|steepness|width|height|straights?|to|then|remove|make|from|back|aus|off|gentle|"
    r"sharp|hairpins?|second last|vorletzt\w*|for|directions?|sides?|richtung\w*|sens|sentido\w*|"
    r"radi\w+|raggi\w*|rayon\w*|angle\w*|winkel\w*|angul\w*|angol\w*|slope\w*|grade\w*|not|nicht|pas|no|non)\b"
)
"""Words with which something other than the places of two turns is exchanged, or nothing."""
STAYS = re.compile(
    r" [,;.] (?:and |but |und |aber |et |mais |y |pero |e |ma )?[^,;.]*\b(?:stays?|keep|kept|remains?|"
    r"unchanged|untouched|bleib\w*|unverandert|reste(?:nt)?|inchange\w*|qued\w+|igual|sin cambi\w+|"
    r"rest(?:a|ano)|invariat\w)\b[^,;.]*(?: , wie [^,;.]*)?(?: \.)?$"
)
"""What stays as it is, said at the end."""
WORDS = 12  # words of a request at most


def turns_to_swap(text: SlottedText) -> str | None:
    """Returns the two turns that a change request asks to swap; None if it asks for anything else.

    The turns are named as in plans of changes: "turn 1,3", or "turn all" for "the two turns".
    """
    said = STAYS.sub("", " ".join(word.text for word in text.words if word.written))
    if not SWAP.search(said) or MORE.search(said) or len(said.split()) > WORDS:
        return None
    found = TWO.findall(said)
    if len(found) == 1:
        one, other = (place_of(word) or int(word) for word in found[0] if word)
        return f"turn {one},{other}"
    return "turn all" if BOTH.search(said) else None
