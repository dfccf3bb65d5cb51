"""Makes a survey's folder from runs: plots, films and 3-D views of every road, and finally ``survey.json``.

DIR/
  survey.json       texts, roads and questions
  media/            plots (PNG), films (MP4) and 3-D views (HTML)
  answers.sqlite    the answers; created when the survey is first served

What raters see contains no verdict and no measurements. All plots have the same axes, as in RoadGPT's thesis,
so that roads can be compared by size: those of the thesis, if all roads fit on them.
"""

import hashlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.report.birds_eye import THESIS
from roadgpt.report.canvas import SOFT, add_axes, in_our_style, new_figure, save
from roadgpt.report.height import THESIS_X, THESIS_Z, draw_heights
from roadgpt.report.pair import draw_plan
from roadgpt.report.plan_view import Frame, plan_points, stations_of
from roadgpt.report.road_record import kept_of
from roadgpt.report.similarity import likeness, similarity
from roadgpt.report.view import page_of, scene
from roadgpt.road import Road, World
from roadgpt.run import Run, read_run
from roadgpt.run.atomic import json_text, sweep, write_whole
from roadgpt_film import film
from roadgpt_study.survey.plan import PairPlan, RoadPlan, SurveyPlan, criteria_of
from roadgpt_study.survey.store import ANSWERS
from roadgpt_study.survey.survey import CARD, CRITERIA, MEDIA, OVERALL, Item, Medium, Survey

SIDE = 4.2  # inches of both plots, so that they can be read on a phone
LEFT, BOTTOM, RIGHT, TOP = 0.86, 0.58, 0.2, 0.16  # inches
MARGIN = 12.0  # m around the roads, where they do not fit on the thesis' axes
BEFORE_THE_END = 0.1  # s; at the end of a drive, films show its outcome, which raters should not know
WHY_NONE = (
    "there are no films, because the library for them is not installed; raters see plots and the 3-D view. "
    "To add films, install the extra 'film' and make the survey again"
)
HIDDEN = {"outcome": "", "description": "", "about": "", "words": "", "places": [], "events": []}
"""Replacements for what a 3-D view shows to users but must not show to raters."""
Tell = Callable[[str], None]
PLACES = ("top", "bottom")
CAMERAS = {"chase": "film from behind the car", "bonnet": "film from the hood camera"}
MATCH = {OVERALL: "general"} | {CRITERIA[name]: name for name in ("turns", "incline", "order")}
"""Maps the criteria for a road and its description to those that ``kept_of`` measures."""
ALIKE = MATCH | {CRITERIA["order"]: "sequence", CRITERIA["length"]: "length"}
"""Maps the criteria for two roads to those that ``similarity`` measures."""


def make_survey(plan: SurveyPlan, base: Path, out: Path | str, tell: Tell = lambda _: None) -> Survey:
    """Makes the folder ``out`` of a survey, in place of one that was never served; films that are there are
    not made again. Paths of runs are relative to ``base``; ``tell`` gets a sentence before every step.
    """
    out = Path(out)
    if (out / ANSWERS).exists():
        raise UsageError(f"people were invited to the survey in {out}; make the new one in another folder")
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out} is a file; name a folder")
    if out.is_dir() and any(path.name not in {CARD, MEDIA, "SURVEY.toml"} for path in out.iterdir()):
        raise UsageError(f"{out} contains other files; name another folder")
    named: list[tuple[str, RoadPlan | PairPlan]]
    named = [(f"a{n}", road) for n, road in enumerate(plan.alignment, 1)]
    named += [(f"s{n}", pair) for n, pair in enumerate(plan.similarity, 1)]
    runs = [[_run(base, name) for name in each.names] for _, each in named]
    axes = Axes.of([run.road for both in runs for run in both if run.road is not None])
    films = plan.films and can_film()
    builder = _ItemBuilder(out / MEDIA, axes, films, plan.views, len(named), tell)
    with explained(RoadGPTError, f"cannot write into {out}", "make room there or name another folder"):
        (out / MEDIA).mkdir(parents=True, exist_ok=True)
        sweep(out / MEDIA)
        items = [builder.item(name, each, own) for (name, each), own in zip(named, runs, strict=True)]
        survey = Survey(
            title=plan.title,
            asks=plan.asks,
            contact=plan.contact,
            purpose=plan.said_purpose,
            keeps=plan.keeps,
            has_check=plan.attention_check,
            about=plan.questions,
            items=tuple(items),
            lacks=WHY_NONE if plan.films and not films else "",
        )
        for path in (out / MEDIA).iterdir():
            if path.name not in survey.media:
                path.unlink()
        write_whole(out / CARD, json_text(survey.model_dump(mode="json")))
    return survey


