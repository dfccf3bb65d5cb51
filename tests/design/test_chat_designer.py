"""The chat designer, with a model that has its answers written down."""

import json
from collections.abc import Sequence

import pytest

from fake_chat import FakeChat
from planned import planned
from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.chat import BudgetError, ChatSettings, Message, RefusedError, UnparsableError
from roadgpt.design.asking import demands, drawn_start, objections, request, rules
from roadgpt.design.designers.chat import ChatDesigner
from roadgpt.errors import DesignError
from roadgpt.road import Design, Limits, Site, World, build, read_design

WORLD = World()
SIDES = {1: "left", -1: "right", 0: "straight"}


def answer(*segments: tuple, start: Sequence[float] = (60, 125, 0), theta: float = 0, **more) -> str:
    """An answer with segments given as (metres, degrees, percent)."""
    made = [
        {"distance": d, "direction": SIDES[(t > 0) - (t < 0)], "incline": g, "turn_degrees": t}
        for d, t, g in segments
    ]
    return json.dumps({"starting_point": list(start), "theta": theta, "segments": made, **more})


def step(d: float, t: float, g: float, last: bool = False) -> str:
    side = SIDES[(t > 0) - (t < 0)]
    return json.dumps({"distance": d, "direction": side, "incline": g, "turn_degrees": t, "last": last})


def start(x: float = 60, y: float = 125, theta: float = 0) -> str:
    return json.dumps({"starting_point": [x, y, 0], "theta": theta})


THREE_TURNS = answer((40, 0, 0), (40, 50, 0), (20, 0, 0), (40, -60, 0), (20, 0, 0), (40, 40, 0))
TWO_TURNS = answer((40, 0, 0), (40, 50, 0), (20, 0, 0), (40, -60, 0))
BRIEF = planned("turn x3", "a road with 3 turns")


def drafted(chat: FakeChat, brief: Brief = BRIEF, earlier: Sequence[Design] = (), **settings):
    designer = ChatDesigner(ChatSettings(**settings), chat)
    design = designer.draft(brief, WORLD, (), earlier, 7)
    return design, designer.report


def is_fine(design: Design, brief: Brief = BRIEF) -> bool:
    return check.inspect(build(design), brief, WORLD) == ()


def test_a_good_answer_is_taken_as_it_is() -> None:
    chat = FakeChat(THREE_TURNS)
    design, report = drafted(chat)
    assert is_fine(design)
    assert [s.turn_degrees for s in design.segments] == [0, 50, 0, -60, 0, 40]
    assert report.rounds == 1
    assert report.changes == ()
    assert report.proposed == design.to_json()
    assert (report.tokens.prompt, report.tokens.completion) == (100, 20)
    assert (report.seconds, report.cost, report.model) == (0.5, 0.001, "fake-1")


def test_the_model_is_told_the_rules_the_words_and_what_they_promise() -> None:
    chat = FakeChat(THREE_TURNS)
    drafted(chat)
    system, user = chat.asked[0]
    assert (system.role, user.role) == ("system", "user")
    assert "from 0 to 250 m" in system.text
    assert "14.3 m" in system.text
    assert "a road with 3 turns" in user.text
    assert "3 turns" in user.text.split("It must show:")[1]


def test_violations_go_back_as_sentences_and_every_round_is_counted() -> None:
    chat = FakeChat(TWO_TURNS, THREE_TURNS)
    design, report = drafted(chat)
    assert is_fine(design)
    assert report.rounds == 2
    assert "- turn count is 2, asked for 3" in chat.questions[1]
    assert json.loads(chat.asked[1][-2].text)["segments"][1]["turn_degrees"] == 50
    assert report.tokens.prompt == 200


def test_without_repair_every_fault_of_the_proposal_is_told() -> None:
    bad = answer((40, 0, 17), (12, 60, 0), (30, 0, -16), (40, -60, 0), (200, 0, 0), (40, 40, 0))
    chat = FakeChat(bad, THREE_TURNS)
    _, report = drafted(chat, repair="none")
    told = chat.questions[1]
    assert "- segment 1: grade 17 % > 15 %" in told
    assert "- segment 3: grade -16 % < -15 %" in told
    assert "- segment 2: radius" in told
    assert "leaves the map at (" in told
    assert report.rounds == 2


def test_a_place_outside_the_map_is_named() -> None:
    design, _ = read_design(json.loads(numbered((200, 0, 0), start=[100, 35, 0])))
    (said,) = objections(design, None, WORLD)
    assert said in {f"segment 1: leaves the map at (250, {y}); x and y run from 0 to 250 m" for y in (31, 39)}


def numbered(*segments: tuple, **more) -> str:
    """RoadGPT's own format."""
    plain = json.loads(answer(*segments, **more))
    named = {f"road_segment{i}": s for i, s in enumerate(plain.pop("segments"), 1)}
    return json.dumps({**plain, **named})


