"""Numbers as messages, tables and pages tell them: each value is written by hand, at the edges of rounding.

The intervals are those of published tables (1 of 10: Clopper and Pearson 0.25 to 44.5 %, Wilson 1.8 to
40.4 %; Brown, Cai and DasGupta 2001)."""

import math

import pytest

from roadgpt.campaign.model import Proposal, Result
from roadgpt.campaign.status import CellStatus
from roadgpt.chat import Spent
from roadgpt.chat.model import Usage
from roadgpt.check.measures import ups_and_downs
from roadgpt.cli.screen import metres, outside, row_of, spending
from roadgpt.cli.streams import aligned, duration
from roadgpt.plural import plural
from roadgpt.report.chapters.wording import decimal, p_value, percent, share_cells, share_of
from roadgpt.report.page import unformulated
from roadgpt.verdict import percent as of_car
from roadgpt.verdict.judging import far_beyond


@pytest.mark.parametrize(
    ("said", "told"),
    [
        (p_value(0.0099), "p = 0.010"),
        (p_value(0.00042), "p = 0.0004"),
        (p_value(0.0001), "p = 0.0001"),
        (p_value(0.00009), "p < 0.0001"),
        (p_value(1.0), "p = 1.000"),
        (percent(0.0625), "6.2 %"),
        (percent(math.nan), "–"),
        (share_of(182, 300), "182 of 300 (60.7 %)"),
        (share_of(0, 0), "0 of 0"),
        (plural(1, "road"), "1 road"),
        (plural(1234, "road"), "1,234 roads"),
        (duration(9.94), "9.9 s"),
        (duration(42.4), "42 s"),
        (duration(59.7), "1 min 00 s"),
        (duration(200), "3 min 20 s"),
        (duration(7500), "2 h 05 min"),
        (metres(0.0004), "+0.000 m"),
        (metres(-0.0004), "below 0 m"),
        (metres(-0.0312), "-0.031 m"),
        (outside(0.621, 1.126), "62 % out, 1.13 m"),
        (outside(0.0, None), "inside"),
        (outside(None, None), ""),
        (of_car(0.9996), "99.9 %"),
        (of_car(0.004), "0.4 %"),
        (of_car(0.0), "0 %"),
        (of_car(1e-5), "<0.1 %"),
        (of_car(1.0), "100 %"),
        (far_beyond(0.004), "on the marking"),
        (far_beyond(0.126), "0.13 m beyond the marking"),
        (ups_and_downs([0, 10, 7.5]), "+10.0 -2.5"),
        (ups_and_downs([0, 0.04]), "+0.0"),
        (
            spending(Spent(calls=1, usage=Usage(prompt=1200, completion=34), seconds=2.26, cost=0.01)),
            "1 answer, 1,234 tokens, 2.3 s, 0.0100 USD",
        ),
        (spending(Spent(calls=2, cost=None)), "2 answers, 0 tokens, 0.0 s, price unknown"),
        ("|".join(aligned([("a", "12"), ("bcd", "3")], "<>")), "a    12|bcd   3"),
        (str(unformulated("=1+1\r\nx")), "'=1+1\nx"),
        (str(unformulated("plain")), "plain"),
    ],
)
def test_a_number_is_told_as_by_hand(said: str, told: str) -> None:
    assert said == told


def test_shares_and_decimals_of_tables() -> None:
    of, n, share, exact, score = share_cells(1, 10)
    assert (of.value, n.value, share.value, share.text) == (1, 10, 0.1, "10.0 %")
    assert (exact.text, score.text) == ("0.3 to 44.5 %", "1.8 to 40.4 %")
    assert (decimal(-0.126).text, decimal(-0.126).value) == ("−0.13", -0.126)
    assert [decimal(each).value for each in (None, math.nan, math.inf)] == [None] * 3
    assert decimal(-0.001).text == "0.00"


@pytest.mark.parametrize(
    ("features", "told"),
    [
        ({"IMPACT": 49.6, "GAP": 0.0, "TTC": 0.04}, "impact 50 km/h, TTC 0.0 s"),
        ({"GAP": 4.04, "TTC": 1.26, "RADIUS": 30.0}, "gap 4.0 m, TTC 1.3 s"),
        ({"RADIUS": 30.0}, None),
    ],
)
def test_how_near_others_came(features: dict[str, float], told: str | None) -> None:
    result = Result(1, 0, Proposal(None, 1, "draft"), "PASS", "", features=features)
    assert row_of(result).told_numbers.get("others") == told


def test_tests_without_words_are_named_by_their_generator() -> None:
    named = {"given": "roads that were given", "words": "nominal roads of scenarios", "random": "any road"}
    for generator, about in named.items():
        cell = CellStatus(
            "c01", "", "robot", generator, 1, 1, {"PASS": 1}, None, 0, 0, None, None, None, None
        )
        assert cell.about == about
