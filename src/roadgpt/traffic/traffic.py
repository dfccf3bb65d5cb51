"""Moves all the others on the road together, whichever movers they belong to."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol

import numpy as np

from roadgpt.brief.scene import Event
from roadgpt.traffic.actor import STEP, TESTED, Actor, FloatArray, TestedCar, Tracks, rounded

if TYPE_CHECKING:
    from roadgpt.road import Road, World
    from roadgpt.traffic.lights import Lights

T0 = 4.0  # s to a collision, at which Euro NCAP's tests begin
Stretch = Literal["before", "now", "past"]


class Stage(NamedTuple):
    """What a mover is made with."""

    road: "Road"
    world: "World"
    seed: int
    lights: "Lights | None" = None
    """The traffic lights, which run for everybody; None where nobody looks at them."""
    aims: "Mapping[int, Aiming | None]" = MappingProxyType({})
    """How who is to hit somebody differs from what the scene says alone, by its number there (see
    ``roadgpt.traffic.aiming``); None: it is not there."""


class Aiming(NamedTuple):
    """By what somebody is moved at first so that it hits somebody, in metres and seconds."""

    along: float = 0.0
    aside: float = 0.0
    time: float | None = None
    """When its first maneuver that changes something begins; None: when the scene says."""


class Mover(Protocol):
    """Moves some of the others, made with a Stage. States are arrays
    ``(actors, 5)`` as in Tracks, in the order of ``actors``, and NaN while an actor is not there."""

    actors: list[Actor]
    """Its own actors; the list may grow at its end."""

    def start(self, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states at time 0; ``bodies``, as in ``move``, are those of the movers before it."""
        ...

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states at ``time + STEP``, from everybody's places at ``time``.

        ``bodies`` are the actors of the other movers that are there, shape (m, 7): their states, lengths and
        widths."""
        ...


class Traffic:
    """Everybody besides the tested car, during one drive."""

    def __init__(self, movers: Sequence[Mover], lights: "Lights | None" = None) -> None:
        self.actors: list[Actor] = []
        """All actors so far, in the order in which they were made."""
        self.lights = lights
        """The traffic lights; None if they stay green."""
        self._movers = [(mover, list[int]()) for mover in movers]  # with the places of their actors
        self._samples: list[FloatArray] = []  # each has rows of those who had come by then
        self._sizes, self._names = np.empty((0, 2)), {TESTED}

    def advance(self, car: TestedCar) -> None:
        """Computes the next sample. Call it at 0, 0.1, 0.2 ... s, with the tested car at that time."""
        if not self._samples:
            self._start(car)
        time, now = (len(self._samples) - 1) * STEP, self._samples[-1]
        is_there, states = ~np.isnan(now[:, 0]), []
        for mover, own in self._movers:
            is_other = is_there.copy()
            is_other[own] = False
            states.append(mover.move(time, car, np.hstack([now[is_other], self._sizes[is_other]])))
        self._add(states)

    def _start(self, car: TestedCar) -> None:
        rows, bodies = list[FloatArray](), np.empty((0, 7))
        for mover, _ in self._movers:
            rows.append(mover.start(car, bodies))
            sizes = np.array([actor.size[:2] for actor in mover.actors]).reshape(-1, 2)
            there = ~np.isnan(rows[-1][:, 0])
            bodies = np.vstack([bodies, np.hstack([rows[-1], sizes])[there]])
        self._add(rows)

    def _add(self, states: Sequence[FloatArray]) -> None:
        before = len(self.actors)
        for mover, own in self._movers:
            for actor in mover.actors[len(own) :]:
                own.append(len(self.actors))
                self.actors.append(replace(actor, name=self._free(actor.name)))
        if came := [actor.size[:2] for actor in self.actors[before:]]:
            self._sizes = np.vstack([self._sizes, came])
        sample = np.full((len(self.actors), 5), np.nan)
        for (_, own), moved in zip(self._movers, states, strict=True):
            sample[own] = moved
        self._samples.append(rounded(sample))

    def _free(self, name: str) -> str:
        """Returns a name that nobody has: the given one, or with a number behind it."""
        number, free = 1, name
        while free in self._names:
            number += 1
            free = f"{name} ({number})"
        self._names.add(free)
        return free

    def around(self, time: float) -> tuple[FloatArray, FloatArray, float]:
        """Returns the samples before and after a time between 0 and that of the last one, shape (actors, 5),
        and which share of the time between them has passed; 0 at the time of a sample."""
        place, last = time / STEP, len(self._samples) - 1
        first = min(int(place + 1e-9), last)
        share = place - first if place - first >= 1e-6 else 0.0
        return self._whole(first), self._whole(min(first + 1, last)), share

    def _whole(self, number: int) -> FloatArray:
        """Returns a sample with rows for all actors so far."""
        sample = self._samples[number]
        came = len(self.actors) - len(sample)
        return np.vstack([sample, np.full((came, 5), np.nan)]) if came else sample

    def at(self, time: float) -> FloatArray:
        """Returns the states at a time between 0 and that of the last sample, shape (actors, 5)."""
        now, after, share = self.around(time)
        return np.asarray((1 - share) * now + share * after) if share else now

    def tell(self, event: tuple[str, ...], time: float) -> None:
        """Tells the actors of a scene when something that the tested car does began or ended."""
        for mover, _ in self._movers:
            getattr(mover, "events", {})[event] = time

    @property
    def event(self) -> Stretch:
        """Before, in or past the event: it begins when somebody acts, or the tested car meets one in T0 s,
        and is past when all have done everything and are in no conflict with it. Past without actors."""
        return next((mover.event for mover, _ in self._movers if hasattr(mover, "event")), "past")

    def _all(self, name: str) -> list[Any]:
        told = [getattr(mover, name, ()) for mover, _ in self._movers]
        return [one for each in told for one in (each.items() if isinstance(each, dict) else each)]

    @property
    def events(self) -> dict[tuple[str, ...], float]:
        """When what the actors of a scene do has begun and ended, in seconds, by ``Maneuver.event``."""
        return dict(self._all("events"))

    @property
    def happened(self) -> dict[str, float]:
        """What of the scene has begun, in words, and the station in metres along its road where the tested
        car was then."""
        return dict(self._all("happened"))

    @property
    def limited(self) -> dict[str, bool]:
        """What the others did with less than their scene or their habits ask for, in sentences, each with
        whether the road does not give what the scene prescribes."""
        return dict(self._all("limited"))

    @property
    def missed(self) -> tuple[str, ...]:
        """What of the scene has not happened so far, in sentences."""
        return tuple(self._all("missed"))

    @property
    def history(self) -> tuple[Event, ...]:
        """What the scene prescribes of its actors, each with whether it has happened so far."""
        return tuple(self._all("history"))

    @property
    def stopped(self) -> tuple[str, ...]:
        """Names of those whom a contact with the tested car made brake."""
        return tuple(
            self.actors[own[n]].name for each, own in self._movers for n in getattr(each, "stopped", ())
        )

    def tracks(self) -> Tracks:
        """Returns how everybody moved who was there at some time."""
        states = np.full((len(self._samples), len(self.actors), 5), np.nan)
        for number, sample in enumerate(self._samples):
            states[number, : len(sample)] = sample
        was_there = np.flatnonzero(~np.isnan(states[:, :, 0]).all(axis=0))
        return Tracks(tuple(self.actors[number] for number in was_there), states[:, was_there])
