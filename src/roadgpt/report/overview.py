"""Draws all roads of a campaign as small maps; colours say where in its lane the car was."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D

from roadgpt.campaign.folder_record import has_tests, open_record
from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.network.network import network_from_json
from roadgpt.reading import read_json
from roadgpt.report.canvas import (
    DARKER,
    GREEN,
    INK,
    LETTERS,
    MARGIN,
    ORANGE,
    OUTCOMES,
    PNG,
    SOFT,
    VERMILLION,
    YELLOW,
    Format,
    fitted,
    in_our_style,
    inches,
    new_figure,
    save_all,
)
from roadgpt.report.plan_view import ASPHALT, FAR_ASPHALT, GROUND, STEPS, path_of
from roadgpt.run.execution import FIELDS
from roadgpt.run.folder import run_of_test
from roadgpt.verdict import graded, percent

PER_PAGE, MOST_PAGES = 100, 10
WIDEST = 11.0  # inches
LARGEST, TITLE, GAP = 2.4, 0.24, 0.12  # inches: of a map, over it, and between maps
HEADER, COLOURS = 1.12, 0.4  # inches: without and of the key to the colours
KEY = 0.92  # inches, from the top down to the key to the signs
PAD, FOOT, BAR = 0.1, 0.22, 0.4  # inches beside and under a road; of the side: the longest bar of a scale
SHORTEST = 30.0  # m that a map shows at least
PLACE, OUTSIDE, DISTANCE, SHARE = map(FIELDS.index, ("pos", "is_oob", "oob_distance", "oob_percentage"))
STYLES = {"NOT TESTED": (0, (6, 1.5)), "INVALID": (0, (3, 1.5)), "ERROR": (0, (1, 1))}
FAR_IN = Normalize(-1.0, 1.0)  # m; about the share of the car that is outside: all, half, nothing
IN_LANE = LinearSegmentedColormap.from_list("in lane", [VERMILLION, ORANGE, YELLOW, GREEN])


@dataclass(frozen=True)
class Thumbnail:
    """One road of an overview or a gallery: its map and its outcome."""

    number: int
    outcome: str
    points: Array  # points of the road, ``(n, 2)``, metres
    failed_at: tuple[float, float] | None = None
    """Position of the car when it failed, x and y in metres; None if it did not fail or has no records."""
    href: str = ""  # address of the link in a gallery; empty for no link
    share: float | None = None
    """Largest share of the car that was outside its lane; None if there is no drive."""
    paved: Outline | None = None  # paved area of a network, in metres; None for a road without junctions
    driven: Array = field(default_factory=lambda: np.empty((0, 3)))
    """Records of the drive, ``(n, 3)``: x and y of the car, and how far its middle was inside the edge of its
    lane (negative outside), metres."""

    @property
    def graded(self) -> str:
        """The outcome, such as "FAIL" or "PASS (partly outside)"."""
        return graded(self.outcome, self.share)


@in_our_style
def overview(folder: Path | str, formats: Sequence[Format] = PNG) -> list[Path]:
    """Draws ``overview.png`` into a folder of runs, and returns the paths of the pictures.

    Each road fills its map, which has a scale. Where the car drove, its colour says how far the middle of the
    car was from the edge of its lane.

    Each picture shows up to 100 roads; the second picture is ``overview-2.png``, and so on. Only the first
    1,000 roads are drawn.

    The roads are read from the files ``test.NNNN.json``, so the function also works for folders that the
    SBFT competition's tools wrote."""
    drawn: list[Path] = []
    for number, figure in enumerate(pages(folder), 1):
        name = f"overview{'' if number == 1 else f'-{number}'}.png"
        drawn += save_all(figure, Path(folder) / name, formats)
    return drawn


def pages(folder: Path | str) -> Iterator[Figure]:
    """Yields the pages of ``overview`` as figures; raises the same errors as ``overview``."""
    folder = Path(folder)
    names = sorted(folder.glob("test.*.json"))
    if not names:
        raise UsageError(f"{folder} holds no test.0001.json; give a folder that roadgpt run made")
    about = _about(folder)
    shown = [names[i : i + PER_PAGE] for i in range(0, len(names), PER_PAGE)][:MOST_PAGES]
    for number, page in enumerate(shown, 1):
        part = f"page {number} of {len(shown)}, of {len(names)} roads" if len(shown) > 1 else ""
        yield page_of([_thumbnail(path) for path in page], about, part)


def _about(folder: Path) -> tuple[str, str]:
    if not has_tests(folder):
        return folder.name, ""
    with open_record(folder) as record:
        request = record.cells()[0].request
    driver, oracle = Path(request.setup.driver).name, request.world.limits.oracle
    by = f", driver {driver}, oracle {oracle}" if request.setup.drives else ""
    return request.words, f"seed {request.seed}{by}"


