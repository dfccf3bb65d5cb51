"""The page of a road in a real browser: what it draws, and what it does when it is touched."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import staged
from chromium import FOUND, BrowserTab, browser
from road_parts import design_of
from roadgpt.brief.scene import Event
from roadgpt.report import view
from roadgpt.report.canvas import SEVERE
from roadgpt.road import CrossSection, Design, Road, Site, World
from roadgpt.run import Request, Run, Setup, prove
from roadgpt.traffic import SIZES, Actor, Tracks
from roadgpt.verdict import judge

pytestmark = pytest.mark.skipif(FOUND is None, reason="no chromium is installed")

EVIL = "</script><script>document.title = 'broken'</script><b>bold</b> & <!-- <img src=x onerror=alert(1)>"
RESET = """
if (roadgpt.player.isPlaying) roadgpt.player.toggle();
if (!roadgpt.player.hasLine) roadgpt.player.toggleLine();
roadgpt.player.moveTo(0); roadgpt.player.setRate(1); roadgpt.player.choose('behind'); keys.open = false;
"""
LANE = "document.querySelector('.hud .lane').textContent"


def design(side: int = 1) -> Design:
    return design_of((50, 0, 6), (40, side * 65, 2), (40, 0, -4), start=(60, 120, 0))


@pytest.fixture(scope="module")
def driven() -> Run:
    run = prove(design(), 7, setup=Setup(driver="beamng_like"))
    return replace(run, request=run.request.model_copy(update={"words": EVIL}))


@pytest.fixture(scope="module")
def tab() -> Iterator[BrowserTab]:
    with browser() as page:
        yield page


@pytest.fixture(scope="module")
def pages(driven: Run, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    failed = prove(design(-1), 7, World(site=Site(friction=0.15)))
    assert failed.outcome == "FAIL"
    alone = replace(prove(design(), setup=Setup(drives=False)), source="alone.json")
    made = {"driven": [driven], "two": [failed, driven], "alone": [alone]}
    return {name: view.write(runs, folder / f"{name}.html") for name, runs in made.items()}


@pytest.fixture
def page(tab: BrowserTab, pages: dict[str, Path]) -> Iterator[BrowserTab]:
    """The page of one drive, as a person finds it; whatever a test does, it must not complain or fetch."""
    tab.size(820, 580)
    if tab.run("location.href") == pages["driven"].as_uri():
        tab.told.clear()
        tab.run(RESET)
        tab.settle()
    else:
        tab.open(pages["driven"])
    yield tab
    assert_quiet(tab, pages["driven"])


def assert_quiet(tab: BrowserTab, path: Path) -> None:
    assert tab.told == []
    assert {address.partition("#")[0] for address in tab.asked} == {path.resolve().as_uri()}


def is_drawn(picture: np.ndarray) -> bool:
    """Many colours, and no single one that covers it: neither empty nor a plain ground."""
    shades = (picture[..., :3] * 15).round().astype(int) @ [256, 16, 1]
    counts = np.unique(shades, return_counts=True)[1]
    return len(counts) > 12 and counts.max() < 0.85 * counts.sum()


def changed(before: np.ndarray, after: np.ndarray) -> float:
    """The share of pixels that are others."""
    return float((np.abs(before[..., :3] - after[..., :3]).max(axis=-1) > 0.04).mean())


def most_of(picture: np.ndarray, much: int, little: int) -> float:
    """The share of pixels in which one colour is strong and another weak."""
    return float(np.mean((picture[..., much] > 0.35) & (picture[..., much] > 2 * picture[..., little])))


def slide(tab: BrowserTab, time: float) -> None:
    tab.run(f"slider.value = {time}; slider.dispatchEvent(new Event('input')); 0")
    tab.settle()


def pose(tab: BrowserTab, number: int = 0) -> dict[str, float]:
    found: dict[str, float] = tab.run(f"roadgpt.poses[{number}]")
    return found


def middle_of(tab: BrowserTab, name: str, across: float = 0.5, down: float = 0.5) -> tuple[float, float]:
    box = tab.run(
        f"(r => [r.x, r.y, r.width, r.height])(document.querySelector('{name}').getBoundingClientRect())"
    )
    return box[0] + across * box[2], box[1] + down * box[3]


def test_the_picture_and_every_strip_are_drawn(page: BrowserTab) -> None:
    for name in (".stage .scene", ".plan canvas", ".height canvas", ".second canvas"):
        picture = page.picture(name)
        assert picture.shape[0] > 30
        assert len(np.unique((picture[..., :3] * 255).round().reshape(-1, 3), axis=0)) > 12, name
    assert is_drawn(page.picture(".stage .scene"))


def test_texts_are_texts(page: BrowserTab) -> None:
    assert page.run("document.querySelector('.title').textContent") == EVIL
    assert page.run("document.title").startswith("</script>")
    assert page.run("document.querySelectorAll('.title *, .said *, img').length") == 0
    assert page.run("document.querySelector('.badge').textContent") == "PASS (partly outside)"
    painted = page.run("getComputedStyle(document.querySelector('.badge')).backgroundColor")
    assert painted == "rgb" + str(tuple(round(255 * part) for part in to_rgb(SEVERE["partly outside"])))
    assert page.run("document.querySelector('.said').textContent").startswith("kept its lane")
    assert "metre road" in page.run("document.querySelector('.words p').textContent")


def test_the_slider_moves_the_car_to_where_it_was(page: BrowserTab, driven: Run) -> None:
    drive = driven.drive
    assert drive is not None
    pictures = []
    for time in (2.0, 6.5):
        slide(page, time)
        found = pose(page)
        for name in ("x", "y", "z", "heading", "speed", "pitch"):
            wanted = float(
                np.interp(time, drive["time"], np.unwrap(drive[name]) if name == "heading" else drive[name])
            )
            turns = round((found[name] - wanted) / math.tau) * math.tau if name == "heading" else 0
            assert found[name] == pytest.approx(wanted + turns, abs=5e-3), name
        pictures.append(page.picture(".stage .scene"))
    assert changed(*pictures) > 0.1
    assert page.run("clock.textContent") == f"6.5 / {drive.duration:.1f} s"


def test_cameras_switch_and_stand_where_they_should(page: BrowserTab) -> None:
    slide(page, 5)
    eyes, pictures = {}, {}
    for name in ("behind", "bonnet", "free"):
        page.click(*middle_of(page, f"[data-camera={name}]"))
        page.wait_for(f"document.querySelector('[data-camera={name}]').ariaChecked === 'true'")
        eyes[name], pictures[name] = np.array(page.run("roadgpt.eyes[0]")), page.picture(".stage .scene")
        assert is_drawn(pictures[name]), name
    assert changed(pictures["behind"], pictures["bonnet"]) > 0.2
    assert changed(pictures["bonnet"], pictures["free"]) > 0.2
    heading = pose(page)["heading"]
    way = eyes["bonnet"] - eyes["behind"]
    # from behind to the bonnet it is straight on, about as far as the camera stays behind and a little down
    assert way[:2] @ [math.cos(heading), math.sin(heading)] == pytest.approx(9.5, abs=1)
    assert abs(way[:2] @ [-math.sin(heading), math.cos(heading)]) < 2.5
    assert eyes["free"][2] > eyes["behind"][2] + 20


def test_dragging_the_picture_sets_the_camera_free(page: BrowserTab) -> None:
    before = np.array(page.run("roadgpt.eyes[0]"))
    x, y = middle_of(page, ".stage .scene")
    page.mouse("mousePressed", x, y)
    for step in range(1, 6):
        page.mouse("mouseMoved", x + 25 * step, y + 5 * step)
    page.mouse("mouseReleased", x + 125, y + 25)
    page.wait_for("roadgpt.player.camera === 'free'")
    page.settle()
    after = np.array(page.run("roadgpt.eyes[0]"))
    assert np.linalg.norm(after - before) > 1
    slide(page, 3)
    assert page.run("roadgpt.eyes[0]") == pytest.approx(after)


def test_a_click_on_a_strip_moves_the_car_there(page: BrowserTab, driven: Run) -> None:
    assert driven.road is not None
    for name in (".height canvas", ".second canvas"):
        wide = page.run(f"document.querySelector('{name}').clientWidth")
        for across in (0.4, 0.8):
            page.click(*middle_of(page, name, across))
            # the graph begins 34 pixels from the left and ends 12 from the right
            wanted = (across * wide - 34) / (wide - 46) * driven.road.length
            page.wait_for(f"Math.abs(roadgpt.poses[0].s - {wanted}) < 1.5")
    page.click(*middle_of(page, ".plan canvas", 0.02, 0.98))
    page.wait_for("roadgpt.poses[0].s < 30")  # the road starts in the lower left corner of its map


def test_it_plays_and_pauses_and_ends(page: BrowserTab) -> None:
    page.click(*middle_of(page, "#play"))
    page.wait_for("roadgpt.player.time > 0.3")
    page.key(" ")
    page.settle()
    stopped = page.run("roadgpt.player.time")
    page.settle()
    assert page.run("roadgpt.player.time") == stopped
    page.run("roadgpt.player.setRate(8); 0")
    slide(page, page.run("roadgpt.player.duration") - 0.2)
    page.key(" ")
    page.wait_for("!roadgpt.player.isPlaying")
    assert page.run("roadgpt.player.time === roadgpt.player.duration")
    page.key(" ")
    page.wait_for("roadgpt.player.time < roadgpt.player.duration / 2")


def test_keys(page: BrowserTab) -> None:
    page.key("ArrowRight")
    page.key("ArrowRight", modifiers=8)
    assert page.run("roadgpt.player.time") == pytest.approx(1.1)
    page.key("ArrowLeft")
    assert page.run("roadgpt.player.time") == pytest.approx(0.1)
    page.key("End")
    assert page.run("roadgpt.player.time === roadgpt.player.duration")
    page.key("Home")
    for key, camera in (("2", "bonnet"), ("3", "free"), ("1", "behind"), ("f", "free")):
        page.key(key)
        assert page.run("roadgpt.player.camera") == camera
    page.key("]")
    assert page.run("[roadgpt.player.time, roadgpt.player.rate]") == [0, 2]
    with_line = page.picture(".stage .scene")
    page.key("l")
    assert changed(with_line, page.picture(".stage .scene")) > 0.001
    page.key("?")
    assert page.run("keys.open")


def test_nothing_is_drawn_while_nothing_changes(page: BrowserTab) -> None:
    page.settle()
    before = page.run("roadgpt.frames")
    for _ in range(5):
        page.settle()
    assert page.run("roadgpt.frames") == before


def test_the_page_would_be_stopped_from_fetching(page: BrowserTab) -> None:
    refused = page.run("fetch('https://example.org/').then(() => 'came', () => 'refused')")
    assert refused == "refused"
    assert any("Content Security Policy" in line for line in page.told)
    page.told.clear()
    page.asked[:] = [address for address in page.asked if address.startswith("file:")]


def test_plates_stay_in_the_picture_and_do_not_cover_each_other(tab: BrowserTab, tmp_path: Path) -> None:
    """On a road without a verge, which floats above the ground, and at an address that nobody understands."""
    run = prove(design(), 7, World(section=CrossSection(shoulder=0)), Setup(drives=False))
    assert run.road is not None
    made = view.scene(run)
    place = run.road.at(40.0)
    texts = ["left its lane\nto the right, and that " + "very " * 9 + "far", "too tight", "overlaps itself"]
    made["places"] = [
        {"x": float(place[0]) + n, "y": float(place[1]), "s": 40.0 + n, "text": text, "time": None}
        | {"colour": "#c04f00", "letters": "#c04f00"}
        for n, text in enumerate(texts)
    ]
    path = tmp_path / "plates.html"
    path.write_text(view.page_of([made]), encoding="utf-8")
    boxes = """['.stage .scene', '.plate'].map(name => [...document.querySelectorAll(name)].map(each =>
        (r => [r.left, r.top, r.right, r.bottom])(each.getBoundingClientRect())))"""
    tab.size(1000, 700)
    tab.open(path, "#t=never&camera=<b>")
    assert tab.run("[roadgpt.player.time, roadgpt.player.camera]") == [0, "behind"]
    assert is_drawn(tab.picture(".stage .scene"))
    for wide, high, is_phone in ((1000, 700, False), (390, 844, True)):
        tab.size(wide, high, is_phone)
        for camera in ("behind", "free"):
            tab.run(f"roadgpt.player.choose('{camera}'); 0")
            tab.settle()
            (stage,), plates = tab.run(boxes)
            assert len(plates) == len(texts)
            for n, one in enumerate(plates):
                assert stage[0] <= one[0] < one[2] <= stage[2]
                assert stage[1] <= one[1] < one[3] <= stage[3]
                for other in plates[n + 1 :]:
                    beside = one[2] <= other[0] or other[2] <= one[0]
                    over = one[3] <= other[1] or other[3] <= one[1]
                    assert beside or over
    slide(tab, 4)
    assert is_drawn(tab.picture(".stage .scene"))
    assert_quiet(tab, path)


def test_two_roads_share_one_clock(tab: BrowserTab, pages: dict[str, Path]) -> None:
    tab.size(1000, 600)  # sentences of two and three lines stand over the stages
    tab.open(pages["two"])
    assert tab.run("[...document.querySelectorAll('.badge')].map(b => b.textContent)") == [
        "FAIL",
        "PASS (partly outside)",
    ]
    slide(tab, 3)
    assert pose(tab, 0)["time"] == pytest.approx(3, abs=1e-3)
    assert pose(tab, 1)["time"] == pytest.approx(3, abs=1e-3)
    for number in (1, 2):
        assert is_drawn(tab.picture(f".panel:nth-child({number}) .scene"))
        assert is_drawn(tab.picture(f".panel:nth-child({number}) .plan canvas"))
    lefts = tab.run("[...document.querySelectorAll('.stage')].map(s => s.getBoundingClientRect().x)")
    assert lefts[1] > lefts[0] + 400
    # the drive that is shorter stays where it ended; the other goes on
    slide(tab, tab.run("roadgpt.player.duration"))
    ends = [tab.run(f"JSON.parse(data.textContent)[{n}].drive.columns.time.at(-1)") for n in (0, 1)]
    assert ends[0] != ends[1]
    assert [pose(tab, 0)["time"], pose(tab, 1)["time"]] == pytest.approx(ends)
    assert tab.run("[...document.querySelectorAll('.place')].every(p => /ended at/.test(p.textContent))")
    # the car that left its lane is red by now
    assert "outside its lane" in tab.run(LANE)
    colours = [tab.picture(f".panel:nth-child({number}) .scene") for number in (1, 2)]
    reds, blues = ([most_of(each, much, little) for each in colours] for much, little in ((0, 2), (2, 0)))
    assert reds[0] > 0.01 > blues[0]
    assert blues[1] > 0.01
    # a click on a strip of one moves both
    tab.click(*middle_of(tab, ".panel:nth-child(2) .height canvas", 0.5))
    tab.wait_for("1 < roadgpt.poses[1].time && roadgpt.poses[1].time < roadgpt.player.duration - 1")
    assert_quiet(tab, pages["two"])


def test_it_fits_a_phone(tab: BrowserTab, pages: dict[str, Path]) -> None:
    tab.size(390, 844, is_phone=True)
    if tab.run("location.href") != pages["two"].as_uri():
        tab.open(pages["two"])
    assert tab.run("document.documentElement.scrollWidth") <= 390
    assert is_drawn(tab.picture(".stage .scene"))
    bar = tab.run("(r => [r.top, r.bottom])(bar.getBoundingClientRect())")
    assert bar[1] == pytest.approx(844, abs=1)
    assert tab.run("document.querySelector('.stage').getBoundingClientRect().bottom") < bar[0]
    smallest = tab.run("Math.min(...[...document.querySelectorAll('button')].map(b => b.offsetHeight))")
    assert smallest >= 40
    assert_quiet(tab, pages["two"])


@pytest.fixture
def night(tab: BrowserTab) -> Iterator[BrowserTab]:
    """A browser that asks for dark pages."""
    scheme = "prefers-color-scheme"
    tab.send("Emulation.setEmulatedMedia", features=[{"name": scheme, "value": "dark"}])
    yield tab
    tab.send("Emulation.setEmulatedMedia", features=[{"name": scheme, "value": "light"}])


def test_it_is_dark_by_night(night: BrowserTab, pages: dict[str, Path]) -> None:
    """Paper is dark and writing light, on the drawings too, and day comes without loading the page again."""
    night.size(820, 580)
    night.open(pages["alone"])
    parts = ("body", "figure.plan canvas", "figure.height canvas", ".bar select")
    dark = {part: night.picture(part)[..., :3] for part in parts}
    drawn = night.run("roadgpt.frames")
    night.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
    night.wait_for(f"roadgpt.frames > {drawn}")
    for part, picture in dark.items():
        assert np.median(picture) < 0.25, part
        assert picture.max() > 0.8, part
        assert np.median(night.picture(part)[..., :3]) > 0.75, part


def test_a_road_that_nobody_drove_is_shown_alone(tab: BrowserTab, pages: dict[str, Path]) -> None:
    tab.size(820, 580)
    if tab.run("location.href") != pages["alone"].as_uri():  # it is there from the test before
        tab.open(pages["alone"])
    assert is_drawn(tab.picture(".stage .scene"))
    assert "nobody drove" in tab.run(LANE)
    assert tab.run("document.querySelector('.legend').hidden")
    slide(tab, tab.run("roadgpt.player.duration"))
    assert pose(tab)["s"] == pytest.approx(tab.run("JSON.parse(data.textContent)[0].road.length"), abs=0.01)
    assert_quiet(tab, pages["alone"])


def test_without_webgl_the_strips_still_work(tab: BrowserTab, pages: dict[str, Path]) -> None:
    tab.size(820, 580)
    plain = """const ask = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind) {
        return kind === "2d" ? ask.call(this, kind) : null;
    };"""
    script = tab.send("Page.addScriptToEvaluateOnNewDocument", source=plain)["identifier"]
    try:
        tab.open(pages["alone"])
    finally:
        tab.send("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    assert "no WebGL" in tab.run("document.querySelector('.nothing').innerText")
    tab.click(*middle_of(tab, ".height canvas", 0.6))
    tab.wait_for("roadgpt.poses[0].s > 50")
    assert_quiet(tab, pages["alone"])


def test_the_others_stand_and_move_where_the_drive_has_them(tab: BrowserTab, tmp_path: Path) -> None:
    run = prove(design(), 7, setup=Setup(driver="beamng_like"))
    assert run.road is not None
    assert run.drive is not None
    actors, states = [], np.full((40, len(SIZES), 5), np.nan)
    for n, (kind, size) in enumerate(SIZES.items()):
        actors.append(Actor(f"{kind} 1", kind, size))
        x, y, z = run.road.at(12.0 + 9.0 * n, 2.0)
        states[n:, n] = [x, y, z, float(run.road.heading(12.0 + 9.0 * n)) + math.pi, 0.0]
    states[:, 0, 0] += 2.0 * 0.1 * np.arange(40)  # the first one moves by 2 m/s
    states[:, 0, 4] = 2.0
    others = Tracks(tuple(actors), states)
    path = view.write([replace(run, drive=replace(run.drive, others=others))], tmp_path / "others.html")
    tab.size(600, 420)
    tab.open(path)
    tab.run("roadgpt.player.moveTo(1.25)")
    tab.wait_for("!roadgpt.player.isPlaying && roadgpt.others[0].length > 0")
    seen = tab.run("roadgpt.others[0].map(({number, x, y, heading}) => [number, x, y, heading])")
    expected = others.at(1.25)
    assert {int(row[0]) for row in seen} == {n for n in range(len(actors)) if n <= 12}
    for number, x, y, heading in seen:
        assert (x, y) == pytest.approx(expected[int(number), :2], abs=0.01)
        assert math.cos(heading - expected[int(number), 3]) > 0.9999
    assert not tab.told


def test_weather_is_seen_on_a_page_whose_address_names_time_and_camera(
    tab: BrowserTab, tmp_path: Path
) -> None:
    """It fades with distance."""
    tab.size(1200, 800)
    seen = {}
    for text in ("medium", "fog 40", "rain 30", "night", "low_sun"):
        run = prove(design(), 7, World().changed(scene=text), Setup(drives=False))
        path = view.write([replace(run, source="a road")], tmp_path / "weather.html")
        tab.open(path, "#t=0.5&camera=bonnet")
        assert tab.run("[roadgpt.player.time, roadgpt.player.camera]") == [0.5, "bonnet"]
        seen[text] = tab.picture(".stage .scene")[..., :3]
        assert_quiet(tab, path)
        assert ("visual range of 40" in tab.run("document.querySelector('.origin').textContent")) == (
            text == "fog 40"
        )
    rows, columns, _ = seen["medium"].shape
    sky = {
        text: picture[rows // 8 : rows // 5, columns // 2 : 9 * columns // 10]
        for text, picture in seen.items()
    }
    road = {text: picture[-rows // 6 :].mean() for text, picture in seen.items()}
    for text in ("fog 40", "rain 30"):
        assert np.ptp(sky[text].mean(axis=(0, 1))) < 0.02 < np.ptp(sky["medium"].mean(axis=(0, 1)))  # grey
    assert sky["fog 40"].std() < 0.01
    assert changed(seen["fog 40"], seen["medium"]) > 0.8
    assert sky["night"].mean() < 0.3 * sky["medium"].mean()
    assert seen["night"][-rows // 5 :].max() > 3 * sky["night"].mean()  # headlights
    assert road["rain 30"] < 0.9 * road["medium"]
    assert seen["low_sun"].max(axis=2)[: rows // 2].mean() > seen["medium"].max(axis=2)[: rows // 2].mean()


def test_the_time_line_and_the_contact(tab: BrowserTab, tmp_path: Path) -> None:
    """A car at 10 m/s behind a van that brakes from 10 m/s with 2 m/s^2: by hand they touch when its 9 m of
    gap are gone, 3 s after the van began to brake; the relative speed is then 6 m/s. It is night."""
    road = World().lay(Road.through([[x, 100] for x in range(20, 181, 20)]))

    def braking(time: np.ndarray) -> tuple[Any, Any, Any]:
        braked = np.clip(time - 1.0, 0.0, 5.0)
        return 30 + 4.7 / 2 + 9 + 6.5 / 2 + 10 * time - braked**2, 98.0, 0.0

    alone = staged.driven(staged.straight(30, 98, 0, 10), 6.0, road)
    drive = staged.among(alone, staged.tracks(6.0, van_1=("van", braking)))
    verdict = judge(road, drive, World())
    request = Request(words="a contact", world=World().changed(scene="night"), seed=1, setup=Setup())
    run = Run(
        request=request, index=1, seed=1, road=road, drive=drive, verdict=verdict, outcome=verdict.outcome,
        description=verdict.description,
    )  # fmt: skip
    events = (Event("van 1", "brakes with 2 m/s2", 1.0, 39.0, 6.0), Event("bus 1", "stops", why="<i>late"))
    run = replace(run, verdict=replace(verdict, events=(*events[:1], *(verdict.events or ()), *events[1:])))
    path = view.write([run], tmp_path / "contact.html")
    tab.size(820, 580)
    tab.open(path)
    assert tab.run("document.querySelector('.slide b').textContent") == "contact"
    tab.run("document.querySelector('button.contact').click()")
    tab.settle()
    assert tab.run("roadgpt.player.time") == pytest.approx(4.0, abs=0.02)
    tab.key("Home")
    tab.key("c")
    assert tab.run("roadgpt.player.time") == pytest.approx(4.0, abs=0.02)
    assert len(np.unique((tab.picture(".near canvas")[..., :3] * 255).round().reshape(-1, 3), axis=0)) > 12
    lit = {}
    for time in (0.5, 2.0, 5.9):
        slide(tab, time)
        lit[time] = tab.run("roadgpt.others[0][0].brake")
    assert lit == {0.5: 0, 2.0: 1, 5.9: 1}
    # at 3 s the gap is 5 m and closes with 4 m/s
    told = "JSON.parse(document.getElementById('data').textContent)[0].others.near"
    assert tab.run(f"{told}.ttc[30]") == pytest.approx(5 / 4, abs=0.01)
    assert tab.run(f"{told}.conflict[30]") == pytest.approx(5 / 4, abs=0.01)
    rows = tab.run("[...document.querySelectorAll('.events li')].map((row) => row.textContent)")
    assert rows[0] == "1.0 s39 mvan 1: brakes with 2 m/s2, until 6.0 s"
    assert rows[-1] == "neverbus 1: stops: <i>late"
    tab.run("document.querySelector('.events button').click()")
    tab.settle()
    assert tab.run("roadgpt.player.time") == pytest.approx(1.0)
    hud = {each: f"document.querySelector('.hud .{each}').textContent" for each in ("event", "other")}
    assert tab.run(hud["event"]) == "van 1: brakes with 2 m/s2"
    slide(tab, 3.0)
    assert tab.run(hud["other"]) == "gap 5.0 m to van 1, 22 km/h"  # 10 - 2 * 2 m/s
    wide = tab.run("document.querySelector('.near canvas').clientWidth")
    x, y = middle_of(tab, ".near canvas", (34 + (wide - 46) / 2) / wide)
    tab.click(x, y)
    tab.settle()
    assert tab.run("roadgpt.player.time") == pytest.approx(3.0, abs=0.05)
    assert not tab.told