def test_roadgpt_s_numbered_segments_are_read_as_well() -> None:
    text = numbered((40, 0, 0), (40, 50, 0), (20, 0, 0), (40, -60, 0), (20, 0, 0), (40, 40, 0))
    design, report = drafted(FakeChat(text))
    assert is_fine(design)
    assert report.rounds == 1


def test_repair_moves_what_lies_outside_and_the_changes_are_told() -> None:
    far = json.dumps({**json.loads(THREE_TURNS), "starting_point": [240, 20, 0]})
    design, report = drafted(FakeChat(far), repair="place")
    assert is_fine(design)
    assert report.rounds == 1
    assert report.changes[0].startswith("start moved from (240, 20) to (")
    assert report.proposed["starting_point"] == [240, 20, 0]


def test_after_the_last_round_the_best_proposal_is_handed_over_with_its_faults() -> None:
    one_turn = answer((40, 0, 0), (40, 50, 0))
    steep = answer((40, 0, 25), (40, 50, 0), (40, 0, -25))
    chat = FakeChat(steep, one_turn, steep)
    design, report = drafted(chat, rounds=3, repair="none")
    assert report.rounds == len(chat.asked) == 3
    assert len(design.segments) == 2
    assert not is_fine(design)


def test_the_number_of_rounds_is_kept() -> None:
    chat = FakeChat(TWO_TURNS)
    for rounds in (1, 4):
        chat.asked.clear()
        assert drafted(chat, rounds=rounds)[1].rounds == rounds == len(chat.asked)


def test_an_answer_that_cannot_be_read_goes_back_with_the_reason() -> None:
    chat = FakeChat("I would rather not say.", THREE_TURNS)
    design, report = drafted(chat)
    assert is_fine(design)
    assert report.rounds == 2
    assert "could not be read" in chat.questions[1]


@pytest.mark.parametrize(
    "line",
    [
        "no JSON at all",
        answer(),
        answer((1e9, 0, 0)),
        answer((40, 0, 300)),
        answer((40, 720, 0)),
        answer((-40, 0, 0)),
        answer(*[(10, 0, 0)] * 501),
        answer((40, 0, 0), start=(1e9, 0, 0)),
        answer((40, 0, 0), start=(10,)),
        answer(*[(99_000, 0, 0)] * 3),
    ],
)
def test_answers_that_are_no_road_end_in_one_sentence(line: str) -> None:
    chat = FakeChat(line)
    with pytest.raises((UnparsableError, DesignError), match=r"^[^\n]+$"):
        drafted(chat)
    assert len(chat.asked) == 3


def test_a_refusal_ends_the_draft_unless_there_is_a_road_already() -> None:
    with pytest.raises(RefusedError):
        drafted(FakeChat(RefusedError("the model declines")))
    design, report = drafted(FakeChat(TWO_TURNS, RefusedError("the model declines")))
    assert len(design.segments) == 4
    assert report.rounds == 2


@pytest.mark.parametrize("strategy", ["whole", "stepwise"])
def test_a_spent_budget_is_passed_on(strategy: str) -> None:
    with pytest.raises(BudgetError):
        drafted(FakeChat(BudgetError("the limit is reached")), strategy=strategy)


def test_earlier_roads_are_told_and_not_repeated() -> None:
    first, _ = drafted(FakeChat(THREE_TURNS))
    other = answer((30, 0, 0), (60, -70, 0), (40, 0, 0), (30, 50, 0), (50, 0, 0), (60, 60, 0))
    chat = FakeChat(THREE_TURNS, other)
    design, report = drafted(chat, earlier=[first])
    assert "start (60, 125), theta 0: 40 m straight, left 50" in chat.questions[0]
    assert "like an earlier one" in chat.questions[1]
    assert report.rounds == 2
    assert design.segments[1].turn_degrees == -70


def test_the_start_to_think_of_changes_with_the_seed_and_only_with_it() -> None:
    starts = {drawn_start(WORLD, seed) for seed in range(20)}
    assert len(starts) == 20
    assert drawn_start(WORLD, 3) == drawn_start(WORLD, 3)
    assert request(BRIEF, WORLD, (), (), 3) == request(BRIEF, WORLD, (), (), 3)


def test_notes_of_rules_are_told() -> None:
    assert "- at s = 3 m: too steep" in request(BRIEF, WORLD, ("at s = 3 m: too steep",), (), 0)


def test_model_text_is_data() -> None:
    """Braces, format fields and paths in an answer or a description go nowhere but into the conversation."""
    evil = answer((40, 0, 0), (40, 50, 0), comment="{0.__class__} ../../etc/passwd %s {settings}")
    chat = FakeChat(evil, THREE_TURNS)
    brief = BRIEF.model_copy(update={"words": "a road {0.__class__} with 3 turns {map_size}"})
    drafted(chat, brief)
    assert "{0.__class__} with 3 turns {map_size}" in chat.questions[0]
    assert all("etc/passwd" not in message.text for message in chat.asked[1])


