"""Batches of training examples: nothing is lost by padding, and few different shapes occur."""

from itertools import islice

from hypothesis import given
from hypothesis import strategies as st

from roadgpt_training.data import Example, batches, padded

numbers = st.lists(st.integers(1, 900), min_size=1, max_size=95)


@given(st.lists(numbers, min_size=1, max_size=6))
def test_padding_adds_zeros_up_to_a_multiple_of_eight(rows: list[list[int]]) -> None:
    out = padded(rows)
    assert [[each for each in row if each] for row in out.tolist()] == rows
    assert out.shape[1] % 8 == 0
    assert out.shape[1] - max(map(len, rows)) < 8


def test_batches_hold_every_example_once_and_have_few_shapes() -> None:
    made = [
        Example((tuple(range(1, 2 + n % 60)),) * (1 + n % 3), (1, *range(10, 12 + n % 37), 2))
        for n in range(480)
    ]
    found = list(islice(batches(iter(made), 16, 30, 3), 30))
    kept = sorted(
        (
            tuple(tuple(int(each) for each in chunk if each) for chunk in text if chunk.any()),
            tuple(int(each) for each in plan if each),
        )
        for texts, plans in found
        for text, plan in zip(texts, plans, strict=True)
    )
    assert kept == sorted((each.pieces, each.tokens) for each in made)
    assert {texts.shape[2] % 8 for texts, _ in found} | {len(plans[0]) % 8 for _, plans in found} == {0}
