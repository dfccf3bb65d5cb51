"""What decides results is recorded, and results are never continued, or shown as new, when it has changed."""

import json
import re
import shutil
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from hashlib import sha256
from pathlib import Path
from random import Random

import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st

from roadgpt import plugins
from roadgpt.brief.model import Brief, Clause
from roadgpt.campaign import campaign
from roadgpt.campaign.record import STORE, Record, Store
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.loading import WRITTEN
from roadgpt.errors import UsageError
from roadgpt.reading import digest
from roadgpt.run import Run, Setup, read_run, versions
from roadgpt.run.versions import joined

MINE = """
import ctypes, json, os, sys, tempfile
from pathlib import Path
from gains import GAIN
from roadgpt.drive import Command

HERE = Path(__file__).parent


class Mine:
    uses = ["extra.bin", "tables", "../shared/map.bin"]

    def __init__(self):
        conf = HERE / "local.json"
        self.gain = json.loads((conf if conf.exists() else HERE / "conf.json").read_text())["gain"]
        (HERE / "log.txt").open("a").write("made\\n")
        with tempfile.NamedTemporaryFile("w+") as file:
            Path(file.name).read_text()
        (HERE / ".." / "shared" / "seen by nobody.txt").read_text()

    def start(self, road, world, seed):
        self.weight = float((HERE / "net.txt").read_text())
        (HERE / "state.txt").write_text(str(seed))
        (HERE / "state.txt").read_text()
        try:
            (HERE / "gone.txt").read_text()
        except FileNotFoundError:
            pass
        sys.path.append(str(HERE))

    def steer(self, view):
        import lazy
        import numpy.polynomial
        return Command(GAIN * self.gain * self.weight * lazy.GAIN, 0.5, 0.0)
"""
SEEN = {
    "mine.py", "gains.py", "lazy.py", "conf.json", "net.txt", "extra.bin", "tables", "../shared/map.bin",
}  # fmt: skip
SPEC = "car/mine.py:Mine"
ROADS = ("turn x2", "--reader", "plan", "-n", "2", "--seed", "3", "--driver", SPEC)


def invoke(*words: str) -> Result:
    result = CliRunner().invoke(app, words, prog_name="roadgpt")
    assert "Traceback" not in result.output
    return result


COMMANDS = {
    "run": ("run", *ROADS, "--out", "runs", "--no-plot", "-q"),
    "run, one more": ("run", *ROADS, "-n", "3", "--out", "runs", "--no-plot", "-q"),
    "campaign": ("campaign", *ROADS, "--out", "tests", "-q"),
    "resume runs": ("resume", "runs", "--driver", SPEC, "-q"),
    "resume tests": ("resume", "tests", "--driver", SPEC, "-q"),
    "resume half": ("resume", "half", "--driver", SPEC, "-q"),
    "faults of runs": ("faults", "runs", "--driver", SPEC, "-q"),
    "faults of tests": ("faults", "tests", "--driver", SPEC, "-q"),
}


def write_driver(place: Path) -> None:
    for name, text in {
        "car/mine.py": MINE, "car/gains.py": "GAIN = 0.1", "car/lazy.py": "GAIN = 1.0",
        "car/conf.json": '{"gain": 1.0}', "car/extra.bin": "x", "car/tables/a/b.csv": "1,2",
        "car/net.txt": "1.0", "shared/map.bin": "m", "shared/seen by nobody.txt": "",
    }.items():  # fmt: skip
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(text)


def rows(path: Path) -> bytes:
    with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)) as db:
        return "\n".join(db.iterdump()).encode()


def contents(folder: str | Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): rows(path) if path.suffix == ".sqlite" else path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file() and path.name not in ("seconds.json", "generation_stats.csv")
        if path.suffix not in (".sqlite-wal", ".sqlite-shm")
    }


