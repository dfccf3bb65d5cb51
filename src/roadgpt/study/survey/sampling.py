"""Selects roads for a survey at random from a study's folder: one road per description to be compared with
the description, and pairs of roads to be compared with each other."""

from pathlib import Path

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.card import CARD
from roadgpt.run.folder import finished, run_folder
from roadgpt.run.seeds import seed_of
from roadgpt.study.survey.item_criteria import criteria_of
from roadgpt.study.survey.plan import PairPlan, RoadPlan, SurveyPlan

DEEPEST = 4  # folders below the study's in which campaigns are looked for


def plan_from_runs(study: Path | str, asks: str, contact: str, seed: int = 0, pairs: int = 2) -> SurveyPlan:
    """Returns the plan of a survey, with valid roads selected at random from each folder of runs.

    Args:
        study: a folder of runs, or a folder that contains several folders of runs.
        asks: who conducts the survey.
        contact: where raters can send questions.
        seed: seed of the random selection; the same seed selects the same roads.
        pairs: greatest number of descriptions for which raters also compare two roads with each other. If a
            description has only two valid roads, one of these roads is also compared with the description.

    Raises:
        UsageError: there is no folder of runs with a valid road.
    """
    study = Path(study).resolve()
    alignment, similarity = list[RoadPlan](), list[PairPlan]()
    for number, campaign in enumerate(_campaigns(study), 1):
        drawn = _drawn(campaign, seed_of(seed, number), 3 if len(similarity) < pairs else 1)
        if not drawn:
            continue
        (first, run), *others = drawn
        alignment.append(RoadPlan(run=first, prompt=run.words, criteria=criteria_of(run.brief)))
        two = others if len(others) == 2 else drawn
        if len(similarity) < pairs and len(two) == 2:
            similarity.append(PairPlan(runs=(two[0][0], two[1][0]), prompt=run.words))
    if not alignment:
        raise UsageError(
            f"{study} holds no runs with a valid road; make some: roadgpt run DESCRIPTION --out DIR"
        )
    return SurveyPlan(asks=asks, contact=contact, alignment=tuple(alignment), similarity=tuple(similarity))


def _campaigns(study: Path) -> list[Path]:
    """Returns the folders of runs, in the order of their names."""
    found = {card.parent for depth in range(DEEPEST) for card in study.glob(f"{'*/' * depth}{CARD}")}
    return sorted(found)


def _drawn(campaign: Path, seed: int, most: int) -> list[tuple[str, Run]]:
    """Selects different runs at random: valid roads that were made from words, driven roads first."""
    indices = np.random.default_rng(seed).permutation(finished(campaign))
    valid, driven = list[tuple[str, Run]](), list[tuple[str, Run]]()
    for index in indices:
        folder = run_folder(campaign, int(index))
        run = read_run(folder)
        if run.is_valid and run.words:
            (valid if run.drive is None else driven).append((str(folder), run))
        if len(driven) == most:
            break
    return (driven + valid)[:most]
