"""Lists things that descriptions mention but no requirement of a Brief can express, such as a bridge.

A reader that recognises such a thing adds the name of the thing to ``Brief.beside``. RoadGPT then tells the
user that the thing is not built, must be given as a number, is set by an option or sets the friction, so that
nothing is ignored silently."""

import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from roadgpt.brief.scene import LANDS
from roadgpt.language.table import SURFACES, WEATHER
from roadgpt.reading import read_text

TEXTS: dict[str, dict[str, str]] = tomllib.loads(read_text(Path(__file__).with_name("beside.toml")))
"""What is said of the things that are not built, and in refusals: by the part of the table, and by name."""
NOT_BUILT, ON_ROUTES, IN_SCENES, SAID_OTHERWISE = (
    TEXTS[part] for part in ("not_built", "on_routes", "in_scenes", "said_otherwise")
)
"""The things that are not built by their names; those that are parts of a route, with words that ask for
them; those that a scene has; and wishes that are not built from words, with the remark for each. In
``Brief.beside``, names on routes come only from plans and from readers that do not know routes."""
NETWORKS = (*ON_ROUTES, "loop")
"""Names of the things that are not a single road. If a reader other than ``plan`` puts one of them into
``Brief.beside``, ``brief.read`` raises AnotherRoadError, which proposes the road without this thing."""
BESIDE = frozenset({*NOT_BUILT, *SAID_OTHERWISE, *SURFACES})


def remarks(names: Sequence[str], *of_surface: Any) -> Iterator[str]:
    """Yields what the user should know about the named things, as sentences without full stops; a surface
    is told of as ``surface_remark`` does."""
    for name in names:
        what, without = NOT_BUILT.get(name), "the road is made without"
        if name in ON_ROUTES:
            yield f"{what} is built as a part of a route, such as '{ON_ROUTES[name]}'; {without} it"
        elif name in LANDS:
            yield f"{what}: the road gets {LANDS[name]}"
        elif name in IN_SCENES:
            yield f"{without} {what}; --scene '{IN_SCENES[name]}' adds it"
        elif what and name not in WEATHER:
            yield f"{what} is not built; {without} it"
        elif name in SAID_OTHERWISE:
            yield SAID_OTHERWISE[name]
    if said := surface_remark(names, *of_surface):
        yield said


def networks_in(names: Iterable[str]) -> str:
    """Returns a sentence, without a full stop, that says why things in ``NETWORKS`` are not built; empty if
    none of them is named."""
    named = [name for name in names if name in NETWORKS]
    if not named:
        return ""
    said = " and ".join(NOT_BUILT[name] for name in named)
    example = next((ON_ROUTES[name] for name in named if name in ON_ROUTES), "")
    if not example:
        return f"{said} cannot be built"
    return f"it is not clear where {said} should be; say it in driving order, such as '{example}'"


def slipperiest(names: Iterable[str]) -> str | None:
    """Returns the slipperiest surface among the names, of which rain makes a road wet; None if there is
    none."""
    made = {str(kind): row.surface for kind, row in WEATHER.items() if row.surface}
    named = {made.get(each, each) for each in names} & SURFACES.keys()
    return min(named, key=lambda each: SURFACES[each].friction, default=None)


def friction_of(names: Iterable[str]) -> float | None:
    """Returns the friction coefficient of the slipperiest surface among the names; None if there is none."""
    return None if (name := slipperiest(names)) is None else SURFACES[name].friction


def surface_remark(
    names: Sequence[str], friction: float | None = None, others: Sequence[str] = (), is_set: bool = True
) -> str:
    """Returns a sentence on whether the named surface, such as ice, sets the ``friction``, or ``others``, the
    surfaces of the scene of the drive, do; empty if none is named. Unless a friction ``is_set``, it says how
    to."""
    own = friction_of(names)
    if own is None:
        return ""
    *more, last = (f"'{name}'" for name in (*WEATHER, *SURFACES) if name in names and friction_of([name]))
    said = f"{', '.join(more)} and {last}" if more else last
    if friction not in (None, own) and friction == friction_of(others):
        return f"the words say {said}, but the given scene says '{others[0]}': friction is {friction:g}"
    if friction not in (None, own):
        return f"the words say {said}, but friction is {friction:g}: the surface in the words is not used"
    told = f"the words say {said}: {'the lowest friction counts, ' if more else 'friction is '}{own:g}"
    return told if is_set else f"{told}; --friction gives another"
