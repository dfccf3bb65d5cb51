"""Plans of changes: they say all that a request says, and make the same road."""

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edit_truth import requests, roads
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.change.request import Change, EditRequest, Place, Target, Way
from roadgpt.check.measures import measure
from roadgpt.errors import EditError
from roadgpt.language.names import Sharpness, Side
from roadgpt.road import World, build
from roadgpt_edit.editing import edit
from tables import rows

STORED = rows(__file__, "stored")
PAGE = Path(__file__).parents[2] / "docs" / "reference" / "plans.md"
WORLD = World()
KNOWN = roads()


SIDES: st.SearchStrategy[Side] = st.sampled_from(["left", "right"])
SHARPNESS: st.SearchStrategy[Sharpness] = st.sampled_from(["gentle", "sweeping", "sharp"])
SLOPING: st.SearchStrategy[Way] = st.sampled_from(["up", "down"])
WAYS: st.SearchStrategy[Way] = SLOPING | st.just("flat")
NUMBERS = st.integers(1, 4000).map(lambda n: n / 20)
PLACED = st.deferred(lambda: PLACES)
TARGETS = st.deferred(
    lambda: (
        st.builds(
            Target,
            noun=st.sampled_from(["turn", "straight", "start", "end", "road"]),
            numbers=st.lists(st.integers(1, 9) | st.integers(-3, -1), max_size=3).map(tuple),
            every=st.booleans(),
            middle=st.booleans(),
            most=st.none() | st.tuples(st.sampled_from(["sharp", "long", "steep"]), st.sampled_from([1, -1])),
            count=st.none() | st.integers(1, 9),
            side=st.none() | SIDES,
            sharpness=st.none() | SHARPNESS,
            way=st.none() | WAYS,
            size=st.none() | st.sampled_from(["long", "short"]),
            degrees=st.none() | NUMBERS,
            length=st.none() | NUMBERS,
            half=st.none() | st.sampled_from([1, 2]),
            place=st.none() | PLACED,
            but=st.none() | TARGETS,
        )
        | st.builds(Target, noun=st.just("turn"), kind=st.sampled_from(["hairpin", "u_turn", "s_bend"]))
    )
)
PLACES = (
    st.builds(Place, st.sampled_from(["after", "before", "from", "up_to", "on"]), TARGETS)
    | st.builds(Place, st.just("between"), TARGETS, TARGETS)
    | st.builds(Place, st.sampled_from(["start", "end", "middle"]))
)
MEASURED = st.sampled_from(["angle", "radius", "length", "slope"])
CHANGES = (
    st.builds(Change, MEASURED, TARGETS, to=NUMBERS, bound=st.sampled_from([-1, 0, 1]))
    | st.builds(Change, MEASURED, TARGETS, by=NUMBERS, more=st.sampled_from([-1, 1]))
    | st.builds(Change, MEASURED, TARGETS, times=NUMBERS)
    | st.builds(
        Change, MEASURED, TARGETS, more=st.sampled_from([-1, 1]), dose=st.sampled_from([0.5, 1.0, 1.8])
    )
    | st.builds(Change, st.just("slope"), TARGETS, way=SLOPING, to=st.none() | NUMBERS)
    | st.builds(Change, st.just("slope"), TARGETS, way=st.just("flat"))
    | st.builds(Change, st.just("side"), TARGETS, side=st.none() | SIDES)
    | st.builds(Change, st.just("shape"), TARGETS, kind=st.just("hairpin"), sharpness=st.none() | SHARPNESS)
    | st.builds(Change, st.sampled_from(["straighten", "remove", "alternate"]), TARGETS)
    | st.builds(
        Change,
        st.just("add"),
        st.just(Target("turn")),
        side=st.none() | SIDES,
        kind=st.none() | st.sampled_from(["hairpin", "s_bend"]),
        sharpness=st.none() | SHARPNESS,
        count=st.integers(1, 4),
        way=st.none() | WAYS,
        place=st.none() | PLACES.filter(lambda place: place.how not in ("from", "up_to")),
        degrees=st.none() | NUMBERS,
        radius=st.none() | NUMBERS,
        grade=st.none() | NUMBERS.map(lambda n: -n),
        is_whole=st.booleans(),
    )
)


def without_words(text: str) -> str:
    """The same value without the texts that messages quote."""
    return re.sub(r"words='[^']*'", "words=''", text)


@given(st.lists(CHANGES, min_size=1, max_size=3))
def test_a_plan_says_all_of_a_request(changes: list[Change]) -> None:
    request = EditRequest("", tuple(changes))
    line = change_plan(request)
    again = read_change_plan(line)
    assert without_words(repr(again.changes)) == without_words(repr(request.changes)), line
    assert change_plan(again) == line


@pytest.mark.parametrize(
    ("line", "told"),
    rows(__file__, "what_is_no_change_is_refused_in_one_sentence"),
)
def test_what_is_no_change_is_refused_in_one_sentence(line: str, told: str) -> None:
    with pytest.raises(EditError, match=told) as refusal:
        read_change_plan(line)
    assert "\n" not in str(refusal.value)


@given(st.text(alphabet="turn 12:;,().=x-+abdeghilmorsw", max_size=60))
def test_any_text_is_a_plan_or_refused(line: str) -> None:
    try:
        request = read_change_plan(line)
    except EditError:
        return
    assert read_change_plan(change_plan(request))


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("add crest on(straight 1)", r"a crest needs a straight of 40 m or more; there are \d+ m"),
        ("add serpentine", "'serpentine' cannot be added"),
        ("add turn x40", "40 turns at once are too many"),
        ("s_bend: remove", "'s_bend' cannot be told apart"),
        ("road between(turn 1, turn 1): alternate", "there is no turn at that place"),
    ],
)
def test_what_cannot_be_done_is_refused_and_not_taken_for_something_else(line: str, told: str) -> None:
    with pytest.raises(EditError, match=told):
        edit(KNOWN["r01"], read_change_plan(line), WORLD)


def test_a_range_of_the_road_includes_what_it_is_counted_from() -> None:
    old = KNOWN["r01"]
    before = measure(build(old).sample().points)

    def radii(line: str) -> list[float]:
        found = measure(build(edit(old, read_change_plan(line), WORLD).design).sample().points)
        return [new.radius / was.radius for new, was in zip(found.turns, before.turns, strict=True)]

    assert radii("turn all from(turn 2): radius x1.3") == pytest.approx([1, 1.3, 1.3], rel=0.05)
    assert radii("turn all up_to(turn 2): radius x1.3") == pytest.approx([1.3, 1.3, 1], rel=0.05)
    assert radii("turn all after(turn 2): radius x1.3") == pytest.approx([1, 1, 1.3], rel=0.05)


IN_DOCS = [
    line
    for block in PAGE.read_text(encoding="utf-8").split("```change\n")[1:]
    for line in block.split("```")[0].splitlines()
]


@pytest.mark.parametrize("line", sorted({*STORED, *IN_DOCS, *(row["plan"] for row in requests())} - {"!"}))
def test_the_plan_of_a_request_is_written_as_it_was_read(line: str) -> None:
    assert change_plan(read_change_plan(line)) == line
