"""The guide runs, block by block; its agent becomes a driver that keeps its lane."""

import re
from pathlib import Path
from typing import Any

import pytest

from roadgpt.drive import simulate
from roadgpt.road import World
from roadgpt.run import Setup, perform
from roadgpt.verdict import judge

GUIDE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "use-gymnasium.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("code", BLOCKS, ids=range(len(BLOCKS)))
def test_each_block_runs(code: str) -> None:
    names: dict[str, Any] = {}
    exec(compile(code, GUIDE.name, "exec"), names)
    for name in ("env", "envs"):
        if name in names:
            names[name].close()


def test_the_agent_of_the_guide_keeps_its_lane() -> None:
    names: dict[str, Any] = {}
    exec(compile(BLOCKS[-1], GUIDE.name, "exec"), names)
    run = perform("a hilly road with 3 turns", 1, World(), Setup(drives=False))
    assert run.road is not None
    assert judge(run.road, simulate(run.road, World(), names["Agent"]()), World()).kept


def test_the_guide_names_everything_that_info_has() -> None:
    import gymnasium

    env = gymnasium.make("roadgpt/LaneKeeping-v0")
    _, info = env.reset(seed=1)
    text = GUIDE.read_text(encoding="utf-8")
    assert not [name for name in info if f"`{name}`" not in text]
