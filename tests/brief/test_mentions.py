"""What a text names and tells, and a plan has not, is named as not used; nothing else is."""

import pytest

from roadgpt.brief import read, sentence
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.mentions import unnamed_in, unused_in
from roadgpt.brief.scenarios import scenario, scenarios


def test_the_sentence_of_a_scenario_names_nothing_that_its_plan_lacks() -> None:
    missing = {}
    for name in scenarios():
        brief = read_plan(scenario(name).plan)
        missing[name] = unused_in(brief, sentence(brief))
    assert len(missing) > 100
    assert not any(missing.values())


@pytest.mark.parametrize(
    ("words", "line", "named"),
    [
        ("A van ran into the back of our car.", "straight && van behind", {"ran into"}),
        ("A van ran into the back of our car.", "straight && van behind hits=rear", set()),
        ("There was no contact with the van.", "straight && van behind", set()),
        ("Le camion freine, puis double le cycliste.", "straight && truck ahead: brake", {"cycliste"}),
        ("Le camion freine.", "straight && truck ahead", {"freine"}),
        ("Der Bus bremst vor der Ampel.", "straight && bus ahead: brake", {"Ampel"}),
        ("Der Bus bremst vor der Ampel.", "crossroads lights && bus ahead: brake", set()),
        ("El coche se detuvo en la intersección.", "straight", {"se detuvo", "intersección"}),
        ("Al semaforo il furgone sorpassa.", "crossroads lights && van lane left", {"sorpassa"}),
        ("She stopped at the stop sign.", "crossroads stop && ego: stop before junction 1", set()),
        ("The taxi made a three-point turn near a crosswalk.", "straight", {"three-point turn", "crosswalk"}),
        ("No roadworks, and without a crosswalk", "straight", set()),
    ],
)
def test_deeds_and_places_are_found_in_a_plan_or_named(words: str, line: str, named: set[str]) -> None:
    assert {*unused_in(read_plan(line), words)} == named


def test_the_reader_names_what_its_plan_does_not_tell() -> None:
    brief = read(
        "On a straight road the tested car reverses, and a bicycle on the right hits it. No fog.",
        map_size=None,
    )
    told = " ".join(brief.unused)
    deeds = {each.what for role in (brief.scene, *brief.scene.actors) for each in role.actions}
    assert ("reverses" in told) == ("reverse" not in deeds)
    assert ("hits" in told) == (not any(actor.hits for actor in brief.scene.actors))
    assert "fog" not in told


@pytest.mark.parametrize(
    ("words", "line", "named"),
    [
        (
            "An ambulance comes from the right.",
            "crossroads && ambulance junction right; adult crossing left",
            ["adult"],
        ),
        ("A pedestrian crosses.", "straight && adult crossing left; car ahead", []),
        (
            "The car in front brakes, then something falls.",
            "straight && car ahead; lost_load ahead",
            ["lost load"],
        ),
        ("Un camion suit le bus.", "straight && truck behind; bus ahead", []),
    ],
)
def test_who_is_in_a_scene_and_in_no_word_is_told(words: str, line: str, named: list[str]) -> None:
    brief = read_plan(line).model_copy(update={"words": words})
    assert unnamed_in(brief) == named
