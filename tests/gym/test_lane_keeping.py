"""The environment beside Gymnasium's own checker, the simulator as a second path, and the rules of roads."""

import math
import subprocess
import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from gym.agents import LOCK, episode, good, made, straight
from roadgpt.drive import Camera, Command, View, simulate
from roadgpt.errors import BriefError, UsageError
from roadgpt.road import World

SMALL = Camera(width=48, height=24, every=1)


class RepeatsActions:
    """Says again what an agent has said; each command holds for two control steps."""

    def __init__(self, actions: list[Any]) -> None:
        self.actions = actions
        self.step = 0

    def steer(self, view: View) -> Command:
        turn, pedal = self.actions[min(self.step // 2, len(self.actions) - 1)].tolist()
        self.step += 1
        turn, pedal = min(max(turn, -1.0), 1.0), min(max(pedal, -1.0), 1.0)
        return Command(turn * LOCK, max(pedal, 0.0), max(-pedal, 0.0))


def test_a_program_that_can_only_give_a_name_gets_the_environment() -> None:
    """In a process of its own, since it is registered here already."""
    code = "import gymnasium; print(gymnasium.make('roadgpt_gym:roadgpt/LaneKeeping-v0').spec.id)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["roadgpt/LaneKeeping-v0"]


@pytest.mark.parametrize("arguments", [{}, {"observation": "camera", "camera": SMALL}])
def test_gymnasiums_checker_has_nothing_to_say(arguments: dict[str, Any]) -> None:
    env = gymnasium.make("roadgpt/LaneKeeping-v0", render_mode="rgb_array", **arguments)
    check_env(env.unwrapped)
    assert env.unwrapped.metadata["render_fps"] == 25
    env.close()
    env.close()


def test_a_good_agent_comes_to_the_goal_and_is_paid_for_the_way() -> None:
    env = made()
    rows = episode(env, good, seed=5)
    road = env.unwrapped.road
    last = rows[-1][3]
    assert last["ended"] == "goal"
    assert all("ended" not in info for *_, info in rows[:-1])
    # from 2.5 m behind the start to 8 m, by air, before the end; never beside the road by much
    way = sum(info["progress"] for *_, info in rows)
    assert road.length - 2.5 - 8.6 < way < road.length - 2.5 - 6.5
    cost = way + 10 - sum(reward for _, _, reward, _ in rows)
    assert 0 < cost < 0.1 * 0.6 * len(rows)  # 0.6 m aside on the average would be a bad agent
    aside = sum(0.1 * abs(info["t"] + 2) for *_, info in rows)
    assert aside < cost


def test_an_episode_is_the_drive_that_simulate_makes_of_its_commands() -> None:
    env = made("a hilly road with 3 turns")
    rng = np.random.default_rng(3)

    def shaken(seen: Any) -> Any:
        return np.asarray(good(seen) + rng.normal(0, [0.08, 0.3]), np.float32)

    rows = episode(env, shaken, seed=8)
    actions = [action for _, action, _, _ in rows]
    drive = simulate(env.unwrapped.road, World(), RepeatsActions(actions))
    assert len(rows) > 100
    assert drive.ended == rows[-1][3]["ended"]
    for name in ("s", "t", "speed", "outside"):
        told = [info[name] for *_, info in rows]
        column = np.asarray(drive.columns[name])
        there = [column[min(2 * (place + 1), len(column) - 1)] for place in range(len(rows))]
        assert told == there, name


def test_the_numbers_are_those_of_the_road_and_the_car() -> None:
    from roadgpt_gym.observation import AHEAD, LABELS, SCALES

    env = made("a hilly road with 3 turns", world={"friction": 0.6, "speed_limit": 15})
    rows = episode(env, good, most=260, seed=2)
    road = env.unwrapped.road
    seen = rows[250][0] * SCALES
    info = rows[249][3]
    told = dict(zip(LABELS, seen.tolist(), strict=True))
    assert told["speed"] == pytest.approx(info["speed"], rel=1e-5)
    assert told["offset"] == pytest.approx(info["t"] + 2, abs=1e-5)
    assert (told["speed_limit"], told["friction"]) == pytest.approx((15, 0.6))
    for metres in AHEAD:
        around = np.clip(info["s"] + metres + np.linspace(-0.6, 0.6, 25), 0, road.length)
        for name, values in (("curvature", road.curvature(around)), ("grade", road.grade(around))):
            there = told[f"{name}_{metres:g}"]
            assert values.min() - 1e-6 <= there <= values.max() + 1e-6 or info["s"] + metres > road.length


@pytest.mark.parametrize(
    ("world", "middle"), [({"lane_width": 3.0}, -1.5), ({"lanes": "2+1", "lane_width": 3.5}, -5.25)]
)
def test_offset_and_reward_are_those_of_the_driven_lane(world: dict[str, Any], middle: float) -> None:
    from roadgpt_gym.observation import LABELS, SCALES

    env = made(world=world)
    seen, info = env.reset(seed=3)
    assert info["t"] == pytest.approx(middle, abs=0.05)
    for _ in range(80):
        seen, reward, *_, info = env.step(good(seen))
    told = dict(zip(LABELS, (seen * SCALES).tolist(), strict=True))
    assert told["offset"] == pytest.approx(info["t"] - middle, abs=1e-5)
    assert abs(told["offset"]) < 0.3
    assert info["outside"] == 0
    assert reward == pytest.approx(info["progress"] - 0.1 * abs(info["t"] - middle), abs=0.02)


def test_the_same_seed_and_actions_give_the_same_bytes() -> None:
    first, second = (made(("two hairpins", "a straight road")) for _ in range(2))
    one, other = (episode(env, good, most=60, seed=11) for env in (first, second))
    assert [row[0].tobytes() for row in one] == [row[0].tobytes() for row in other]
    assert [row[2] for row in one] == [row[2] for row in other]
    again = [env.reset()[0].tobytes() for env in (first, second)]  # and the road after it, too
    assert again[0] == again[1]
    assert first.unwrapped.road.length == second.unwrapped.road.length
    lengths = set()
    for seed in range(11, 16):
        first.reset(seed=seed)
        lengths.add(first.unwrapped.road.length)
    assert len(lengths) == 5


def test_the_camera_gives_the_same_bytes_and_sees_the_car_turn() -> None:
    frames = []
    for _ in range(2):
        env = made(observation="camera", camera=SMALL)
        frames.append([row[0] for row in episode(env, straight, most=40, seed=4)])
    assert all(np.array_equal(a, b) for a, b in zip(*frames, strict=True))
    assert frames[0][0].shape == (24, 48, 3)
    assert not np.array_equal(frames[0][0], frames[0][-1])
    assert frames[0][0] is not frames[0][1]
    top, bottom = frames[0][0][:6].mean(axis=(0, 1)), frames[0][0][-6:].mean(axis=(0, 1))
    assert top[2] > bottom[2]  # the sky is above


def test_descriptions_take_turns_and_one_may_be_asked_for() -> None:
    env = made(["a straight road", "two hairpins"])
    told = {env.reset(seed=seed)[1]["prompt"] for seed in range(12)}
    assert told == {"a straight road", "two hairpins"}
    _, info = env.reset(seed=1, options={"prompt": "a flat road with a left turn"})
    assert info["prompt"] == "a flat road with a left turn"
    assert env.unwrapped.road.curvature(np.linspace(0, env.unwrapped.road.length, 200)).max() > 0.005
    assert env.reset()[1]["prompt"] in told
    env.unwrapped.set_prompts(["a straight road"])
    assert {env.reset()[1]["prompt"] for _ in range(4)} == {"a straight road"}


def test_leaving_the_lane_ends_it_and_nothing_comes_after() -> None:
    env = made("two hairpins")
    rows = episode(env, straight, seed=1)
    last = rows[-1]
    assert last[3]["ended"] == "out_of_lane"
    assert last[3]["outside"] > 0.5
    assert last[2] < -9
    _, reward, terminated, truncated, info = env.step(straight(None))
    assert (reward, terminated, truncated, info["ended"]) == (0.0, True, False, "out_of_lane")


def test_standing_still_is_stuck() -> None:
    rows = episode(made(), lambda seen: np.array([0.0, -1.0], np.float32), seed=1)
    assert rows[-1][3]["ended"] == "stuck"
    assert len(rows) == 250  # 10 s


@pytest.mark.parametrize(
    "action", [[math.nan, 0.0], [0.0, math.inf], [0.0], [0.0, 0.0, 0.0], "left", None, [None, 0.0]]
)
def test_an_action_that_is_none_is_refused(action: Any) -> None:
    env = made().unwrapped
    with pytest.raises(UsageError, match=r"call reset\(\)"):
        env.step(np.zeros(2))
    env.reset(seed=1)
    before = env.step(np.zeros(2))[4]
    with pytest.raises(UsageError, match="two finite numbers"):
        env.step(action)
    assert env.step(np.zeros(2))[4]["s"] == pytest.approx(before["s"], abs=0.05)  # and loses nothing


def test_actions_beyond_the_ends_are_cut() -> None:
    told = []
    for turn, pedal in ((1.0, 1.0), (7.0, 3.0)):
        env = made().unwrapped
        env.reset(seed=1)
        told.append([env.step(np.array([turn, pedal]))[0].tobytes() for _ in range(10)])
    assert told[0] == told[1]


@pytest.mark.parametrize(
    ("arguments", "kind", "said"),
    [
        ({"observation": "smell"}, UsageError, "no observation 'smell'; there are: state, camera"),
        ({"world": {"frction": 0.6}}, UsageError, "frction"),
        ({"world": {"friction": -1}}, UsageError, "friction = -1"),
        ({"prompt": []}, UsageError, "give one"),
        ({"prompt": "a road with 500 hairpins"}, BriefError, "no map holds so many turns"),
        ({"reader": "crystal ball"}, UsageError, "crystal ball"),
    ],
)
def test_wrong_arguments_are_refused_in_a_sentence(arguments: dict[str, Any], kind: type, said: str) -> None:
    from roadgpt_gym.lane_keeping import LaneKeeping

    with pytest.raises(kind, match=said) as caught:
        LaneKeeping(**arguments)
    assert "\n" not in str(caught.value)


def test_render_shows_the_car_on_its_road() -> None:
    env = made(render_mode="rgb_array")
    env.reset(seed=1)
    one = env.render()
    assert one.shape == (360, 640, 3)
    assert one.dtype == np.uint8
    for _ in range(40):
        env.step(np.array([0.0, 1.0], np.float32))
    other = env.render()
    assert not np.array_equal(one, other)
    # the car is blue, and no longer where it was hidden behind nothing: in the middle of both pictures
    for picture in (one, other):
        middle = picture[150:330, 220:420].astype(int)
        assert (middle[..., 2] - middle[..., 0] > 40).mean() > 0.03
    env.close()
