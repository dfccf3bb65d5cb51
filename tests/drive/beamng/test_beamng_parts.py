"""Settings, version pairs, the command line, ports, the watchdog and the self test, each on its own."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest
from beamngpy.connection import Connection
from click.testing import CliRunner

from drive.beamng.fake_beamng import VERSIONS, FakeBeamNG, FakeFault, fake_home
from roadgpt.cli.app import app
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.simulators.beamng import BeamngSettings, BeamngSimulator
from roadgpt.drive.simulators.beamng import session as sessions
from roadgpt.drive.simulators.beamng.compatibility import VERSION_PAIRS, mismatch_advice
from roadgpt.drive.simulators.beamng.launch import command_line
from roadgpt.drive.simulators.beamng.session import leave_all
from roadgpt.drive.simulators.beamng.slots import _user, take
from roadgpt.drive.simulators.beamng.watchdog import OverdueError, Watchdog
from roadgpt.errors import PartError, SimulationError, UsageError
from roadgpt.road import Road, World

OURS = Connection.PROTOCOL_VERSION
SHORT = Road.through([[40, 100], [70, 100], [100, 100]])


def drive(settings: BeamngSettings) -> str:
    return BeamngSimulator(settings).simulate(SHORT, World(), Reference(), 1).ended


def test_settings_come_from_the_environment() -> None:
    told = {"ROADGPT_BEAMNG_PORT": "4000", "ROADGPT_BEAMNG_NOGPU": "1", "BNG_HOME": "/games/b"}
    settings = BeamngSettings.of(told)
    assert (settings.port, settings.nogpu, settings.home) == (4000, True, Path("/games/b"))
    assert not BeamngSettings.of({**told, "ROADGPT_BEAMNG_HOST": "other"}).launches
    with pytest.raises(UsageError, match="ROADGPT_BEAMNG_RATE cannot be '5'"):
        BeamngSettings.of({"ROADGPT_BEAMNG_RATE": "5"})


def test_every_pair_has_its_cure() -> None:
    said = mismatch_advice("v1.24", "v1.27", "1.36")
    assert "BeamNG.tech 0.37 uses protocol v1.24" in said
    assert "pip install beamngpy==1.34.1'" in said
    assert "install BeamNG.tech 0.39" in said
    assert "pip install beamngpy==1.36'" in mismatch_advice("v1.27", "v1.26", "1.35.1")
    assert "pip install beamngpy==1.24', or install BeamNG.tech 0.39" in mismatch_advice(
        "v1.19", "v1.27", "1.36"
    )
    assert "BeamNG.tech 0.36 or 0.35 uses protocol v1.23" in mismatch_advice("v1.23", "v1.27", "1.36")
    assert "0.39 with 1.36" in mismatch_advice("v9", "v1.27", "1.36")
    assert {pair.protocol: pair.tech for pair in VERSION_PAIRS[:3]} == VERSIONS


@pytest.mark.parametrize("other", sorted({*VERSIONS, "v1.19", "v2.0"} - {OURS}))
def test_another_version_is_told_of_with_the_cure(other: str) -> None:
    with FakeBeamNG(protocol=other) as fake:
        with pytest.raises(PartError, match=f"protocol {other}, and the installed beamngpy .* uses {OURS}"):
            drive(BeamngSettings(port=fake.port))
        assert {kind for _, kind in fake.transcript} == {"Hello"}


def test_a_game_that_is_not_tech_is_told_of() -> None:
    with (
        FakeBeamNG(protocol=OURS, tech=False) as fake,
        pytest.raises(PartError, match="needs BeamNG\\.tech"),
    ):
        drive(BeamngSettings(port=fake.port))


def test_a_stranger_on_the_port_is_told_of(port: int) -> None:
    def chat(server: socket.socket) -> None:
        for _ in range(2):  # one who only looks, one who greets
            client, _ = server.accept()
            with suppress(OSError), client:
                client.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                client.recv(100)

    with socket.create_server(("127.0.0.1", port)) as server:
        threading.Thread(target=chat, args=(server,), daemon=True).start()
        with pytest.raises(SimulationError, match="is not BeamNG\\.tech"):
            drive(BeamngSettings(port=port))


def test_nobody_on_the_port_and_no_home_are_told_of(tmp_path: Path, port: int) -> None:
    with pytest.raises(SimulationError, match=f"nobody listens on 127.0.0.1:{port}; give --beamng-home"):
        drive(BeamngSettings(port=port))
    with pytest.raises(PartError, match=r"no BeamNG in .*: --beamng-home is the folder"):
        drive(BeamngSettings(port=port, home=tmp_path))
    with pytest.raises(UsageError, match="has a space"):
        drive(BeamngSettings(port=port, home=tmp_path, user=tmp_path / "a b"))


@pytest.mark.parametrize("number", [0, 1, 2])
@pytest.mark.parametrize("own", [True, False])
@pytest.mark.parametrize("launches", [True, False])
def test_which_user_folder_a_worker_gets(number: int, own: bool, launches: bool, tmp_path: Path) -> None:
    """The first one gets the user's own, the others get one beside it, or in the temporary folder; where
    BeamNG is running already, its folder is its own affair.
    """
    user = tmp_path / "me" if own else None
    home = tmp_path / "home" if launches else None
    found = _user(BeamngSettings(home=home, user=user), number)
    if not launches or number == 0:
        assert found == user
    elif own:
        assert found == tmp_path / f"me-{number + 1}"
        assert found.is_dir()
    else:
        assert found == Path(tempfile.gettempdir(), f"roadgpt-beamng-user-{number + 1}")


def test_a_further_worker_gets_the_licence_from_wherever_the_first_has_it(tmp_path: Path) -> None:
    user, settings = tmp_path / "me", BeamngSettings(home=tmp_path, user=tmp_path / "me")
    for place, text in ((user, "mine"), (user / "0.38", "old"), (user / "0.39", "new")):
        place.mkdir()
        (place / "tech.key").write_text(text)
    (user / "0.40").mkdir()
    (user / "0.39" / "mods.txt").write_text("large")
    second = _user(settings, 1)
    assert second is not None
    copied = {str(path.relative_to(second)): path.read_text() for path in second.rglob("*") if path.is_file()}
    assert copied == {"tech.key": "mine", "0.38/tech.key": "old", "0.39/tech.key": "new"}


@pytest.mark.parametrize("launches", [True, False])
def test_the_first_free_slot_is_taken_with_the_port_and_folder_of_its_number(
    launches: bool, tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roadgpt.drive.simulators.beamng.slots.is_taken", lambda host, at: not launches)
    home = tmp_path if launches else None
    settings = BeamngSettings(port=port, home=home, user=tmp_path / "me", host="localhost")
    taken = [take(settings) for _ in range(3)]
    try:
        assert [slot.port for slot in taken] == [port, port + 1, port + 2]
        names = ["me", "me-2", "me-3"] if launches else ["me"] * 3
        assert [slot.user for slot in taken] == [tmp_path / name for name in names]
        taken[1].release()
        again = take(settings)
        assert (again.port, again.user) == (port + 1, tmp_path / names[1])
        taken[1] = again
    finally:
        for slot in taken:
            slot.release()


def test_a_beamng_that_ends_at_once_or_never_listens_is_told_of(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "slow", protocol=OURS, slow_start=60)
    with pytest.raises(SimulationError, match=f"does not listen on port {port} after 0.5 s"):
        drive(BeamngSettings(port=port, home=home, start_timeout=0.5))
    (home / "settings.json").write_text("no JSON")
    with pytest.raises(SimulationError, match="BeamNG ended at once \\(exit status 1\\)"):
        drive(BeamngSettings(port=port, home=home))


def test_a_slow_start_is_waited_for(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS, slow_start=1.0)
    assert drive(BeamngSettings(port=port, home=home, rate=20)) == "goal"


def test_a_beamng_that_hangs_while_it_starts_costs_one_more_try(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS, faults=[FakeFault("hang", "GetLevels", 0, 1)])
    assert drive(BeamngSettings(port=port, home=home, rate=20, start_timeout=1.5)) == "goal"
    assert len((home / "started.jsonl").read_text().splitlines()) == 2


def test_a_port_that_is_taken_is_passed_over(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS)
    with socket.create_server(("127.0.0.1", port)):
        assert drive(BeamngSettings(port=port, home=home, rate=20)) == "goal"
    words = json.loads((home / "started.jsonl").read_text().splitlines()[0])["words"]
    assert words[words.index("-tport") + 1] == str(port + 1)
    sessions.leave_all()
    slot = take(BeamngSettings(port=port, home=home))
    assert slot.port == port  # let go of, it can be had again
    slot.release()


def test_nothing_of_ours_runs_on_after_a_session(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS)
    drive(BeamngSettings(port=port, home=home, rate=20))
    (started,) = (home / "started.jsonl").read_text().splitlines()
    sessions.leave_all()
    with pytest.raises(ProcessLookupError):
        os.kill(json.loads(started)["pid"], 0)


def test_what_a_killed_worker_left_behind_is_ended(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS)
    code = (
        "import os, signal; from roadgpt.drive.simulators.beamng import BeamngSettings; "
        "from roadgpt.drive.simulators.beamng.session import session_of; "
        f"session_of(BeamngSettings(port={port}, home={str(home)!r})).ready(); "
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == -signal.SIGKILL
    (started,) = (home / "started.jsonl").read_text().splitlines()
    os.kill(json.loads(started)["pid"], 0)  # it lives on
    assert drive(BeamngSettings(port=port, home=home, rate=20)) == "goal"
    first, second = map(json.loads, (home / "started.jsonl").read_text().splitlines())
    assert first["pid"] != second["pid"]
    assert first["words"] == second["words"]  # on the same port, which was free again


def test_the_command_line_is_the_clients(tmp_path: Path) -> None:
    """Ours and beamngpy's own, for all that can be asked for."""
    from beamngpy import BeamNGpy

    for given in ({"headless": True}, {"nogpu": True}, {"gfx": "vk"}, {}):
        settings = BeamngSettings(home=tmp_path, **given)
        ours = command_line(Path("b"), settings, 4, tmp_path)
        if OURS == "v1.27":  # the first that knows all of these options
            theirs = BeamNGpy("127.0.0.1", 4, user=str(tmp_path), **given)
            assert ours == theirs._prepare_call("b", None, "-tcom-listen-ip", "127.0.0.1")
        assert ("-headless" in ours) == bool({"headless", "nogpu"} & {*given})


