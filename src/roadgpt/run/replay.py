"""The lines that make a Run again: the road from its words, and the drive from the road."""

import shlex
from pathlib import Path

from roadgpt.road import World
from roadgpt.run.model import Request, Run, Setup

USUAL = World()
PLAIN = Setup()

# Flags of the command line, and the part of the Setup that each one names.
DESIGN_FLAGS = {"--reader": "reader", "--designer": "designer", "--rules": "rules", "--geometry": "geometry"}
DRIVE_FLAGS = {"--driver": "driver", "--simulator": "simulator"}
WORLD_FLAGS = {
    "--map-size": ("map_size", 1.0),
    "--speed-limit": ("speed_limit", 3.6),
    "--oob-tolerance": ("oob_tolerance", 1.0),
    "--verge": ("verge", 1.0),
    "--friction": ("friction", 1.0),
}


def replay_lines(run: Run, folder: Path | None = None) -> list[str]:
    """Commands that give this Run again: from its words (as the last road), and from its road file."""
    lines = []
    if run.words:
        request = run.request
        plain = ["roadgpt", "run", run.words, "-n", str(run.index), "--seed", str(request.seed)]
        lines.append(shlex.join(plain + _flags(request, DESIGN_FLAGS | DRIVE_FLAGS)))
    if folder is not None and run.road is not None and run.request.setup.drives:
        again = ["roadgpt", "drive", str(folder / "road.json"), "--seed", str(run.seed)]
        lines.append(shlex.join(again + _flags(run.request, DRIVE_FLAGS)))
    return lines


def _flags(request: Request, named: dict[str, str]) -> list[str]:
    """What differs from the defaults."""
    out = []
    for flag, name in named.items():
        if getattr(request.setup, name) != getattr(PLAIN, name):
            out += [flag, str(getattr(request.setup, name))]
    for flag, (name, per_unit) in WORLD_FLAGS.items():
        if getattr(request.world, name) != getattr(USUAL, name):
            out += [flag, f"{getattr(request.world, name) * per_unit:.10g}"]
    if request.setup.keep_driving:
        out.append("--keep-driving")
    if not request.setup.drives and "--designer" in named:
        out.append("--no-drive")
    return out
