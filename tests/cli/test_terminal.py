"""The program itself, as a process: in a pipe, on a terminal, interrupted, cut off."""

import json
import os
import re
import shlex
import subprocess
import sys
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from command_line import roadgpt
from roadgpt.cli.streams import shown as as_printed

ROADGPT = [sys.executable, "-c", "from roadgpt.cli import main; main()"]
RUN = [*ROADGPT, "run", "turn x3 | up", "--reader", "plan", "--no-plot", "--no-drive"]


def on_a_terminal(
    *command: str, stdout_is_a_file: bool = False, mood: dict[str, str] | None = None
) -> tuple[str, str]:
    """What a command shows on a pseudo-terminal, and what it writes to standard output, if that is a file."""
    pty = pytest.importorskip("pty", reason="no pseudo-terminals on this platform")
    here, there = pty.openpty()
    file = Path("stdout.txt")
    with file.open("w") as stdout:
        process = subprocess.Popen(
            command,
            stdin=there,
            stdout=stdout if stdout_is_a_file else there,
            stderr=there,
            env=os.environ | {"TERM": "xterm-256color", "COLUMNS": "120"} | (mood or {}),
        )
        os.close(there)
        shown = b""
        while True:
            try:
                piece = os.read(here, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            shown += piece
        assert process.wait(60) == 0
    os.close(here)
    return shown.decode(), file.read_text()


def test_a_terminal_gets_a_bar_with_rate_and_time_left() -> None:
    shown, _ = on_a_terminal(*RUN, "-n", "3")
    assert "roads/s" in shown
    assert "ETA" in shown
    assert "3/3" in shown
    assert "3 of 3 roads" in shown
    # the bar is wiped from its line before a road is written there
    before = [shown[: shown.index(f"{number}/3  ")].splitlines()[-1] for number in (1, 2, 3)]
    assert not any("roads" in line.split("\x1b[2K")[-1] for line in before)


def test_standard_output_in_a_file_stays_whole_while_the_bar_is_on_the_terminal() -> None:
    shown, written = on_a_terminal(*RUN, "-n", "3", "--json", stdout_is_a_file=True)
    assert [json.loads(line)["test_outcome"] for line in written.splitlines()] == ["VALID"] * 3
    assert "ETA" in shown
    assert "test_outcome" not in shown


FULL, CLOSED = (">/dev/full", "No space left on device"), (">&-", "Bad file descriptor")


@pytest.mark.parametrize(
    ("command", "place"),
    [
        (RUN, CLOSED),
        ([*ROADGPT, "config", "show"], FULL),
    ],
)
def test_standard_output_that_takes_nothing_is_told_in_a_sentence(
    command: list[str], place: tuple[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    there, why = place
    line = f"{shlex.join(command)} {there}"
    done = subprocess.run(["sh", "-c", line], stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        f"roadgpt: cannot write to standard output ({why}); send it where there is room"
    )
    assert "Exception ignored" not in done.stderr
    assert not [*tmp_path.rglob("roadgpt-crash-*"), *Path().rglob("roadgpt-crash-*")]


def test_who_says_nothing_needs_no_standard_output() -> None:
    line = f"{shlex.join(RUN)} --quiet >&- 2>&- <&-"
    assert subprocess.run(["sh", "-c", line], check=False).returncode == 0
    assert len([*Path("roadgpt-runs").glob("*/test.0001.json")]) == 1


@pytest.mark.parametrize(
    ("mood", "command"), [({"TERM": "dumb"}, RUN), ({"NO_COLOR": "1"}, [*ROADGPT, "config", "show"])]
)
def test_who_wants_no_colours_gets_none(mood: dict[str, str], command: list[str]) -> None:
    shown, _ = on_a_terminal(*command, mood=mood)
    assert "\x1b[3" not in shown.replace("\x1b[39m", "").split("outcome")[-1]
    assert "\x1b[1m" not in shown.split("outcome")[-1]


def test_a_reader_that_goes_away_is_no_error() -> None:
    process = subprocess.Popen(
        [*RUN, "-n", "300", "--json", "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert json.loads(process.stdout.readline())
    process.stdout.close()
    assert process.wait(60) == 141
    assert process.stderr is not None
    assert process.stderr.read() == ""
    process.stderr.close()


def said_in(encoding: str, *command: str | bytes) -> bytes:
    """What a command says into a pipe of this encoding, where there is neither locale nor home."""
    bare = {"PATH": os.environ["PATH"], "LC_ALL": "C", "HOME": "nowhere"}
    env = bare | {"PYTHONIOENCODING": encoding}
    done = subprocess.run([*ROADGPT, *command], capture_output=True, env=env, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    return done.stdout


def test_a_pipe_that_has_not_all_letters_gets_escapes() -> None:
    words = b"an uphill road with 3 turns \xe4\xbd\xa0\xe5\xa5\xbd \x80"
    said = said_in("ascii", "run", words, "--no-plot", "--no-drive")
    assert b"1 of 1 roads" in said
    assert b"\\u4f60" in said
    (folder,) = Path("roadgpt-runs").iterdir()
    assert b"\xe4\xbd\xa0" in said_in("utf-8", "show", str(folder))


EVIL = "\x1b]0;title\x07\x1b[2J\x1b[8m\x1b[30m\x9b31m\x7f\u202e\u2066\r"
SEVERAL = """
import json, sys
from roadgpt.cli import app
from roadgpt.cli.streams import make_ready
make_ready()
for words in json.loads(sys.argv[1]):
    try:
        app(words, prog_name="roadgpt")
    except SystemExit:
        pass
"""


def commands(char: str) -> bool:
    """Whether a character commands a terminal, or the direction of the text, by its classes in Unicode."""
    turns = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
    kind, way = unicodedata.category(char), unicodedata.bidirectional(char)
    return (kind in ("Cc", "Zl", "Zp") and char not in "\n\t") or way in turns or char in "\u200e\u200f"


def poisoned(data: object) -> object:
    """The same data with commands for terminals in each sentence."""
    if isinstance(data, dict):
        return {name: poisoned(value) for name, value in data.items()}
    if isinstance(data, list):
        return [poisoned(value) for value in data]
    return f"{data}{EVIL}" if isinstance(data, str) and " " in data else data


def test_what_others_wrote_commands_no_terminal() -> None:
    """A folder whose sentences hold commands is shown, compared and exported, and names of files are said."""
    roadgpt("run", "straight 100", *RUN[5:], "--out", "r")
    for file in Path("r").rglob("*.json"):
        file.write_text(json.dumps(poisoned(json.loads(file.read_text()))))
    Path("own.json").write_text(json.dumps({"format": EVIL}))
    run = "r/runs/0001"
    words = [
        ["show", "r"], ["show", run], ["show", run, "--json"], ["export", run, "--to", "csv", "--out", "e"],
        ["compare", run, run], ["drive", f"none{EVIL}.json"], ["drive", "own.json"], ["run", "--plan", EVIL],
        ["check", run], ["edit", run, "--plan", f"turn 1: {EVIL}"],
    ]  # fmt: skip
    said, _ = on_a_terminal(sys.executable, "-c", SEVERAL, json.dumps(words))
    bar = r"\x1b\[(?:[0-9;]*m|2K|1A|\?25[lh])|\r\n?"
    hidden = re.findall(r"\x1b\[(?:8|30)m", said)
    assert hidden == [char for char in re.sub(bar, "", said) if commands(char)] == []
    assert said.count("\\u001b]0;title\\u0007\\u001b[2J") >= 4
    assert "\\u009b31m\\u007f\\u202e\\u2066\\u000d" in said


@given(
    st.text(st.characters(categories=["Cc", "Cf", "Zl", "Zp", "Lu", "Nd"]) | st.sampled_from("\x1b[0;8m\n\t"))
)
def test_only_what_commands_is_shown_otherwise(text: str) -> None:
    """Unicode's classes are the second opinion: controls, separators of lines, and overrides of direction."""
    told = as_printed(text)
    assert not any(map(commands, re.sub(r"\x1b\[(?:[01]|3[1-6]|91)m", "", told)))
    back = re.sub(r"\\u([0-9a-f]{4})", lambda found: chr(int(found[1], 16)), told)
    assert back == text
