"""Words for turns and sides in five languages, as plain words, which several rules look for."""

from roadgpt.brief.readers.model.word_set import word_set

LEFT = word_set(
    "left lefts lefthand leftward linke links linkskurven gauche izquierda sinistra l lh sx izq izda"
)
RIGHT = word_set(
    "right rights righthand rightward rechte rechts rechtskurven droite derecha destra r rh dx dcha"
)
TURNS = word_set("turns bends corners curves kurven virages tournants courbes curvas")
"""What roads have several of, when no shape is meant; Italian "curve" is English for one."""
SHAPES = word_set("hairpins switchbacks kehren tournants epingles horquillas tornanti")
"""Turns of a shape, several of them."""
ONE_TURN = word_set("turn bend curve corner hairpin switchback kurve kehre virage tournant curva")
COUNTED = TURNS | SHAPES | {"curve"}
"""What may stand behind a number."""
