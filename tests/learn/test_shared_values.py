"""What is said once stands once in the plans that are learnt, and means the same."""

import pytest

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.learn.data import with_shared_values
from roadgpt.learn.pair import Pair


@pytest.mark.parametrize(
    ("text", "line", "once"),
    [
        ("left, right, both of 40 degrees", "turn left deg=40; turn right deg=40",
         "turn left; turn right | deg=40"),
        ("left 40 degrees, right 40 degrees", "turn left deg=40; turn right deg=40", None),
        ("left, 30 m, right, R 25 each", "turn left r=25; straight len=30; turn right r=25",
         "turn left; straight len=30; turn right | r=25"),
        ("three turns of 40 degrees", "turn x3 deg=40", None),
        ("left R 20, right R 30", "turn left r=20; turn right r=30", None),
        ("one two three", "!nonsense", None),
    ],
)  # fmt: skip
def test_what_all_turns_share(text: str, line: str, once: str | None) -> None:
    assert with_shared_values(line, slotted(text).slots) == (once or line)


def test_the_normal_form_stays(generated: tuple[Pair, ...]) -> None:
    changed = 0
    for pair in generated:
        once = with_shared_values(pair.plan, slotted(pair.text).slots)
        if once != pair.plan:  # what is not changed has the same form
            changed += 1
            assert normal(read_plan(once)) == normal(read_plan(pair.plan))
    assert changed > 5
