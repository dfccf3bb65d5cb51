"""Things beside the road that are added to descriptions: named in the plan if said, and not if denied."""

import numpy as np

from roadgpt.brief.beside import BESIDE
from roadgpt.brief.plan import plan, read_plan
from roadgpt_training.mentions import DENIED, SAID, TALK, names_in, with_mention, with_names, with_talk
from roadgpt_training.pair import Pair

LANGUAGES = {"en", "de", "fr", "es", "it"}


PARTS_OF_ROUTES = {"junction", "crossroads", "roundabout", "merge", "exit", "lane_change"}


def test_every_name_has_words_in_five_languages() -> None:
    assert {*SAID} == {*DENIED} == LANGUAGES
    for table in SAID.values():
        named = {name for names in table for name in names.split(", ")}
        assert BESIDE - named == {*PARTS_OF_ROUTES, "traffic_light", "lanes"}
    for table in (*SAID.values(), *DENIED.values()):
        for names, phrases in table.items():
            assert {*names.split(", ")} <= BESIDE
            assert phrases["after"], names
            assert {*phrases} == {"before", "after"}


def test_the_flag_alike_is_kept_once() -> None:
    assert names_in("turn x3 | alike beside(rain)") == ["rain", "alike"]
    assert with_names("turn x3 | alike", ["rain", "alike"]) == plan(read_plan("turn x3 | alike beside(rain)"))
    rng = np.random.default_rng(1)
    for _ in range(400):
        made = with_mention(Pair("three equal turns", "turn x3 | alike", "f", "en"), rng)
        assert made is None or read_plan(made.plan).alike


def test_what_is_said_is_named_and_what_is_denied_is_not() -> None:
    rng = np.random.default_rng(4)
    named = denied = 0
    for _ in range(1500):
        language = sorted(LANGUAGES)[int(rng.integers(5))]
        found = with_mention(Pair("two bends", "turn x2 | up", "f", language), rng)
        assert found is not None
        text, line = found.text, found.plan
        assert "two bends" in text.lower()
        assert "{" not in text
        if line == "turn x2 | up":
            denied += 1
        else:
            named += 1
            brief = read_plan(line)
            assert brief.model_copy(update={"beside": (), "alike": False}) == read_plan("turn x2 | up")
            assert plan(brief) == line
    assert named > 900
    assert denied > 300


def test_what_is_named_on_a_route_stands_behind_two_bars_and_no_junction_is_denied() -> None:
    rng = np.random.default_rng(7)
    route = "turn left // crossroads straight"
    for language in sorted(LANGUAGES):
        for _ in range(200):
            found = with_mention(Pair("a left, then a crossroads", route, "f", language), rng)
            assert found is not None
            text, line = found.text, found.plan
            if line == route:
                assert not {"junctions", "Kreuzung", "roundabout", "rond-point", "rotonda"} & {*text.split()}
            else:
                brief = read_plan(line)
                assert brief.beside
                assert not PARTS_OF_ROUTES & {*brief.beside}
                assert brief.model_copy(update={"beside": ()}) == read_plan(route)


def test_talk_stands_around_the_text_and_leaves_it_whole() -> None:
    assert {*TALK} == LANGUAGES
    rng = np.random.default_rng(6)
    places = set()
    for language in sorted(LANGUAGES):
        for _ in range(60):
            text = with_talk("two sharp bends", language, rng)
            at = text.lower().index("two sharp bends")
            places.add((at > 0, not text.lower().endswith("two sharp bends")))
    assert places == {(True, False), (False, True), (True, True)}
