"""Back-labelling: designs and measures roads, and describes the measurements in several styles.

The module ``generator`` chooses phrases at random and derives plans from them; this module starts from the
geometry. Therefore the numbers in a description fit together as on a real road: the lengths add up, and the
radii suit the angles.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.plan import read_plan
from roadgpt.check.describing import describe
from roadgpt.design import draft_road
from roadgpt.errors import BriefError, DesignError
from roadgpt.road import World, build
from roadgpt_training.generator import pairs
from roadgpt_training.pair import Pair, standard
from roadgpt_training.phrasebook import one_of

FAMILY = "measured-en"
MOST_CLAUSES = 7
FACTS = {"degrees": 0.6, "radius": 0.35, "slope": 0.6, "length": 0.6}
"""The probability with which each kind of fact is mentioned."""
WHOLE = {"length": 0.4, "climb": 0.25}


@dataclass(frozen=True, slots=True)
class Style:
    """The writing style of one person: the words for turns and straights, conjunctions and units."""

    turn: Sequence[str]
    straight: Sequence[str]
    degrees: str
    radius: str
    metres: str
    up: str
    down: str
    flat: str
    join: str
    whole: str
    climb: str
    fall: str


STYLES = (
    Style(
        ("turn {side}", "{side} turn"), ("straight",),
        " of {} degrees", ", radius {} m", " for {} m", " uphill", " downhill", " on the flat",
        ", then ", "{} m long in all: ", "it climbs {} m in all: ", "it falls {} m in all: ",
    ),
    Style(
        ("{side}",), ("str",), " {}°", " R{}", " {}m", " up", " down", " level",
        "; ", "L={}m; ", "+{} m net; ", "-{} m net; ",
    ),
    Style(
        ("the road bends {side}", "it swings {side}", "a bend to the {side}"),
        ("it runs straight", "a straight"),
        " through {} degrees", " at a radius of {} metres", " for {} metres",
        ", climbing", ", falling", ", level", "; after that ",
        "a road of {} metres: ", "a road that gains {} metres: ", "a road that loses {} metres: ",
    ),
    Style(
        ("{side}-hand curve", "curve to the {side}"), ("tangent",),
        ", {} deg", ", R = {} m", ", {} m", ", rising", ", descending", ", level",
        " / ", "total length {} m / ", "net rise {} m / ", "net drop {} m / ",
    ),
)  # fmt: skip


def measured_pairs(seed: int) -> Iterator[Pair]:
    """Yields an endless series of descriptions of measured roads with their plans; the same seed gives the
    same pairs.
    """
    rng = np.random.default_rng([seed, 11])
    for wanted in pairs(seed, {"en": 1.0}):
        if wanted.is_refusal:
            continue
        try:
            design = draft_road(read_plan(wanted.plan), World(), seed=int(rng.integers(2**31)))
            pair = described(describe(build(design)), rng)
        except (DesignError, BriefError):
            continue
        if pair:
            yield pair


def described(brief: Brief, rng: np.random.Generator) -> Pair | None:
    """Describes a measured road by facts chosen at random from its Brief; None if the Brief has no clauses or
    too many.
    """
    kept = {fact for fact, share in FACTS.items() if rng.random() < share}
    style = one_of(STYLES, rng)
    clauses = tuple(_less(clause, kept) for clause in brief.clauses)
    if not 1 <= len(clauses) <= MOST_CLAUSES:
        return None
    whole = {fact for fact, share in WHOLE.items() if rng.random() < share and getattr(brief, fact)}
    plan = standard(Brief(clauses=clauses, **{fact: getattr(brief, fact) for fact in whole}))
    things = style.join.join(_thing(clause, style, rng) for clause in clauses)
    return Pair(_head(brief, whole, style) + things, plan, FAMILY, "en")


def _less(clause: Clause, kept: set[str]) -> Clause:
    """Returns a clause with only the facts in ``kept``; with slopes, a level part is said to be level."""
    gone = {fact: None for fact in ("degrees", "radius", "slope", "length") if fact not in kept}
    return clause.model_copy(update={**gone, "incline": clause.incline if "slope" in kept else None})


def _head(brief: Brief, whole: set[str], style: Style) -> str:
    text = ""
    if "length" in whole and brief.length:
        text += style.whole.format(f"{brief.length.lo:g}")
    if "climb" in whole and brief.climb and brief.climb.lo:
        text += (style.climb if brief.climb.lo > 0 else style.fall).format(f"{abs(brief.climb.lo):g}")
    return text


def _thing(clause: Clause, style: Style, rng: np.random.Generator) -> str:
    ways = style.turn if clause.kind == "turn" else style.straight
    text = one_of(ways, rng).format(side=clause.side)
    for amount, form in (
        (clause.degrees, style.degrees), (clause.radius, style.radius), (clause.length, style.metres),
    ):  # fmt: skip
        text += form.format(f"{amount.lo:g}") if amount else ""
    words = {"up": style.up, "down": style.down, "flat": style.flat}
    text += words.get(clause.slope or "", "")
    return text + (f" at {clause.incline.lo:g} %" if clause.incline else "")
