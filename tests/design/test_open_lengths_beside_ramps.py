"""A road beside a ramp may have a least length and no largest one."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt.cli import app


@pytest.mark.parametrize("plan", ["| lanes=2 len=300.. motorway // merge main", "merge ramp // | len=250.."])
def test_a_least_length_beside_a_ramp_is_met(plan: str, tmp_path: Path) -> None:
    words = ["run", "--plan", plan, "-n", "1", "--seed", "1", "--no-plot", "--out", str(tmp_path / "runs")]
    done = CliRunner().invoke(app, words, "roadgpt", catch_exceptions=False)
    assert "PASS" in done.output
    assert "INVALID" not in done.output
