"""Words for turns, left and right in five languages, in lower case without accents."""

from roadgpt.brief.readers.model.word_set import word_set

LEFT = word_set(
    "left lefts lefthand leftward linke links linkskurven gauche izquierda sinistra l lh sx izq izda"
)
RIGHT = word_set(
    "right rights righthand rightward rechte rechts rechtskurven droite derecha destra r rh dx dcha"
)
TURNS = word_set("turns bends corners curves kurven virages tournants courbes curvas")
"""Plural nouns for turns in general; Italian "curve" is left out, since it is singular in English."""
SHAPES = word_set("hairpins switchbacks kehren tournants epingles horquillas tornanti")
"""Plural nouns for turns of a particular shape."""
ONE_TURN = word_set("turn bend curve corner hairpin switchback kurve kehre virage tournant curva")
COUNTED = TURNS | SHAPES | {"curve"}
"""Nouns that a number can count."""
