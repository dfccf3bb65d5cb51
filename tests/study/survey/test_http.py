"""What the survey's server answers to anybody: raters, their mistakes, and people who mean harm."""

import json
import re
import socket
from collections.abc import Iterator
from html.parser import HTMLParser
from urllib.parse import quote

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from roadgpt_study.survey.app import CLOSED, FORM, JSON, MOST_ADDRESS, MOST_BYTES
from roadgpt_study.survey.server import Server
from roadgpt_study.survey.store import AnswerStore, Rater, code_of
from roadgpt_study.survey.survey import MATCHES, MOST_LETTERS
from survey_made import EVIL, PICTURE, Client, agreed, folder_of, port_of, served, survey

STATUSES = {200, 206, 303, 400, 403, 404, 405, 410, 411, 413, 414, 415, 416, 422}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = folder_of(
        survey(prompt=EVIL, asks=EVIL, title="R & <b>D</b>"), tmp_path_factory.mktemp("s") / "s"
    )
    with served(folder, is_open=True) as its:
        yield its


@pytest.fixture
def client(server: Server) -> Iterator[Client]:
    one = Client(port_of(server))
    yield one
    one.close()


class Elements(HTMLParser):
    """What a browser would make of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    @classmethod
    def of(cls, text: str) -> "Elements":
        found = cls()
        found.feed(text)
        found.close()
        return found

    def values(self, tag: str, name: str) -> list[str]:
        return [attrs[name] or "" for its, attrs in self.tags if its == tag and name in attrs]

    def assert_harmless(self) -> None:
        assert self.values("script", "src") == ["/static/survey.js"]
        assert sum(tag == "script" for tag, _ in self.tags) == 1
        for tag, attrs in self.tags:
            assert tag not in {"b", "object", "embed", "base"}
            assert not {name for name in attrs if name.startswith("on") or name == "style"}
            assert not (attrs.get("src") or "").startswith(("x", "http", "javascript"))


def number_of(server: Server, token: str, id_: str) -> int:
    """Of the page on which a rater is asked something."""
    rater = server.app.store.rater_of(token)
    assert rater is not None
    own = server.app.survey.pages_for(rater.digest)
    return next(n for n, page in enumerate(own, 1) if id_ in [q.id for q in page.questions])


def kept(server: Server, token: str) -> dict[str, str]:
    rater = server.app.store.rater_of(token)
    assert rater is not None
    return server.app.store.answers_of(rater)


def test_a_whole_rating_by_forms_alone(server: Server, client: Client) -> None:
    token = server.app.store.add_rater()
    base = f"/r/{token}"
    door = client.get(base)
    assert "Jane" not in door.text
    assert Elements.of(door.text).values("form", "action") == [base]
    assert client.get(f"{base}/1").headers["location"] == base, "nothing is asked before consent"
    assert client.post(base, {}).headers["location"] == base
    assert client.save(token, "about.age", "20 to 29").status == 403
    assert client.post(base, {"agree": "yes"}).headers["location"] == f"{base}/1"

    where, seen, said = f"{base}/1", 0, dict[str, str]()
    while where != f"{base}/done":
        page = Elements.of(client.get(where).text)
        page.assert_harmless()
        fields = dict[str, str]()
        for name in dict.fromkeys(page.values("input", "name")):
            fields[name] = [a["value"] or "" for t, a in page.tags if t == "input" and a.get("name") == name][
                2
            ]
        fields |= {name: f" of {name}\r\nsecond line " for name in page.values("textarea", "name")}
        moved = client.post(where, {**fields, "go": "next"})
        assert moved.status == 303, moved.text
        said |= fields
        where, seen = moved.headers["location"], seen + 1
    assert seen == len(server.app.survey.pages)
    assert set(said) == set(server.app.survey.questions)
    assert kept(server, token) == {name: value.strip().replace("\r\n", "\n") for name, value in said.items()}
    assert "none" not in client.get(where).text.split("</main>")[0]


def test_what_is_left_out_is_told_and_may_be_left_out(server: Server, client: Client) -> None:
    token = agreed(server)
    number = number_of(server, token, "a1.overall")
    path = f"/r/{token}/{number}"
    told = client.post(path, {"a1.overall": MATCHES[4], "go": "next"})
    assert told.status == 200
    page = Elements.of(told.text)
    assert [each for each in page.values("a", "href") if each.startswith("#q-")] == ["#q-a1-1"]
    assert "q-a1-1" in page.values("fieldset", "id")
    checked = [a["value"] for t, a in page.tags if t == "input" and "checked" in a]
    assert checked == [MATCHES[4]]
    assert client.post(path, {"go": "skip"}).headers["location"] == f"/r/{token}/{number + 1}"
    assert client.post(path, {"go": "back"}).headers["location"] == f"/r/{token}/{number - 1}"
    assert kept(server, token) == {"a1.overall": MATCHES[4]}
    assert client.get(f"/r/{token}").headers["location"] == f"/r/{token}/1", "where it goes on: what is open"


def test_hostile_words_stay_words(server: Server, client: Client) -> None:
    token = agreed(server)
    for question in ("a1.remarks", "end.remarks"):
        assert client.save(token, question, EVIL + "</textarea>").status == 200
    for path in ("", "/mine", "/done", f"/{number_of(server, token, 'a1.remarks')}", "/99", "/<script>"):
        page = Elements.of(client.get(f"/r/{token}{path}".replace("<", "%3C")).text)
        if page.tags:
            page.assert_harmless()
    words = "".join(Elements.of(client.get(f"/r/{token}/mine").text).words)
    assert words.count(EVIL) >= 3
    shown = Elements.of(client.get(f"/r/{token}/{number_of(server, token, 'a1.remarks')}").text)
    assert EVIL + "</textarea>" in "".join(shown.words)


def test_one_answer_at_a_time(server: Server, client: Client) -> None:
    token = agreed(server)
    assert json.loads(client.save(token, "a2.overall", MATCHES[1]).body) == {"saved": "a2.overall"}
    assert client.save(token, "a2.overall", MATCHES[3]).status == 200
    assert kept(server, token) == {"a2.overall": MATCHES[3]}
    assert client.save(token, "a2.overall", "").status == 200
    assert kept(server, token) == {}
    for question, value in (
        ("a2.overall", "splendid"),
        ("a9.overall", MATCHES[0]),
        ("a1.remarks", "x" * (MOST_LETTERS + 1)),
    ):
        refused = client.save(token, question, value)
        assert refused.status == 422
        assert json.loads(refused.body)["error"]
    assert (
        client.save(token, "a1.remarks", " a\x00b\u202ec\u200bd\ud800 10\u00a0% नि\u200dक\r\n\x0b.").status
        == 200
    )
    assert kept(server, token) == {"a1.remarks": "abcd 10 % नि\u200dक\n ."}
    assert client.save(token, "a1.remarks", "ナ" * MOST_LETTERS).status == 200, "in any alphabet"
    assert set(kept(server, token)) == {"a1.remarks"}


def test_withdrawal_leaves_no_trace_in_any_file(server: Server, client: Client) -> None:
    token, marked = agreed(server), "Unmistakable-7219"
    client.save(token, "a1.remarks", f"{marked} remark " * 20)
    folder = server.app.folder

    def traces() -> int:
        return sum(marked.encode() in path.read_bytes() for path in folder.glob("answers.sqlite*"))

    assert traces() > 0
    assert client.post(f"/r/{token}/withdraw", {}).status == 303, "not by accident"
    assert traces() > 0
    assert "deleted" in client.post(f"/r/{token}/withdraw", {"sure": "yes"}).text
    assert traces() == 0
    late = client.save(token, "a1.remarks", "from another tab")
    assert (late.status, json.loads(late.body)["error"]) == (410, CLOSED)
    assert client.post(f"/r/{token}/1", {"about.age": "20 to 29"}).status == 410
    assert client.post(f"/r/{token}", {"agree": "yes"}).status == 410
    assert kept(server, token) == {}
    assert "deleted" in client.get(f"/r/{token}/1").text


def test_whoever_joins_by_the_shared_link_gets_a_link_of_their_own(server: Server, client: Client) -> None:
    shared = f"/join/{server.app.shared}"
    before = len(server.app.store.raters())
    assert "link of your own" in client.get(shared).text
    assert client.post(shared, {}).headers["location"] == shared
    assert len(server.app.store.raters()) == before, "looking makes no rater"
    own = [client.post(shared, {"agree": "yes"}).headers["location"] for _ in range(2)]
    assert own[0] != own[1]
    assert all(re.fullmatch(r"/r/[\w-]{32}/1", each) for each in own)
    assert client.get(own[0]).status == 200
    for wrong in ("", server.app.shared[:-1], server.app.shared + "x", "x" * 32):
        assert client.get(f"/join/{wrong}").status == 404


def test_tokens_that_are_nobodys_open_nothing(server: Server, client: Client) -> None:
    token = agreed(server)
    rater = server.app.store.rater_of(token)
    assert rater is not None
    assert len(token) >= 22, "128 bits or more"
    wrong = [
        token[:-1],
        token + "x",
        token.swapcase(),
        token[::-1],
        rater.digest,
        code_of(rater.digest),
        "",
        "0" * 64,
        "%00",
        "é",
    ]
    told = {(client.get(f"/r/{quoted}/1".replace("é", "%C3%A9")).status) for quoted in wrong}
    assert told == {404}
    assert {client.save(each, "about.age", "20 to 29").status for each in wrong[:4]} == {404}
    assert token.encode() not in b"".join(p.read_bytes() for p in server.app.folder.glob("answers.sqlite*"))


@pytest.mark.parametrize(
    "path",
    [
        "../secret.txt", "..%2fsecret.txt", "%2e%2e/secret.txt", "....//secret.txt", "..\\secret.txt",
        "/etc/passwd", "a1-above.png/../../secret.txt", "a1-above.png%00.html", "", ".", "..", "survey.json",
        "answers.sqlite",
    ],
)  # fmt: skip
def test_no_path_leads_out_of_what_the_survey_lists(server: Server, client: Client, path: str) -> None:
    token = agreed(server)
    for root in (f"/r/{token}/media/", "/static/", "/", f"/r/{token}/"):
        reply = client.get(root + path)
        assert reply.status in {303, 404} or reply.headers["content-type"].startswith("text/html"), root
        for secret in (b"not to be sent", b"root:", b"SQLite format", b'"format"'):
            assert secret not in reply.body


def test_a_film_is_sent_in_the_parts_that_a_phone_asks_for(server: Server, client: Client) -> None:
    path, size = f"/r/{agreed(server)}/media/a1-above.png", len(PICTURE)
    whole = client.get(path)
    assert (whole.body, whole.headers["accept-ranges"]) == (PICTURE, "bytes")
    for asked, first, last in (
        ("0-1", 0, 1),
        ("100-", 100, size - 1),
        ("-10", size - 10, size - 1),
        ("0-99999", 0, size - 1),
    ):
        part = client.get(path, Range=f"bytes={asked}")
        assert part.status == 206
        assert part.body == PICTURE[first : last + 1]
        assert part.headers["content-range"] == f"bytes {first}-{last}/{size}"
    assert client.get(path, Range=f"bytes={size}-").status == 416
    for odd in ("bytes=5-1", "bytes=-", "bytes=a-b", "lines=1-2"):
        refused = client.get(path, Range=odd)
        assert refused.status in {400, 416}
        assert len(refused.body) < 100, "a range that makes no sense brings none of the file"
    two = client.get(path, Range="bytes=0-1,9-11")
    assert two.status == 206
    assert re.findall(rb"\r\n\r\n(.+?)\r\n--", two.body, re.S) == [PICTURE[:2], PICTURE[9:12]]
    head = client.ask("HEAD", path)
    assert (head.body, head.headers["content-length"]) == (b"", str(size))


def test_every_answer_forbids_what_is_not_needed(server: Server, client: Client) -> None:
    token = agreed(server)
    for path in (
        "/",
        f"/r/{token}/1",
        f"/r/{token}/media/a1-above.png",
        "/static/survey.css",
        "/static/survey.js",
        "/x",
    ):
        headers = client.get(path).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["x-content-type-options"] == "nosniff"
        assert "set-cookie" not in headers
        assert headers["server"] == "roadgpt"
    assert client.get(f"/r/{token}/1").headers["cache-control"] == "no-store"


def test_bodies_have_limits_and_files_are_not_taken(server: Server, client: Client) -> None:
    token = agreed(server)
    path = f"/r/{token}/1"
    form = {"Content-Type": FORM}
    assert client.ask("POST", path, b"x" * (MOST_BYTES + 1), form).status == 413
    one = Client(port_of(server))
    assert one.ask("POST", path, b"a=b&" * (MOST_BYTES // 4), form).status in {200, 303}
    assert one.ask("POST", path, b"x", {"Content-Type": "multipart/form-data; boundary=x"}).status == 415
    assert one.ask("POST", f"/r/{token}/answer", b"{}", form).status == 415
    assert one.ask("POST", path, b"0\r\n\r\n", {**form, "Transfer-Encoding": "chunked"}).status == 411
    one.close()
    two = Client(port_of(server))
    assert two.get("/" + "x" * MOST_ADDRESS).status == 414
    two.close()
    for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW"):
        other = Client(port_of(server))
        refused = other.ask(method, path)
        other.close()
        assert refused.status == 405
        assert set(refused.headers["allow"].split(", ")) == {"GET", "HEAD", "POST"}
    assert kept(server, token) == {}


def test_broken_requests_are_answered_or_dropped_and_hurt_nobody_else(server: Server, client: Client) -> None:
    token = agreed(server)
    line = f"POST /r/{token}/answer HTTP/1.1\r\nContent-Type: {JSON}\r\n".encode()
    for raw in (
        b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00",
        b"GET " + b"x" * 70_000,
        b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 200 + b"\r\n", b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
        line + b"Content-Length: -1\r\n\r\n", line + b"Content-Length: 1e3\r\n\r\n", line + b"\r\n",
        line + b"Content-Length: 500\r\n\r\n{", line + b"Content-Length: 99999999999999999999\r\n\r\n",
    ):  # fmt: skip
        with socket.create_connection(("127.0.0.1", port_of(server)), timeout=10) as wire:
            wire.sendall(raw)
            wire.shutdown(socket.SHUT_WR)
            told = b""
            while piece := wire.recv(65536):
                told += piece
        assert not told or told.startswith((b"HTTP/1.1 4", b"HTTP/1.1 5")), raw[:40]
        assert b"Traceback" not in told
        assert b"<script" not in told.replace(b'<script src="/static/survey.js" defer></script>', b"")
    assert client.get(f"/r/{token}/1").status == 200


PAGES = "1 2 9 answer withdraw mine done media/a1-above.png 0 -1 １"
PATHS = st.sampled_from(["", *(f"/{page}" for page in PAGES.split())])
VALUES = st.one_of(st.text(max_size=30), st.sampled_from([*MATCHES, "yes", "20 to 29", "x" * 5000]))
BODIES = st.one_of(
    st.binary(max_size=200),
    st.recursive(
        st.none() | st.booleans() | st.floats() | VALUES,
        lambda s: st.lists(s) | st.dictionaries(VALUES, s),
        max_leaves=5,
    ).map(lambda value: json.dumps(value).encode()),
    st.fixed_dictionaries({"question": st.sampled_from(["a1.overall", "check", "zzz"]), "value": VALUES}).map(
        lambda value: json.dumps(value).encode()
    ),
    st.dictionaries(st.sampled_from(["a1.overall", "a1.remarks", "go", "agree", "check"]), VALUES).map(
        lambda fields: "&".join(f"{k}={v}" for k, v in fields.items()).encode("utf-8", "replace")
    ),
)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(method=st.sampled_from(["GET", "POST", "PUT"]), path=PATHS | st.text(max_size=20).map("/{}".format),
       kind=st.sampled_from([FORM, JSON, "text/plain", ""]), body=BODIES)  # fmt: skip
@example(method="POST", path="/answer", kind=JSON, body=b"[" * 60_000)
@example(method="POST", path="/1", kind=FORM, body=b"about.age=%ff%fe&about.age=20+to+29")
@example(method="POST", path="/answer", kind=JSON, body=b'{"question": "a1.remarks", "value": "\\ud800"}')
def test_nothing_that_is_posted_breaks_the_survey(
    server: Server, client: Client, method: str, path: str, kind: str, body: bytes
) -> None:
    app = server.app
    token = FUZZED.setdefault(id(app), agreed(server))
    address = f"/r/{token}{quote(path, errors='replace')}"
    told = client.ask(method, address, body, {"Content-Type": kind} if kind else {})
    assert told.status in STATUSES
    if told.headers.get("content-type", "").startswith("text/html"):
        Elements.of(told.body.decode()).assert_harmless()
    rater = app.store.rater_of(token)
    assert rater is not None
    if rater.state == "withdrawn":  # it found the button
        FUZZED[id(app)] = agreed(server)
    for question, value in app.store.answers_of(rater).items():
        assert app.survey.questions[question].takes(value)


FUZZED: dict[int, str] = {}


def test_every_rater_has_an_order_of_their_own_and_keeps_it() -> None:
    asked = survey(roads=4, pairs=3)
    orders = {}
    for number in range(60):
        digest = f"{number:064x}"
        own = asked.pages_for(digest)
        assert own == asked.pages_for(digest)
        assert sorted(page.questions[0].id for page in own) == sorted(p.questions[0].id for p in asked.pages)
        parts = [page.part for page in own]
        assert (parts[0], parts[-1]) == ("about", "end")
        assert parts[-4:-1] == ["similarity"] * 3
        assert parts[1] == parts[5] == "alignment", "the check stands among the roads"
        orders[digest] = tuple(page.item.id for page in own if page.item)
    assert len(set(orders.values())) > 30
    firsts = [order[0] for order in orders.values()]
    assert {firsts.count(f"a{n}") > 5 for n in range(1, 5)} == {True}


def test_a_full_disk_costs_no_confirmed_answer(
    server: Server, client: Client, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import sqlite3

    token = agreed(server)

    def full(self: AnswerStore, rater: Rater, answers: object) -> bool:
        raise sqlite3.OperationalError("database or disk is full")

    with monkeypatch.context() as patched:
        patched.setattr(AnswerStore, "save", full)
        refused = client.save(token, "a1.overall", MATCHES[0])
    assert refused.status == 503
    assert "could not be saved" in json.loads(refused.body)["error"]
    assert "disk is full" in capsys.readouterr().err
    again = Client(port_of(server))
    assert again.save(token, "a1.overall", MATCHES[0]).status == 200
    again.close()
