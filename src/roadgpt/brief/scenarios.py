"""Reads the catalogue of scenarios: scenes of regulations and typologies, with parameters.

``r157:cut_in slower=30`` names a scenario with another value of one parameter; ``*`` stands for any letters
of a name, and a comma divides several. The scenarios are data, in ``scenarios.toml``."""

import ast
import operator
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any, Literal, NamedTuple

from roadgpt.brief.model import mirrored_scene
from roadgpt.brief.plan import read_scene
from roadgpt.brief.scene import Scene
from roadgpt.errors import BriefError, UsageError
from roadgpt.language.table import NUMBERS, SIZES
from roadgpt.reading import read_text

Grid = Literal["nominal", "standard"]
Value = float | str
LANE_WIDTH = 3.5  # m, of the nominal roads
OPERATORS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}  # fmt: skip
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "abs": abs,
    "length": lambda kind: SIZES[kind].length,
    "max": max,
    "sign": lambda side: 1 if side == "left" else -1,
    "side": lambda offset: "left" if offset > 0 else "right",
}
"""What formulas can have besides numbers, parameters and a minus. Left is positive."""
FORMULA, SPEEDS = re.compile(r"\{(.+?)\}"), re.compile(r"(?:\bv=|\bto=|\bspeed )(\{.+?\})")
TABLE: dict[str, Any] = tomllib.loads(read_text(Path(__file__).with_name("scenarios.toml")))
WORDS: Mapping[str, str] = TABLE.pop("words")
ROADS: Mapping[str, str] = TABLE.pop("roads")
TOLERANCES: Mapping[str, Mapping[str, str]] = TABLE.pop("tolerances")


class Rating(NamedTuple):
    """One of the classes of Euro NCAP that tell how well a test ended."""

    says: str
    source: str
    bands: Sequence[Mapping[str, float]]
    """For speeds of the tested car from ``ego`` on, in km/h: the number below which each colour is."""
    towards: int = 0
    """If it is not 0: what counts is by how much less than nominal the speed of the impact is."""
    edge: bool = False
    """Whether metres beyond the edge of the lane count, and not the speed of an impact."""


CLASSES = {name: Rating(**row) for name, row in TABLE.pop("classes").items()}


class Missing(NamedTuple):
    """A row of the catalogue that is no scenario."""

    name: str
    says: str
    source: str
    impossible: str
    """Why it is not possible."""


MISSING = {name: Missing(name, **TABLE.pop(name)) for name, row in [*TABLE.items()] if "impossible" in row}


