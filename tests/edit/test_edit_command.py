"""`roadgpt edit`: a changed road goes into a new folder, and the old one stays as it was."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from chat.stub_server import StubServer, says, serving
from command_line import invoke
from edit_truth import roads
from roadgpt.run import read_run

WORDS = "make the second turn sharper"
LINE = "turn 2: angle more; end: slope down"
CHANGE = ("--plan", LINE)


@pytest.fixture(autouse=True)
def a_design_is_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("design.json").write_text(json.dumps(roads()["h01"].to_json()))


@pytest.fixture
def stub() -> Iterator[StubServer]:
    with serving() as found:
        yield found


def made(*more: str) -> Path:
    """The folder of a run with three turns."""
    words = ["run", "--plan", "turn x3", "--seed", "5", "--out", "old", "--no-drive", "--no-plot"]
    assert invoke(*words, *more).exit_code == 0
    return Path("old", "runs", "0001")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_a_run_is_changed_into_a_new_folder() -> None:
    old = made()
    before = contents(Path("old"))
    result = invoke("edit", str(old), *CHANGE, "--out", "new", "--no-plot")
    assert result.exit_code == 0
    assert contents(Path("old")) == before
    assert "turn 2: " in result.stdout
    assert "changed road: " in result.stdout
    run = read_run("new/runs/0001")
    card = json.loads(Path("new/runs/0001/edit.json").read_text())
    assert card["request"] == LINE
    assert card["of"] == str(old)
    assert card["design_before"] == json.loads((old / "design.json").read_text())
    assert run.design is not None
    assert run.design.to_json() != card["design_before"]
    assert run.outcome == "VALID"
    assert run.request.world == read_run(old).request.world
    assert Path("new/test.0001.json").is_file()


def test_the_run_of_a_road_that_needs_a_larger_map_has_one() -> None:
    old = made()
    result = invoke("edit", str(old), "--plan", "straight -1: length +300", "--out", "new", "--no-plot")
    assert result.exit_code == 0
    run = read_run(Path("new", "runs", "0001"))
    assert run.is_valid
    assert run.world.site.map_size > read_run(old).world.site.map_size == 250
    assert f"the map is {run.world.site.map_size:g} m wide" in result.stdout


def test_pictures_show_the_road_before_and_after() -> None:
    made()
    assert invoke("edit", "old", *CHANGE, "--out", "new").exit_code == 0
    for name in ("birds_eye.png", "height.png", "curvature_grade.png"):
        after, before = Path("new/runs/0001", name), Path("new/runs/0001/before", name)
        assert after.read_bytes()[:4] == before.read_bytes()[:4] == b"\x89PNG"
        assert after.read_bytes() != before.read_bytes()
    assert invoke("edit", "old", *CHANGE, "--out", "plain", "--no-plot").exit_code == 0
    assert not [*Path("plain").rglob("*.png")]


def test_a_design_from_a_file_is_changed_and_driven() -> None:
    result = invoke("edit", "design.json", "--plan", "turn 1: side right", "--json", "--no-plot")
    assert result.exit_code == 0
    (line,) = result.stdout.splitlines()
    row = json.loads(line)
    assert row["test_outcome"] == "PASS"
    assert row["request"] == "turn 1: side right"
    assert any("to the right" in sentence for sentence in row["changes"])
    assert Path(row["file"]).is_file()
    assert read_run(row["file"]).drive is not None


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        (["design.json", "--plan", "turn 5: angle more"], "no fifth turn; the road has 2 turns"),
        (["design.json", "--plan", "turn 2: colour blue"], "'colour' is not expected"),
        (["design.json", "paint it blue"], "roadgpt: "),
        (["nowhere.json", *CHANGE], "there is no nowhere.json"),
        (["design.json", *CHANGE, "--reader", "gpt"], "gpt"),
        (["design.json", *CHANGE, "--reader", "chat"], "--plan needs no language model"),
        (["design.json"], "Say what to change"),
        ([], "Name the folder of a run"),
        (["design.json", *CHANGE, "--out", "full"], "not empty"),
        (["points.json", *CHANGE], "no design"),
        (["many", *CHANGE], "many holds 2 roads; name one, as many/1"),
        (["design.json", *CHANGE, "--model", "x"], "--model"),
    ],
)
def test_what_cannot_be_done_is_told_and_nothing_is_written(words: list[str], advice: str) -> None:
    Path("full").mkdir()
    Path("full", "note.txt").write_text("mine")
    Path("points.json").write_text(json.dumps([[60, 100], [100, 100], [130, 110]]))
    invoke("run", "--plan", "turn x2", "-n", "2", "--seed", "1", "--no-drive", "--no-plot", "--out", "many")
    before = contents(Path())
    result = invoke("edit", *words)
    assert result.exit_code == 2
    assert advice in result.stderr
    assert contents(Path()) == before


def test_a_language_model_reads_changes_too(stub: StubServer) -> None:
    stub.play(says('{"changes": ["turn 2: angle =70"], "scene": [], "unused": ["please"]}'))
    more = ("--reader", "chat", "--base-url", stub.url, "--model", "m", "--no-drive", "--no-plot", "--json")
    result = invoke("edit", "design.json", f"{WORDS}, please", *more)
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout.splitlines()[-1])
    assert any("60 -> 70 degrees" in sentence for sentence in told["changes"])
    assert told["unused"] == ["please"]
