"""Pictures as PNG, SVG and PDF, on the user's own axes, and in notebooks."""

import io
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure
from PIL import Image

import roadgpt
from road_parts import design_of
from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt.report import FORMATS, Format, draw
from roadgpt.report.canvas import encoded, format_of, new_figure
from roadgpt.report.plotting import png_of
from roadgpt.road import Design, Road, build
from roadgpt.run import Request, Run, Setup, prove

NAMES = ("birds_eye", "height", "curvature_grade")


@pytest.fixture(scope="module")
def design() -> Design:
    return design_of((40, 0, 4), (40, -60, 0))


@pytest.fixture(scope="module")
def run(design: Design) -> Run:
    return prove(design, 3, setup=Setup(driver="beamng_like"))


def is_of(data: bytes, name: Format) -> bool:
    """What the file itself says, by its format's own mark."""
    if name == "svg":
        return ET.fromstring(data).tag == "{http://www.w3.org/2000/svg}svg"
    return data.startswith({"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-1."}[name])


@pytest.fixture(scope="module")
def written(run: Run, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return draw(run, tmp_path_factory.mktemp("written"), formats=FORMATS)


def test_every_picture_is_written_in_every_format(written: list[Path]) -> None:
    assert {path.name for path in written} == {f"{name}.{kind}" for name in NAMES for kind in FORMATS}
    for path in written:
        assert is_of(path.read_bytes(), format_of(path)), path


@pytest.mark.parametrize("name", FORMATS)
def test_the_same_figure_gives_the_same_bytes_whatever_the_users_style_and_no_date(
    name: Format, run: Run, written: list[Path], tmp_path: Path
) -> None:
    with mpl.rc_context({"font.size": 31, "axes.facecolor": "red", "savefig.bbox": "tight"}):
        others = {path.name: path.read_bytes() for path in draw(run, tmp_path, formats=(name,))}
    for path in written:
        if format_of(path) != name:
            continue
        one, other = path.read_bytes(), others[path.name]
        assert one == other
        assert b"CreationDate" not in one
        assert b"<dc:date>" not in one
        assert name != "png" or b"tEXt" not in one


def test_letters_in_a_pdf_are_of_a_type_that_publishers_take(run: Run, tmp_path: Path) -> None:
    with mpl.rc_context({"pdf.compression": 0}):
        figure = new_figure(3, 2)
        figure.text(0.1, 0.5, "left its lane")
        data = encoded(figure, "pdf")
    assert b"/Type3" not in data
    assert re.search(rb"/Subtype /(TrueType|CIDFontType2)", data)


def ask(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, [*words], catch_exceptions=False)
    return done.exit_code, done.output


def test_commands_write_the_formats_that_are_asked_for(design: Design, tmp_path: Path) -> None:
    road = tmp_path / "road.json"
    road.write_text(json.dumps(design.to_json()))
    status, said = ask("view", str(road), "--out", str(tmp_path / "plots"), "--format", "svg,pdf")
    assert status == 0
    found = {path.name for path in (tmp_path / "plots" / "road").iterdir()}
    assert found == {f"{name}.{kind}" for name in NAMES for kind in ("svg", "pdf")}
    assert str(tmp_path / "plots" / "road" / "height.pdf") in said
    picture = tmp_path / "both.svg"
    assert ask("compare", str(road), str(road), "--out", str(picture))[0] == 0
    assert is_of(picture.read_bytes(), "svg")
    status, said = ask("view", str(road), "--format", "bmp")
    assert status == 2
    assert "'bmp' is no format of pictures" in said
    status, said = ask("compare", str(road), str(road), "--out", str(tmp_path / "both.doc"))
    assert status == 2
    assert "both.doc" in said


def test_run_writes_its_pictures_and_its_overview_as_asked(tmp_path: Path) -> None:
    words = ("a straight road of 40 m", "--seed", "1", "--out", str(tmp_path / "runs"), "--format", "pdf")
    assert ask("run", "--no-drive", *words)[0] == 0
    assert is_of((tmp_path / "runs" / "overview.pdf").read_bytes(), "pdf")
    own = tmp_path / "runs" / "runs" / "0001"
    assert {path.name for path in own.glob("*.p*")} >= {f"{name}.pdf" for name in NAMES}
    assert not list(tmp_path.rglob("*.png"))


def test_a_road_is_plotted_to_scale_on_the_users_axes(design: Design, run: Run) -> None:
    figure = Figure(figsize=(8, 4))
    road_axes, run_axes = figure.subplots(1, 2)
    road = build(design)
    assert roadgpt.plot(road, road_axes) is road_axes
    assert roadgpt.plot(run, run_axes) is run_axes
    figure.savefig(io.BytesIO(), format="png")  # which is when aspects are settled
    for axes in (road_axes, run_axes):
        (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
        box = axes.get_window_extent()
        assert box.width / (x1 - x0) == pytest.approx(box.height / (y1 - y0), rel=1e-6)
        for corner in (*road.at(road.sample().s, 4.0), *road.at(road.sample().s, -4.0)):
            assert x0 < corner[0] < x1
            assert y0 < corner[1] < y1
    # the driven path, and the rim that says where the car was partly outside
    assert run.verdict is not None
    assert run.verdict.severity == "partly outside"
    assert len(run_axes.collections) == len(road_axes.collections) + 2


def test_plot_says_what_it_cannot_draw() -> None:
    lost = Run(Request(), 4, 1, outcome="ERROR", description="nothing could be designed")
    with pytest.raises(UsageError, match=r"run 4 has no road.*nothing could be designed"):
        roadgpt.plot(lost)
    with pytest.raises(UsageError, match="a str cannot be plotted"):
        roadgpt.plot("a road")


def test_values_are_told_in_one_line(design: Design, run: Run) -> None:
    road = build(design)
    brief = roadgpt.read("an uphill road with 3 turns")
    for value in (design, road, run, run.drive, run.verdict, brief, run.world):
        assert "\n" not in repr(value)
        assert len(repr(value)) < 500
    assert f"{road.length:.1f} m" in repr(road)
    assert "2 segments, 1 of them turning" in repr(design)
    assert "slope='up'" in repr(brief)
    assert "None" not in repr(brief)  # what nobody asked for is left out
    assert "straight" in repr(Road.through([[10, 10], [60, 10]]))


def test_pictures_in_notebooks_show_the_value(design: Design, run: Run, tmp_path: Path) -> None:
    road = png_of(build(design))
    assert road is not None
    assert road != png_of(run)
    pixels = np.asarray(Image.open(io.BytesIO(road)).convert("RGB"))
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 20
    assert png_of("a road") is None
    empty = roadgpt.campaign("a straight road", 2, 1, setup=Setup(drives=False), out=tmp_path / "c")
    assert png_of(empty) is None
    list(empty)
    page = png_of(empty)
    assert page is not None
    assert is_of(page, "png")


def test_the_verb_campaign_can_be_called_whatever_room_was_imported_and_pyplot_never_is(
    tmp_path: Path,
) -> None:
    code = "import sys, roadgpt.campaign.model, roadgpt.run; from roadgpt.run import Setup; "
    code += (
        "print(len(list(roadgpt.campaign('a straight road', 1, setup=Setup(drives=False), out=sys.argv[1]))))"
        "; import roadgpt.report; print('matplotlib.pyplot' in sys.modules, 'matplotlib' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "c")], capture_output=True, text=True, check=False
    )
    assert (done.stdout.split(), done.stderr) == (["1", "False", "True"], "")