class Scenario(NamedTuple):
    """A scenario of the catalogue, with values of its parameters."""

    name: str
    says: str
    source: str
    road: str
    """The name of its nominal road in ``ROADS``, as a template like ``scene``."""
    scene: str
    """A scene as in plans, with what is computed of the parameters in braces."""
    parameters: Mapping[str, Sequence[Any]]
    """The nominal value of each, with its unit or what it means."""
    grid: Sequence[Mapping[str, Sequence[Any]]]
    """The standard grid: blocks, each a product of its lists."""
    values: Mapping[str, Value]
    avoidable: str = "any"
    """The criterion by which it is judged whether a collision was avoidable: see ``Limits.avoidable``."""
    judged: str = "impact"
    """Which of Euro NCAP's classes tell how well it ended."""
    given: tuple[str, ...] = ()
    """The parameters that were given a value, which a grid leaves as they are."""

    def __str__(self) -> str:
        told = self.name
        for name, value in self.values.items():
            if name in self.given or value != self.parameters[name][0]:
                told += f" {name}={_text(value)}"
        return told

    @property
    def tolerances(self) -> Mapping[str, str]:
        """Within how much what the robot drives is what the source prescribes."""
        return {**TOLERANCES.get(self.name.partition(":")[0], {}), **TOLERANCES["ours"]}

    def rated(self, impact: float | None, beyond: float) -> tuple[str, str]:
        """Returns the colour of how a test ended, and what decided: the difference of speeds at a contact in
        km/h, None without one, and how many metres the tested car was beyond the edge of its lane."""
        its, ego = CLASSES[self.judged], float(self.values["ego"])
        if impact is None and not its.edge:
            return "green", "0"
        if impact is not None and its.edge:
            return "red", f"{impact:.0f} km/h"
        number = beyond if impact is None else impact
        if impact is not None and its.towards:
            number = ego + its.towards * float(self.values.get("target", 0.0)) - impact
        band = [each for each in its.bands if each["ego"] <= ego][-1]
        colour = next(each for each in band if each != "ego" and number < band[each])
        return colour, f"{-beyond:+.2f} m" if impact is None else f"{impact:.0f}"

    @property
    def scene_text(self) -> str:
        """The scene, as in a plan."""
        return self._filled(self.scene)

    @property
    def plan(self) -> str:
        """The plan of the nominal road."""
        return ROADS[self._filled(self.road).replace("_", " ")]

    def onto(self, other: Scene, left_hand: bool = False) -> Scene:
        """Returns the scene, mirrored for traffic on the left, together with another one, such as its traffic
        and weather. Raises UsageError if the values are no scene, or both say something else of one thing."""
        if self.fault:
            raise UsageError(self.fault)
        try:
            own = read_scene(self.scene_text)
        except (BriefError, ZeroDivisionError) as error:
            said = "a number is divided by 0" if isinstance(error, ZeroDivisionError) else str(error)
            raise UsageError(f"the scenario '{self}' is not possible: {said}") from error
        own = mirrored_scene(own) if left_hand else own
        told, added = own.told, other.told  # a stored test keeps to the person of its own scene
        for name, value in added.items():
            is_other = name != "person" and told.get(name, () if name == "actions" else value) != value
            if is_other or (name == "light" in self.given and name not in told):
                raise UsageError(
                    f"the scenario '{self}' and the other scene both say the {name} of the scene, and "
                    "contradict each other; leave one of them out"
                )
        # who is there, and a light that was given, are said, even if that is nobody and the day's
        stated: dict[str, Any] = {"actors": (), **({"light": None} if "light" in self.given else {})}
        return Scene.model_validate(stated | told | added)

    def points(self, grid: Grid, with_road: bool) -> "Iterator[Scenario]":
        """Yields the scenario itself, or with the values of all points of its standard grid, but for those
        that were given; without ``with_road`` none that differ only in their nominal road."""
        fixed = {*self.given, *([] if with_road else ["road"])}
        seen = set[tuple[Value, ...]]()
        for block in self.grid if grid == "standard" else ({},):
            lists = {name: each for name, each in block.items() if name not in fixed}
            for values in product(*lists.values()):
                its = {**self.values, **dict(zip(lists, values, strict=True))}
                if (key := tuple(its.values())) not in seen:
                    seen.add(key)
                    yield self._replace(values=its)

    @property
    def fault(self) -> str:
        """A sentence about a speed that nobody can have, or else nothing."""
        least, most = NUMBERS["speed"].least, NUMBERS["speed"].most
        for formula in SPEEDS.findall(self.scene):
            if not least <= (speed := _computed(_parsed(formula[1:-1]).body, self.values)) <= most:
                named = [name for name in self.values if re.search(rf"\b{name}\b", formula)]
                given = " ".join(f"{name}={_text(self.values[name])}" for name in named)
                said = f"{self.name}: {given} lead{'s' * (len(named) == 1)} to a speed of {_text(speed)} km/h"
                return f"{said}; speeds are from {least} to {most}"
        return ""

    def _filled(self, template: str) -> str:
        names = {name: WORDS.get(str(value), value) for name, value in self.values.items()}
        return FORMULA.sub(lambda found: _text(_computed(_parsed(found[1]).body, names)), template)

    def with_value(self, name: str, text: str) -> "Scenario":
        """Returns the scenario with another value of a parameter."""
        if name not in self.parameters:
            near = _nearest(name, self.parameters) or f"its parameters are {', '.join(self.parameters)}"
            raise UsageError(f"the scenario {self.name} has no '{name}'; {near}")
        usual, unit = self.parameters[name]
        if isinstance(usual, str):
            words = dict.fromkeys([usual, *(each for block in self.grid for each in block.get(name, ()))])
            if text not in words:
                raise UsageError(f"'{name}' of {self.name} is {' or '.join(words)}, not '{text[:40]}'")
        try:
            value = text if isinstance(usual, str) else float(text)
        except ValueError:
            raise UsageError(f"'{name}' of {self.name} is a number, {unit}; not '{text[:40]}'") from None
        return self._replace(values={**self.values, name: value}, given=(*self.given, name))


