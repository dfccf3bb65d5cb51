"""Writes the roads of Runs as road files: for each new Run while a campaign is running, or for existing
Runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive import Drive
from roadgpt.errors import ExportError, UsageError
from roadgpt.export import Poses, Trajectories, doubts, exporter_of, save
from roadgpt.export.ego import CAR
from roadgpt.network import RoadEnd, network_of
from roadgpt.road import Road, World
from roadgpt.run.folder import Draw
from roadgpt.run.model import Run

if TYPE_CHECKING:
    from roadgpt.traffic import Tracks

NAME = "road"  # of the files in a Run's own folder
TOLD = 5  # of others that are left out


def export(
    run: Run, folder: Path | str, formats: Sequence[str], tell: Callable[[str], None], name: str = NAME
) -> tuple[tuple[Path, ...], dict[str, ExportError]]:
    """Writes the road of a Run in each format, and its drive and the others if the format can hold them;
    ``tell`` gets the doubts. Returns the files, and why formats refuse the road."""
    if run.road is None:
        raise ExportError(f"run {run.index} has no road to export: {run.description}")
    poses, placed = None if run.drive is None else poses_of(run.drive), None
    if run.drive is not None and poses is not None and run.drive.lights:
        poses = replace(poses, lights=_lights(run.road, run.drive, run.world))
    holds_others = any(getattr(exporter_of(each), "holds_others", False) for each in formats)
    if poses is None and holds_others and run.world.scene.has_others and run.road.has_way:
        try:
            placed = _placed(run, tell)
        except UsageError as error:
            tell(f"others on the road left out, who find no place: {error}")
    written, refused = list[Path](), dict[str, ExportError]()
    for format_ in formats:
        try:
            written += save(run.road, folder, [format_], run.world, name, poses, placed)
        except ExportError as error:
            refused[format_] = error
    for said in doubts(run.road, [each for each in formats if each not in refused], run.world, poses):
        tell(said)
    return tuple(dict.fromkeys(written)), refused


def poses_of(drive: Drive) -> Poses | None:
    """Returns how the car and the others moved in a drive; None if it has one step only."""
    if len(drive) < 2:
        return None
    return Poses.of(drive.columns, None if drive.others is None else _others(drive.others))


def _others(tracks: "Tracks", samples: int | None = None) -> Trajectories:
    sizes = np.array([each.size for each in tracks.actors]).reshape(-1, 3)
    names, kinds = (tuple(getattr(each, what) for each in tracks.actors) for what in ("name", "kind"))
    return Trajectories(names, kinds, sizes, tracks.time[:samples], tracks.states[:samples])


def _placed(run: Run, tell: Callable[[str], None]) -> Trajectories | None:
    """Returns the others as they are when the tested car begins a drive; ``tell`` gets who comes later."""
    from roadgpt.traffic.rehearsal import rehearsed  # only scenes that nobody has driven load it

    assert run.road is not None
    if (others := rehearsed(run.road, run.world, run.seed, ahead=CAR.middle)) is None:
        return None
    tracks = others.tracks()
    late = [each.name for each, (x, *_) in zip(tracks.actors, tracks.states[0], strict=True) if np.isnan(x)]
    if late:
        more = ", ..." * (len(late) > TOLD)
        tell(f"others left out, who come later: {', '.join(late[:TOLD])}{more}; drive the road to have them")
    return _others(tracks, 1)


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
        if self.formats and run.road is not None:
            _, refused = export(
                run, folder, self.formats, lambda said: self.tell(f"road {run.index}: {said}")
            )
            for format_, error in refused.items():
                self.tell(f"road {run.index} is not exported to {format_}: {error}")
        if self.draw is not None:
            self.draw.of_run(run, folder)

    def of_campaign(self, folder: Path) -> None:
        """Lets ``draw``, if given, draw the picture of all roads of the campaign."""
        if self.draw is not None:
            self.draw.of_campaign(folder)
