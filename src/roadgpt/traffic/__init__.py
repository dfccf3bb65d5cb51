"""Moves the others on the road: everybody besides the tested car. Main function: ``begin``.

Three movers share the work: ``replay`` has recorded tracks, ``script`` a scene's actors, ``idm`` its flow.
They are no plug-ins: a scene says who is there, and a simulator of your own moves them as it likes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.traffic.actor import SIZES, STEP, Actor, Size, TestedCar, Tracks
from roadgpt.traffic.traffic import Aiming, Mover, Stage, Traffic

if TYPE_CHECKING:
    from roadgpt.road import Road, World

__all__ = ["SIZES", "STEP", "Actor", "Mover", "Size", "Stage", "TestedCar", "Tracks", "Traffic", "begin"]


def begin(
    road: "Road", world: "World", seed: int, replay: Tracks | Path | str | None = None,
    aims: Mapping[int, Aiming | None] | None = None, path: Sequence[TestedCar] = (),
) -> Traffic | None:  # fmt: skip
    """Returns the others who are on the road that the tested car drives; None if nobody else is.

    Args:
        world: its scene says who else is there.
        seed: of the movers that draw numbers.
        replay: recorded tracks, or the file that holds them (see ``recording``).
        aims: see ``Stage``; None: those with which who is to hit somebody does so if the tested car moves on
            its ``path``: without one, in the middle of its lane and with its speed, unless it has a script.
        path: where the tested car is every STEP seconds if it reacts to nobody.

    Raises:
        UsageError: the file cannot be used, or an actor of the scene cannot be, or act, on this road."""
    scene, movers, lights = world.scene, list[Mover](), None
    if scene.has_flow or scene.actors or scene.lights:
        from roadgpt.traffic.lights import lights_of

        lights = lights_of(road, world, seed)
    if replay is not None:
        from roadgpt.traffic.recording import read_recording
        from roadgpt.traffic.replay import ReplayMover

        tracks = replay if isinstance(replay, Tracks) else read_recording(Path(replay)).on(road, world)
        movers.append(ReplayMover(tracks))
    stage = Stage(road, world, seed, lights, aims or {})
    if aims is None and any(each.hits for each in scene.actors) and (path or not scene.has_script):
        from roadgpt.traffic.aiming import aims_of, steady

        stage = stage._replace(aims=aims_of(stage, path or [*steady(road, world)]))
    if scene.actors or scene.parked or scene.roadworks:
        from roadgpt.traffic.script import Script

        movers.append(Script(stage))
    if scene.has_flow:
        from roadgpt.traffic.idm import IdmMover

        movers.append(IdmMover(stage))
    return Traffic(movers, lights) if movers or scene.lights else None
