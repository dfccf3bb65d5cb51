"""Makes the figures of README and docs anew: printed outputs and pictures, from the commands beside them.

    python docs/figures.py FOLDER                 everything: about 25 minutes on two cores
    python docs/figures.py FOLDER quick           what the tests compare
    python docs/figures.py FOLDER view README.md  some pictures or pages

In README, the tutorial and the how-tos a block of the kind ``console`` holds commands behind ``$``. Below a
command stands what it prints, if the page shows it; that is what this script replaces. A block behind the
comment ``<!-- slow -->`` is not quick. Commands work in FOLDER, with the repository's examples beside them;
what they made and printed is kept there and not made again (``make figures`` begins with an empty folder).
Films need the extra ``film``, pictures of pages need chromium. Pictures have 960 by 640 pixels (the lane
finder's is a strip of 960) and at most 256 colours.
"""

import base64
import hashlib
import io
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
SIZE = 960, 640  # px
WINDOW = 1200, 800  # px, of the browser
MOST = 150_000  # bytes
COLOURS = 256, 192, 128, 96, 64
HOW_TOS = sorted((ROOT / "docs" / "how-to").glob("*.md"))
UPHILL = "roadgpt-runs/an-uphill-road-with-3-turns-7"
PAGES = ("README.md", "docs/tutorial.md", *(f"docs/how-to/{page.name}" for page in HOW_TOS))
BLOCK = re.compile(r"(?P<slow><!-- slow -->\n)?^```console\n(?P<lines>.*?)^```$", re.MULTILINE | re.DOTALL)
TIMES = re.compile(r"in [\d.]+ s( \([\d.]+ roads/s\))?")
"""What differs from machine to machine in what commands print."""
COMMANDS = {
    "pass": 'roadgpt run "a narrow road climbs out of a valley in four hairpins, '
    'along a lake, under a ridge" --seed 2 --out roadgpt-runs/pass',
    "overview": "roadgpt view roadgpt-runs/pass/runs/0001 --out roadgpt-runs/pass.html",
    "uphill": 'roadgpt run "an uphill road with 3 turns" -n 5 --seed 7',
    "hard": 'roadgpt campaign "an uphill road with 3 turns" --goal failures -n 200 -j 2 --seed 7 --out hard',
    "faults": "roadgpt faults hard --minimise -j 2",
    "report": "roadgpt report hard",
    "view": "roadgpt view hard --worst --out view.html",
    "junctions": 'roadgpt run --plan "straight 60 // crossroads left lights // roundabout exit=3 // | up" '
    "-n 3 --seed 4 --speed-limit 50 --out junctions",
    "ramp": 'roadgpt run --plan "| lanes=2 len=300 motorway // diverge ramp" '
    "--seed 1 --speed-limit 80 --out ramp",
    "grid": 'roadgpt run --plan "map columns=3 rows=2 lights" -n 2 --seed 4 --speed-limit 50 --out grid',
    "village": 'roadgpt run --plan "map crossroads x3; roundabout; t_junction x2" '
    "-n 2 --seed 5 --speed-limit 50 --out village",
    "page": "roadgpt view junctions/runs/0001 --out junctions.html",
    "thesis": "roadgpt study thesis --out thesis",
}
"""The commands that make the pictures; each stands on the page that shows its picture."""


def printed(work: Path, command: str) -> str:
    """Runs a command in the folder, if that was not done before, and returns what it printed."""
    kept = work / ".printed" / hashlib.sha256(command.encode()).hexdigest()[:16]
    if not kept.exists():
        print(f"$ {command}", flush=True)
        kept.parent.mkdir(parents=True, exist_ok=True)
        if not (work / "examples").exists():
            (work / "examples").symlink_to(ROOT / "examples")
        program, *words = shlex.split(command)
        if program != "roadgpt":
            raise SystemExit(f"a page shows the command {command!r}, which is none of RoadGPT")
        begun = [sys.executable, "-m", "roadgpt", *words]
        done = subprocess.run(begun, cwd=work, stdout=subprocess.PIPE, encoding="utf-8", check=True)
        kept.write_text(done.stdout, encoding="utf-8")
    return kept.read_text(encoding="utf-8")