def test_without_a_gpu_and_with_vulkan_keeps_both(tmp_path: Path) -> None:
    words = command_line(Path("b"), BeamngSettings(home=tmp_path, nogpu=True, gfx="vk"), 4, None)
    assert " ".join(words).endswith("-headless -gfx vk -gfx null")


def test_a_client_that_nobody_tried_is_warned_of_and_driven(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("roadgpt.drive.simulators.beamng.session.version", lambda name: "1.99")
    with FakeBeamNG(protocol=OURS) as fake, caplog.at_level("WARNING", logger="roadgpt"):
        drive = BeamngSimulator(BeamngSettings(port=fake.port, rate=20)).simulate(
            SHORT, World(), BeamngLike(), 7
        )
        leave_all()
    assert drive.ended == "goal"
    assert any("beamngpy 1.99 has not been tried with RoadGPT" in one.message for one in caplog.records)


def test_the_documents_name_the_same_pairs() -> None:
    text = (Path(__file__).parents[3] / "docs" / "how-to" / "use-beamng.md").read_text()
    rows = re.findall(r"^\| (\d\S*) \| (\S+) \| (\S+) \| (.*?) \|", text, flags=re.M)
    assert [(tech, client, protocol) for tech, client, protocol, _ in rows] == [
        pair[:3] for pair in VERSION_PAIRS
    ]
    assert [said.startswith("yes") for *_, said in rows] == [pair.is_tried for pair in VERSION_PAIRS]


def test_the_watchdog_ends_a_call_that_hangs_and_lets_others_be() -> None:
    ours, theirs = socket.socketpair()
    killed: list[bool] = []
    dog = Watchdog(lambda: [ours], lambda: killed.append(True))
    begun = time.monotonic()

    def ask() -> None:
        with dog.within(0.3, "it was asleep"):
            if not ours.recv(1):
                raise ConnectionError

    with pytest.raises(OverdueError, match=r"no answer within 0\.3 s while it was asleep"):
        ask()
    assert time.monotonic() - begun < 3
    assert killed == [True]
    other = Watchdog(lambda: [theirs], lambda: killed.append(True))
    with other.within(0.2, "others"):
        other.pause()  # a driver thinks
        time.sleep(0.5)
        other.due_in(5)
    with pytest.raises(KeyError), other.within(5, "others"):
        raise KeyError
    assert not other.has_fired
    ours.close()
    theirs.close()


def test_the_self_test_writes_a_report(tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS)
    monkeypatch.setenv("ROADGPT_BEAMNG_RATE", "20")
    for name in ("HOME", "USER", "PORT"):  # what the options set goes again with the test
        monkeypatch.setenv(f"ROADGPT_BEAMNG_{name}", "")
    words = [
        "beamng",
        "selftest",
        "--out",
        str(tmp_path / "out"),
        "--repeats",
        "2",
        "--beamng-home",
        str(home),
    ]
    words += ["--beamng-user", str(tmp_path / "user"), "--beamng-port", str(port)]
    done = CliRunner().invoke(app, words, standalone_mode=False)
    assert done.exception is None, done.output
    report = json.loads((tmp_path / "out" / "beamng-selftest.json").read_text())
    assert len(report["checks"]) == 10
    assert all(check["is_fine"] for check in report["checks"]), report
    assert "34 degrees to the right" in report["checks"][7]["said"]
    page = (tmp_path / "out" / "beamng-selftest.md").read_text()
    assert page.count("| yes |") == 10
    assert (tmp_path / "out" / report["pictures"][0]).stat().st_size > 100


def test_the_self_test_finds_what_is_wrong(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("HOME", "PORT"):
        monkeypatch.setenv(f"ROADGPT_BEAMNG_{name}", "")
    words = ["beamng", "selftest", "--out", str(tmp_path), "--beamng-port", str(port)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 1
    assert "PROBLEM  connection: SimulatorError: nobody listens" in done.output
    assert "1 of 1 checks found a problem" in done.output