@cache
def _parsed(formula: str) -> ast.Expression:
    return ast.parse(formula, mode="eval")


def _computed(node: ast.expr, names: Mapping[str, Value]) -> Any:
    """Returns the value of a formula in braces."""
    match node:
        case ast.Constant(value):
            return value
        case ast.Name(name):
            return names[name]
        case ast.UnaryOp(operand=one):
            return -_computed(one, names)
        case ast.BinOp(left, sign, right):
            return OPERATORS[type(sign)](_computed(left, names), _computed(right, names))
        case ast.Call(ast.Name(name), args):
            return FUNCTIONS[name](*(_computed(each, names) for each in args))
    raise ValueError(f"a formula of a scenario has {ast.unparse(node)}")


def _text(value: Value) -> str:
    return value if isinstance(value, str) else f"{round(value, 4) + 0.0:.8g}"


def _nearest(name: str, known: Mapping[str, Any]) -> str:
    near = get_close_matches(name, known, 1, 0.4)
    return f"did you mean '{near[0]}'?" if near else ""


@cache
def scenarios() -> Mapping[str, Scenario]:
    """Returns all scenarios with their nominal values, by name."""
    usual = {name: {each: value for each, (value, _) in TABLE[name]["parameters"].items()} for name in TABLE}
    return {name: Scenario(name, **row, values=usual[name]) for name, row in TABLE.items()}


def chosen(text: str) -> list[Scenario]:
    """Returns the scenarios that a text names, such as "ncap:*, r157:cut_in slower=30". Raises UsageError if
    there is no such scenario or parameter, or a value or a scenario is not possible."""
    found: dict[str, Scenario] = {}
    for part in filter(None, map(str.strip, text.split(","))):
        name, *given = part.split()
        named = [each for each in scenarios().values() if fnmatchcase(each.name, name)]
        if not named and name in MISSING:
            raise UsageError(f"{name} is not possible: {MISSING[name].impossible}")
        if not named:
            near = _nearest(name, scenarios())
            raise UsageError(f"there is no scenario '{name[:40]}'; {near or 'roadgpt scenarios lists them'}")
        for each in named:
            for word in given:
                key, equals, value = word.partition("=")
                if not equals:
                    raise UsageError(
                        f"'{word[:40]}' is no parameter of {each.name}; write for example ego=40"
                    )
                each = each.with_value(key, value)
            each.onto(Scene())
            found[str(each)] = each
    if not found:
        raise UsageError("no scenario is named; roadgpt scenarios lists them")
    return [*found.values()]


@cache
def points_of(text: str, grid: Grid, with_road: bool) -> tuple[tuple[Scenario, ...], int]:
    """Returns the points of the scenarios that a text names, and how many are left out because they lead to
    speeds below 0, which the grids of their sources exclude."""
    every = [point for each in chosen(text) for point in each.points(grid, with_road)]
    found = tuple(point for point in every if not point.fault)
    return found, len(every) - len(found)


def scenario(text: str) -> Scenario:
    """Returns the one scenario that a text names."""
    found = chosen(text)
    if len(found) > 1:
        raise UsageError(f"'{text[:40]}' names {len(found)} scenarios; name one, or test them in a campaign")
    return found[0]
