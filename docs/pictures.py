"""Makes the pictures of docs/images anew, from the commands that stand here.

    python docs/pictures.py /tmp/pictures              all of them: about 20 minutes on two cores
    python docs/pictures.py /tmp/pictures view film    some of them

Runs and campaigns are kept in the folder that is named, and not made again where they are there. Needs the
extra ``film``, and a chromium for the pages. Every picture has 960 by
640 pixels (the lane finder's a strip of 960) and at most 256 colours.
"""

import base64
import io
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
COMMANDS = {
    "switchbacks": "roadgpt run 'zig-zag down a hillside with 4 sharp switchbacks, hard for a lane keeper' "
    "-n 20 --seed 3 --friction 0.6 --out switchbacks",
    "uphill": "roadgpt run 'an uphill road with 3 turns' -n 5 --seed 7 --out uphill",
    "hard": "roadgpt campaign 'an uphill road with 3 turns' --goal failures -n 200 -j 2 --seed 7 --out hard",
    "hard/faults": "roadgpt faults hard --minimise -j 2",
    "hard/report.html": "roadgpt report hard",
    "view.html": "roadgpt view hard --worst --out view.html",
    "serpentine": "roadgpt run 'a serpentine road' -n 40 --seed 5 --out serpentine",
    "serpentine/faults": "roadgpt faults serpentine -j 2",
    "junctions": "roadgpt run --plan 'straight 60 // crossroads left lights // roundabout exit=3 // | up' "
    "-n 3 --seed 4 --speed-limit 50 --out junctions",
    "ramp": "roadgpt run --plan '| lanes=2 len=300 motorway // diverge ramp' "
    "--seed 1 --speed-limit 80 --out ramp",
    "grid": "roadgpt run --plan 'map columns=3 rows=2 lights' -n 2 --seed 4 --speed-limit 50 --out grid",
    "village": "roadgpt run --plan 'map crossroads x3; roundabout; t_junction x2' "
    "-n 2 --seed 5 --speed-limit 50 --out village",
    "junctions.html": "roadgpt view junctions/runs/0001 --out junctions.html",
    "thesis/report.html": "roadgpt study thesis --roads 100 --out thesis",
}


def made(work: Path, *names: str) -> Path:
    """Runs the commands that make these, where they are not there; returns the last."""
    for name in names:
        if not (work / name).exists():
            print(f"$ {COMMANDS[name]}", flush=True)
            words = shlex.split(COMMANDS[name])[1:]
            subprocess.run([sys.executable, "-m", "roadgpt", *words], cwd=work, check=True)
    return work / names[-1]


def switchbacks(work: Path) -> Image.Image:
    """Returns a road from above, with a failure."""
    return Image.open(made(work, "switchbacks") / "runs" / "0011" / "birds_eye.png")


def junctions(work: Path) -> Image.Image:
    """Returns a route through junctions from above."""
    return Image.open(made(work, "junctions") / "runs" / "0001" / "birds_eye.png")


def ramp(work: Path) -> Image.Image:
    """Returns the exit of a motorway from above."""
    return Image.open(made(work, "ramp") / "runs" / "0001" / "birds_eye.png")


def maps(work: Path) -> Image.Image:
    """Returns two maps from above, side by side."""
    both = [Image.open(made(work, name) / "runs" / "0001" / "birds_eye.png") for name in ("grid", "village")]
    height = max(each.height for each in both)
    whole = Image.new("RGB", (sum(each.width for each in both), height), "white")
    whole.paste(both[0])
    whole.paste(both[1], (both[0].width, 0))
    return whole


def junctions_view(work: Path) -> Image.Image:
    """Returns the page of a route, before a roundabout."""
    return shot(made(work, "junctions", "junctions.html"), "#t=15&camera=behind")


def fault(work: Path) -> Image.Image:
    """Returns the picture of the most typical failure of a fault."""
    return Image.open(min((made(work, "serpentine", "serpentine/faults")).glob("*.png")))


def film(work: Path) -> Image.Image:
    """The same moment from behind and, small, from the hood camera."""
    from roadgpt.report.film import Film, Settings
    from roadgpt.run import read_run

    run = read_run(made(work, "uphill") / "runs" / "0001")
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
    return shot(made(work, "hard", "view.html"), "#t=7.4&camera=behind")


def faults(work: Path) -> Image.Image:
    """Returns the gallery of distinct faults in a campaign's report."""
    return shot(made(work, "hard", "hard/faults", "hard/report.html"), "#s1")


def map_of_features(work: Path) -> Image.Image:
    """Returns a feature map in a campaign's report."""
    page = made(work, "hard", "hard/faults", "hard/report.html")
    return shot(page, "#s2", (660, 440), "document.querySelector('#s2 figure').scrollIntoView()")


def study(work: Path) -> Image.Image:
    """Returns the first page of a study's report."""
    return shot(made(work, "thesis/report.html"))


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
    "switchbacks": switchbacks,
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
    """Writes a picture in the size of all, with as many colours as there is room for."""
    small = picture.convert("RGB")
    small.thumbnail(SIZE, Image.Resampling.LANCZOS)
    whole = small if name == "lane-finder" else Image.new("RGB", SIZE, "white")
    whole.paste(small, ((whole.width - small.width) // 2, (whole.height - small.height) // 2))
    path = IMAGES / f"{name}.png"
    for colours in COLOURS:
        whole.quantize(colours, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size < MOST:
            break
    print(f"{path}: {path.stat().st_size // 1000} kB, {colours} colours", flush=True)


if __name__ == "__main__":
    folder = Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or PICTURES:
        keep(PICTURES[name](folder), name)