def recorded(folder: str | Path) -> dict[str, str]:
    with Record.opened(Path(folder)) as record:
        return record.versions(record.plan().drivers[0])


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two folders of results, finished, and one that is not; everywhere the driver fails."""
    place = tmp_path_factory.mktemp("what decides")
    write_driver(place)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        for name in ("run", "campaign"):
            done = invoke(*COMMANDS[name])
            assert done.exit_code == 0, done.output
        shutil.copytree("runs", "half")
        with Store.opened(Path("half")) as store:
            store.reopen("", 2, 1)
            store.finish(is_finished=False)
    return place


@pytest.fixture
def here(made: Path, monkeypatch: pytest.MonkeyPatch, no_workers: None) -> Path:
    """The folder of these; tests leave it as it was."""
    monkeypatch.chdir(made)
    return made


@contextmanager
def changed(file: str, content: str | None) -> Iterator[None]:
    """A file with other content, or without the file."""
    path, before = Path(file), Path(file).read_bytes() if Path(file).exists() else None
    path.unlink(missing_ok=True) if content is None else path.write_text(content)
    try:
        yield
    finally:
        path.unlink(missing_ok=True) if before is None else path.write_bytes(before)


def refused(says: str, *names: str) -> None:
    """Each command is refused in a sentence, and nothing is lost."""
    for name in names or COMMANDS:
        place = next(each for each in ("runs", "tests", "half") if each in COMMANDS[name])
        before = contents(place)
        done = invoke(*COMMANDS[name])
        assert done.exit_code == 2, (name, done.output)
        (line,) = done.stderr.strip().splitlines()
        assert re.fullmatch(
            rf"roadgpt: what decides the results in {place} has changed: {says}; name another folder, or add "
            "--again to the command that made this one, to make all its tests anew",
            line,
        ), (name, line)
        assert contents(place) == before


def test_the_record_names_every_file_that_decides_and_no_other(here: Path) -> None:
    for folder in ("runs", "tests"):
        found = recorded(folder)
        files = {
            name.removeprefix("driver:"): its for name, its in found.items() if name.startswith("driver:")
        }
        read = {name: sha256(Path("car", name).read_bytes()).hexdigest()[:16] for name in SEEN - {"tables"}}
        assert files.pop("tables") == digest(Path("car", "tables"))
        assert files == read | {"state.txt": WRITTEN, "log.txt": WRITTEN, "gone.txt": "absent"}
        assert str(here) not in json.dumps(found)
        shown = invoke("show", *(["runs/runs/0001"] if folder == "runs" else ["tests/c01/1"])).output
        assert f"driver:mine.py {files['mine.py']}" in shown
        assert re.search(r"roadgpt 0.1.0, roadgpt source [0-9a-f]{16}, python 3", shown)
    early = SEEN - {"lazy.py"} | {"log.txt", "state.txt", "gone.txt"}
    for number in (1, 2):  # a Run has what its driver used until start ended, whatever the process did before
        found = read_run(Path("runs", "runs", f"{number:04d}")).versions
        assert {name for name in found if ":" in name} == {f"driver:{name}" for name in early}


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("mine.py", COMMANDS), ("gains.py", ("resume tests",)), ("conf.json", ("campaign",)),
        ("net.txt", ("run",)), ("tables/a/b.csv", ("resume tests",)),
        ("../shared/map.bin", ("resume tests",)),
    ],
)  # fmt: skip
def test_results_of_another_driver_are_not_shown_as_its(here: Path, file: str, names: list[str]) -> None:
    with changed(f"car/{file}", Path("car", file).read_text() + " "):
        file = "tables" if "tables" in file else file
        its = digest(Path("car", file))
        refused(rf"the driver's file {re.escape(file)} \(was [0-9a-f]{{16}}, is {its}\)", *names)


def test_a_file_that_has_gone_or_come_is_a_change(here: Path) -> None:
    with changed("car/net.txt", None):
        refused(r"the driver's file net.txt \(was [0-9a-f]{16}, is absent\)", "run", "faults of tests")
    with changed("car/gone.txt", ""):
        refused(r"the driver's file gone.txt \(was absent, is [0-9a-f]{16}\)", "campaign", "resume half")
    with changed("car/local.json", '{"gain": 0.0}'):  # only a driver that is loaded shows that it is read now
        loading = "run", "campaign", "faults of runs"
        refused(r"the driver's file local.json \(was absent, .*", *loading)
    with changed("car/state.txt", "9"), changed("car/log.txt", "9"):  # the driver writes these itself
        assert invoke(*COMMANDS["run"]).exit_code == 0


def test_another_roadgpt_is_a_change(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(versions, "__version__", "9.9.9")
    refused(r"roadgpt \(was 0.1.0, is 9.9.9\)")
    monkeypatch.undo()
    monkeypatch.chdir(here)
    monkeypatch.setattr(versions, "_source", lambda place: "0" * 64)
    both = (
        r"roadgpt source \(was [0-9a-f]{16}, is 0{64}\), plug-ins \(was roadgpt_sbft .*, is roadgpt_sbft .*\)"
    )
    refused(both, "run", "resume half", "resume runs")


@pytest.fixture
def rules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An installed package with a rule."""
    (tmp_path / "acme_rules.py").write_text("def inspect(network, route, brief, world):\n    return ()\n")
    info = tmp_path / "acme-1.0.dist-info"
    info.mkdir()
    (info / "entry_points.txt").write_text("[roadgpt.rules]\nkind = acme_rules:inspect\n")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: acme\nVersion: 1.0\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    fresh()
    yield tmp_path
    monkeypatch.undo()
    fresh()


