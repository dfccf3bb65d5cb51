"""Makes an HTML page that shows one or two roads in 3-D and replays their drives. Main function: ``write``.

The page needs no server and no network: it contains its scripts, styles and data, and its content security
policy forbids requests. The scripts are in ``page/`` and are joined in the order of SCRIPTS; three.js is in
``three/``, with its licence."""

import html
import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.report.view.scene import scene, scenery
from roadgpt.run import Run
from roadgpt.run.atomic import write_whole

__all__ = ["page", "page_of", "scene", "write"]

MOST = 2  # roads on one page
HERE = Path(__file__).parent
SCRIPTS = (
    "numbers.js",
    "trip.js",
    "grain.js",
    "ribbon.js",
    "network.js",
    "land.js",
    "signs.js",
    "car.js",
    "stage.js",
    "cameras.js",
    "plan.js",
    "strip.js",
    "panel.js",
    "controls.js",
    "main.js",
)


def page(runs: Sequence[Run]) -> str:
    """Returns the whole page, to be written as UTF-8; the same Runs give the same text."""
    if not 1 <= len(runs) <= MOST:
        raise UsageError(f"a page shows one road or two side by side; {len(runs)} are given")
    return page_of([scene(run) for run in runs])


def page_of(scenes: Sequence[Mapping[str, Any]]) -> str:
    """Returns the page for one or two scenes made by ``scene``; empty parts of a scene are not shown."""
    title = " and ".join(dict.fromkeys(each["title"] for each in scenes))
    parts = {
        "TITLE": html.escape(title.encode("ascii", "xmlcharrefreplace").decode()).replace("&amp;#", "&#"),
        "STYLE": _part("page/style.css"),
        "LICENCE": _part("three/LICENSE"),
        "THREE": _part("three/three.min.js"),
        "SCRIPT": "\n".join(_part(f"page/{name}") for name in SCRIPTS),
        "SCENERY": embedded(scenery()),
        "DATA": embedded(scenes),
    }
    # in one pass, so that no text in a description is mistaken for a placeholder
    return re.sub("@@([A-Z]+)@@", lambda found: parts[found[1]], _part("page/page.html"))


def write(runs: Sequence[Run], path: Path | str) -> Path:
    """Writes the page into a file, which is replaced if it exists, and returns the path."""
    path = Path(path)
    text = page(runs)
    with explained(RoadGPTError, f"cannot write {path}", "name another file with --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
    return path


def embedded(data: object) -> str:
    """Returns data as JSON that is safe inside a script element: ASCII without ``<``, ``>`` and ``&``."""
    try:
        text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"), sort_keys=True)
    except ValueError as error:
        raise UsageError("the road has a number that is not finite; check it before it is shown") from error
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


@cache
def _part(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")
