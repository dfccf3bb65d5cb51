"""Every command line that worked before commands were merged works, and says its present name once."""

import json
import re
import shutil
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from cli.earlier_options import EARLIER
from roadgpt.cli import app

RENAMED = {
    "plot": "view --format png ROAD",
    "status": "show CAMPAIGN",
    "top": "show --watch CAMPAIGN",
    "redrive": "drive --again CAMPAIGN TEST",
    "parts": "config plugins",
    "sbft": "compete sbft",
    "sdc": "compete sdc",
    "sdc serve": "compete sdc",
    "beamng": "doctor beamng",
    "beamng selftest": "doctor beamng",
}

AGAIN = ("--no-plot", "--out", "x")
PARENT = click.Context(app, **app.context_settings)


def invoke(*words: str) -> Result:
    return CliRunner().invoke(app, list(words), prog_name="roadgpt")


def resolved(words: list[str]) -> tuple[click.Command, list[str]]:
    """The command that words lead to, and the words that are left."""
    context = click.Context(app, info_name="roadgpt", resilient_parsing=True, **app.context_settings)
    _, command, rest = app.resolve_command(context, words)
    while isinstance(command, click.Group) and rest and rest[0] in command.commands:
        command, rest = command.commands[rest[0]], rest[1:]
    assert command is not None
    return command, rest


@pytest.mark.parametrize("name", EARLIER)
def test_an_earlier_command_answers_and_says_its_present_name_if_it_has_one(name: str) -> None:
    result = invoke(*name.split(), "--help")
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("Usage: roadgpt ")
    told = f"roadgpt: 'roadgpt {name}' is now 'roadgpt {RENAMED[name]}'\n" if name in RENAMED else ""
    assert result.stderr == told


@pytest.mark.parametrize("name", EARLIER)
def test_an_earlier_command_takes_each_of_its_earlier_options(name: str) -> None:
    command, rest = resolved(name.split())
    known = {flag for each in command.params for flag in (*each.opts, *each.secondary_opts)}
    missing = set(EARLIER[name].split()) - known - {word for word in rest if word.startswith("--")}
    assert missing <= {"--verge"} | ({"--help"} if "sdc" in name or "beamng" in name else set())


@pytest.mark.parametrize("command", [name for name in EARLIER if "--verge" in EARLIER[name].split()])
@pytest.mark.parametrize("words", [["--verge", "1.5"], ["--verge=1.5"], ["--shoulder", "1.5"]])
def test_the_shoulder_is_set_by_its_earlier_name_too(
    command: str, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    found, rest = resolved(command.split())
    needed = {"export": ["--to", "csv"]}.get(command, [])
    something = [] if command == "study thesis" else ["something"]
    context = found.make_context("x", [*rest, *needed, *words, *something], PARENT)
    assert context.params["shoulder"] == 1.5
    told = "roadgpt: '--verge' is now '--shoulder'\n" if words[0].startswith("--verge") else ""
    assert capsys.readouterr().err == told


def test_behind_two_dashes_a_word_is_no_option() -> None:
    found, _ = resolved(["run"])
    context = found.make_context("run", ["--", "a", "--verge"], PARENT)
    assert context.params["words"] == ("a", "--verge")


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("campaign") / "c"
    words = ("campaign", "turn x2", "-n", "2", "--seed", "3", "--reader", "plan")
    assert invoke(*words, "--out", str(made), "--quiet").exit_code == 0
    return made


@pytest.fixture
def folder(campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("road.json").write_text(json.dumps([[60, 100], [100, 100], [130, 110], [150, 140]]))
    shutil.copytree(campaign, "c")
    return tmp_path


def without_seconds(text: str) -> str:
    return re.sub(r"\d+(\.\d+)? (s|tests/s)\b", "", text)


def test_an_earlier_command_prints_and_ends_as_the_present_one(folder: Path) -> None:
    del folder
    pairs = [
        (["status", "c", "--json"], ["show", "c", "--json"]),
        (["parts"], ["config", "plugins"]),
        (["parts", "--json"], ["config", "plugins", "--json"]),
        (["redrive", "c", "1", *AGAIN], ["drive", "--again", "c", "1", *AGAIN]),
        (["redrive", "c", "99"], ["drive", "--again", "c", "99"]),
        (["top", "c"], ["show", "c", "--watch"]),
        (["top", "nowhere"], ["show", "nowhere", "--watch"]),
        (["plot", "nothing.json"], ["view", "nothing.json", "--format", "png"]),
        (["sbft", "--class-name", "X"], ["compete", "sbft", "--class-name", "X"]),
    ]  # fmt: skip
    for earlier, present in pairs:
        first, second = invoke(*earlier), invoke(*present)
        assert first.exit_code == second.exit_code, earlier
        assert without_seconds(first.stdout) == without_seconds(second.stdout), earlier
        (told, *rest) = first.stderr.splitlines()
        assert re.fullmatch(r"roadgpt: 'roadgpt \w+' is now 'roadgpt [^']+'", told)
        assert rest == second.stderr.splitlines(), earlier


def test_status_prints_what_it_printed(folder: Path) -> None:
    """That is how far the campaign is, and nothing else; show says besides how to show one test."""
    del folder
    status, show = invoke("status", "c").stdout.splitlines(), invoke("show", "c").stdout.splitlines()
    assert [without_seconds(line) for line in status] == [without_seconds(line) for line in show[:-1]]
    assert show[-1].startswith("one test: roadgpt show c/")
    assert invoke("status", "road.json").exit_code == 2


def test_plot_draws_what_it_drew(folder: Path) -> None:
    drawn = invoke("plot", "road.json", "--out", "a").stdout.split()
    assert drawn == [str(path).replace("/b/", "/a/").replace("b/road", "a/road") for path in
                     invoke("view", "road.json", "--format", "png", "--out", "b").stdout.split()]  # fmt: skip
    assert {Path(name).suffix for name in drawn} == {".png"}
    chosen = invoke("plot", "road.json", "--out", "c1", "--format", "svg").stdout.split()
    assert {Path(name).suffix for name in chosen} == {".svg"}
    assert all((folder / name).is_file() for name in [*drawn, *chosen])


def test_options_of_files_and_of_tests_are_not_mixed(folder: Path) -> None:
    del folder
    for words, told in (
        (["drive", "--again", "c", "1", "--friction", "0.5"], "leave out --friction"),
        (["drive", "--again", "c", "1", "--seed", "5"], "leave out --seed"),
        (
            ["drive", "road.json", "--worst"],
            "--worst is for tests of a campaign, which are driven with --again",
        ),
        (["view", "road.json", "--axes", "thesis"], "--axes is for pictures; say --format png as well"),
        (["view", "road.json", "--format", "png", "--open"], "--open is for the page; leave out --format"),
        (["show", "c", "--watch", "--json"], "leave out --json"),
        (["show", "c", "--watch", "--failures"], "--failures selects roads"),
    ):
        result = invoke(*words)
        assert result.exit_code == 2, words
        assert told in result.stderr
        assert result.stdout == ""


def test_show_as_json_has_a_line_for_each_road(folder: Path) -> None:
    del folder
    rows = [json.loads(line) for line in invoke("show", "c/c01", "--json").stdout.splitlines()]
    assert [row["file"] for row in rows] == ["c/c01/1", "c/c01/2"]
    assert all(row["test_outcome"] in ("PASS", "FAIL", "INVALID") for row in rows)
