"""Limits of tokens and money: never passed, whoever is under way, and not given up while money is left."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaign.quick import Inline, made, plan, put_on_shelves
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import Cell
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.single_test import FinishedTest, OutOfAllowance, Task
from roadgpt.campaign.status import status_of
from roadgpt.chat import ChatSettings, Spent, Usage
from roadgpt.errors import BudgetError
from roadgpt.road import Design

PRICE, TOKENS = 0.002, 100  # of one question


def paid(task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedTest | OutOfAllowance:
    """A test that asks one to three questions, each only while there is room for it."""
    asked = 0
    tokens, cost = task.allowance
    for _ in range(1 + task.number % 3):
        enough = (tokens is None or (asked + 1) * TOKENS <= tokens) and (
            cost is None or (asked + 1) * PRICE <= cost + 1e-12
        )
        if not enough:
            return OutOfAllowance(spent(asked))
        asked += 1
    return FinishedTest(made(task, cell, *earlier).result, spent=spent(asked))


def spent(questions: int) -> Spent:
    return Spent(calls=questions, usage=Usage(prompt=TOKENS * questions), cost=PRICE * questions)


def with_limits(there: Plan, **limits: float | None) -> Plan:
    return there.model_copy(update={"chat": ChatSettings.model_validate(limits)})


@settings(max_examples=8)
@given(
    order=st.integers(0, 1000),
    questions=st.integers(1, 70),
    by_tokens=st.booleans(),
    workers=st.integers(1, 9),
)
def test_a_limit_is_never_passed_and_hardly_anything_is_left(
    order: int, questions: int, by_tokens: bool, workers: int
) -> None:
    limit = {"max_tokens": TOKENS * questions} if by_tokens else {"max_cost": PRICE * questions}
    with TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
        put_on_shelves(patch.setattr)
        patch.setattr(Store, "run_test", staticmethod(paid))
        Inline.rng = np.random.default_rng(order)
        folder = Path(name) / "c"
        begin(with_limits(plan(30), **limit), folder)
        needed = sum(1 + number % 3 for number in range(1, 31))
        said = ""
        try:
            for _ in work(folder, workers, "inline"):
                pass
        except BudgetError as error:
            said = str(error)
        more = "--max-tokens" if by_tokens else "--max-cost"
        more += f" {2 * TOKENS * questions}" if by_tokens else f" {2 * PRICE * questions:g}"
        again = f"continue with a higher one, such as: roadgpt resume {folder} {more}"
        assert said.endswith(again) == (status_of(folder).done < 30)
        with Record.opened(folder) as record:
            tokens, cost = record.spent()
            there = record.plan()
        assert tokens <= TOKENS * questions
        assert cost <= PRICE * questions + 1e-9
        if status_of(folder).done < 30:
            assert tokens > TOKENS * (questions - 3)  # less is left than one test may need
        free = with_limits(there, max_tokens=None, max_cost=None)
        for _ in work(folder, workers, "inline", chat=free.chat):
            pass
        assert status_of(folder).done == 30
        assert status_of(folder).tokens >= TOKENS * needed
        with Record.opened(folder) as record:
            assert record.plan() == free  # the next sitting has the limits of this one
