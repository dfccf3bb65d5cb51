"""What agents are told of the language: complete, short, and true when it is built and driven."""

import re
import shlex
import sys
from pathlib import Path

import pytest

from command_line import invoke, roadgpt
from roadgpt.brief import read
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.language.table import MANEUVERS, PARTS, PLACES, ROAD_USERS, WEATHER, named_in
from roadgpt.run import Setup, perform
from roadgpt_mcp.knowledge import DATA, skill, topics

MOST_WORDS = 2500
PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "write-plans.md").read_text(encoding="utf-8")
PLANS = re.findall("^```plan\n(.+)\n```$", PAGE, re.M)


def test_the_skill_is_short_and_says_what_it_is_for(tmp_path: Path) -> None:
    assert roadgpt("skill", "--out", tmp_path).output == f"{tmp_path / 'SKILL.md'}\n"
    text = (tmp_path / "SKILL.md").read_text(encoding="utf-8")
    head = re.fullmatch(
        r"---\nname: roadgpt\ndescription: ([^\n]{50,1024})\n---\n# RoadGPT\n(.+)", text, re.S
    )
    assert head
    assert len(text.split()) <= MOST_WORDS
    assert not re.search(r"\$\w", text)
    assert "`roadgpt run --plan" in text


@pytest.mark.parametrize("whose", ["tools", "commands"])
def test_every_row_of_the_table_is_told(whose: str) -> None:
    told = "".join(topics(whose).values())
    rows = (*ROAD_USERS, *PLACES, *MANEUVERS, *WEATHER, *named_in("features"), *named_in("junctions"))
    parts = [part for thing in ("clause", "road", "junction", "map") for part in PARTS[thing].values()]
    keys = [f"{part.key}=" for part in parts if part.key not in ("", "x")]
    words = [word for part in parts for word in part.words]
    assert not [row for row in (*rows, *words) if not re.search(rf"\b{row}\b", told)]
    assert not [key for key in keys if not re.search(rf"\b{key}", told)]


def test_the_topics_of_the_server_have_all_that_the_skill_has() -> None:
    lines = {line for line in skill().splitlines() if "`roadgpt" not in line}
    told = {line for text in topics().values() for line in text.splitlines()}
    assert lines - told == {"---", "name: roadgpt", "# RoadGPT"} | {
        line for line in lines if line.startswith("description: ")
    }


def test_all_plans_in_the_text_can_be_read() -> None:
    plans = {
        name: [
            plan
            for line in re.findall(r"^(?:`[^`]+`(?:, )?)+$", text, re.M)
            for plan in re.findall("`([^`]+)`", line)
        ]
        for name, text in topics().items()
    }
    assert {name for name, found in plans.items() if found} == {
        "roads", "routes", "maps", "others", "conditions", "changes",
    }  # fmt: skip
    for name, found in plans.items():
        for plan in found:
            assert read_change_plan(plan) if name == "changes" else read(plan, "plan")


def test_each_text_stands_with_its_plan_for_people_too() -> None:
    assert re.findall("^> (.+)\n\n```plan\n", PAGE, re.M) == [worked["text"] for worked in DATA["worked"]]
    assert 6 <= len(PLANS) == len(DATA["worked"])


def test_the_page_shows_what_the_command_says_of_a_wrong_plan() -> None:
    found = re.search("^```text\n\\$ roadgpt (.+)\n((?:.+\n)+)```", PAGE, re.M)
    assert found
    told = invoke(*shlex.split(found[1]))
    assert (told.exit_code, told.output) == (2, found[2])
    assert told.output.count("\n- ") > 1


@pytest.mark.parametrize("plan", PLANS)
def test_the_worked_plans_happen_as_told_with_the_robot(plan: str) -> None:
    run = perform(plan, 1, setup=Setup(reader="plan", driver="robot"))
    # a robot runs into who is in its way
    assert run.outcome in ("PASS", "FAIL", "UNAVOIDABLE"), run.description
    assert run.verdict is not None
    events = run.verdict.events or ()
    assert not [event.why for event in events if event.time is None]
    assert len(events) >= len(re.findall(r"[:,] (?=[a-z])", plan.partition("&&")[2]))


def test_without_the_extra_a_sentence_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcp", None)
    told = invoke("mcp")
    assert told.exit_code == 2
    assert re.fullmatch(
        r"roadgpt: serving agents needs the package 'mcp'; install it with: python -m pip .+\n", told.output
    )
