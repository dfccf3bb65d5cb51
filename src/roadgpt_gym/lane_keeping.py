"""The environment ``roadgpt/LaneKeeping-v0``: drive a road that meets a description, and stay in the lane."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pydantic import ValidationError

from roadgpt.brief import sentence
from roadgpt.design.room import world_for
from roadgpt.drive.camera_sensor import CameraSensor
from roadgpt.drive.drive_monitor import DriveMonitor
from roadgpt.drive.simulators.mujoco.car import ETK_LIKE
from roadgpt.drive.simulators.mujoco.vehicle import CONTROL, Vehicle
from roadgpt.drive.view import CameraSpec
from roadgpt.errors import DesignError, UsageError, advice_on
from roadgpt.road import Road, World
from roadgpt.run import Setup, brief_of, perform
from roadgpt_gym.observation import LABELS, MOST, Preview

OBSERVATIONS = ("state", "camera")
RENDER_MODES = ("rgb_array",)
STEPS = 2  # control steps of 20 ms per step of the environment: 25 Hz, the rate of a camera
FAILED, ARRIVED = -10.0, 10.0
ASIDE = 0.1  # penalty per step for each metre between the car and the middle of the lane
ROUGH = 0.02  # penalty per rad/s of the front wheels
TRIES = 5  # seeds that are tried for one road before an error is raised
SEEDS = 2**31 - 1
FILM = (640, 360)  # pixels of the image of render()

State = NDArray[np.float32] | NDArray[np.uint8]


class LaneKeeping(gymnasium.Env[State, NDArray[np.float32]]):
    """An environment with a new road in each episode; all roads meet the description, and the seed of
    ``reset`` selects the road.

    Action: two numbers from -1 to 1. The first is the angle of the front wheels as a share of full lock (0.62
    rad), left positive; the second is throttle above 0 and brake below.

    Observation ``state``: 24 numbers, see ``roadgpt_gym.observation.LABELS``, each divided by a typical
    value.
    Observation ``camera``: an image (height, width, 3) from behind the windscreen.

    Reward of a step: metres gained along the road, minus 0.1 per metre of distance from the middle of the
    lane, minus a small penalty for rough steering; +10 at the goal, -10 if the car leaves its lane, falls off
    the road, overturns or gets stuck. The goal and each of these failures set ``terminated``; running
    out of time sets ``truncated``.

    ``info`` has s, t (m, position on the road), outside (share of the car outside its lane), speed (m/s),
    progress (m gained in this step), prompt, and at the end ``ended``: "goal", "out_of_lane", "fell", "stuck"
    or "timeout". After ``reset`` it also has ``understood``: a sentence with the requirements that were read
    from the description. The road itself is ``env.unwrapped.road``.

    Args:
        prompt: one description, or several; the seed then selects one for each episode.
        observation: "state" or "camera".
        render_mode: "rgb_array" or None.
        world: values for fields of ``roadgpt.road.World``, such as ``{"friction": 0.6}``; all other fields
            keep their defaults. If ``world`` gives no friction, a road surface that the description names,
            such as "icy", determines the friction.
        camera: camera of the observation; by default the SBFT competition's camera, with 320 x 160 pixels.
        reader: name of the plug-in that reads the descriptions."""

    metadata: dict[str, Any] = {"render_modes": [*RENDER_MODES], "render_fps": round(1 / (STEPS * CONTROL))}  # noqa: RUF012

    def __init__(
        self,
        prompt: str | Sequence[str] = "a road",
        observation: str = "state",
        render_mode: str | None = None,
        world: Mapping[str, Any] | None = None,
        camera: CameraSpec | None = None,
        reader: str = "model",
    ) -> None:
        if observation not in OBSERVATIONS:
            raise UsageError(f"there is no observation '{observation}'; there are: {', '.join(OBSERVATIONS)}")
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UsageError(f"there is no render_mode '{render_mode}'; there are: {', '.join(RENDER_MODES)}")
        self.render_mode = render_mode
        self._given = self._world = _world_of(world or {})
        self._setup = Setup(reader=reader, drives=False)
        self._camera = None if observation == "state" else (camera or CameraSpec(every=1))
        self.set_prompts([prompt] if isinstance(prompt, str) else prompt)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        if self._camera is None:
            self.observation_space: Any = spaces.Box(-MOST, MOST, (len(LABELS),), np.float32)
        else:
            shape = (self._camera.height, self._camera.width, 3)
            self.observation_space = spaces.Box(0, 255, shape, np.uint8)
        self.road: Road | None = None

    def __copy__(self) -> "LaneKeeping":
        return deepcopy(self)  # a copy that shared the car would move it

    def set_prompts(self, prompts: Sequence[str]) -> None:
        """Replaces the descriptions, from the next ``reset`` on."""
        if not prompts:
            raise UsageError("there is no description; give one, such as 'a winding road'")
        self._briefs = [brief_of(words, self._given, self._setup) for words in prompts]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[State, dict[str, Any]]:
        """Makes a new road and places the car at its start; ``options["prompt"]`` is a description for this
        road only."""
        unknown = sorted(set(options or ()) - {"prompt"})
        if unknown:
            raise UsageError(f"reset() has no option {', '.join(map(repr, unknown))}; it has 'prompt'")
        super().reset(seed=seed)
        brief = self._briefs[int(self.np_random.integers(len(self._briefs)))]
        if options and "prompt" in options:
            brief = brief_of(str(options["prompt"]), self._given, self._setup)
        if brief.scene.has_script:
            raise UsageError("the environment cannot make its car do what a scene tells; leave that out")
        self._words, self._world = brief.words, world_for(brief, self._given)
        self.road = road = self._drawn(brief)
        self._vehicle = Vehicle.on(road, self._world, ETK_LIKE)
        self._monitor = DriveMonitor(road, self._world, ETK_LIKE.box)
        self._profile = self._world.profile_of(road)
        self._vehicle.put(self._monitor.start, float(self._profile.middle(self._monitor.start)))
        self._preview = Preview(road, self._world)
        self._sensor = None if self._camera is None else CameraSensor(self._camera, road, self._world)
        self._scene: Any = None
        self._step, self._row, self._gain = 0, self._vehicle.see(), 0.0
        self._ended = self._monitor.ended(self._vehicle.row, 0.0, self._vehicle.mishap)
        return self._seen(), {**self._info(), "understood": sentence(brief)}

    def _drawn(self, brief: Any) -> Road:
        said = ""
        for _ in range(TRIES):
            seed = int(self.np_random.integers(SEEDS))
            try:
                run = perform(brief, seed, self._world, self._setup)
            except DesignError as error:
                said = str(error)
                continue
            if run.road is not None and run.is_valid:
                return run.road
            said = run.validation_message
        raise DesignError(f"no road of '{brief.words}' could be drawn: {said}")

    def step(self, action: NDArray[np.float32]) -> tuple[State, float, bool, bool, dict[str, Any]]:
        """Applies an action for two control steps (40 ms in total); values beyond ±1 are clipped. After the
        end of the episode nothing moves, and the reward is 0."""
        if self.road is None:
            raise UsageError("the environment has no road yet; call reset() first")
        turn, pedal = _checked(action)
        was_over, before, steer = self._ended is not None, self._row["s"], self._row["steer"]
        for _ in range(STEPS):
            if self._ended is not None:
                break
            self._vehicle.move(turn * ETK_LIKE.max_steer_angle, max(pedal, 0.0), max(-pedal, 0.0))
            self._step += 1
            self._ended = self._monitor.ended(self._vehicle.row, self._step * CONTROL, self._vehicle.mishap)
        self._row = row = self._vehicle.see()
        aside = abs(row["t"] - float(self._profile.middle(row["s"])))
        self._gain = row["s"] - before
        reward = self._gain - ASIDE * aside - ROUGH * abs(row["steer"] - steer) / (STEPS * CONTROL)
        reward += {None: 0.0, "goal": ARRIVED, "timeout": 0.0}.get(self._ended, FAILED)
        reward = 0.0 if was_over else reward
        is_over = self._ended not in (None, "timeout")
        return self._seen(), float(reward), is_over, self._ended == "timeout", self._info()

    def _seen(self) -> State:
        if self._sensor is not None:
            return self._sensor.see(self._row).copy()
        return self._preview.numbers(self._row, self._world)

    def _info(self) -> dict[str, Any]:
        told: dict[str, Any] = {name: self._row[name] for name in ("s", "t", "outside", "speed")}
        told |= {"progress": self._gain, "prompt": self._words}
        return told if self._ended is None else {**told, "ended": self._ended}

    def render(self) -> Any:
        """Returns the image (360, 640, 3) of a camera behind the car; None without a render mode or road."""
        if self.render_mode is None or self.road is None:
            return None
        from roadgpt.scene import Camera as Pinhole
        from roadgpt.scene import Pose, Scenery

        if self._scene is None:
            self._scene = Scenery.of(self.road, self._world)
        pose = Pose(**{name: self._row[name] for name in Pose._fields if name in self._row})
        return self._scene.render(Pinhole(*FILM, mount="chase"), pose, car=pose)


def _world_of(fields: Mapping[str, Any]) -> World:
    try:
        return World.model_validate(fields)
    except ValidationError as error:
        wrong = error.errors()[0]
        name = str(wrong["loc"][-1])
        raise UsageError(f"the world cannot have {name} = {wrong['input']!r}; {advice_on(wrong)}") from None


def _checked(action: Any) -> list[float]:
    try:
        numbers = np.asarray(action, float)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.shape != (2,) or not np.isfinite(numbers).all():
        raise UsageError(f"an action is two finite numbers from -1 to 1, steering and pedals, not {action!r}")
    return [*map(float, np.clip(numbers, -1.0, 1.0))]