def renewed(work: Path, page: str, is_quick: bool = False) -> str:
    """Returns the text of a page with the outputs of its commands, or of its quick blocks, made anew."""

    def block(match: re.Match[str]) -> str:
        if is_quick and match["slow"]:
            return match[0]
        lines = []
        for part in re.split(r"^\$ ", match["lines"], flags=re.MULTILINE)[1:]:
            command, shown = part.split("\n", 1)
            told = printed(work, command)
            lines.append(f"$ {command}\n{told if shown.strip() else shown}")
        return f"{match['slow'] or ''}```console\n{''.join(lines)}```"

    return BLOCK.sub(block, (ROOT / page).read_text(encoding="utf-8"))


def made(work: Path, *names: str) -> Path:
    """Runs the commands of these names, and returns the folder in which they were run."""
    for name in names:
        printed(work, COMMANDS[name])
    return work


def landscape(work: Path) -> Image.Image:
    """Returns the page of a road in its landscape, seen as a whole."""
    return shot(made(work, "pass", "overview") / "roadgpt-runs/pass.html", "#camera=free")


def junctions(work: Path) -> Image.Image:
    """Returns a route through junctions from above."""
    return Image.open(made(work, "junctions") / "junctions" / "runs" / "0001" / "birds_eye.png")


def ramp(work: Path) -> Image.Image:
    """Returns the exit of a motorway from above."""
    return Image.open(made(work, "ramp") / "ramp" / "runs" / "0001" / "birds_eye.png")


def maps(work: Path) -> Image.Image:
    """Returns two maps from above, side by side."""
    folders = [made(work, name) / name for name in ("grid", "village")]
    both = [Image.open(folder / "runs" / "0001" / "birds_eye.png") for folder in folders]
    height = max(each.height for each in both)
    whole = Image.new("RGB", (sum(each.width for each in both), height), "white")
    whole.paste(both[0])
    whole.paste(both[1], (both[0].width, 0))
    return whole


def junctions_view(work: Path) -> Image.Image:
    """Returns the page of a route, before a roundabout."""
    return shot(made(work, "junctions", "page") / "junctions.html", "#t=15&camera=behind")


def fault(work: Path) -> Image.Image:
    """Returns the picture of the most typical failure of a fault."""
    return Image.open(min((made(work, "hard", "faults") / "hard" / "faults" / "c01").glob("*.png")))


