"""Makes the changes of a scene that a request asks for. Which actor, action or place is meant is decided on
the scene before the changes."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from roadgpt.brief.amount import Amount, exactly, span
from roadgpt.brief.change.plan import LEVELS, LISTS, OF_SINGLE, SINGLE
from roadgpt.brief.change.request import SceneChange, Things, Value
from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.scene import LAND_KINDS, ON_ITS_WAY, ONE_OF, Action, Air, Mark, Role, Scene
from roadgpt.errors import EditError, UnclearPlaceError
from roadgpt.language.table import (
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    NUMBERS,
    ROAD_USERS,
    SCENES,
    SURFACES,
    USUAL_SPEEDS,
    WEATHER,
)

HALF_AGAIN = 0.5  # 'more' is half as much again, and 'less' undoes that
EMPTY = Scene()
USUAL: Mapping[str, Mapping[Any, float | None]] = {
    "speed": USUAL_SPEEDS,
    "decel": {str(name): row.usual for name, row in MANEUVERS.items()},
    "length": {str(name): row.length for name, row in LANDFORMS.items()},
    "away": {str(name): row.away for name, row in LANDFORMS.items()},
}
"""What numbers are where a scene says none, by the kind of what has them."""
ALIKE = [{kind, row.read_as} for kind, row in ROAD_USERS.items() if row.read_as]
HIDING = {str(kind) for kind, row in WEATHER.items() if not row.falls}
CALLED = {
    **{name: row["called"] for name, row in SCENES["single"].items() if "called" in row},
    "scene": "part",
    "slippery": "slippery place",
    **{str(name): f"{name} road" for name in SURFACES},
    **{str(name): f"{name} land" for name in LAND_KINDS},
}
"""Parts of a scene in words, where they are not called by their names."""


def _fields_of(scene: Scene) -> dict[str, Any]:
    """Returns the fields of a scene, with one for each kind of weather."""
    fields = dict(scene)
    del fields["weather"]
    return fields | {kind: scene.amount_of(kind) for kind in WEATHER}


NOTHING = _fields_of(EMPTY)


def changed_scene(scene: Scene, changes: Sequence[SceneChange], limit: float) -> Scene:
    """Returns the scene with the changes that a request asks for; ``limit`` is the speed limit in km/h, at
    which the tested car starts if nothing is said. Raises EditError if the scene does not have what is to be
    changed, or contradicts itself afterwards."""
    stage = _Stage(scene, limit)
    for change in sorted(changes, key=lambda change: not _clears(change)):  # what is added then, stays
        stage.change(change)
    return stage.scene()


class _Stage:
    """A scene that is being changed."""

    def __init__(self, before: Scene, limit: float) -> None:
        self.before, self.limit = before, limit
        self.fields = _fields_of(before)
        names = dict.fromkeys(name for name, _ in LISTS.values())
        self.lists: dict[str, list[Any]] = {name: [*self.fields.pop(name)] for name in names}
        """The actors, slippery places and parts of the landscape; None for one that was removed."""
        self.named = [*before.actors]
        """The actors as events name them: those before the changes, then the new ones."""
        self.told = set[tuple[Any, ...]]()

    def change(self, change: SceneChange) -> None:
        """Makes one change."""
        target = change.target
        if target is None:
            assert isinstance(change.new, Scene)
            self._add(change.new)
        elif target.name in LISTS:
            name = LISTS[target.name][0]
            for place in self._places(target):
                is_gone = change.what == "remove" and change.doing is None
                if self.lists[name][place] is None or (is_gone and (name, place) in self.told):
                    raise EditError(
                        f"'{_called(target)}' is to be removed, and something else is asked of it; leave one"
                        " of them out"
                    )
                self.told.add((name, place))
                self.lists[name][place] = None if is_gone else self._changed(name, place, change)
        elif change.what == "remove":
            self._clear(target)
        else:
            self._change_single(change, OF_SINGLE[target.name])

    def scene(self) -> Scene:
        """Returns the scene after the changes."""
        left = {name: tuple(filter(None, those)) for name, those in self.lists.items()}
        left["actors"] = tuple(map(self._renumbered, left["actors"]))
        air = [(kind, self.fields[kind]) for kind in WEATHER if self.fields[kind] is not None]
        left["weather"] = tuple(Air.model_construct(kind=kind, amount=amount) for kind, amount in air)
        fields = {name: value for name, value in self.fields.items() if name not in WEATHER}
        try:
            return Scene.model_validate(EMPTY.model_copy(update=fields | left).model_dump())
        except ValidationError as error:
            problem = error.errors()[0]["msg"].removeprefix("Value error, ")
            raise EditError(f"the changed scene is not possible: {problem}") from error

    def _add(self, part: Scene) -> None:
        for name, value in _fields_of(part).items():
            if name in self.lists:
                self.lists[name] += value
            elif name == "parked":
                self.fields[name] += value
            elif value != NOTHING[name]:
                self._once(f"the {name} of the scene", name)
                self.fields[name] = value
        self.named += part.actors

    def _once(self, said: str, *what: Any) -> None:
        if what in self.told:
            raise EditError(f"{said} is asked for twice; say it once")
        self.told.add(what)

    def _clear(self, target: Things) -> None:
        """Removes a part of which a scene has one."""
        has = {name: value for name, value in _fields_of(self.before).items() if value != NOTHING[name]}
        is_other = target.name in (*LIGHTS, *SURFACES, *LAND_KINDS) and target.name not in has.values()
        names = [name for name in SINGLE[target.name] if name in has and not is_other]
        if not names or (target.side and target.side not in self.before.parked):
            raise EditError(f"the scene has no {_called(target)} to remove; leave that out")
        for name in names:
            if name in self.lists:
                self.lists[name][: len(has[name])] = [None] * len(has[name])
            elif target.side:
                self.fields[name] = tuple(side for side in self.fields[name] if side != target.side)
            else:
                self.fields[name] = NOTHING[name]

    def _change_single(self, change: SceneChange, name: str) -> None:
        said, now = f"the {name} of the scene", self.fields[name]
        self._once(said, name, change.bound)
        if name in LEVELS:
            usual = self.before.hills if name == "land" else self.fields["flow"]
            self.fields[name] = _level(change, name, now or usual)
            return
        if now is None and name != "speed":
            raise EditError(f"there is no {name} in the scene that could change; ask for {name} first")
        if name in HIDING:  # its number is how far one sees: the more fog, the less
            change = replace(change, more=change.more if change.by is not None else -change.more)
        self.fields[name] = _amount(change, now or exactly(self.limit), said)

    def _places(self, target: Things) -> list[int]:
        """Returns the places in their list of the things that are meant."""
        those: Sequence[Any] = getattr(self.before, LISTS[target.name][0])
        there = [
            (place, getattr(each, "kind", "slippery"))
            for place, each in enumerate(those)
            if target.where in (None, getattr(each, "where", None))
            and target.side in (None, getattr(each, "side", None))
        ]
        fit = [place for place, kind in there if target.name in (kind, "actor", "landscape", "roadworks")]
        if not fit:  # a deer may be an animal of the scene, and the other way round
            fit = [place for place, kind in there if {target.name, kind} in ALIKE]
        if not fit:
            has = "; ".join(map(str, those)) or "nothing of the kind"
            raise EditError(f"the scene has no {_called(target)}; there is: {has}")
        if any(abs(number) > len(fit) for number in target.numbers):
            raise EditError(f"of '{_called(target)}' the scene has {len(fit)}; give a number up to that")
        if len(fit) > 1 and not (target.every or target.numbers):
            has = "; ".join(str(those[place]) for place in fit)
            raise UnclearPlaceError(f"which {_called(target)} is meant: {has}? give a number, or say all")
        wanted = [fit[number - (number > 0)] for number in target.numbers]
        return [*dict.fromkeys(wanted or fit)]

    def _changed(self, name: str, place: int, change: SceneChange) -> Any:
        thing = self.lists[name][place]
        rivals = ONE_OF[::-1] if change.doing else ONE_OF
        of_one = next((fields[0] for fields in rivals if change.key in fields), change.key)
        if change.what != "add":
            what = change.doing or (NUMBERS[change.key].key if change.key else change.what)
            self._once(f"{what} of '{thing}'", name, place, change.what, change.doing, of_one, change.bound)
        if change.doing is None:
            if change.what == "number":
                return _with_number(thing, change, getattr(thing, "kind", ""), str(thing))
            if change.what == "count":
                return thing.model_copy(update={"count": _amount(change, thing.count, str(thing))})
            if change.what == "add":
                is_own = isinstance(change.new, Action) and change.new.what in ON_ITS_WAY
                kept = [each for each in thing.actions if not (is_own and each.what in ON_ITS_WAY)]
                return thing.model_copy(update={"actions": (*kept, change.new)})
            form = change.form or Things("")
            kind, where = form.name or thing.kind, form.where or thing.where
            side = form.side if form.where else form.side or thing.side
            side = OTHER_SIDE.get(thing.side, thing.side) if side == "other" else side
            return thing.model_copy(update={"kind": kind, "where": where, "side": side})
        actions = list[Action]()
        for action in thing.actions:
            if action.what != change.doing:
                actions.append(action)
            elif change.what == "number":
                actions.append(_with_number(action, change, action.what, f"{thing.kind} that {action}"))
        if all(action.what != change.doing for action in thing.actions):
            raise EditError(f"in '{thing}' nobody does '{change.doing}'; add it first")
        return thing.model_copy(update={"actions": tuple(actions)})

    def _renumbered(self, role: Role) -> Role:
        """Returns an actor whose events name the others by their numbers after the changes."""
        actions = [
            action.model_copy(update={"at": action.at and self._mark(action.at)}) for action in role.actions
        ]
        return role.model_copy(update={"actions": tuple(actions)})

    def _mark(self, mark: Mark) -> Mark:
        if mark.what is None:
            return mark
        actors = self.lists["actors"]
        alike = [place for place, each in enumerate(self.named) if each.kind == mark.of]
        if not 0 < mark.number <= len(alike):
            return mark
        place = alike[mark.number - 1]
        if (role := actors[place]) is None:
            raise EditError(f"somebody acts {mark.said}, and that {mark.of} is to be removed; change both")
        number = sum(each is not None and each.kind == role.kind for each in actors[: place + 1])
        return mark.model_copy(update={"of": role.kind, "number": number})


def _with_number(thing: Any, change: SceneChange, kind: str, said: str) -> Any:
    """Returns a thing with another number. A new one takes the place of those that it excludes; one that is
    not said is the usual one."""
    key = change.key
    rivals = {each for fields in ONE_OF if key in fields for each in fields if each != key}
    given = [each for each in rivals if getattr(thing, each, None) is not None]
    now: Amount | None = getattr(thing, key)
    usual = USUAL.get(key, {}).get(kind)
    if now is None and usual and not given:
        now = exactly(usual)
    if now is None and change.to is None:
        name = NUMBERS[key].key
        raise EditError(f"the scene does not say {name} of '{said}', which could change; give a figure")
    return thing.model_copy(update={**dict.fromkeys(given), key: _amount(change, now, said)})


def _amount(change: Value, now: Amount | None, said: str) -> Amount:
    """Returns the amount that a change makes of the present one."""
    to, bound = change.to, change.bound
    if to is not None:
        if not bound:
            return exactly(to)
        low, high = (now.lo, now.hi) if now else (None, None)
        if bound > 0:
            low = to if low is None else max(low, to)
        else:
            high = to if high is None else min(high, to)
        return exactly(to) if low is not None and high is not None and low > high else Amount(lo=low, hi=high)
    assert now is not None
    if change.by is not None:
        low, high = (None if end is None else end + change.more * change.by for end in (now.lo, now.hi))
        return Amount(lo=low, hi=high)
    if change.times is not None:
        return now.times(change.times)
    if span(now).lo < 0 or now.hi == 0:
        raise EditError(f"it is not clear what more and less of {now} are in '{said}'; give a figure")
    factor = 1 + HALF_AGAIN * change.dose
    ends = now.times(factor if change.more > 0 else 1 / factor)
    low, high = (None if end is None else float(f"{end:.3g}") for end in (ends.lo, ends.hi))
    return Amount(lo=low, hi=high)


def _level(change: Value, name: str, now: str | None) -> str | None:
    """Returns how dense traffic is, or how high the hills are, one level further; two if much more or less is
    wanted."""
    levels = LAND_KINDS if name == "land" else (None if name == "flow" else "none", *FLOWS)
    place = levels.index(now) if now in levels else 0
    further = place + change.more * (2 if change.dose > 1 else 1)
    new = levels[min(max(further, 0), len(levels) - 1)]
    if new == levels[place]:
        said = f"{now} land" if name == "land" else f"{now or 'no'} traffic"
        raise EditError(f"there is {said} already, and no level beyond; leave that out")
    return new


def _clears(change: SceneChange) -> bool:
    return change.what == "remove" and change.target is not None and change.target.name in SINGLE


def _called(target: Things) -> str:
    words = (
        CALLED.get(target.name, target.name.replace("_", " ")),
        *target.numbers,
        target.where,
        target.side,
    )
    return " ".join(str(word) for word in words if word)
