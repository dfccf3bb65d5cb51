"""A Gymnasium environment in which an agent drives the car.

    import gymnasium, roadgpt_gym
    env = gymnasium.make("roadgpt/LaneKeeping-v0", prompt="two hairpins")

It needs RoadGPT's optional dependencies: ``roadgpt[gym]``. Importing this package registers the
environment with Gymnasium."""

from roadgpt.errors import UsageError, to_install

NAME = "roadgpt/LaneKeeping-v0"

try:
    from gymnasium.envs.registration import register, registry
except ImportError as error:
    raise UsageError(f"this needs more libraries: {to_install('gym')} ({error})") from error

if NAME not in registry:
    register(id=NAME, entry_point="roadgpt_gym.lane_keeping:LaneKeeping")
