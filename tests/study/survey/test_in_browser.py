"""A whole rating in a real browser, on a desktop and on a phone: what is seen, touched, typed and kept."""

from collections.abc import Iterator

import numpy as np
import pytest

from chromium import FOUND, BrowserTab, browser
from roadgpt.road import Design, Segment
from roadgpt.run import Setup, prove
from roadgpt_study.survey.build import write_view
from roadgpt_study.survey.server import Server
from roadgpt_study.survey.survey import MATCHES, MEDIA, Medium
from survey_made import EVIL, PICTURE, folder_of, port_of, served, survey

pytestmark = pytest.mark.skipif(FOUND is None, reason="no chromium is installed")
SIZES = {"desktop": (1280, 800, False), "phone": (390, 844, True)}
NARROW = "document.documentElement.scrollWidth <= innerWidth"


@pytest.fixture(scope="module")
def tab() -> Iterator[BrowserTab]:
    with browser() as page:
        yield page


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    made = survey(roads=2, pairs=1, prompt=EVIL)
    view = Medium(name="view.html", kind="view", title="Look at the road in 3-D")
    items = tuple(item.model_copy(update={"media": (*item.media, view)}) for item in made.items)
    folder = folder_of(made.model_copy(update={"items": items}), tmp_path_factory.mktemp("s") / "s")
    road = Design(
        starting_point=(60, 60, 0),
        theta=20,
        segments=(Segment(distance=60, direction="straight", incline=5),),
    )
    write_view([prove(road, setup=Setup(drives=False))], [EVIL], folder / MEDIA / view.name)
    with served(folder) as its:
        yield its


def went(tab: BrowserTab, do: str) -> None:
    """Do what leads to another page, and wait for it."""
    loads = tab.loads
    tab.run(f"setTimeout(() => {{ {do} }}, 0); 0")
    while tab.loads <= loads:
        tab._next()


def visit(tab: BrowserTab, address: str) -> None:
    went(tab, f"location.href = {address!r}")


def middle(tab: BrowserTab, of: str) -> tuple[float, float]:
    """Of an element, once it is scrolled into the window."""
    tab.run(f"document.querySelector({of!r}).scrollIntoView({{block: 'center', behavior: 'instant'}}); 0")
    tab.settle()
    x, y, wide, high = tab.run(
        f"(r => [r.x, r.y, r.width, r.height])(document.querySelector({of!r}).getBoundingClientRect())"
    )
    return x + wide / 2, y + high / 2


def given(server: Server, token: str) -> dict[str, str]:
    rater = server.app.store.rater_of(token)
    assert rater is not None
    return server.app.store.answers_of(rater)


def test_a_whole_rating_on_a_phone(tab: BrowserTab, server: Server) -> None:
    tab.size(*SIZES["phone"])
    token = server.app.store.add_rater()
    base = f"http://127.0.0.1:{port_of(server)}/r/{token}"
    tab.told.clear()
    tab.asked.clear()
    visit(tab, base)
    assert tab.run("document.querySelectorAll('form').length") == 1
    tab.click(*middle(tab, "input[name=agree]"))
    went(tab, "document.querySelector('button').click()")
    rater = server.app.store.rater_of(token)
    assert rater is not None
    own = server.app.survey.pages_for(rater.digest)
    wanted: dict[str, str] = {}
    for number, page in enumerate(own, 1):
        assert tab.run("location.pathname") == f"/r/{token}/{number}"
        assert tab.run(NARROW), "nothing lies beyond the window"
        assert tab.run("document.querySelector('progress').value") == number - 1
        for question in page.questions:
            if question.answers:
                answer = question.answers[2]
                box = f"input[name='{question.id}'][value='{answer}']"
                tab.click(*middle(tab, box))
                assert tab.run(f"document.querySelector({box!r}).checked")
            else:
                answer = f"about {question.id}: {EVIL}"
                tab.run(f"document.querySelector(\"textarea[name='{question.id}']\").focus(); 0")
                tab.send("Input.insertText", text=answer)
            wanted[question.id] = answer
        tab.wait_for("document.querySelector('.saved').textContent === 'Saved.'")
        assert given(server, token) == wanted, "each answer is kept before the page is sent"
        went(tab, "document.querySelector('button.main').click()")
    assert tab.run("location.pathname") == f"/r/{token}/done"
    visit(tab, f"{base}/mine")
    assert tab.run(NARROW)
    assert tab.run("document.querySelectorAll('tbody tr').length") == len(wanted)
    assert tab.run("document.querySelectorAll('main script, main img, main b').length") == 0
    assert tab.run("document.title") == "My answers - Roads"
    tab.click(*middle(tab, "input[name=sure]"))
    went(tab, "document.querySelector('button.danger').click()")
    assert given(server, token) == {}
    assert tab.told == [], "no policy was broken, no script failed"
    assert {address.split("/")[2] for address in tab.asked if address.startswith("http")} == {
        base.split("/")[2]
    }


