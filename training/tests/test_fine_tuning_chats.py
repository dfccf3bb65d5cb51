"""Chats for larger models: an answer for each description, in the words of the reader where it refuses."""

import json

from roadgpt.brief.refusal import refused
from roadgpt.road import World
from roadgpt_training.fine_tuning_chats import brief_chats, design_chats
from roadgpt_training.pair import Pair

PAIRS = [
    Pair("a left bend", "turn left", "f", "en"),
    Pair("hello", "!nonsense", "f", "en"),
    Pair("a bend with a grade of 40 %", "!impossible grade", "f", "en"),
]


def test_a_refusal_is_answered_with_its_sentence() -> None:
    chats = [json.loads(line)["messages"] for line in brief_chats(PAIRS)]
    assert [chat[1]["content"] for chat in chats] == [pair.text for pair in PAIRS]
    answers = [chat[2]["content"] for chat in chats]
    assert json.loads(answers[0])["clauses"][0]["side"] == "left"
    assert answers[1:] == [str(refused(pair.plan)) for pair in PAIRS[1:]]


def test_a_refusal_has_no_road() -> None:
    (chat,) = design_chats(PAIRS, World(), 1)
    assert "road_segment1" in json.loads(chat)["messages"][2]["content"]
