"""How fast pictures are drawn, and how long 9 s of film take beside encoding alone: prints two tables.

    python benchmarks/bench_film.py [SECONDS]

Rates are pictures per CPU second of this process, after compiling: one core, nothing waited for. A film's
clock depends on what else the machine does, its CPU seconds hardly. "Encoding alone" writes the same frames,
drawn beforehand.
"""

import os
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from roadgpt.road import Design, Segment, World
from roadgpt.run import Run, prove
from roadgpt.scene import Camera, Pose, Scenery
from roadgpt_film.film import Film, Settings, write_film

SECONDS = float(sys.argv[1]) if sys.argv[1:] else 9.0
SIZES = ((200, 66), (320, 160), (640, 360), (1280, 720))
POSES = 20
LEAST = SECONDS / 6  # CPU seconds for each rate


def driven(turns: tuple[float, ...]) -> Run:
    """A hilly road with a drive of more than 9 s."""
    parts = [Segment(distance=50, direction="straight", incline=6)]
    for k, turn in enumerate(turns):
        side = "left" if turn > 0 else "right"
        parts += [
            Segment(distance=40, direction=side, incline=8 - 8 * k, turn_degrees=turn),
            Segment(distance=30, direction="straight", incline=6 - 8 * k),
        ]
    run = prove(Design(starting_point=(60, 60, 0), theta=20, segments=tuple(parts)), 7)
    assert run.drive is not None
    assert run.drive.duration > SECONDS, run.drive.duration
    return replace(run, request=run.request.model_copy(update={"words": "two turns over a hill"}))


def rates(run: Run) -> None:
    """Pictures per CPU second."""
    assert run.road is not None
    assert run.drive is not None
    scene, drive = Scenery.of(run.road, World()), run.drive
    steps = [int(k * (len(drive) - 1) / POSES) for k in range(POSES)]
    names = ("x", "y", "z", "heading", "pitch", "roll")
    poses = [Pose(*(float(drive[name][step]) for name in names)) for step in steps]
    print("| pictures per CPU s | from the bonnet, no car | from behind, with car |\n|---|---|---|")
    for size in SIZES:
        found = []
        for mount in ("bonnet", "chase"):
            camera = Camera(*size, mount=mount)
            found.append(_rate(scene, camera, poses, mount == "chase"))
        print(f"| {size[0]} x {size[1]} | {found[0]:.0f} | {found[1]:.0f} |")


def _rate(scene: Scenery, camera: Camera, poses: list[Pose], has_car: bool) -> float:
    def all_poses() -> None:
        for pose in poses:
            scene.render(camera, pose, car=pose if has_car else None)

    all_poses()  # compiles
    count, begun = 0, time.process_time()
    while time.process_time() - begun < LEAST:
        all_poses()
        count += len(poses)
    return count / (time.process_time() - begun)


def films(runs: list[Run], folder: Path) -> None:
    """Clock and CPU seconds of films, and of their encoding alone."""
    settings = Settings(seconds=SECONDS)
    print(
        f"\n| {SECONDS:g} s of film, {os.cpu_count()} cores | frames | clock s | CPU s "
        "| encoding alone: clock s | CPU s | kB |"
    )
    print("|---|---|---|---|---|---|---|")
    for name, shown, view in (
        ("from behind, 640 x 360", runs[:1], "chase"),
        ("from the bonnet, 640 x 360", runs[:1], "bonnet"),
        ("split screen of two, from behind, 2 x 640 x 360", runs, "chase"),
    ):
        path = folder / "film.mp4"
        clock, cpu = time.perf_counter(), time.process_time()
        film = Film.of(shown, view, settings)  # type: ignore[arg-type]
        write_film(film.frames(), path, settings.fps)
        took = time.perf_counter() - clock, time.process_time() - cpu
        frames = list(film.frames())
        clock, cpu = time.perf_counter(), time.process_time()
        write_film(frames, path, settings.fps)
        alone = time.perf_counter() - clock, time.process_time() - cpu
        size = path.stat().st_size / 1000
        print(
            f"| {name} | {len(film)} | {took[0]:.1f} | {took[1]:.1f} "
            f"| {alone[0]:.1f} | {alone[1]:.1f} | {size:.0f} |"
        )


if __name__ == "__main__":
    both = [driven((60.0, -70.0)), driven((-60.0, 50.0))]
    rates(both[0])
    with tempfile.TemporaryDirectory() as place:
        films(both, Path(place))