def _thumbnail(path: Path) -> Thumbnail:
    test = _loaded(path)
    try:
        points = np.asarray(test.get("interpolated_points") or np.empty((0, 2)), float)[:, :2]
        outcome = test.get("test_outcome") or ("VALID" if test.get("is_valid") else "INVALID")
        records = test.get("execution_data") or []
        outside = next((record for record in records if record[OUTSIDE]), records[-1] if records else None)
        place = tuple(outside[PLACE][:2]) if outcome == "FAIL" and outside else None
        share = _share(path, records, outcome)
        driven = np.array([(*record[PLACE][:2], record[DISTANCE]) for record in records]).reshape(-1, 3)
        return Thumbnail(int(test["id"]), outcome, points, place, "", share, _paved(path), driven)
    except (TypeError, ValueError, LookupError, AttributeError, OverflowError) as error:
        raise UsageError(f"{path} cannot be drawn ({error}); remove it or make the road again") from error


def _paved(path: Path) -> Outline | None:
    run = run_of_test(path)
    if run is None or not (run / "road.json").is_file():
        return None
    data = _loaded(run / "road.json")
    if not isinstance(data, dict) or "network" not in data:
        return None
    return path_of(network_from_json(data["network"]).paved)


def _share(path: Path, records: list[Any], outcome: str) -> float | None:
    """Returns the largest share of the car outside its lane, by the verdict or else the test's records; the
    last record of a test that passed is at the goal and does not count."""
    run = run_of_test(path)
    if run is not None and (run / "verdict.json").is_file():
        verdict = _loaded(run / "verdict.json")
        share = verdict.get("max_oob") if isinstance(verdict, dict) else None
        return float(share) if isinstance(share, (int, float)) else None
    counted = records[:-1] if outcome == "PASS" else records
    return max((float(record[SHARE]) for record in counted), default=None)


def _loaded(path: Path) -> Any:
    try:
        return read_json(path)
    except (OSError, ValueError) as error:
        raise UsageError(f"{path} cannot be read ({error}); remove it or make it again") from error


def page_of(entries: list[Thumbnail], about: tuple[str, str], part: str) -> Figure:
    """Returns one page with the maps of roads; ``about`` is description and seed, ``part`` the
    page's number."""
    count = len(entries)
    # a number of columns that gives the page about the shape of a sheet of paper
    columns = min(10, max(1, count if count <= 4 else int(np.ceil(np.sqrt(count * 1.05)))))
    rows = -(-count // columns)
    cell = min(LARGEST, (WIDEST - 2 * MARGIN) / columns - GAP)
    width = max(6.0, 2 * MARGIN + columns * (cell + GAP) - GAP)
    top = HEADER + COLOURS * any(len(entry.driven) for entry in entries)
    high = top + rows * (cell + TITLE + GAP) + 0.15
    figure = new_figure(width, high)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, width), ylim=(high, 0))
    axes.axis("off")
    _header(axes, about, part, Counter(entry.graded for entry in entries), width)
    _key(axes, entries)
    if top > HEADER:
        _key_to_colours(axes, width, high)
    for number, entry in enumerate(entries):
        row, column = divmod(number, columns)
        corner = MARGIN + column * (cell + GAP), top + TITLE + row * (cell + TITLE + GAP)
        _cell(axes, entry, corner, cell)
    return figure


def _header(axes: Axes, about: tuple[str, str], part: str, counts: Counter[str], width: float) -> None:
    title = fitted(about[0] or "roads that were given", width - 2 * MARGIN, 12, bold=True)
    axes.text(MARGIN, 0.3, title, size=12, weight="bold", color=INK, va="center")
    x = MARGIN
    for outcome in (*OUTCOMES, *sorted(counts.keys() - OUTCOMES)):
        if counts[outcome]:
            text = f"{counts[outcome]} {outcome}"
            axes.text(
                x + 0.06, 0.6, text, size=9.5, weight="bold", va="center",
                color=LETTERS.get(OUTCOMES.get(outcome, INK), "white"),
                bbox={"boxstyle": "round,pad=0.28", "fc": OUTCOMES.get(outcome, INK), "ec": "none"},
            )  # fmt: skip
            x += inches(text, 9.5, bold=True) + 0.28
    axes.text(
        x + 0.05, 0.6, "   ·   ".join(filter(None, (about[1], part))), size=9.5, color=SOFT, va="center"
    )


