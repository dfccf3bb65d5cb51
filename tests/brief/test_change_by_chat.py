"""Change requests read by a language model: whatever it answers, a valid plan or a sentence comes of it."""

import json

import pytest

from fake_chat import FakeChat
from roadgpt.brief.change import EditRequest, read_request
from roadgpt.brief.change.chatting import EXAMPLES
from roadgpt.brief.change.plan import change_plan
from roadgpt.chat import ChatSettings
from roadgpt.errors import EditError


def answer(*changes: str, unused: tuple[str, ...] = ()) -> str:
    road, _, scene = "; ".join(changes).partition(" && ")
    return json.dumps({"changes": [road], "scene": [scene] if scene else [], "unused": unused})


def request(chat: FakeChat, words: str = "make the second turn sharper", rounds: int = 3) -> EditRequest:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("roadgpt.brief.change.chatting.open_chat", lambda _: chat)
        return read_request(words, ChatSettings(rounds=rounds))


def test_a_good_answer_is_taken_and_the_words_stand_last_in_the_question() -> None:
    chat = FakeChat(answer("turn 2: angle more", "end: slope down"))
    made = request(chat)
    assert change_plan(made) == "turn 2: angle more; end: slope down"
    assert made.words == "make the second turn sharper"
    assert chat.questions == ["make the second turn sharper"]


def test_what_is_wrong_goes_back_and_the_next_answer_counts() -> None:
    chat = FakeChat(answer("turn 2: colour blue"), answer("turn 2: angle more"))
    assert change_plan(request(chat)) == "turn 2: angle more"
    assert "'colour' is not expected" in chat.questions[1]


@pytest.mark.parametrize(
    "bad", [answer(), answer("turn 2: colour blue"), answer("turn: x3", "add hairpin"), answer("x" * 5000)]
)
def test_it_ends_after_its_rounds_with_the_reason(bad: str) -> None:
    chat = FakeChat(bad)
    with pytest.raises(EditError, match="the language model's plan cannot be used: "):
        request(chat, rounds=2)
    assert len(chat.questions) == 2


def test_words_that_the_model_made_up_are_not_called_unused() -> None:
    made = request(FakeChat(answer("turn 2: angle more", unused=("pronto", "banana"))), "sharper, pronto")
    assert made.unused == ("pronto",)


def test_a_surface_is_read_with_the_model_too() -> None:
    both = request(FakeChat(answer("turn 2: angle more")), "sharpen the second turn and make it wet")
    alone = request(FakeChat(answer()), "make it icy")
    denied = request(FakeChat(answer("turn 2: angle more")), "sharpen the second turn, but not wet")
    assert (both.surface, both.unused) == ("wet", ())
    assert (alone.surface, alone.changes) == ("ice", ())
    assert (denied.surface, denied.unused) == ("", ("wet",))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example[0][:20])
def test_the_examples_in_the_prompt_are_plans(example: tuple[str, str]) -> None:
    told = json.loads(example[1])
    made = request(FakeChat(example[1]), example[0], rounds=1)
    assert (len(made.changes), len(made.scene)) == (len(told["changes"]), len(told["scene"]))
    assert all(word in example[0] for word in told["unused"])
