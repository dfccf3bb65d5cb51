"""A surface that a change request names: the friction of the changed road, or a word not understood."""

import pytest

from edit_truth import roads
from roadgpt.brief.change import read_request
from roadgpt.errors import EditError
from roadgpt.road import World
from roadgpt_edit.editing import edit

ROAD = roads()["r01"]
DRY = World()
# friction that docs/reference/words.md gives for surfaces
WET, SNOWY, ICY = 0.6, 0.35, 0.1


@pytest.mark.parametrize(
    ("words", "friction"),
    [
        ("make the second turn sharper and make it wet", WET),
        ("make it wet and the second turn sharper", WET),
        ("make it wet", WET),
        ("make it icy", ICY),
        ("add a hairpin at the end, on a snow-covered road", SNOWY),
        ("mach die Strasse nass und die zweite Kurve enger", WET),
        ("rends la route mouillée et le dernier virage plus serré", WET),
        ("la segunda curva más cerrada y la carretera con hielo", ICY),
        ("la seconda curva più stretta e la strada bagnata", WET),
    ],
)
def test_a_surface_beside_other_wishes_sets_the_friction_and_is_said(words: str, friction: float) -> None:
    made = edit(ROAD, words, DRY)
    assert made.world.site.friction == friction
    assert any(sentence.startswith(f"friction 1 -> {friction:g}") for sentence in made.changes)
    assert not {"wet", "icy", "snow", "nass", "mouillée", "hielo", "bagnata"} & {*made.unused}
    only = words.startswith("make it") and " and " not in words
    assert (made.design == ROAD) == only


DENIED = ("the second turn sharper, dry instead of wet", "the second turn sharper, and no longer wet")


@pytest.mark.parametrize("words", DENIED)
def test_a_surface_that_is_denied_is_taken_away(words: str) -> None:
    made = edit(ROAD, words, World.model_validate({"scene": "wet", "friction": 0.6}))
    assert made.world == World.model_validate({"scene": "", "friction": 1.0})
    assert made.design != ROAD


@pytest.mark.parametrize("words", DENIED)
def test_a_surface_that_the_road_does_not_have_is_not_taken_away(words: str) -> None:
    with pytest.raises(EditError, match="has no wet road to remove"):
        edit(ROAD, words, DRY)


def test_messages_about_words_have_no_syntax_of_plans() -> None:
    with pytest.raises(EditError) as caught:
        edit(roads()["h01"], read_request("the first turn to the left"), DRY)
    assert str(caught.value) == "nothing is to be changed: 'turn 1 to the left' is so already"