def _key(axes: Axes, entries: list[Thumbnail]) -> None:
    x = MARGIN + 0.06
    if any(len(entry.points) for entry in entries):
        axes.scatter(x, KEY, s=20, c=INK, marker="o", lw=0)
        axes.text(x + 0.12, KEY, "start", size=8.5, color=SOFT, va="center")
        x += inches("start", 8.5) + 0.42
    if any(entry.failed_at for entry in entries):
        axes.scatter(x, KEY, s=60, c=VERMILLION, marker="X", ec="white", lw=0.8)
        axes.text(x + 0.12, KEY, "where the car failed", size=8.5, color=SOFT, va="center")


def _key_to_colours(axes: Axes, width: float, high: float) -> None:
    text, figure = "middle of the car", axes.get_figure(root=True)
    axes.text(MARGIN, KEY + COLOURS - 0.12, text, size=8.5, color=SOFT, va="center")
    assert figure is not None
    left = MARGIN + inches(text, 8.5) + 0.2
    bar = figure.add_axes((left / width, 1 - (KEY + COLOURS - 0.08) / high, 3.2 / width, 0.08 / high))
    colours = figure.colorbar(ScalarMappable(FAR_IN, IN_LANE), bar, orientation="horizontal", extend="both")
    colours.outline.set_visible(False)
    bar.set_xticks([-1, 0, 1], ["1 m outside its lane", "at the edge", "1 m inside"])
    bar.tick_params(labelsize=8, colors=SOFT, length=2, pad=2)


def _cell(axes: Axes, entry: Thumbnail, place: tuple[float, float], cell: float) -> None:
    """Draws a road so that it fills its map; y grows upwards on the map and downwards on the page."""
    x0, y0 = place
    is_large = cell > 1.2
    small = 8.5 if is_large else 7
    axes.add_patch(Rectangle((x0, y0), cell, cell, fc=GROUND, ec="#c5cad1", lw=0.8, zorder=1))
    colour = OUTCOMES.get(entry.graded, INK)
    outcome = entry.outcome
    if entry.graded != entry.outcome and entry.share is not None:
        outcome = f"{percent(entry.share)} outside"
    axes.text(x0, y0 - 0.06, f"{entry.number}", size=small, color=SOFT, va="bottom")
    style: dict[str, Any] = {"size": small, "weight": "bold", "color": DARKER.get(colour, colour)}
    axes.text(x0 + cell, y0 - 0.06, outcome, ha="right", va="bottom", **style)
    if not len(entry.points):
        return
    driven = entry.driven
    paved = np.empty((0, 2)) if entry.paved is None else entry.paved.vertices
    shown = np.concatenate([entry.points, driven[:, :2], paved])
    low, high = shown.min(axis=0), shown.max(axis=0)
    scale = float(np.min((cell - 2 * PAD, cell - PAD - FOOT) / np.maximum(high - low, SHORTEST)))
    to_page = Affine2D().translate(*-(low + high) / 2).scale(scale, -scale)
    to_page.translate(x0 + cell / 2, y0 + (cell + PAD - FOOT) / 2)
    if entry.paved is not None:
        area = entry.paved.transformed(to_page)
        axes.add_patch(PathPatch(area, fc=ASPHALT, ec=ASPHALT, lw=0.6, zorder=1.5))
    line, path = to_page.transform(entry.points), to_page.transform(driven[:, :2])
    wide = 2.2 if is_large else 1.5
    axes.plot(
        *line.T, lw=0.6 * wide if len(path) else wide, ls=STYLES.get(entry.outcome, "solid"), zorder=2,
        color=FAR_ASPHALT if len(path) else colour,
    )  # fmt: skip
    pieces = LineCollection(
        list(np.stack([path[:-1], path[1:]], axis=1)),
        cmap=IN_LANE,
        norm=FAR_IN,
        linewidths=wide,
        zorder=2.5,
        capstyle="round",
    )
    pieces.set_array((driven[:-1, 2] + driven[1:, 2]) / 2)
    axes.add_collection(pieces)
    axes.plot(*line[0], "o", ms=2 * wide, color=INK, zorder=3)
    if entry.failed_at is not None:
        axes.plot(*to_page.transform(entry.failed_at), "X", ms=4 * wide, mfc=VERMILLION, mec="white", mew=0.8)
    bar = max(step for step in STEPS if step * scale <= BAR * cell)
    foot = y0 + cell - 0.08
    axes.plot([x0 + 0.08, x0 + 0.08 + bar * scale], [foot, foot], color=SOFT, lw=1.2)
    text = f"{bar:g} m" if bar < 1000 else f"{bar / 1000:g} km"
    axes.text(x0 + 0.13 + bar * scale, foot, text, size=small - 1, color=SOFT, va="center")
