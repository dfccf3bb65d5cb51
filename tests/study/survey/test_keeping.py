"""Answers are kept: of many raters at once, and when the server's process is killed."""

import os
import re
import signal
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from http.client import HTTPException
from pathlib import Path

import pytest

from roadgpt.errors import RoadGPTError, UsageError
from roadgpt_study.survey.serving import open_server
from roadgpt_study.survey.store import ANSWERS, AnswerStore, digest_of
from roadgpt_study.survey.survey import ALIKE, MATCHES, read_survey
from survey_made import Client, agreed, folder_of, port_of, served, survey

RATERS = 50
WITHOUT = """
import sys
for name in ("starlette", "uvicorn"):
    sys.modules[name] = None  # as where it is not installed
import roadgpt_study.study_report, roadgpt_study.execution
import roadgpt_study.survey.build, roadgpt_study.survey.analysis, roadgpt_study.survey.rating_charts
from roadgpt.__main__ import main
roadgpt_study.survey.rating_charts.save_all = lambda *_: []  # charts stay on the page; a PDF takes seconds
for words in sys.argv[1:]:
    sys.argv[1:] = words.split()
    try:
        main()
    except SystemExit as end:
        print(f"status {end.code or 0}")
"""


def rows(folder: Path) -> set[tuple[str, str, str]]:
    """What another program reads in the file of answers."""
    with closing(sqlite3.connect(folder / ANSWERS)) as file:
        return {(rater, question, value) for rater, question, value in file.execute("SELECT * FROM answers")}


