"""The thesis' own method: one question, no repair, spline geometry."""

import json

import pytest

from fake_chat import FakeChat
from planned import planned
from roadgpt import check
from roadgpt.chat import ChatError, ChatSettings, UnparsableError
from roadgpt.design.designers.thesis import ThesisDesigner
from roadgpt.errors import ReplyError
from roadgpt.road import World, build

WORLD = World()
EXAMPLE = {  # the example of the thesis, whose left turn has a negative angle
    "starting_point": [50, 30, 0],
    "theta": 90,
    "road_segment1": {"distance": 50, "direction": "right", "incline": 5, "turn_degrees": -40},
    "road_segment2": {"distance": 40, "direction": "left", "incline": 3, "turn_degrees": -20},
    "road_segment3": {"distance": 30, "direction": "straight", "incline": 2, "turn_degrees": 0},
}


def drafted(*lines):
    chat = FakeChat(*lines)
    designer = ThesisDesigner(ChatSettings(rounds=3), chat)
    return designer.draft(planned("turn x3", "a road with 3 turns"), WORLD, ("note",), (), 7), designer, chat


def test_one_question_and_nothing_is_repaired() -> None:
    outside = {**EXAMPLE, "starting_point": [240, 240, 0]}
    design, designer, chat = drafted(json.dumps(outside))
    assert len(chat.asked) == 1
    assert chat.questions == ["a road with 3 turns"]
    assert design.starting_point == (240, 240, 0)
    assert designer.report.rounds == 1
    assert {finding.rule for finding in check.inspect(build(design, "spline"), None, WORLD)} >= {"inside_map"}


def test_the_direction_wins_over_the_sign_and_that_is_told() -> None:
    design, designer, _ = drafted(json.dumps(EXAMPLE))
    assert [s.turn_degrees for s in design.segments] == [-40, 20, 0]
    assert designer.report.changes == (
        "segment 2: direction 'left' and turn_degrees -20 disagree; the direction wins: 20",
    )


@pytest.mark.parametrize(
    "line",
    [
        "{'starting_point': (1, 2, 3), 'theta': __import__('os').system('true')}",
        json.dumps({**EXAMPLE, "road_segment1": {"distance": "far"}}),
        json.dumps({"starting_point": [1, 2, 3], "theta": 0}),
        "[1, 2, 3]",
        "",
    ],
)
def test_an_answer_that_is_no_design_is_one_sentence_and_not_run(line: str) -> None:
    with pytest.raises(UnparsableError, match=r"^the answer of the model is no road: ") as caught:
        drafted(line)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ReplyError)
    assert isinstance(caught.value, ChatError)
