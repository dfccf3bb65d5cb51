"""Files that are broken, or meant to do harm: one sentence each, in bounded time and memory."""

import os
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from exported import ROADS, WORLD
from roadgpt.errors import UsageError
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import read_opendrive
from roadgpt_formats.opendrive import tree

SOUND = document(ROADS["arcs"], WORLD).to_text()
BODY = SOUND.split("?>", 1)[1]


def refused(folder: Path, content: str | bytes) -> str:
    """The sentence; it comes within seconds and megabytes."""
    path = folder / "bad.xodr"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    begun = time.perf_counter()
    with pytest.raises(UsageError) as caught:
        read_opendrive(path)
    assert time.perf_counter() - begun < 20
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    assert len(said) < 400 + len(str(path))
    return said.removeprefix(f"{path}: ")


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.7, 0.99])
def test_half_a_file(tmp_path: Path, share: float) -> None:
    assert "it is not well-formed XML" in refused(tmp_path, SOUND[: int(share * len(SOUND))])


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999", "", "abc", "1_0", "0x10", "1e13", "٣"])
@pytest.mark.parametrize("name", ["hdg", "curvature", "a", "x"])
def test_numbers_that_are_none(tmp_path: Path, name: str, value: str) -> None:
    before, after = SOUND.split(f' {name}="', 1)
    said = refused(tmp_path, f'{before} {name}="{value}"{after.split(chr(34), 1)[1]}')
    assert f"{name} is " in said
    assert "correct it" in said


@contextmanager
def listening() -> Iterator[tuple[str, list[str]]]:
    """A web server, and who asked it."""
    asked: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_response(200)
            self.end_headers()

        def log_message(self, *args: object) -> None:
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/", asked
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def test_no_entity_is_fetched_or_expanded(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("do not tell")
    with listening() as (url, asked):
        for source in (url, secret.as_uri()):
            for dtd in (
                f'<!DOCTYPE OpenDRIVE [<!ENTITY e SYSTEM "{source}">]>',
                f'<!DOCTYPE OpenDRIVE SYSTEM "{source}">',
                f'<!DOCTYPE OpenDRIVE [<!ENTITY % p SYSTEM "{source}"> %p;]>',
            ):
                body = BODY.replace('name="road" length', 'name="&e;" length') if "ENTITY e" in dtd else BODY
                said = refused(tmp_path, f'<?xml version="1.0"?>{dtd}{body}')
                assert said == "it has a DOCTYPE, which OpenDRIVE has no use for; remove it"
        assert asked == []


def test_a_bomb_of_entities(tmp_path: Path) -> None:
    levels = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 12))
    bomb = f'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY e0 "ha">{levels}]><OpenDRIVE>&e11;</OpenDRIVE>'
    assert "DOCTYPE" in refused(tmp_path, bomb)
    assert "not well-formed XML (undefined entity" in refused(tmp_path, "<OpenDRIVE>&e11;</OpenDRIVE>")


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (lambda: "<OpenDRIVE>" + "<x/>" * 600_000 + "</OpenDRIVE>", "more than 500,000 elements"),
        (lambda: "<OpenDRIVE><road>" + "<x>" * 400_000, "elements too deep"),
        (lambda: '<OpenDRIVE a="' + "a" * 30_000_000 + '"/>', "one tag is longer than a megabyte"),
        (lambda: "<OpenDRIVE " + "".join(map('a{}="1" '.format, range(200_000))) + "/>", "one tag is longer"),
        (lambda: "<OpenDRIVE>" + " " * tree.LARGEST + "</OpenDRIVE>", "larger than 50 MB"),
    ],
    ids=["elements", "depth", "attribute", "attributes", "size"],
)
def test_too_much_of_anything(tmp_path: Path, content: Callable[[], str], sentence: str) -> None:
    text = content()
    tracemalloc.start()
    try:
        assert sentence in refused(tmp_path, text)
        assert tracemalloc.get_traced_memory()[1] < 400e6
    finally:
        tracemalloc.stop()


def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.xodr"
    os.mkfifo(pipe)
    with pytest.raises(UsageError, match="it is a pipe or a device, not a file"):
        read_opendrive(pipe)


def test_a_line_of_two_hundred_thousand_elements(tmp_path: Path) -> None:
    begin, rest = SOUND.split("<planView>")
    end = rest.split("</planView>")[1]
    whole = '<geometry s="0" x="0" y="0" hdg="0" length="0.01"><line/></geometry>'
    for one, count, most in (
        (whole, 10_000, "4,000"),
        ("<geometry><line/></geometry>", 200_000, "60,000"),
    ):
        said = refused(tmp_path, f"{begin}<planView>{one * count}</planView>{end}")
        assert f"more than {most} elements" in said


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"\x00\x01\x02\xff" * 100, "not well-formed XML"),
        (b"PK\x03\x04" + bytes(200), "not well-formed XML"),
        ("<html><body/></html>", "it is XML but not OpenDRIVE: it begins with <html>"),
        ("<OpenDRIVE/>", "there is no road in it"),
        ('<OpenDRIVE><road id="1" length="9"/></OpenDRIVE>', "road 1: its <planView> has no geometry"),
        ('<?xml version="1.0" encoding="klingon"?><OpenDRIVE/>', "not well-formed XML"),
        (
            '<?xml version="1.0" encoding="UTF-8"?><OpenDRIVE a="\udcff"/>'.encode(
                "utf-8", "surrogateescape"
            ),
            "not well",
        ),
    ],
)
def test_what_is_no_opendrive(tmp_path: Path, content: str | bytes, sentence: str) -> None:
    assert sentence in refused(tmp_path, content)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / "no.xodr", tmp_path):
        with pytest.raises(UsageError, match=r"it cannot be read: .*; give the path of an OpenDRIVE file"):
            read_opendrive(path)