def fresh() -> None:
    """Forgets what was installed."""
    plugins._registered.cache_clear()
    plugins._every.cache_clear()
    versions._source.cache_clear()
    sys.modules.pop("acme_rules", None)


def test_another_plugin_or_version_of_it_is_a_change(rules: Path, here: Path) -> None:
    digest = r"\([0-9a-f]{16}\)"
    own = rf"roadgpt_sbft 0.1.0 {digest}, roadgpt_search 0.1.0 {digest}"  # whose rules and columns are asked
    change = rf"plug-ins \(was {own}, is acme 1.0 {digest}, {own}\)"
    refused(change, "run", "campaign", "faults of runs")
    roads = ("run", "turn x2", "--reader", "plan", "--seed", "3", "--no-drive", "--no-plot", "-q")
    out = (*roads, "--out", str(rules / "own"))
    assert invoke(*out).exit_code == 0
    card = rules / "acme-1.0.dist-info" / "METADATA"
    card.write_text(card.read_text().replace("1.0", "1.1"))
    fresh()
    assert re.search(r"plug-ins \(was acme 1\.0 \(.*, is acme 1\.1 \(", (said := invoke(*out)).stderr)
    assert said.exit_code == 2
    card.write_text(card.read_text().replace("1.1", "1.0"))
    fresh()
    assert invoke(*out).exit_code == 0
    with (rules / "acme_rules.py").open("a") as file:  # as while it is developed
        file.write("\n")
    fresh()
    assert invoke(*out).exit_code == 2
    card.unlink()
    (rules / "acme-1.0.dist-info" / "entry_points.txt").unlink()
    fresh()
    assert re.search(rf", is {own}\)", invoke(*out).stderr)


@pytest.mark.parametrize(
    ("option", "value", "says"),
    [
        ("--friction", "0.5", "friction"), ("--speed-limit", "50", "speed_limit"),
        ("--driver", "reference", "driver"), ("--seed", "4", "seed"),
        ("--keep-driving", None, "keep_driving"),
    ],
)  # fmt: skip
def test_another_setting_is_a_change(here: Path, option: str, value: str | None, says: str) -> None:
    before = contents("runs")
    done = invoke(*COMMANDS["run"], option, *([value] if value else []))
    assert done.exit_code == 2
    assert done.stderr.strip() == (
        f"roadgpt: runs holds other roads (different {says}); name another folder, or add --again to make "
        "all its tests anew"
    )
    assert contents("runs") == before
    done = invoke(*COMMANDS["campaign"], "--friction", "0.5")
    assert done.exit_code == 2
    assert "add --again" in done.stderr


def test_another_reading_of_the_same_words_is_a_change(tmp_path: Path) -> None:
    words, setup = "a road", Setup(drives=False)
    one, two = (Brief(words=words, clauses=(Clause(kind="turn"),) * count) for count in (1, 2))
    assert len([*campaign(one, 1, 3, setup=setup, out=tmp_path)]) == 1
    assert not [*campaign(one, 1, 3, setup=setup, out=tmp_path)]
    with pytest.raises(UsageError, match=r"different reading of the description"):
        campaign(two, 2, 3, setup=setup, out=tmp_path)


def test_results_of_a_version_that_recorded_nothing_are_not_continued(here: Path, tmp_path: Path) -> None:
    shutil.copytree("half", tmp_path / "old")
    with closing(sqlite3.connect(tmp_path / "old" / STORE)) as db, db:
        db.execute("UPDATE meta SET value = '[{}]' WHERE name = 'versions'")
    done = invoke("resume", str(tmp_path / "old"), "--driver", SPEC)
    assert done.exit_code == 2
    assert re.search(r"has changed: roadgpt \(was not recorded, is 0.1.0\), .*; name another", done.stderr)
    assert invoke("show", str(tmp_path / "old")).exit_code == 0


