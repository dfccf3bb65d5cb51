"""Spoilt replies crash nothing, and no invalid road is called valid; the benchmark takes 10,000 of them."""

from mutated_replies import outcomes


def test_every_spoilt_reply_ends_in_a_road_that_is_looked_at_or_in_one_sentence() -> None:
    found = outcomes(range(40))
    assert set(found) <= {"valid", "invalid", "sentence"}
    assert min(found["invalid"], found["sentence"]) > 4
