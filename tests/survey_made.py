"""A survey without roads, and a client that speaks to its server as a browser without scripts does."""

import http.client
import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlencode

from roadgpt.run.atomic import json_text
from roadgpt_study.survey.server import Server
from roadgpt_study.survey.serving import open_server
from roadgpt_study.survey.survey import CARD, MEDIA, Item, Medium, Survey

EVIL = "\"><script>document.title='broken'</script><img src=x onerror=alert(1)>{0}{title}&amp;"
PICTURE = b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 8
MOST_AT_ONCE = 50


def survey(
    roads: int = 3, pairs: int = 2, prompt: str = "an uphill road with 3 turns", **more: Any
) -> Survey:
    """Roads and pairs that need no files but one picture."""
    picture = (Medium(name="a1-above.png", kind="picture", title="from above"),)
    alignment = [
        Item(
            id=f"a{n}",
            part="alignment",
            prompt=prompt,
            criteria=("incline",),
            media=picture if n == 1 else (),
        )
        for n in range(1, roads + 1)
    ]
    similarity = [Item(id=f"s{n}", part="similarity", prompt=prompt) for n in range(1, pairs + 1)]
    texts = {
        "title": "Roads",
        "asks": "Jane Roe",
        "contact": "jane@roe.example",
        "purpose": "Why.",
        "keeps": "Little.",
    }
    return Survey(**{**texts, **more}, items=(*alignment, *similarity))


def folder_of(made: Survey, folder: Path) -> Path:
    """The survey's folder, as ``make`` leaves it."""
    (folder / MEDIA).mkdir(parents=True)
    (folder / MEDIA / "a1-above.png").write_bytes(PICTURE)
    (folder / "secret.txt").write_text("not to be sent")
    (folder / CARD).write_text(json_text(made.model_dump(mode="json")), encoding="utf-8")
    return folder


@contextmanager
def served(folder: Path, is_open: bool = False) -> Iterator[Server]:
    """The survey on a free port; it stops with the block."""
    server = open_server(folder, "127.0.0.1", 0, is_open)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server
    finally:
        server.stop()
        thread.join()
        server.close()
        server.app.store.close()


class HttpReply(NamedTuple):
    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()


class Client:
    """One connection, kept open."""

    def __init__(self, port: int) -> None:
        self._line = http.client.HTTPConnection("127.0.0.1", port, timeout=30)

    def ask(
        self, method: str, path: str, body: bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> HttpReply:
        self._line.request(method, path, body, dict(headers or {}))
        got = self._line.getresponse()
        return HttpReply(got.status, {k.lower(): v for k, v in got.getheaders()}, got.read())

    def get(self, path: str, **headers: str) -> HttpReply:
        return self.ask("GET", path, headers={k.replace("_", "-"): v for k, v in headers.items()})

    def post(self, path: str, fields: Mapping[str, str]) -> HttpReply:
        kind = {"Content-Type": "application/x-www-form-urlencoded"}
        return self.ask("POST", path, urlencode(fields).encode(), kind)

    def save(self, token: str, question: str, value: str) -> HttpReply:
        body = json.dumps({"question": question, "value": value}).encode()
        return self.ask("POST", f"/r/{token}/answer", body, {"Content-Type": "application/json"})

    def close(self) -> None:
        self._line.close()


def port_of(server: Server) -> int:
    return server.port


def agreed(server: Server) -> str:
    """The token of a rater who agreed to take part."""
    store = server.app.store
    token = store.add_rater()
    rater = store.rater_of(token)
    assert rater is not None
    store.agree(rater)
    return token