def _run(base: Path, name: str) -> Run:
    run = read_run(base / name)
    if run.road is None:
        raise UsageError(f"{name} has no road ({run.description}); name another run")
    return run


@dataclass(frozen=True)
class Axes:
    """The limits of the axes of all plots of a survey, metres."""

    frame: Frame
    along: float
    height: float

    @classmethod
    def of(cls, roads: Sequence[Road]) -> "Axes":
        """Returns the thesis' axes if all roads fit on them; otherwise, axes on which all roads fit."""
        lines = [road.at(stations_of(road)) for road in roads]
        points = np.concatenate([plan_points(road) for road in roads])
        frame = THESIS
        if not all(frame.holds(*point) for point in points[::5]):
            low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
            x, y = (low + high) / 2
            half = float(np.max(high - low)) / 2
            frame = Frame(x - half, x + half, y - half, y + half)
        along = max(THESIS_X, *(road.length * 1.02 for road in roads))
        return cls(frame, along, max(THESIS_Z, *(float(np.ptp(line[:, 2])) * 1.05 for line in lines)))


@in_our_style
def draw_plots(road: Road, world: World, axes: Axes, folder: Path, name: str) -> tuple[str, str]:
    """Writes ``NAME-above.png`` (bird's-eye view) and ``NAME-height.png``; returns the two file names."""
    names = f"{name}-above.png", f"{name}-height.png"
    figures = [new_figure(LEFT + SIDE + RIGHT, BOTTOM + SIDE + TOP) for _ in names]
    above, beside = (add_axes(figure, LEFT, BOTTOM, RIGHT, TOP) for figure in figures)
    draw_plan(above, road, world, axes.frame, axes.frame.width / SIDE)
    s = stations_of(road)
    z = road.at(s)[:, 2] - road.at(s)[:, 2].min()
    beside.set(xlim=(0, axes.along), ylim=(0, axes.height))
    beside.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    beside.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    draw_heights(beside, s, z, "height above the lowest point, m")
    beside.plot([road.length, road.length], [0, z[-1]], color=SOFT, lw=1, ls=(0, (3, 3)), zorder=3)
    for figure, file in zip(figures, names, strict=True):
        save(figure, folder / file)
    return names


def can_film() -> bool:
    """Returns whether the library that encodes films is installed."""
    try:
        film.encoder()
    except UsageError:
        return False
    return True


def make_film(runs: Sequence[Run], path: Path, view: str) -> None:
    """Writes a film of one drive, or of two in a split screen, which ends before the outcome is visible."""
    longest = max(run.drive.duration for run in runs if run.drive is not None)
    settings = film.Settings(seconds=max(longest - BEFORE_THE_END, BEFORE_THE_END))
    film.write(runs, path, view, settings)


def write_view(runs: Sequence[Run], titles: Sequence[str], path: Path) -> None:
    """Writes the 3-D view of one road or of two, each with its title, as an HTML page."""
    scenes = [scene(run) | {"title": title} | HIDDEN for run, title in zip(runs, titles, strict=True)]
    write_whole(path, page_of(scenes))


