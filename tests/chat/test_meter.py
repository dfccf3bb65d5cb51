"""Tokens, seconds and money are counted; a limit ends a campaign before it is passed, and nothing is lost."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from chat.asker import Turn, on_shelf
from chat.stub_server import HeardRequest, StubServer, says
from roadgpt.chat import BudgetError, ChatSettings, Message, Meter, Usage, counting, open_chat
from roadgpt.chat.meter import PRICES, price_of
from roadgpt.cli import app
from roadgpt.run import read_run

QUESTION = [Message(role="user", text="How far?")]


def varied(stub: StubServer) -> Any:
    """Another angle each time, 150 tokens each."""

    def scene(request: HeardRequest, handler: Any) -> None:
        says(f'{{"degrees": {29 + 7 * len(stub.requests)}}}')(request, handler)

    return scene


def settings(stub: StubServer, **more: Any) -> ChatSettings:
    return ChatSettings(base_url=stub.url, model="m", **more)


def run(stub: StubServer, *more: str) -> Result:
    words = ("run", "a left turn", "--designer", "asker", "-n", "6", "--seed", "7", "--no-drive", "--no-plot")
    server = ("--base-url", stub.url, "--model", "m", "--out", "c")
    return CliRunner().invoke(app, [*words, *server, *more], prog_name="roadgpt")


@pytest.mark.parametrize(
    ("limit", "flag"),
    [(("--max-tokens", "600"), "--max-tokens"), (("--max-cost", "0.0012", "--price", "2/2"), "--max-cost")],
)
def test_a_campaign_stops_before_its_limit_and_goes_on_with_a_higher_one(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch, limit: tuple[str, ...], flag: str
) -> None:
    on_shelf(monkeypatch)
    stub.play(varied(stub))
    stopped = run(stub, *limit)
    assert stopped.exit_code == 4
    assert f"the limit of {'600 tokens' if flag == '--max-tokens' else '0.0012 USD'}" in stopped.stderr
    assert f"a higher {flag}" in stopped.stderr
    assert stopped.stderr.count("\n") == 1
    finished = [*Path("c").glob("test.*.json")]
    assert len(finished) == len(stub.requests) == 4  # 150 tokens each: the limit is kept to the last
    assert "4 of 6 roads" in stopped.stdout
    assert Path("c", "generation_stats.csv").read_text().splitlines()[1].startswith("4,4,0")
    before = {path: path.read_bytes() for path in Path("c").glob("runs/*/design.json")}
    again = run(stub, *limit)
    assert again.exit_code == 4  # what the roads before have cost still counts
    assert len(stub.requests) == 4
    rest = run(stub, flag, "100000", *limit[2:])
    assert rest.exit_code == 0, rest.output
    assert len(stub.requests) == 6
    assert all(path.read_bytes() == content for path, content in before.items())
    assert "language model: 6 answers, 900 tokens" in rest.stdout


def test_what_a_road_cost_stands_in_its_run_and_in_the_summaries(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    on_shelf(monkeypatch)
    stub.play(varied(stub))
    result = run(stub, "--price", "1/2", "--json")
    assert result.exit_code == 0, result.output
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    assert [row["tokens"] for row in rows] == [150] * 6
    assert [row["cost_usd"] for row in rows] == [pytest.approx(0.0002)] * 6
    assert "language model: 6 answers, 900 tokens" in result.stderr
    spent = read_run(Path("c/runs/0002")).spent
    assert spent is not None
    assert spent.usage == Usage(prompt=100, completion=50)
    assert 0 < spent.seconds < 5
    shown = CliRunner().invoke(app, ["show", "c"]).stdout
    assert "language model: 6 answers, 900 tokens" in shown
    assert "0.0012 USD" in shown
    one = CliRunner().invoke(app, ["show", "c/runs/0001"]).stdout
    assert "model     1 answer, 150 tokens" in one
    assert f"--model m --base-url {stub.url} --price 1/2" in one


def test_a_road_that_came_to_nothing_is_counted_too(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    on_shelf(monkeypatch)
    good = varied(stub)

    def scene(request: HeardRequest, handler: Any) -> None:
        (says("no") if len(stub.requests) in range(2, 5) else good)(request, handler)

    stub.play(scene)
    result = run(stub)
    assert result.exit_code == 0, result.output
    assert "ERROR" in result.stdout
    spent = read_run(Path("c/runs/0002")).spent
    assert spent is not None
    assert spent.calls == 3
    assert "language model: 8 answers, 1,200 tokens" in result.stdout


def test_the_cap_of_an_answer_shrinks_to_what_is_left(stub: StubServer) -> None:
    stub.play(says('{"degrees": 5}'))
    chat = open_chat(settings(stub, max_tokens=400))
    chat.ask(QUESTION, Turn)
    chat.ask(QUESTION, Turn)
    caps = [request.body["max_tokens"] for request in stub.requests]
    assert caps == [398, 248]
    with pytest.raises(BudgetError, match="300 are spent"):
        chat.ask([Message(role="user", text="x" * 200)], Turn)
    assert len(stub.requests) == 2


def test_money_without_a_price_is_told_before_anything_is_asked(stub: StubServer) -> None:
    chat = open_chat(settings(stub, max_cost=1.0))
    with pytest.raises(BudgetError, match=r"the price of 'm' is not known.*--price 0.15/0.60"):
        chat.ask(QUESTION, Turn)
    assert stub.requests == []


def test_two_chats_of_one_campaign_share_its_limit(stub: StubServer) -> None:
    stub.play(says('{"degrees": 5}'))
    one, two = (open_chat(settings(stub, max_tokens=10**6, retries=n)) for n in (0, 1))
    meter = Meter(max_tokens=350)
    with counting(meter):
        one.ask(QUESTION, Turn)
        two.ask(QUESTION, Turn)
        with pytest.raises(BudgetError):
            one.ask(QUESTION, Turn)
    assert meter.spent.usage.total == 300
    assert one.spent.calls == two.spent.calls == 1


@pytest.mark.parametrize("price", ["free", "1", "1/2/3", "-1/2", "nan/1", "1/inf"])
def test_a_price_is_two_numbers(price: str) -> None:
    result = CliRunner().invoke(app, ["run", "a road", "--reader", "chat", "--price", price])
    assert result.exit_code == 2
    assert "a price is two numbers" in result.output


def test_prices_are_those_of_the_table_where_it_holds() -> None:
    def price(model: str, **more: Any) -> tuple[float, float] | None:
        return price_of(ChatSettings(model=model, **more), model)

    assert price("gpt-4o-mini") == (0.15, 0.6)  # OpenAI's own price page, the same since July 2024
    assert price("gpt-4o-mini-2024-07-18") == (0.15, 0.6)
    assert price("gpt-4o-mini", base_url="https://me.openai.azure.com") == (0.15, 0.6)
    assert price("gpt-4o-mini", base_url="http://localhost:8000/v1") is None
    assert price("gpt-4o-mini", base_url="https://api.openai.com.evil.example/v1") is None
    assert price("gpt-99") is None
    assert price("gpt-99", price="1/2") == (1.0, 2.0)
    assert all(0 < asked <= answered for asked, answered in PRICES.values())