@pytest.mark.parametrize(
    "line", ["| turns=1..", "straight | flat turns=0", "turn x2; straight up; hairpin | len=300"]
)
def test_demands_have_no_odd_words(line: str) -> None:
    text = "\n".join(demands(outline(planned(line), WORLD.site.map_size)))
    assert not {"inf", "None", "nan", "-inf"} & {*text.replace(":", " ").split()}


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("s_bend", "in this order: 2 S-bend turns: "),
        ("serpentine", "in this order: 4 or more serpentine turns: "),
        ("hairpin x2", "in this order: 2 hairpins: "),
        ("hairpin left", "in this order: 1 hairpin: to the left, "),
        ("straight | turns=0", "in this order: 1 straight: 10 or more m long"),
        ("| up turns=1.. climb=20", "a climb of 17 to 23 m"),
        ("turn x3 | rights=..2", "0 to 2 right turns"),
        ("| flat turns=1..", "the whole road is level (mean slope -1 to 1 %)"),
    ],
)
def test_demands_in_words(line: str, told: str) -> None:
    demanded = demands(outline(planned(line), WORLD.site.map_size))
    assert any(line.startswith(told) for line in demanded), demanded


@pytest.mark.parametrize("name", ["chat_rules.txt", "thesis_rules.txt"])
def test_the_rules_are_filled_in_for_every_world(name: str) -> None:
    text = rules(name, World(site=Site(map_size=400), limits=Limits(max_grade=0.1)))
    assert "{map_size}" not in text
    assert "400" in text or "320" in text


def test_step_by_step_one_segment_per_question() -> None:
    steps = [step(40, 0, 0), step(40, 50, 0), step(20, 0, 0), step(40, -60, 0), step(20, 0, 0)]
    chat = FakeChat(start(), *steps, step(40, 40, 0, True))
    design, report = drafted(chat, strategy="stepwise")
    assert is_fine(design)
    assert report.rounds == len(chat.asked) == 7
    assert "4. 40 m right, turn -60" in chat.questions[5]
    assert len(design.segments) == 6


def test_step_by_step_a_segment_that_will_not_do_is_asked_for_again() -> None:
    chat = FakeChat(
        start(), step(40, 0, 0), step(40, 0, 30), step(40, 50, 0), step(40, -60, 0), step(40, 60, 0, True)
    )
    design, report = drafted(chat, strategy="stepwise", repair="none")
    assert "- segment 2: grade 30 % > 15 %" in chat.questions[3]
    assert is_fine(design)
    assert report.rounds == 6
    assert report.changes == ()


def test_step_by_step_a_segment_that_never_does_is_left_out_and_the_run_goes_on() -> None:
    crazy = step(40, 0, 200)
    chat = FakeChat(start(), step(60, 0, 0), crazy, crazy, crazy, step(40, 50, 0), crazy)
    design, report = drafted(chat, strategy="stepwise", repair="none", rounds=3)
    assert len(design.segments) == 2
    assert report.changes[0].startswith("segment 2 was left out: ")
    assert len(chat.asked) < 20


def test_step_by_step_the_end_is_looked_at_before_it_is_one() -> None:
    steps = [step(40, 0, 0), step(40, 50, 0), step(40, -60, 0, True), step(40, 40, 0, True)]
    chat = FakeChat(start(), *steps)
    design, _ = drafted(chat, strategy="stepwise")
    assert is_fine(design)
    assert "turn count is 2, asked for 3" in chat.questions[4]


def test_step_by_step_a_turn_too_many_is_taken_back() -> None:
    steps = [step(40, 40, 0), step(40, -40, 0), step(40, 40, 0), step(40, -40, 0, True)]
    design, report = drafted(FakeChat(start(30, 125), *steps), strategy="stepwise")
    assert is_fine(design)
    assert any(change.startswith("segment 4 was taken back") for change in report.changes)


@pytest.mark.parametrize(
    "lines", [["rubbish"], [start(), "rubbish"], [RefusedError("no")], [start(), RefusedError("no")]]
)
def test_step_by_step_no_segment_at_all_is_one_sentence(lines: list) -> None:
    chat = FakeChat(*lines)
    with pytest.raises((UnparsableError, DesignError, RefusedError)):
        drafted(chat, strategy="stepwise")
    assert len(chat.asked) <= 8


def test_step_by_step_any_number_of_segments() -> None:
    def wave(messages: Sequence[Message]) -> str:
        number = messages[-1].text.count(" m left") + messages[-1].text.count(" m right")
        return step(8, 12 if number % 2 else -12, 0, last=number == 24)

    design, _ = drafted(FakeChat(start(20, 125), wave), Brief(), strategy="stepwise", repair="none")
    assert len(design.segments) == 25
