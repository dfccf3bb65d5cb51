"""What people name: tests and runs, one way for all commands; wrong names are told in one sentence."""

import csv
import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign.folder_record import run_again
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.selection import chosen, selection_of
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.network import read_opendrive
from roadgpt.run import read_run
from roadgpt_search.faults.fault import faults_in
from rows import rows


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")


def lines(*words: object) -> list[str]:
    done = roadgpt(*words)
    assert done.exit_code == 0, done.output
    return done.stdout.splitlines()


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign of two cells, one of one cell, and a folder of runs."""
    home = tmp_path_factory.mktemp("home")
    (home / "plan.toml").write_text(
        'prompts = ["turn x2 | flat"]\nseeds = [3, 4]\ntests = 4\nreader = "plan"\n'
        'drivers = "beamng_like"\n'
        "[world]\noob_tolerance = 0.3\nmap_size = 200\n"
    )
    words = ["turn x2 | flat", "--reader", "plan", "--seed", 3, "--oob-tolerance", 0.3]
    words += ["--driver", "beamng_like"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        lines("campaign", home / "plan.toml", "--out", home / "two", "-q")
        lines("campaign", *words, "-n", 3, "--out", home / "one", "-q")
    lines("run", *words, "-n", 3, "--no-plot", "--out", home / "runs", "-q")
    return home


@pytest.fixture(autouse=True)
def here(home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("two", "one", "runs"):
        (tmp_path / name).symlink_to(home / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def results(folder: str) -> list[dict[str, str]]:
    with Path(folder, "results.csv").open(encoding="utf-8") as file:
        return [*csv.DictReader(file)]


def names(folder: str, choice: str | None = None) -> list[str]:
    place = selection_of(folder)
    assert place is not None
    return [str(NumberedTest(each.cell, each.number or 0)) for each in chosen(place, choice)]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "cell", "number"),
    [
        ("two/c02/3", "c02", 3), ("two/c02/0003", "c02", 3), ("one/2", "c01", 2), ("one/c01/2", "c01", 2),
        ("runs/2", "", 2), ("two/c02", "c02", None), ("two", "", None), ("two/", "", None),
        ("runs", "", None), ("./one/c01/2", "c01", 2),
    ],
)  # fmt: skip
def test_names_of_tests_cells_and_folders(text: str, cell: str, number: int | None) -> None:
    place = selection_of(text)
    assert place is not None
    assert (place.folder.name, place.cell, place.number) == (
        text.removeprefix("./").split("/")[0],
        cell,
        number,
    )
    if number is not None:
        assert place.run().index == number


@pytest.mark.parametrize(
    "text", ["runs/runs/0001", "runs/test.0001.json", "nothing", "nothing/c01/3", "out/1", "/"]
)
def test_what_names_no_test_is_for_others_to_read(text: str) -> None:
    assert selection_of(text) is None


@pytest.mark.parametrize(("text", "said"), rows(__file__, "wrong_names"))
@pytest.mark.parametrize("command", ["view", "film", "view --format png"])
def test_a_wrong_name_is_told_in_one_sentence(command: str, text: str, said: str) -> None:
    done = roadgpt(*command.split(), text)
    assert done.exit_code == 2
    (line,) = done.stderr.splitlines()
    assert said in line
    assert not [*Path().glob("roadgpt-*")]


def test_what_is_chosen_is_what_the_table_says() -> None:
    rows = results("two")
    failed = [f"{row['cell']}/{row['test']}" for row in rows if row["outcome"] == "FAIL"]
    assert 2 <= len(failed) < len(rows)
    assert names("two", "failures") == failed
    assert names("two/c02", "failures") == [name for name in failed if name.startswith("c02/")]
    assert names("two") == [f"{row['cell']}/{row['test']}" for row in rows]
    least = min((row for row in rows if row["outcome"] == "FAIL"), key=lambda row: float(row["margin_m"]))
    assert names("two", "worst") == [f"{least['cell']}/{least['test']}"]
    found = faults_in(Path("two"))
    assert names("two", "faults") == [str(fault.names[0]) for fault in found.them]


def test_what_is_chosen_of_runs_is_what_their_files_say() -> None:
    runs = [read_run(f"runs/runs/{number:04d}") for number in (1, 2, 3)]
    assert names("runs", "failures") == [str(run.index) for run in runs if run.outcome == "FAIL"]
    order = sorted(runs, key=lambda run: (run.outcome != "FAIL", run.verdict.margin if run.verdict else 0))
    assert names("runs", "worst") == [str(order[0].index)]


def test_failures_are_exported_without_driving(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roadgpt.run.simulate", lambda *_: pytest.fail("somebody drives"))
    made = lines("export", "two", "--failures", "--to", "opendrive,csv", "--out", "out")
    roads = [Path(name) for name in made if name.endswith(".xodr")]
    assert [path.stem for path in roads] == [
        f"two-{name.replace('/', '-000')}" for name in names("two", "failures")
    ]
    assert len([name for name in made if name.endswith(".drive.csv")]) == len(roads)
    place = selection_of(names("two", "failures")[0].join(["two/", ""]))
    assert place is not None
    assert read_opendrive(roads[0]).road.length == pytest.approx(place.run().length, abs=0.01)


def test_each_road_is_exported_once_however_it_is_named() -> None:
    made = lines("export", "one/2", "one/c01/2", "runs/1", "runs/runs/0001", "--to", "sbft", "--out", "out")
    assert len(made) == 2


def test_one_wrong_name_does_not_stop_the_others() -> None:
    done = roadgpt("export", "one/9", "one/2", "--to", "csv", "--out", "out")
    assert done.exit_code == 2
    assert "its tests are 1 to 3" in done.stderr
    assert "out/one-c01-0002.csv" in done.stdout


def test_a_page_a_film_pictures_and_a_summary_of_what_is_named() -> None:
    worst = names("two", "worst")[0]
    assert lines("view", "two", "--worst") == [f"two-{worst.replace('/', '-000')}-view.html"]
    assert lines("view", "one/1", "runs/1", "--out", "both.html") == ["both.html"]
    drawn = lines("view", "--format", "png", "two", "--worst")
    assert f"plots/two-{worst.replace('/', '-000')}/birds_eye.png" in drawn
    told = lines("show", f"two/{worst}")
    assert told[0].startswith("FAIL: ")
    assert f"  again     roadgpt drive --again two/{worst}" in told
    assert lines("show", "two", "--worst")[0] == told[0]
    listed = lines("show", "two", "--failures")
    assert [line.split()[0] for line in listed] == [f"two/{name}" for name in names("two", "failures")]
    cell = lines("show", "two/c02")
    assert [line.split()[0] for line in cell[3:]] == [f"two/c02/{number}" for number in (1, 2, 3, 4)]


@pytest.mark.parametrize(("words", "said"), rows(__file__, "wrong_choices"))
def test_what_cannot_be_meant_is_told(words: list[str], said: str) -> None:
    done = roadgpt(*words)
    assert done.exit_code == 2
    assert said in " ".join(done.stderr.split())


@pytest.mark.usefixtures("no_workers")
def test_where_nothing_failed_that_is_said() -> None:
    words = ["straight | turns=0", "--reader", "plan", "--seed", 1, "-n", 2, "-q"]
    lines("campaign", *words, "--out", "calm")
    for choice in ("--failures", "--faults"):
        done = roadgpt("export", "calm", choice, "--to", "csv")
        assert done.exit_code == 2
        assert done.stderr == "roadgpt: no road failed in calm\n"
    assert lines("show", "calm", "--worst")[0].startswith("PASS")


def test_tests_are_driven_again_by_any_of_their_names() -> None:
    told = lines("drive", "--again", "two", "c02/1", "two/c01/2", "--no-plot", "--out", "again")
    assert [line.split()[1] for line in told] == ["c02/1", "c01/2"]
    assert [
        line.split()[1] for line in lines("drive", "--again", "two/c02/1", "--no-plot", "--out", "again")
    ] == ["c02/1"]
    worst = lines("drive", "--again", "two", "--worst", "--no-plot", "--out", "again")
    assert [line.split()[1] for line in worst] == names("two", "worst")


def test_a_test_of_a_campaign_is_changed() -> None:
    roadgpt("edit", "one/2", "--plan", "road: length +20", "--no-drive", "--no-plot", "--out", "edited")
    card = json.loads(Path("edited/runs/0001/edit.json").read_text(encoding="utf-8"))
    assert card["of"] == "one/2"
    again, _ = run_again(Path("one"), "c01", 2)
    assert again.design is not None
    assert card["design_before"] == again.design.to_json()


@pytest.mark.usefixtures("no_workers")
def test_a_campaign_that_was_moved_needs_no_driver() -> None:
    """The file of the driver is gone; what the campaign kept can be seen all the same."""
    Path("mine.py").write_text(
        "from roadgpt.drive import Command\n"
        "class Mine:\n    def steer(self, view):\n        return Command(0.0, 1.0)\n"
    )
    words = ["turn x2 | flat", "--reader", "plan", "-n", 2, "-q", "--driver", "mine.py:Mine"]
    lines("campaign", *words, "--out", "own")
    shutil.move("own", "elsewhere")
    Path("mine.py").unlink()
    assert lines("view", "elsewhere/1") == ["elsewhere-c01-0001-view.html"]
    assert lines("export", "elsewhere", "--worst", "--to", "csv")
