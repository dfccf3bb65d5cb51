"""Makes a survey's folder from runs: plots, films and 3-D views of every road, and finally ``survey.json``.

DIR/
  survey.json       what is shown and asked
  media/            plots (PNG), films (MP4) and 3-D views (HTML)
  answers.sqlite    created when the survey is first served
"""

import hashlib
import time
from collections.abc import Callable
from pathlib import Path

from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.atomic import json_text, sweep, write_whole
from roadgpt.study.survey.described_criteria import criteria_of
from roadgpt.study.survey.films import WHY_NONE, are_possible, make_film
from roadgpt.study.survey.measured_scores import match_scores, similarity_scores
from roadgpt.study.survey.plan import PairPlan, RoadPlan, SurveyPlan, criterion_text
from roadgpt.study.survey.questions import ABOUT
from roadgpt.study.survey.road_plots import Axes, draw_plots
from roadgpt.study.survey.store import ANSWERS
from roadgpt.study.survey.survey import CARD, MEDIA, Item, Medium, Survey
from roadgpt.study.survey.view_3d import write_view

Tell = Callable[[str], None]
PLACES = ("top", "bottom")
CAMERAS = {"chase": "film from behind the car", "bonnet": "film from the hood camera"}


def make_survey(plan: SurveyPlan, base: Path, out: Path | str, tell: Tell = lambda _: None) -> Survey:
    """Makes the folder of a survey. It keeps films that exist, so that it can be stopped and called again.

    Args:
        plan: the contents of SURVEY.toml.
        base: the folder to which the paths of runs are relative.
        out: the survey's folder; another survey in it is replaced if nobody has been invited to it yet.
        tell: called with a sentence before every step.

    Raises:
        UsageError: a run cannot be used, or the folder contains answers or something else.
        RoadGPTError: a file cannot be written.
    """
    out = Path(out)
    _must_be_free(out)
    alignment = [(road, _run(base, road.run)) for road in plan.alignment]
    similarity = [(pair, [_run(base, name) for name in pair.runs]) for pair in plan.similarity]
    runs = [run for _, run in alignment] + [run for _, both in similarity for run in both]
    axes = Axes.of([run.road for run in runs if run.road is not None])
    films = plan.films and are_possible()
    work = _Work(out / MEDIA, axes, films, plan.views, _Pages(len(alignment) + len(similarity), tell))
    try:
        (out / MEDIA).mkdir(parents=True, exist_ok=True)
        sweep(out / MEDIA)
        items = [work.road(f"a{n}", road, run) for n, (road, run) in enumerate(alignment, 1)]
        items += [work.pair(f"s{n}", pair, both) for n, (pair, both) in enumerate(similarity, 1)]
        survey = Survey(
            title=plan.title,
            asks=plan.asks,
            contact=plan.contact,
            purpose=plan.said_purpose,
            keeps=plan.keeps,
            has_check=plan.attention_check,
            about=plan.questions(ABOUT),
            items=tuple(items),
            lacks=WHY_NONE if plan.films and not films else "",
        )
        for path in (out / MEDIA).iterdir():
            if path.name not in survey.media:
                path.unlink()
        write_whole(out / CARD, json_text(survey.model_dump(mode="json")))
    except OSError as error:
        raise RoadGPTError(
            f"cannot write into {out}: {error.strerror or error}; make room there or name another folder"
        ) from error
    return survey


def _must_be_free(out: Path) -> None:
    if (out / ANSWERS).exists():
        raise UsageError(f"people were invited to the survey in {out}; make the new one in another folder")
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out} is a file; name a folder")
    if out.is_dir() and any(path.name not in {CARD, MEDIA, "SURVEY.toml"} for path in out.iterdir()):
        raise UsageError(f"{out} contains other files; name another folder")


def _run(base: Path, name: str) -> Run:
    run = read_run(base / name)
    if run.road is None:
        raise UsageError(f"{name} has no road ({run.description}); name another run")
    return run


