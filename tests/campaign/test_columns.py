"""A stranger's column stands wherever tests are told, and his chapter in both reports, in its place."""

import csv
import json
import re
from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from xml.etree import ElementTree

import pytest

from command_line import invoke, roadgpt
from roadgpt import plugins
from roadgpt.campaign.columns import ResultColumns, Told
from roadgpt.campaign.record import Record
from roadgpt.drive.drive import Drive
from roadgpt.errors import PartError
from roadgpt.report.chapters import Chapter
from roadgpt.report.page.model import Section

FAILING = ("turn x2", "--reader", "plan", "--seed", 7, "--driver", "beamng_like", "--friction", 0.3, "-n", 2)


def fastest(drive: Drive) -> float:
    """By hand, km/h."""
    return 3.6 * max(drive["speed"].tolist())


SPEED = ResultColumns(
    lambda run: {"FASTEST": fastest(run.drive)} if run.drive is not None else {},
    told={"FASTEST": Told("fastest_kmh", "fastest {:.0f} km/h".format)},
)
TWICE = ResultColumns(lambda run: {"LENGTH": run.length})
BROKEN = ResultColumns(lambda run: {"LONGEST": 1 / 0})


def weather(record: Record) -> Chapter | None:
    """A chapter on the folder's name, before the others."""
    return Chapter(
        Section("Weather", [f"It rained in {record.folder.name}."]), ("It rained.",), is_first=True
    )


def advice(record: Record) -> Chapter | None:
    """A chapter behind the others."""
    return Chapter(Section("Advice", ["Go on."]), ("Go on.",)) if record.names() else None


def nothing(record: Record) -> None:
    """A chapter that has nothing to tell."""


Register = Callable[..., None]


@pytest.fixture
def register(monkeypatch: pytest.MonkeyPatch) -> Iterator[Register]:
    """Registers parts of this file beside those that are installed."""

    def beside(**kinds: dict[str, str]) -> None:
        def found(group: str) -> list[EntryPoint]:
            own = kinds.get(group.removeprefix("roadgpt."), {})
            added = [EntryPoint(name, f"{__name__}:{part}", group) for name, part in own.items()]
            return [*entry_points(group=group), *added]

        monkeypatch.setattr(plugins, "entry_points", found)
        plugins._registered.cache_clear()

    yield beside
    plugins._registered.cache_clear()


@pytest.mark.usefixtures("no_workers")
def test_a_column_stands_in_tables_junit_lines_and_the_report(register: Register, tmp_path: Path) -> None:
    register(columns={"speed": "SPEED"})
    out, file = tmp_path / "c", tmp_path / "c.xml"
    roadgpt("campaign", *FAILING, "--out", out, "--junit", file)
    rows = [*csv.DictReader((out / "results.csv").read_text(encoding="utf-8").splitlines())]
    assert {row["outcome"] for row in rows} == {"FAIL"}
    cases = [*ElementTree.parse(file).getroot().iter("testcase")]
    page = Path(roadgpt("report", out).stdout.strip()).read_text(encoding="utf-8")
    assert "fastest_kmh" in page
    brief = Path(roadgpt("report", out, "--brief").stdout.strip()).read_text(encoding="utf-8")
    worst = float((re.search(r"Fastest (\d+) km/h\.", brief) or "0")[1])
    assert worst in [pytest.approx(float(row["FASTEST"]), abs=0.5) for row in rows]
    for number, (row, case) in enumerate(zip(rows, cases, strict=True), 1):
        said = roadgpt("show", f"{out}/c01/{number}", "--json").stdout
        speed = json.loads(said)["fastest_kmh"]
        told = {each.get("name"): each.get("value") for each in case.iter("property")}
        assert 10 < speed < 200
        assert float(row["FASTEST"]) == pytest.approx(speed, abs=1)  # a stored drive is rounded
        assert float(told["fastest_kmh"] or 0) == pytest.approx(speed, abs=1)
        assert f"  speed     fastest {speed:.0f} km/h\n" in roadgpt("show", f"{out}/c01/{number}").stdout
        assert f"fastest {float(row['FASTEST']):.0f} km/h" in roadgpt("show", f"{out}/c01").stdout
        assert f"{float(row['FASTEST']):.2f}" in page


@pytest.mark.usefixtures("no_workers")
@pytest.mark.parametrize(
    ("part", "reason"),
    [
        (
            "TWICE",
            "the columns 'zebra' cannot be computed (ValueError: another column is called LENGTH)",
        ),
        ("BROKEN", "the columns 'zebra' cannot be computed (ZeroDivisionError: division by zero); repair or"),
    ],
)
def test_columns_that_clash_or_break_are_named(
    register: Register, part: str, reason: str, tmp_path: Path
) -> None:
    register(columns={"zebra": part})
    done = invoke("campaign", *FAILING, "--out", tmp_path / "c")
    assert done.exit_code == PartError.exit_status
    assert reason in done.stderr


@pytest.mark.usefixtures("no_workers")
def test_chapters_stand_before_and_behind_those_of_the_report(register: Register, tmp_path: Path) -> None:
    parts = {"rain": "weather", "advice": "advice", "nothing": "nothing"}
    register(chapters=parts, columns={"speed": "SPEED"})
    every = {}
    for command, own in (("run", "Validity"), ("campaign", "Outcomes")):
        out = tmp_path / command
        made = roadgpt(command, *FAILING, "--out", out, *(["--no-plot"] if command == "run" else []))
        assert ("  fastest " in made.stdout) == (command == "run")  # which prints a line for each test
        file = tmp_path / f"{command}.xml"
        page = Path(roadgpt("report", out, "--junit", file).stdout.strip()).read_text(encoding="utf-8")
        assert "fastest_kmh" in page
        assert file.read_text(encoding="utf-8").count('name="fastest_kmh"') == 2
        heads = [at.split("<")[0] for at in page.split("<h2>")[1:]]
        assert heads.index("Weather") < heads.index(own)
        assert heads[-2:] == ["Advice", "How this was made"]
        assert "Fastest " in Path(roadgpt("report", out, "--brief").stdout.strip()).read_text("utf-8")
        every[command] = [head for head in heads if head != "Feature map"]
        assert f"It rained in {out.name}." in page
        assert page.index("It rained.") < page.index("Go on.")
    assert every["run"] == every["campaign"], "one report"
    page = Path(roadgpt("report", tmp_path / "run" / "runs" / "0002").stdout.strip()).read_text("utf-8")
    assert page.startswith("<!doctype html>")
    assert "1 test: 1 FAIL." in page
    assert "fastest_kmh" in page
    brief = Path(roadgpt("report", tmp_path / "run" / "runs" / "0002", "--brief").stdout.strip())
    assert "-n 2 --seed 7" in brief.read_text("utf-8"), "the command that makes this road, the second"
