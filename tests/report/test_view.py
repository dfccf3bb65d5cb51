"""The page of a road: what stands in it, and that nothing in a description gets out of its place."""

import base64
import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from road_parts import design_of, named
from roadgpt.cli import app
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.report import view
from roadgpt.report.view import DRIVE
from roadgpt.road import CrossSection, Design, Road, Site, World
from roadgpt.run import Run, Setup, perform, prove, write_run
from roadgpt.scene import Scenery

EVIL = (
    "</script><script>alert(1)</script><!-- &lt; @@SCRIPT@@ ' \" \\ \u2028 \ud800 "
    "<img src=x onerror=alert(2)>"
)


def design(turn: float = 65) -> Design:
    return design_of((60, 0, 5), (45, turn, 2), (50, 0, -3))


@pytest.fixture(scope="module")
def driven() -> Run:
    return named(prove(design(), 7), "a road with one left turn")


@pytest.fixture(scope="module")
def alone() -> Run:
    return replace(prove(design(), setup=Setup(drives=False)), source="alone.json")


class ViewParser(HTMLParser):
    """What a browser would see: elements, what scripts hold, and addresses."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.scripts: list[str] = []
        self.fetched: list[str] = []
        self._is_script = self._is_title = False
        self.title = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self._is_script, self._is_title = tag == "script", tag == "title"
        self.fetched += [
            value or "" for name, value in attrs if name in ("src", "href", "srcset", "data", "action")
        ]
        if self._is_script:
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._is_script = self._is_title = False

    def handle_data(self, data: str) -> None:
        if self._is_script:
            self.scripts[-1] += data
        if self._is_title:
            self.title += data


def seen(page: str) -> ViewParser:
    reader = ViewParser()
    reader.feed(page)
    return reader


def data_of(page: str) -> list[dict[str, object]]:
    found: list[dict[str, object]] = json.loads(seen(page).scripts[0])
    return found


def test_the_page_holds_everything_and_fetches_nothing(driven: Run) -> None:
    page = view.page([driven])
    reader = seen(page)
    assert reader.fetched == []
    assert len(reader.scripts) == 4
    assert "default-src 'none'" in page
    assert "@import" not in page
    assert not re.search(r"url\(", page.split("</style>")[0])
    assert "@@" not in page.replace(reader.scripts[2], "")


def test_a_description_cannot_break_out(driven: Run) -> None:
    plain, evil = seen(view.page([driven])), view.page([replace(named(driven, EVIL), description=EVIL)])
    reader = seen(evil)
    assert reader.tags == plain.tags
    assert reader.scripts[1:] == plain.scripts[1:]
    assert data_of(evil)[0]["title"] == EVIL
    assert reader.title.startswith("</script><script>alert(1)")
    evil.encode("utf-8")


@settings(max_examples=60)
@given(st.recursive(st.text() | st.floats(allow_nan=False, allow_infinity=False), st.lists))
def test_what_is_embedded_comes_back(data: object) -> None:
    text = view.embedded(data)
    assert json.loads(text) == data
    assert text.isascii()
    assert not {*text} & {*"<>&"}


def test_the_road_is_drawn_where_it_is(driven: Run) -> None:
    road = view.scene(driven)["road"]
    assert driven.road is not None
    assert len({len(road[name]) for name in ("s", "x", "y", "z", "heading", "curvature", "grade")}) == 1
    points = np.stack([road["x"], road["y"], road["z"]], axis=-1)
    assert points == pytest.approx(driven.road.at(np.array(road["s"])), abs=2e-3)
    # between two stations the drawn line stays within 2 cm of the road
    middle = (np.array(road["s"])[1:] + np.array(road["s"])[:-1]) / 2
    assert (points[1:] + points[:-1]) / 2 == pytest.approx(driven.road.at(middle), abs=0.02)


def test_the_markings_are_those_that_are_judged(driven: Run) -> None:
    made = view.scene(driven)
    assert driven.road is not None
    left, right = map(float, driven.world.profile_of(driven.road).marking_limits(0.0))
    assert made["marking"]["width"] == 2 * left
    lanes = made["road"]["lanes"]  # the page paints edge lines up to the outermost bounds
    assert [(bound["marking"], bound["t"]) for bound in lanes["bounds"]] == [
        ("solid", 4.0),
        ("broken", 0.0),
        ("solid", right),
    ]
    assert (lanes["rims"], lanes["middle"], lanes["shoulder"]) == ({"left": 7.0, "right": -7.0}, -2.0, 3.0)


def test_a_road_s_own_lanes_and_bank_are_told_at_each_station() -> None:
    world = World(
        section=CrossSection(lanes="2+1", lane_width=3.0, lane_width_end=4.0, bank=0.06, shoulder=1.0)
    )
    run = prove(Road.through([(20, 20), (80, 30), (120, 80), (110, 140)]), 0, world, Setup(drives=False))
    road = view.scene(run)["road"]
    s, lanes = np.array(road["s"]), road["lanes"]
    width = np.interp(s, [0.0, road["length"]], [3.0, 4.0])
    far = np.abs(s - road["length"] / 2) < 1e-9 + road["length"] / 2
    assert (lanes["driven"], len(lanes["bounds"])) == (2, 4)
    assert [bound["marking"] for bound in lanes["bounds"]] == ["solid", "solid", "broken", "solid"]
    right = np.array(lanes["bounds"][3]["t"])
    assert right[0] == -6.0
    assert right[-1] == -8.0
    assert np.abs(right + 2 * width)[far].max() < 0.25  # they widen without a kink, so not evenly
    assert np.array(lanes["rims"]["right"]) == pytest.approx(right - 1.0, abs=2e-3)
    assert np.array(lanes["middle"]) == pytest.approx(0.75 * right, abs=2e-3)
    assert np.abs(lanes["bank"]).max() == pytest.approx(np.arctan(0.06), abs=2e-5)


def test_the_landscape_is_that_of_films(driven: Run) -> None:
    assert driven.road is not None
    told, film = view.scene(driven)["land"], Scenery.of(driven.road, driven.world)
    points, corners = (
        np.frombuffer(base64.b64decode(told["ground"][n]), "<i4") for n in ("points", "corners")
    )
    points, corners = points.reshape(-1, 3) / 100, corners.reshape(-1, 3)
    near = (np.abs(points[:, :2] - told["middle"]) < told["wide"] - 1).all(axis=1)
    assert near.sum() > 1000
    assert points[near, 2] == pytest.approx(film.ground.height(*points[near, :2].T), abs=0.02)
    assert corners.max() == len(points) - 1
    assert told["isLaid"]
    trees = np.reshape(told["trees"], (-1, 7))
    assert trees[:, :3] / 10 == pytest.approx(film.trees.places, abs=0.06)
    assert trees[:, 5].tolist() == film.trees.looks.tolist()


def test_the_drive_is_that_of_the_run(driven: Run) -> None:
    drive = view.scene(driven)["drive"]
    assert driven.drive is not None
    for name, digits in DRIVE.items():
        wanted = driven.drive[name]
        found = np.array(drive["columns"][name])
        if name == "heading":
            found, wanted = np.cos(found), np.cos(wanted)
        assert found == pytest.approx(wanted, abs=10.0**-digits)
    assert drive["car"]["length"] == driven.drive.car.length


def test_the_lane_of_a_car_that_was_made_to_change_it_is_the_new_one(driven: Run) -> None:
    """On lanes 4 m wide."""
    plan = "straight 250 | lanes=2 && ego v=50: change_lane left s=60"
    columns = view.scene(perform(plan, 1, setup=Setup(reader="plan")))["drive"]["columns"]
    assert columns["middle"][-1] - columns["middle"][0] == pytest.approx(4.0)
    assert columns["t"][-1] == pytest.approx(columns["middle"][-1], abs=0.3)
    assert "middle" not in view.scene(driven)["drive"]["columns"]


def test_a_drive_that_a_tyre_failed_is_in_the_colour_of_failing_from_then_on() -> None:
    """The page is told when the oracle was against the car, not only how much of the car was outside."""
    run = prove(design(), 7, World().changed(oracle="departure"), Setup(driver="beamng_like"))
    assert run.outcome == "FAIL"
    assert run.verdict is not None
    columns = view.scene(run)["drive"]["columns"]
    first = columns["failed"].index(1)
    assert columns["time"][first] == pytest.approx(run.verdict.at_time, abs=0.02)
    assert 0 < columns["outside"][first] < 0.1
    assert not any(columns["failed"][:first])


def test_a_failed_drive_tells_where_and_when() -> None:
    run = prove(design(), 7, World(site=Site(friction=0.15)))
    assert run.outcome == "FAIL"
    assert run.verdict is not None
    (place,) = view.scene(run)["places"]
    assert place["time"] == pytest.approx(run.verdict.at_time, abs=0.02)
    assert (place["x"], place["y"]) == pytest.approx(run.verdict.at_xy)


def test_what_cannot_be_shown_is_told(driven: Run, alone: Run, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no road to show"):
        view.page([replace(driven, road=None)])
    with pytest.raises(UsageError, match="3 are given"):
        view.page([driven] * 3)
    with pytest.raises(UsageError, match="not finite"):
        view.embedded([float("nan")])
    (tmp_path / "file").touch()
    with pytest.raises(RoadGPTError, match="--out"):
        view.write([alone], tmp_path / "file" / "page.html")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.fixture
def folder(driven: Run, tmp_path: Path) -> Path:
    (tmp_path / "road.json").write_text("[[20, 20], [60, 40], [120, 60], [160, 120]]")
    write_run(driven, tmp_path / "campaign")
    return tmp_path


def test_the_command_writes_one_page_of_a_file_and_a_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    run, page = folder / "campaign" / "runs" / "0001", folder / "page.html"
    words = ["view", str(folder / "road.json"), str(run), "--out", str(page), "--open"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert done.stdout == f"{page}\n"
    first, second = data_of(page.read_text(encoding="utf-8"))
    assert (first["title"], first["drive"]) == ("road.json", None)
    assert second["drive"] is not None
    assert opened == [page.resolve().as_uri()]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "road file or the folder of a run"),
        (["road.json"] * 3, "one road or two"),
        (["none.json"], "none.json"),
        (["road.json", "--out", "campaign"], "is a folder"),
        (["road.json", "--out", "road.json"], "does not end in .html"),
        (["road.json", "--out", "road.json/page.html"], "--out"),
    ],
)
def test_wrong_words_get_advice(
    folder: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], said: str
) -> None:
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(app, ["view", *words])
    assert done.exit_code in (1, 2)
    assert said in done.output
    assert not [*folder.glob("*.html")]


def test_the_page_is_named_after_its_roads(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    done = CliRunner().invoke(app, ["view", "road.json", "--open"])
    assert (done.exit_code, done.stdout) == (0, "road-view.html\n")
    assert "no browser could be started; open road-view.html" in done.stderr
    done = CliRunner().invoke(app, ["view", "road.json", "campaign/runs/0001"])
    assert (done.exit_code, done.stdout) == (0, "road-and-campaign-0001-view.html\n")
    assert len(data_of((folder / "road-and-campaign-0001-view.html").read_text(encoding="utf-8"))) == 2


def test_only_a_scene_with_weather_puts_it_on_the_page(driven: Run) -> None:
    def shown(text: str) -> dict[str, object]:
        world = driven.world.changed(scene=text)
        return view.scene(replace(driven, request=driven.request.model_copy(update={"world": world})))

    plain = shown("")
    assert "weather" not in plain
    for text in ("medium", "wet", "ego v=50"):
        assert shown(text) == plain
    foggy = shown("fog 50")
    assert foggy.pop("weather")["extinction"] == pytest.approx(math.log(20) / 50)
    assert foggy.pop("about") == plain["about"] + "; fog with a visual range of 50 metres"
    assert foggy == {name: value for name, value in plain.items() if name != "about"}
