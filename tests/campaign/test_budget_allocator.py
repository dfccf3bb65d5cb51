"""Limits of tokens and money: never passed, whoever is under way, and not given up while money is left."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaign.quick import Inline, made, plan, put_on_shelves
from roadgpt.campaign import scheduler
from roadgpt.campaign.budget_allocator import BudgetAllocator
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import Cell
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Record
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
        patch.setattr(scheduler, "execute", paid)
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


@given(
    st.lists(st.tuples(st.booleans(), st.integers(1, 20), st.floats(0, 1)), max_size=40),
    st.floats(0.01, 10),
)
def test_shares_never_sum_to_more_than_is_left(steps: list[tuple[bool, int, float]], limit: float) -> None:
    allocator = BudgetAllocator(ChatSettings(max_cost=limit), 0, 0.0)
    out: dict[int, float] = {}
    paid_so_far, key = 0.0, 0
    for ends, tests, share in steps:
        if ends and out:
            number, given_to_it = out.popitem()
            paid_so_far += share * given_to_it
            allocator.back(number, Spent(calls=1, cost=share * given_to_it))
        elif not ends:
            each = allocator.share(2 * tests)
            for _ in range(tests):
                key += 1
                allocator.give(key, each)
                out[key] = each.cost or 0.0
        assert paid_so_far + sum(out.values()) <= limit * (1 + 1e-9)


def test_without_limits_nobody_is_held_back() -> None:
    allocator = BudgetAllocator(ChatSettings(), 5, 1.0)
    assert allocator.share(7) == allocator.share() == (None, None)
    assert BudgetAllocator(None, 0, 0.0).share() == (None, None)


@pytest.mark.parametrize("tests", [1, 4, 50])
def test_a_first_round_leaves_half_for_the_next(tests: int) -> None:
    allocator = BudgetAllocator(ChatSettings(model="m", max_cost=2.0, max_tokens=8_000), 0, 0.0)
    each = allocator.share(2 * tests)
    for number in range(tests):
        allocator.give(number, each)
    tokens, cost = allocator.share()
    assert cost == pytest.approx(1.0)
    assert tokens == pytest.approx(4_000, abs=tests)
