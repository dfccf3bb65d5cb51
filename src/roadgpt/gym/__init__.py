"""A Gymnasium environment in which an agent drives the car.

    import gymnasium, roadgpt.gym
    env = gymnasium.make("roadgpt/LaneKeeping-v0", prompt="two hairpins")

It needs RoadGPT's optional dependencies: ``roadgpt[gym]``. Gymnasium no longer searches other packages for
environments, so this package registers its own when it is imported.
"""

from roadgpt.errors import UsageError

NAME = "roadgpt/LaneKeeping-v0"

try:
    from gymnasium.envs.registration import register, registry
except ImportError as error:
    raise UsageError(f"this needs more libraries: python -m pip install 'roadgpt[gym]' ({error})") from error

if NAME not in registry:
    register(id=NAME, entry_point="roadgpt.gym.lane_keeping:LaneKeeping")