def test_it_can_be_done_with_the_keyboard_and_each_answer_has_its_words(
    tab: BrowserTab, server: Server
) -> None:
    tab.size(*SIZES["desktop"])
    token = server.app.store.add_rater()
    rater = server.app.store.rater_of(token)
    assert rater is not None
    server.app.store.agree(rater)
    visit(tab, f"http://127.0.0.1:{port_of(server)}/r/{token}/1")
    tab.key("Tab", code="Tab", windowsVirtualKeyCode=9)
    assert tab.run("document.activeElement.className") == "skip"
    while tab.run("document.activeElement.name") != "about.age":
        tab.key("Tab", code="Tab", windowsVirtualKeyCode=9)
    tab.key(" ", code="Space", windowsVirtualKeyCode=32)
    tab.key("ArrowDown", code="ArrowDown", windowsVirtualKeyCode=40)
    tab.wait_for("document.querySelector('.saved').textContent === 'Saved.'")
    assert given(server, token) == {"about.age": "20 to 29"}
    tree = tab.send("Accessibility.getFullAXTree")["nodes"]
    named = [(n["role"]["value"], n.get("name", {}).get("value", "")) for n in tree if not n.get("ignored")]
    assert ("radio", "20 to 29") in named
    assert ("group", "How old are you?") in named
    assert ("progressbar", "Page 1 of 6") in named
    assert all(name for role, name in named if role in {"radio", "group", "button", "textbox", "link"})


def test_an_answer_waits_for_a_server_that_is_away(tab: BrowserTab, server: Server) -> None:
    token = server.app.store.add_rater()
    rater = server.app.store.rater_of(token)
    assert rater is not None
    server.app.store.agree(rater)
    visit(tab, f"http://127.0.0.1:{port_of(server)}/r/{token}/1")
    tab.send(
        "Network.emulateNetworkConditions",
        offline=True,
        latency=0,
        downloadThroughput=-1,
        uploadThroughput=-1,
    )
    tab.run("document.querySelector('input[name=\"about.licence\"]').click(); 0")
    tab.wait_for("document.querySelector('.saved').textContent.startsWith('Not saved yet')")
    assert given(server, token) == {}
    tab.send(
        "Network.emulateNetworkConditions",
        offline=False,
        latency=0,
        downloadThroughput=-1,
        uploadThroughput=-1,
    )
    tab.wait_for("document.querySelector('.saved').textContent === 'Saved.'")
    assert given(server, token) == {"about.licence": "yes"}
    tab.told.clear()


def test_pictures_and_the_view_are_seen_and_the_view_can_reach_nothing(
    tab: BrowserTab, server: Server
) -> None:
    tab.size(*SIZES["desktop"])
    token = server.app.store.add_rater()
    rater = server.app.store.rater_of(token)
    assert rater is not None
    server.app.store.agree(rater)
    own = server.app.survey.pages_for(rater.digest)
    number = next(n for n, page in enumerate(own, 1) if page.item and page.item.id == "a1")
    tab.told.clear()
    tab.asked.clear()
    visit(tab, f"http://127.0.0.1:{port_of(server)}/r/{token}/{number}")
    assert not any("view.html" in address for address in tab.asked), (
        "it is heavy, and loaded when it is opened"
    )
    tab.run("document.querySelector('details.view').open = true; 0")
    middle(tab, "iframe")
    frames = "document.querySelector('iframe')"
    assert tab.run(f"{frames}.sandbox.value") == "allow-scripts"
    for _ in range(200):
        picture = tab.picture("iframe")
        if len(np.unique((picture[..., :3] * 31).round().reshape(-1, 3), axis=0)) > 100:
            break
    else:
        pytest.fail("the view draws nothing")
    assert tab.run(f"{frames}.contentDocument") is None, "it has an origin of its own"
    assert tab.told == []
    assert len(PICTURE) > 0
    assert MATCHES[0] in tab.run("document.body.textContent")
