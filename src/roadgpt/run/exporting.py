"""Writes the roads of Runs as road files: for each new Run while a campaign is running, or for existing
Runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from roadgpt.drive import Drive
from roadgpt.errors import ExportError
from roadgpt.export import Others, Poses, doubts, save
from roadgpt.network import RoadEnd, network_of
from roadgpt.road import Road, World
from roadgpt.run.folder import Draw
from roadgpt.run.model import Run

NAME = "road"  # of the files in a Run's own folder


def export(
    run: Run, folder: Path | str, formats: Sequence[str], tell: Callable[[str], None], name: str = NAME
) -> tuple[Path, ...]:
    """Writes the road of a Run in each format, and its drive if the format can hold one; ``tell`` gets the
    doubts."""
    if run.road is None:
        raise ExportError(f"run {run.index} has no road to export: {run.description}")
    poses = None if run.drive is None else poses_of(run.drive)
    if run.drive is not None and poses is not None and run.drive.lights:
        poses = replace(poses, lights=_lights(run.road, run.drive, run.world))
    written = save(run.road, folder, formats, run.world, name, poses)
    for said in doubts(run.road, formats, run.world, poses):
        tell(said)
    return written


def poses_of(drive: Drive) -> Poses | None:
    """Returns how the car and the others moved in a drive; None if it has one step only."""
    if len(drive) < 2:
        return None
    others = None
    if drive.others is not None:
        actors, states = drive.others.actors, drive.others.states
        sizes = np.array([each.size for each in actors]).reshape(-1, 3)
        names, kinds = tuple(each.name for each in actors), tuple(each.kind for each in actors)
        others = Others(names, kinds, sizes, drive.others.time, states)
    return Poses.of(drive.columns, others)


def _lights(road: Road, drive: Drive, world: World) -> dict[int, list[tuple[float, dict[RoadEnd, str]]]]:
    """Returns what the lights showed in a drive, as Poses have it."""
    from roadgpt.traffic.lights import lights_of  # only drives with lights load it

    lights, names, road = lights_of(road, world, drive.seed), ("green", "yellow", "red"), world.lay(road)
    return {
        junction.id: [(lasts, {arm: names[each] for arm, each in shown.items()}) for lasts, shown in phases]
        for junction in network_of(road, world).junctions
        if (phases := lights.cycle(junction))
    }


@dataclass(frozen=True)
class Exporting:
    """A ``Draw`` that writes the road files of each Run of a campaign before ``draw`` draws the pictures."""

    formats: tuple[str, ...]
    tell: Callable[[str], None]
    """A function that receives a message if a road cannot be exported to a format. Only that file is then
    missing."""
    draw: Draw | None = None

    def of_run(self, run: Run, folder: Path) -> None:
        """Writes the road of one Run in all formats; then ``draw``, if given, draws the Run's pictures."""
        for format_ in self.formats if run.road is not None else ():
            try:
                export(run, folder, [format_], lambda said: self.tell(f"road {run.index}: {said}"))
            except ExportError as error:
                self.tell(f"road {run.index} is not exported to {format_}: {error}")
        if self.draw is not None:
            self.draw.of_run(run, folder)

    def of_campaign(self, folder: Path) -> None:
        """Lets ``draw``, if given, draw the picture of all roads of the campaign."""
        if self.draw is not None:
            self.draw.of_campaign(folder)