def film(work: Path) -> Image.Image:
    """The same moment from behind and, small, from the hood camera."""
    from roadgpt.run import read_run
    from roadgpt_film.film import Film, Settings

    run = read_run(made(work, "uphill") / UPHILL / "runs" / "0001")
    wide, high = SIZE
    behind, hood = (
        Image.fromarray(Film.of([run], view, Settings(*size)).frame(100))
        for view, size in (("chase", SIZE), ("bonnet", (wide // 3, high // 3 // 2 * 2)))
    )
    behind.paste("white", (wide - hood.width - 16, high - hood.height - 16, wide - 8, high - 8))
    behind.paste(hood, (wide - hood.width - 12, high - hood.height - 12))
    return behind


def view(work: Path) -> Image.Image:
    """Returns the page of a road, where the car has left its lane."""
    return shot(made(work, "hard", "view") / "view.html", "#t=7.4&camera=behind")


def faults(work: Path) -> Image.Image:
    """Returns the gallery of distinct faults in a campaign's report."""
    return shot(made(work, "hard", "faults", "report") / "hard" / "report.html", "#s1")


def map_of_features(work: Path) -> Image.Image:
    """Returns a feature map in a campaign's report."""
    page = made(work, "hard", "faults", "report") / "hard" / "report.html"
    return shot(page, "#s2", (660, 440), "document.querySelector('#s2 figure').scrollIntoView()")


def study(work: Path) -> Image.Image:
    """Returns the first page of a study's report."""
    return shot(made(work, "thesis") / "thesis" / "report.html")


def lane_finder(work: Path) -> Image.Image:
    """Returns what the lane finder sees in a bend, before a crest and on it, beside each other."""
    del work
    sys.path.insert(0, str(ROOT / "examples" / "vision"))
    from lane_finder import LaneFinder

    from roadgpt import Limits, World, perform, simulate
    from roadgpt.run import Setup

    class Keeping(LaneFinder):
        """Keeps what it sees."""

        def start(self, road, world, seed):
            super().start(road, world, seed)
            self.pictures = []

        def steer(self, view):
            before = self._image
            command = super().steer(view)
            if view.image is not before:
                self.pictures.append(self._ground.marked(view.image, self.lane))
            return command

    world = World(limits=Limits(speed_limit=25 / 3.6))
    run = perform("a right turn on a climb, then a crest and a right turn", 7, world, Setup(drives=False))
    driver = Keeping()
    simulate(run.road, world, driver)
    rows = [
        np.pad(driver.pictures[n], ((0, 0), (0, 8), (0, 0)), constant_values=255) for n in (212, 500, 548)
    ]
    return Image.fromarray(np.concatenate(rows, axis=1)[:, :-8])


PICTURES = {
    "landscape": landscape,
    "fault": fault,
    "film": film,
    "view": view,
    "faults": faults,
    "feature-map": map_of_features,
    "junctions": junctions,
    "junctions-view": junctions_view,
    "ramp": ramp,
    "maps": maps,
    "study": study,
    "lane-finder": lane_finder,
}


def shot(page: Path, at: str = "", window: tuple[int, int] = WINDOW, script: str = "0") -> Image.Image:
    """Returns what a browser with a window of some pixels shows of a page after a script."""
    sys.path.insert(0, str(ROOT / "tests"))
    from chromium import browser

    with browser() as tab:
        scale = max(1.0, SIZE[0] / window[0])
        width, height = window
        tab.send(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=scale, mobile=False,
        )  # fmt: skip
        tab.send("Page.navigate", url=page.resolve().as_uri() + at)
        while tab.run("document.readyState + location.protocol") != "completefile:":
            time.sleep(0.1)
        if page.name == "view.html":
            tab.wait_for("window.roadgpt && roadgpt.frames > 0")
        tab.run(script)
        tab.settle()
        data = tab.send("Page.captureScreenshot")["data"]
    return Image.open(io.BytesIO(base64.b64decode(data)))


def keep(picture: Image.Image, name: str) -> None:
    """Writes a picture with as many colours as there is room for."""
    whole = framed(picture, name)
    path = IMAGES / f"{name}.png"
    for colours in COLOURS:
        whole.quantize(colours, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size < MOST:
            break
    print(f"{path}: {path.stat().st_size // 1000} kB, {colours} colours", flush=True)


def framed(picture: Image.Image, name: str) -> Image.Image:
    """Returns a picture in the size of all."""
    small = picture.convert("RGB")
    small.thumbnail(SIZE, Image.Resampling.LANCZOS)
    whole = small if name == "lane-finder" else Image.new("RGB", SIZE, "white")
    whole.paste(small, ((whole.width - small.width) // 2, (whole.height - small.height) // 2))
    return whole


QUICK = ("junctions", "ramp", "maps")
"""Pictures that take seconds."""


def main(folder: str, *names: str) -> None:
    """Makes the pictures and pages of these names anew; all, if none is given."""
    work = Path(folder).resolve()
    work.mkdir(parents=True, exist_ok=True)
    is_quick = names == ("quick",)
    wanted = (*QUICK, *PAGES) if is_quick else names or (*PICTURES, *PAGES)
    for name in wanted:
        if name in PICTURES:
            keep(PICTURES[name](work), name)
            continue
        text = renewed(work, name, is_quick)
        is_new = TIMES.sub("", text) != TIMES.sub("", (ROOT / name).read_text(encoding="utf-8"))
        print(f"{name}: {'changed' if is_new else 'as it was'}", flush=True)
        if is_new:
            (ROOT / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