class _ItemBuilder:
    """Makes the items of a survey, and reports which page is being made and how long the rest will take."""

    def __init__(
        self, folder: Path, axes: Axes, has_films: bool, has_views: bool, total: int, tell: Tell
    ) -> None:
        self.folder, self.axes, self.has_films, self.has_views = folder, axes, has_films, has_views
        self.total, self.tell = total, tell
        self.begun, self.count = time.monotonic(), 0

    def item(self, name: str, plan: RoadPlan | PairPlan, runs: list[Run]) -> Item:
        """Makes the item of a road and its description, or of two roads, one shown above the other."""
        prompt, is_pair = (plan.prompt or runs[0].words).strip(), len(runs) > 1
        if not prompt:
            raise UsageError(
                f"{plan.names[0]} was not made from a description; "
                'add prompt = "..." to it in the survey\'s file'
            )
        self._begin(prompt + (" (two roads)" if is_pair else ""))
        media: list[Medium] = []
        for number, (run, place) in enumerate(zip(runs, PLACES, strict=False), 1):
            own, lead = (f"{name}-{number}", f"Road {number} ({place}): ") if is_pair else (name, "")
            media += self._plots(own, run, lead)
        criteria = criteria_of(runs[0].brief) if plan.criteria is None else plan.criteria
        return Item(
            id=name,
            part="similarity" if is_pair else "alignment",
            prompt=prompt,
            criteria=tuple(CRITERIA.get(criterion, criterion) for criterion in criteria),
            media=(*media, *self._films(name, runs), *self._view(name, prompt, runs)),
            roads=plan.names,
            machine=similarity_scores(*runs) if is_pair else match_scores(runs[0], prompt),
        )

    def _begin(self, sentence: str) -> None:
        left = ""
        if self.count:
            seconds = (time.monotonic() - self.begun) / self.count * (self.total - self.count)
            left = (
                f", about {seconds / 60:.0f} min left" if seconds >= 90 else f", about {seconds:.0f} s left"
            )
        self.count += 1
        self.tell(f"page {self.count} of {self.total}{left}: {sentence}")

    def _plots(self, name: str, run: Run, lead: str) -> list[Medium]:
        assert run.road is not None
        files = draw_plots(run.road, run.world, self.axes, self.folder, name)
        texts = ("bird's-eye view of the road", "height of the road over the distance along it")
        return [
            Medium(name=file, kind="picture", title=_capital(lead + text))
            for file, text in zip(files, texts, strict=True)
        ]

    def _films(self, name: str, runs: list[Run]) -> list[Medium]:
        if not self.has_films or any(run.drive is None for run in runs):
            return []
        made = []
        for camera, said in CAMERAS.items():
            drives = b"".join(run.drive.to_bytes() for run in runs if run.drive is not None)
            mark = hashlib.sha256(drives).hexdigest()[:10]  # a film is made again if its run has changed
            path = self.folder / f"{name}-{camera}-{mark}.mp4"
            if not path.is_file():
                self.tell(f"  {said}")
                make_film(runs, path, camera)
            title = _capital(said) + (", road 1 left, road 2 right" if len(runs) > 1 else "")
            made.append(Medium(name=path.name, kind="film", title=title))
        return made

    def _view(self, name: str, prompt: str, runs: list[Run]) -> list[Medium]:
        if not self.has_views:
            return []
        file = f"{name}-view.html"
        titles = [prompt] if len(runs) == 1 else [f"Road {n} ({place})" for n, place in enumerate(PLACES, 1)]
        write_view(runs, titles, self.folder / file)
        what = "both roads" if len(runs) > 1 else "the road"
        return [Medium(name=file, kind="view", title=f"View {what} in 3-D")]


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def match_scores(run: Run, prompt: str) -> dict[str, float]:
    """Returns 1 or 0 for each criterion of the thesis that a road meets or not; empty if it was not made from
    the description ``prompt``."""
    if run.road is None or run.brief is None or prompt != run.words.strip():
        return {}
    kept = {str(name): good for name, good in kept_of(run.road, run.brief, run.world).items()}
    return {ours: float(kept[measured]) for ours, measured in MATCH.items() if measured in kept}


def similarity_scores(one: Run, other: Run) -> dict[str, float]:
    """Returns how similar two roads are by each criterion, 0 to 1; empty if they cannot be compared."""
    if one.road is None or other.road is None:
        return {}
    try:
        found = similarity(likeness(one.road), likeness(other.road))
    except UsageError:
        return {}
    return {ours: float(getattr(found, measured)) for ours, measured in ALIKE.items()}