def test_what_has_not_changed_goes_on_to_the_same_bytes(here: Path, tmp_path: Path) -> None:
    for file in SEEN - {"tables"}:  # only its time differs
        Path("car", file).write_bytes(Path("car", file).read_bytes())
    Path("car", "tables", "__pycache__").mkdir(exist_ok=True)
    Path("car", "tables", "__pycache__", "x.pyc").write_text("")
    shutil.copytree("half", tmp_path / "half")
    assert invoke("resume", str(tmp_path / "half"), "--driver", SPEC, "-q").exit_code == 0
    parts, whole = contents(tmp_path / "half"), contents("runs")
    same = [name for name in whole if not name.endswith(".lock") and name != STORE]  # it holds times
    assert {name: parts[name] for name in same} == {name: whole[name] for name in same}
    assert invoke(*COMMANDS["campaign"]).exit_code == 0
    assert invoke("show", "runs").exit_code == 0


@pytest.mark.parametrize("name", ["run", "resume runs", "campaign", "resume tests"])
def test_again_makes_all_anew_and_keeps_what_was_there(here: Path, tmp_path: Path, name: str) -> None:
    place = "runs" if "runs" in COMMANDS[name] else "tests"
    mine = tmp_path / place
    words = [str(mine) if word == place else word for word in COMMANDS[name]]
    shutil.copytree(place, mine)
    was = contents(place)
    with changed("car/gains.py", "GAIN = -1.0"):
        assert invoke(*words).exit_code == 2
        assert invoke(*words, "--again").exit_code == 0
        before, now = contents(mine / "before-1"), contents(mine)
        assert {key: its for key, its in was.items() if not key.endswith(".lock")} == before
        same = "runs/0001/drive.npz" if place == "runs" else "results.csv"
        assert was[same] != now[same]
        assert recorded(mine) != recorded(place)
        if name == "run":
            assert invoke("show", str(mine / "before-1")).exit_code == 0
            assert invoke(*words, "--again").exit_code == 0
            assert contents(mine / "before-1") == before
            assert contents(mine / "before-2")[same] == now[same]


def runs_of(place: Path, roads: int, out: str) -> "Iterator[Run]":
    brief, setup = Brief(words="turn x2", clauses=(Clause(kind="turn"),) * 2), Setup(driver=str(place / SPEC))
    return iter(campaign(brief, roads, 3, setup=setup, out=place / out))


def test_a_driver_that_is_changed_while_it_drives_ends_the_work(tmp_path: Path) -> None:
    write_driver(tmp_path)
    drives = runs_of(tmp_path, 3, "c")
    next(drives)
    with (
        changed(str(tmp_path / "car" / "mine.py"), MINE + " "),
        pytest.raises(UsageError, match=r"the driver's file mine\.py \(was"),
    ):
        next(drives)
    assert [path.name for path in sorted((tmp_path / "c").glob("test.*"))] == ["test.0001.json"]
    assert [run.index for run in runs_of(tmp_path, 3, "c")] == [2, 3]


def test_modules_of_another_driver_or_of_another_day_are_not_used(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_driver(tmp_path / name)
    (tmp_path / "b" / "car" / "gains.py").write_text("GAIN = -1.0")
    (one,), (other,) = (runs_of(tmp_path / name, 1, "c") for name in ("a", "b"))
    assert one.drive is not None
    assert other.drive is not None
    assert one.drive.to_bytes() != other.drive.to_bytes()
    (tmp_path / "a" / "car" / "gains.py").write_text("GAIN = -1.0")
    (later,) = runs_of(tmp_path / "a", 1, "d")
    assert later.drive.to_bytes() == other.drive.to_bytes()


def test_what_a_class_says_it_uses_has_to_be_there(tmp_path: Path) -> None:
    write_driver(tmp_path)
    (tmp_path / "car" / "extra.bin").unlink()
    with pytest.raises(
        UsageError, match=r"class lists 'extra\.bin' in uses, and there is no .*extra\.bin; correct it"
    ):
        driver_of(str(tmp_path / SPEC))


@given(
    st.lists(
        st.dictionaries(st.sampled_from("abcde"), st.sampled_from(["1", WRITTEN]), max_size=4),
        min_size=1,
        max_size=5,
    ),
    st.randoms(use_true_random=False),
)
def test_the_record_does_not_depend_on_the_order_of_tests(
    files: list[dict[str, str]], random: Random
) -> None:
    found = []
    for _ in range(2):
        record = {"roadgpt": "0.1.0", "roadgpt source": "s"}
        for each in files:
            record = joined(record, each, "c")
        found.append(json.dumps(record))
        random.shuffle(files)
    assert found[0] == found[1]
    assert record.keys() == {"roadgpt", "roadgpt source"} | {
        f"driver:{name}" for each in files for name in each
    }
    for name, its in record.items():
        if its == "1":
            with pytest.raises(UsageError, match=rf"the driver's file {name[-1]} \(was 1, is 2\)"):
                joined(record, {name[-1]: "2"}, "c")
