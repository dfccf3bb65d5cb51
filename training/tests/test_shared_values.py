"""What is said once stands once in the plans that are learnt, and means the same."""

import pytest

from roadgpt.brief.normal import normal
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.data import with_shared_values
from roadgpt_training.pair import Pair
from tables import rows


@pytest.mark.parametrize(("text", "line", "once"), rows(__file__, "all_turns_share"))
def test_what_all_turns_share(text: str, line: str, once: str | None) -> None:
    assert with_shared_values(line, slotted(text).slots) == (once or line)


def test_the_normal_form_stays(generated: tuple[Pair, ...]) -> None:
    changed = 0
    for pair in generated:
        once = with_shared_values(pair.plan, slotted(pair.text).slots)
        if once != pair.plan:  # what is not changed has the same form
            changed += 1
            assert normal(read_plan(once)) == normal(read_plan(pair.plan))
    assert changed > 2