class _Pages:
    """Reports which page is being made and how long the rest will take."""

    def __init__(self, total: int, tell: Tell) -> None:
        self.total, self.tell = total, tell
        self.begun, self.count = time.monotonic(), 0

    def begin(self, sentence: str) -> None:
        """Reports that the next page is begun."""
        left = ""
        if self.count:
            seconds = (time.monotonic() - self.begun) / self.count * (self.total - self.count)
            left = (
                f", about {seconds / 60:.0f} min left" if seconds >= 90 else f", about {seconds:.0f} s left"
            )
        self.count += 1
        self.tell(f"page {self.count} of {self.total}{left}: {sentence}")


class _Work:
    """Makes the items of a survey and reports its progress."""

    def __init__(self, folder: Path, axes: Axes, has_films: bool, has_views: bool, pages: _Pages) -> None:
        self.folder, self.axes, self.pages = folder, axes, pages
        self.has_films, self.has_views = has_films, has_views

    def road(self, name: str, plan: RoadPlan, run: Run) -> Item:
        """Makes the item of a road and its description."""
        prompt = _prompt(plan.prompt or run.words, plan.run)
        self.pages.begin(prompt)
        criteria = criteria_of(run.brief) if plan.criteria is None else plan.criteria
        return Item(
            id=name,
            part="alignment",
            prompt=prompt,
            criteria=tuple(map(criterion_text, criteria)),
            media=(*self._plots(name, run, ""), *self._films(name, [run]), *self._view(name, prompt, [run])),
            roads=(plan.run,),
            machine=match_scores(run, prompt),
        )

    def pair(self, name: str, plan: PairPlan, runs: list[Run]) -> Item:
        """Makes the item of two roads of one description, one shown above the other."""
        prompt = _prompt(plan.prompt or runs[0].words, plan.runs[0])
        self.pages.begin(f"{prompt} (two roads)")
        plots: list[Medium] = []
        for number, (run, place) in enumerate(zip(runs, PLACES, strict=True), 1):
            plots += self._plots(f"{name}-{number}", run, f"Road {number} ({place}): ")
        return Item(
            id=name,
            part="similarity",
            prompt=prompt,
            criteria=tuple(map(criterion_text, plan.criteria)),
            media=(*plots, *self._films(name, runs), *self._view(name, prompt, runs)),
            roads=plan.runs,
            machine=similarity_scores(*runs),
        )

    def _plots(self, name: str, run: Run, lead: str) -> list[Medium]:
        assert run.road is not None
        above, height = draw_plots(run.road, run.world, self.axes, self.folder, name)
        titles = (
            f"{lead}bird's-eye view of the road",
            f"{lead}height of the road over the distance along it",
        )
        return [
            Medium(name=file, kind="picture", title=title[0].upper() + title[1:])
            for file, title in zip((above, height), titles, strict=True)
        ]

    def _films(self, name: str, runs: list[Run]) -> list[Medium]:
        if not self.has_films or any(run.drive is None for run in runs):
            return []
        made = []
        for camera, said in CAMERAS.items():
            title = said[0].upper() + said[1:] + (", road 1 left, road 2 right" if len(runs) > 1 else "")
            path = self.folder / f"{name}-{camera}-{_mark(runs)}.mp4"
            if not path.is_file():
                self.pages.tell(f"  {said}")
                make_film(runs, path, camera)
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


def _prompt(words: str, name: str) -> str:
    if not words.strip():
        raise UsageError(
            f'{name} was not made from a description; add prompt = "..." to it in the survey\'s file'
        )
    return words.strip()


def _mark(runs: list[Run]) -> str:
    """Returns a hash of the drives, so that a film is made again if its run has changed."""
    drives = b"".join(run.drive.to_bytes() for run in runs if run.drive is not None)
    return hashlib.sha256(drives).hexdigest()[:10]


__all__ = ["Tell", "make_survey"]
