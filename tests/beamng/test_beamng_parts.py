"""Settings, version pairs, the command line, ports, the watchdog and the self test, each on its own."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest
from beamngpy.connection import Connection
from click.testing import CliRunner

from beamng.fake_beamng import VERSIONS, FakeBeamNG, fake_home
from roadgpt.cli.app import app
from roadgpt.drive.drivers.reference import Reference
from roadgpt.errors import PartError, SimulationError, UsageError
from roadgpt.road import Road, World
from roadgpt_beamng import session as sessions
from roadgpt_beamng.launch import command_line, take
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_beamng.simulator import BeamngSimulator
from roadgpt_beamng.watchdog import OverdueError, Watchdog

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


@pytest.mark.parametrize("other", sorted({*VERSIONS, "v1.19", "v2.0"} - {OURS}))
def test_another_version_is_told_of_with_the_cure(other: str) -> None:
    with FakeBeamNG(protocol=other) as fake:
        with pytest.raises(PartError, match=f"protocol {other}, and the installed beamngpy .* uses {OURS}"):
            drive(BeamngSettings(port=fake.port))
        assert {kind for _, kind in fake.transcript} == {"Hello"}


def test_a_game_that_is_not_tech_is_told_of() -> None:
    with FakeBeamNG(protocol=OURS, tech=False) as fake, pytest.raises(PartError, match="needs BeamNG\\.tech"):
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


@pytest.mark.parametrize("launches", [True, False])
def test_the_first_free_slot_is_taken_with_the_port_and_folder_of_its_number(
    launches: bool, tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roadgpt_beamng.launch.is_taken", lambda host, at: not launches)
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


def test_what_a_killed_worker_left_behind_is_ended(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS)
    code = (
        "import os, signal; from roadgpt_beamng.settings import BeamngSettings; "
        "from roadgpt_beamng.session import session_of; "
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
    words = ["doctor", "beamng", "--out", str(tmp_path / "out"), "--repeats", "2", "--beamng-home", str(home)]
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
