"""Makes a survey's folder from runs: plots, films and 3-D views of every road, and finally ``survey.json``.

DIR/
  survey.json       texts, roads and questions
  media/            plots (PNG), films (MP4) and 3-D views (HTML)
  answers.sqlite    the answers; created when the survey is first served
"""

import hashlib
import time
from collections.abc import Callable
from pathlib import Path

from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.run import Run, read_run
from roadgpt.run.atomic import json_text, sweep, write_whole
from roadgpt.study.road_record import kept_of
from roadgpt.study.similarity import likeness, similarity
from roadgpt.study.survey.media import WHY_NONE, Axes, can_film, draw_plots, make_film, write_view
from roadgpt.study.survey.plan import PairPlan, RoadPlan, SurveyPlan, criteria_of
from roadgpt.study.survey.store import ANSWERS
from roadgpt.study.survey.survey import CARD, CRITERIA, MEDIA, OVERALL, Item, Medium, Survey

Tell = Callable[[str], None]
PLACES = ("top", "bottom")
CAMERAS = {"chase": "film from behind the car", "bonnet": "film from the hood camera"}
MATCH = {OVERALL: "general"} | {CRITERIA[name]: name for name in ("turns", "incline", "order")}
"""Maps the criteria for a road and its description to the measured criteria of ``study.criteria``."""
ALIKE = MATCH | {CRITERIA["order"]: "sequence", CRITERIA["length"]: "length"}
"""Maps the criteria for two roads to the measured criteria of ``study.similarity``."""


def make_survey(plan: SurveyPlan, base: Path, out: Path | str, tell: Tell = lambda _: None) -> Survey:
    """Makes the folder ``out`` of a survey. An earlier survey in ``out`` is replaced if it was never served.

    Existing films are kept, so that an interrupted call can be repeated without filming again. Paths of runs
    in the plan are relative to ``base``; ``tell`` is called with a sentence before every step.

    Raises:
        UsageError: a run cannot be used, or the folder contains answers or other files.
        RoadGPTError: a file cannot be written.
    """
    out = Path(out)
    _must_be_free(out)
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
        prompt, is_pair = _prompt(plan.prompt or runs[0].words, plan.names[0]), len(runs) > 1
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
            path = self.folder / f"{name}-{camera}-{_mark(runs)}.mp4"
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


def match_scores(run: Run, prompt: str) -> dict[str, float]:
    """Returns, for each criterion of the thesis, 1 if a road meets it and 0 if not; empty if the road was not
    made from the description ``prompt``."""
    if run.road is None or run.brief is None or prompt != run.words.strip():
        return {}
    kept = {str(name): good for name, good in kept_of(run).items()}
    return {ours: float(kept[measured]) for ours, measured in MATCH.items() if measured in kept}


def similarity_scores(one: Run, other: Run) -> dict[str, float]:
    """Returns, for each criterion, how similar two roads are (0 to 1); empty if one of them cannot be
    compared."""
    if one.road is None or other.road is None:
        return {}
    try:
        found = similarity(likeness(one.road), likeness(other.road))
    except UsageError:
        return {}
    return {ours: float(getattr(found, measured)) for ours, measured in ALIKE.items()}
