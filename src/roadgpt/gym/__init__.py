"""The car's seat as Gymnasium has it.

    import gymnasium, roadgpt.gym
    env = gymnasium.make("roadgpt/LaneKeeping-v0", prompt="two hairpins")

Wants the extra ``gym``. Gymnasium no longer looks for environments of other packages, so this room registers
its own when it is imported.
"""

from roadgpt.errors import UsageError

NAME = "roadgpt/LaneKeeping-v0"

try:
    from gymnasium.envs.registration import register, registry
except ImportError as error:
    raise UsageError(f"this needs more libraries: python -m pip install 'roadgpt[gym]' ({error})") from error

if NAME not in registry:
    register(id=NAME, entry_point="roadgpt.gym.lane_keeping:LaneKeeping")