def test_fifty_raters_at_once_lose_no_answer(tmp_path: Path) -> None:
    folder = folder_of(survey(), tmp_path / "s")
    wanted: list[tuple[str, str, str]] = []
    failed: list[object] = []
    with served(folder) as server:
        tokens = [agreed(server) for _ in range(RATERS)]
        together = threading.Barrier(RATERS)

        def rate(number: int, token: str) -> None:
            client = Client(port_of(server))
            try:
                together.wait(30)
                for step, question in enumerate(("a1.overall", "a2.overall", "a3.1", "a1.overall")):
                    value = MATCHES[(number + step) % 5]
                    reply = client.save(token, question, value)
                    if reply.status != 200:
                        failed.append(reply)
                moved = client.post(f"/r/{token}/1", {"about.age": "20 to 29", "go": "skip"})
                if moved.status != 303:
                    failed.append(moved)
            except (OSError, HTTPException, threading.BrokenBarrierError) as error:
                failed.append(error)
            finally:
                client.close()
            last = MATCHES[(number + 3) % 5]
            said = {
                "a1.overall": last,
                "a2.overall": MATCHES[(number + 1) % 5],
                "a3.1": MATCHES[(number + 2) % 5],
            }
            wanted.extend((digest_of(token), question, value) for question, value in said.items())
            wanted.append((digest_of(token), "about.age", "20 to 29"))

        threads = [threading.Thread(target=rate, args=each) for each in enumerate(tokens)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert failed == []
    assert len(wanted) == 4 * RATERS
    assert rows(folder) == set(wanted)


@contextmanager
def command(folder: Path, *words: str) -> Iterator[tuple[subprocess.Popen[str], list[str], int]]:
    """The command that people start; its links and its port."""
    process = subprocess.Popen(
        [sys.executable, "-m", "roadgpt", "study", "survey", "serve", str(folder), "--port", "0", *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        said = ""
        for line in process.stdout:
            said += line
            if "Ctrl-C" in line:
                break
        port = re.search(r"127\.0\.0\.1:(\d+)", said)
        assert port, said + (process.stderr.read() if process.stderr else "")
        yield process, re.findall(r"/r/([\w-]+)$", said, re.M), int(port[1])
    finally:
        process.kill()
        process.communicate()


def test_what_was_confirmed_outlives_kill_9(tmp_path: Path) -> None:
    folder = folder_of(survey(), tmp_path / "s")
    confirmed: dict[tuple[str, str], str] = {}
    under_way: dict[str, tuple[str, str]] = {}
    tokens: list[str] = []
    for patience in (7, 23):
        with command(folder, "--raters", "3") as (process, links, port):
            assert len(links) == 3
            assert tokens in ([], links), "links stay the same"
            tokens = links
            enough = threading.Semaphore(0)

            def rate(
                token: str, port: int = port, enough: threading.Semaphore = enough, most: int = patience
            ) -> None:
                client = Client(port)
                try:
                    client.post(f"/r/{token}", {"agree": "yes"})
                    for step in range(1000):
                        question, value = f"a{step % 3 + 1}.overall", MATCHES[step % 5]
                        under_way[token] = (question, value)
                        if client.save(token, question, value).status == 200:
                            confirmed[token, question] = value
                        if step == most:
                            enough.release()
                except (OSError, HTTPException):
                    pass  # the server was killed: what was under way may be kept or not
                finally:
                    client.close()

            threads = [threading.Thread(target=rate, args=(token,)) for token in tokens]
            for thread in threads:
                thread.start()
            for _ in tokens:  # each of them, for none waits for another
                assert enough.acquire(timeout=60)
            process.send_signal(signal.SIGKILL)
            for thread in threads:
                thread.join()
        with closing(sqlite3.connect(folder / ANSWERS)) as file:
            assert file.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        there = {(rater, question): value for rater, question, value in rows(folder)}
        for (token, question), value in confirmed.items():
            found = there[digest_of(token), question]
            assert found == value or (question, found) == under_way[token]
        assert len(confirmed) == 9
    with served(folder) as server:
        client = Client(port_of(server))
        assert "/r/" in client.get(f"/r/{tokens[0]}").headers["location"], "and it goes on where it was"
        client.close()


def test_ctrl_c_ends_the_server_among_many_requests(tmp_path: Path) -> None:
    """A signal that comes within a request is no error of that request: it ends the server as well."""
    folder = folder_of(survey(), tmp_path / "s")
    with command(folder, "--raters", "8") as (process, links, port):
        answered = threading.Semaphore(0)

        def read(token: str) -> None:
            client = Client(port)
            try:
                while client.get(f"/r/{token}").status == 200:
                    answered.release()
            except (OSError, HTTPException):
                pass  # the server has ended
            finally:
                client.close()

        threads = [threading.Thread(target=read, args=(token,)) for token in links]
        for thread in threads:
            thread.start()
        for _ in range(100):
            assert answered.acquire(timeout=60)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
        for thread in threads:
            thread.join()
    assert process.returncode == 130
    assert "0 of 8 raters agreed so far" in out
    assert err.strip() == ""


def test_only_serving_needs_the_extra(tmp_path: Path) -> None:
    folder = folder_of(survey(), tmp_path / "s")

    survey_ = "study survey"
    lines = [f"{survey_} serve {folder}", f"{survey_} analyse {folder} --synthetic 3"]
    done = subprocess.run([sys.executable, "-c", WITHOUT, *lines], capture_output=True, text=True, check=True)
    assert re.findall(r"^status (\d+)$", done.stdout, re.M) == ["2", "0"], done.stderr
    assert done.stderr.count("\n") == 1
    assert "[survey]'" in done.stderr
    assert not (folder / ANSWERS).exists()


def test_every_commit_waits_for_the_disk(tmp_path: Path) -> None:
    store = AnswerStore(tmp_path / ANSWERS)
    told = {
        name: store._file.execute(f"PRAGMA {name}").fetchone()[0]
        for name in ("journal_mode", "synchronous", "secure_delete")
    }
    store.close()
    assert told == {"journal_mode": "wal", "synchronous": 2, "secure_delete": 1}


def test_answers_come_all_or_none_and_only_from_raters_who_agreed(tmp_path: Path) -> None:
    store = AnswerStore(tmp_path / ANSWERS)
    token = store.add_rater()
    rater = store.rater_of(token)
    assert rater is not None
    assert not store.save(rater, {"a1.overall": MATCHES[0]})
    store.agree(rater)
    with pytest.raises(sqlite3.Error):
        store.save(rater, {"a1.overall": MATCHES[0], "a2.overall": ["no text"]})  # type: ignore[dict-item]
    assert store.answers_of(rater) == {}
    assert store.save(rater, {"s1.overall": ALIKE[0]})
    store.withdraw(rater)
    store.agree(rater)
    assert not store.save(rater, {"s1.overall": ALIKE[0]}), "who withdrew stays withdrawn"
    store.close()


def test_what_cannot_be_served_is_told_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="holds no survey"):
        open_server(tmp_path, "127.0.0.1", 0)
    folder = folder_of(survey(), tmp_path / "s")
    with served(folder) as server, pytest.raises(UsageError, match=r"cannot listen on 127\.0\.0\.1, port"):
        open_server(folder, "127.0.0.1", port_of(server))
    with pytest.raises(UsageError, match=r"cannot listen on no\.such\.host\.example"):
        open_server(folder, "no.such.host.example", 0)
    (folder / ANSWERS).unlink()
    (folder / ANSWERS).write_bytes(b"this is no file of answers, but it is long enough to look at" * 20)
    with pytest.raises(RoadGPTError, match="cannot be opened"):
        open_server(folder, "127.0.0.1", 0)
    (folder / "survey.json").write_text("{}")
    with pytest.raises(UsageError, match="damaged"):
        read_survey(folder)


@pytest.mark.skipif(sys.platform == "win32", reason="no such rights")
def test_answers_are_for_their_owner_alone(tmp_path: Path) -> None:
    """Whatever the usual rights of new files are, and also where the file was there before."""
    before = os.umask(0)
    try:
        store = AnswerStore(tmp_path / ANSWERS)
        store.add_rater()
        made = [*tmp_path.iterdir()]
        assert {path.stat().st_mode & 0o777 for path in made} == {0o600}
        assert len(made) > 1  # its log is beside it
        store.close()
        (tmp_path / ANSWERS).chmod(0o666)
        AnswerStore(tmp_path / ANSWERS).close()
        assert (tmp_path / ANSWERS).stat().st_mode & 0o777 == 0o600
    finally:
        os.umask(before)
