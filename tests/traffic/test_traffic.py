"""All movers together: who sees whom, and what is recorded."""

import numpy as np
import pytest

from exported import ROADS, WORLD
from roadgpt.traffic import SIZES, STEP, Actor, Mover, Stage, TestedCar, Tracks, Traffic, begin
from roadgpt.traffic.idm import IdmMover
from roadgpt.traffic.replay import ReplayMover
from roadgpt.traffic.script import Script

TestedCar.__test__ = False
CAR = TestedCar(0.0, 0.0, 0.0, 10.0, 2.5, -2.0, 4.7, 1.86)


class Walker:
    """Its actors walk along x at 1 m/s; every second one more comes."""

    def __init__(self, name: str, y: float) -> None:
        self.name, self.y = name, y
        self.actors: list[Actor] = []
        self.seen: list[np.ndarray] = []
        self._come()

    def _come(self) -> None:
        self.actors.append(Actor(self.name, "adult", SIZES["adult"]))

    def start(self, car: TestedCar, bodies: np.ndarray) -> np.ndarray:
        return self._states(0.0)

    def move(self, time: float, car: TestedCar, bodies: np.ndarray) -> np.ndarray:
        assert car is CAR
        self.seen.append(bodies)
        if round((time + STEP) / STEP) % 10 == 0:
            self._come()
        return self._states(time + STEP)

    def _states(self, time: float) -> np.ndarray:
        came = np.arange(len(self.actors))
        x = np.where(time - came < 1.95, time - came, np.nan)  # each is gone after 1.95 s
        return np.column_stack([x, np.where(np.isnan(x), x, self.y), 0 * x, 0 * x, 0 * x + 1])


def test_movers_see_each_other_and_everybody_is_recorded_under_a_name_of_its_own() -> None:
    one, two = Walker("walker", 3.0), Walker("walker", -3.0)
    traffic = Traffic([one, two])
    for _ in range(30):
        traffic.advance(CAR)
    tracks = traffic.tracks()
    names = ["walker", *(f"walker ({number})" for number in range(2, 9))]
    assert [actor.name for actor in tracks.actors] == names
    assert tracks.states.shape == (31, 8, 5)
    for number in range(8):
        came, y = number // 2, (3.0, -3.0)[number % 2]
        for sample, state in enumerate(tracks.states[:, number]):
            time = sample * STEP - came
            expected = [time, y, 0, 0, 1] if -0.01 < time < 1.9501 else [np.nan] * 5
            np.testing.assert_allclose(state, expected, atol=1e-3)
    for mover, y in ((one, -3.0), (two, 3.0)):
        assert [len(bodies) for bodies in mover.seen] == [min(1 + n // 10, 2) for n in range(30)]
        assert all((bodies[:, 1] == y).all() for bodies in mover.seen)
        np.testing.assert_array_equal(mover.seen[0][:, 5:], [SIZES["adult"][:2]])
    np.testing.assert_allclose(traffic.at(1.26)[:2, 0], 1.26)
    assert np.isnan(traffic.at(0.96)[2:]).all()  # they come at 1 s


def test_a_replay_gives_the_samples_and_nobody_is_there_without_a_reason() -> None:
    states = np.zeros((3, 2, 5))
    states[:, 0, 4], states[2, 0, 4] = 3.0, 0.1
    states[:, 1, 4] = 5.0
    actors = (Actor("stays", "car", SIZES["car"]), Actor("goes", "bus", SIZES["bus"]))
    traffic = begin(ROADS["arcs"], WORLD, 1, Tracks(actors, states))
    assert traffic is not None
    for _ in range(5):
        traffic.advance(CAR)
    found = traffic.tracks().states
    np.testing.assert_array_equal(found[:3], states)
    np.testing.assert_array_equal(found[3:, 0], states[[2, 2, 2], 0])
    assert np.isnan(found[3:, 1]).all()
    assert begin(ROADS["arcs"], WORLD, 1) is None


@pytest.mark.parametrize("kind", [ReplayMover, Script, IdmMover])
def test_every_mover_keeps_its_protocol_and_gives_the_same_again(kind: type[Mover]) -> None:
    world, states = WORLD, np.random.default_rng(0).uniform(-9, 9, (20, 3, 5))
    tracks = Tracks(tuple(Actor(f"car {n}", "car", SIZES["car"]) for n in range(3)), states)
    scene = getattr(world, "scene", None)
    if scene is not None:
        world = world.model_copy(update={"scene": scene.model_copy(update={"flow": "medium"})})
    with_what = tracks if kind is ReplayMover else Stage(ROADS["arcs"], world, 7)
    made = [kind(with_what) for _ in range(2)]
    nobody = np.empty((0, 7))
    for number in range(10):
        moved = [
            mover.move((number - 1) * STEP, CAR, nobody) if number else mover.start(CAR, nobody)
            for mover in made
        ]
        np.testing.assert_array_equal(*moved)
        assert moved[0].shape == (len(made[0].actors), 5)
        is_gone = np.isnan(moved[0])
        assert (is_gone.any(axis=1) == is_gone.all(axis=1)).all()
    assert made[0].actors == made[1].actors
