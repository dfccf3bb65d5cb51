"""Many Runs in one folder: written as each ends; an interrupted campaign goes on where it stopped."""

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from roadgpt.errors import DesignError, RoadGPTError, UsageError
from roadgpt.road import Design
from roadgpt.run.atomic import held, json_text, sweep, write_whole
from roadgpt.run.folder import RUNS, Draw, read_run, run_folder, write_run
from roadgpt.run.model import Request, Run
from roadgpt.run.naming import new_folder
from roadgpt.run.seeds import seed_of
from roadgpt.run.tables import Tally, write_description
from roadgpt.run.test_file import test_name

FORMAT = 1
CARD = "campaign.json"
LOCK = "campaign.lock"
GIVE_UP = 3  # roads that cannot be designed, before any that could

Perform = Callable[[int, Sequence[Design]], Run]
"""Makes the Run of an index, different from the Designs before it."""


@dataclass
class Campaign:
    """Iterate over it to make it work; each Run is on the disk when it is handed out."""

    folder: Path
    request: Request
    roads: int
    """How many there will be."""
    perform: Perform
    draw: Draw | None = None
    kept: tuple[int, ...] = ()
    """Numbers of the roads that are finished."""
    _tally: Tally = field(default_factory=Tally)
    _designs: dict[int, Design] = field(default_factory=dict)

    @classmethod
    def opened(
        cls, request: Request, roads: int, out: Path | str | None, perform: Perform, draw: Draw | None
    ) -> "Campaign":
        """A campaign in its folder: a new one, or the one that lies there, to be continued.

        Raises:
            UsageError: the folder holds something else, or cannot be made.
        """
        if roads < 1:
            raise UsageError(f"{roads} roads cannot be made; ask for 1 or more")
        if out is None:
            return cls(new_folder(request.words, request.seed), request, roads, perform, draw)
        folder = Path(out)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            is_empty = not any(folder.iterdir())
        except OSError as error:
            raise UsageError(f"cannot use {folder}: {error.strerror}; name another folder") from error
        campaign = cls(folder, request, roads, perform, draw)
        if not is_empty:
            campaign._take_up()
        return campaign

    def __iter__(self) -> Iterator[Run]:
        """The Runs that are still to be made, one by one.

        Raises:
            DesignError: no road could be designed.
            UsageError: a part is not installed, or another process is at work in the folder.
            RoadGPTError: a file cannot be written.
        """
        try:
            with held(self.folder / LOCK):
                self._begin()
                yield from self._work()
        except BlockingIOError as error:
            raise UsageError(
                f"another process is at work in {self.folder}; wait for it or name another folder"
            ) from error
        except OSError as error:
            raise RoadGPTError(
                f"cannot write into {self.folder}: {error.strerror or error}; make room there and go on "
                "with the same command and --out"
            ) from error

    def _work(self) -> Iterator[Run]:
        """Road after road, each written and counted before it is handed out."""
        try:
            for index in (index for index in range(1, self.roads + 1) if index not in self.kept):
                run = self._one(index)
                write_run(run, self.folder, self.draw)
                self._count(run)
                self.kept += (index,)
                self._tally.write(self.folder)
                yield run
                if not self._tally.with_road and index >= min(GIVE_UP, self.roads):
                    raise DesignError(run.description)
        finally:
            # however it ends, the tables tell of every road that is there
            self._tally.write(self.folder)
        if self.draw is not None:
            self.draw.of_campaign(self.folder)
        self._write_card(is_finished=True)

    def earlier_runs(self) -> Iterator[Run]:
        """The Runs that were there before, read from the disk."""
        for index in self.kept:
            yield read_run(run_folder(self.folder, index))

    def _one(self, index: int) -> Run:
        earlier = [design for number, design in sorted(self._designs.items()) if number < index]
        try:
            return self.perform(index, earlier)
        except DesignError as error:
            own = seed_of(self.request.seed, index)
            return Run(self.request, index, own, outcome="ERROR", description=str(error))

    def _count(self, run: Run) -> None:
        self._tally.add(run)
        if run.design is not None:
            self._designs[run.index] = run.design

    def _begin(self) -> None:
        (self.folder / RUNS).mkdir(exist_ok=True)
        sweep(self.folder)
        sweep(self.folder / RUNS)
        self._write_card(is_finished=False)
        write_description(self.request, self.roads, self.folder)

    def _write_card(self, is_finished: bool) -> None:
        card = {
            "format": FORMAT,
            "request": self.request.model_dump(mode="json"),
            "roads": self.roads,
            "is_finished": is_finished,
        }
        write_whole(self.folder / CARD, json_text(card))

    def _take_up(self) -> None:
        """Look at what lies in the folder, and keep the roads that are finished."""
        card = read_card(self.folder)
        asked = self.request.model_dump(mode="json")
        other = [key for key in asked if card["request"].get(key) != asked[key]]
        if other:
            raise UsageError(
                f"{self.folder} holds another campaign (other {' and '.join(other)}); name another folder"
            )
        if card["is_finished"] and card["roads"] >= self.roads:
            raise UsageError(
                f"{self.folder} holds this campaign already, finished with {card['roads']} roads; "
                "ask for more roads or name another folder"
            )
        self.kept = tuple(finished(self.folder, self.roads))
        for run in self.earlier_runs():
            self._count(run)


def finished(folder: Path, roads: int) -> Iterator[int]:
    """Numbers of the roads that are finished, of the first so many."""
    for index in range(1, roads + 1):
        if (folder / test_name(index)).is_file() and run_folder(folder, index).is_dir():
            yield index


def read_card(folder: Path) -> dict[str, Any]:
    """What a campaign's folder says of the campaign.

    Raises:
        UsageError: no campaign lies there.
    """
    try:
        card = json.loads((folder / CARD).read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise UsageError(f"{folder} is not empty and holds no campaign; name another folder") from error
    except (OSError, ValueError) as error:
        raise UsageError(f"{folder / CARD} cannot be read ({error}); name another folder") from error
    if not isinstance(card, dict) or card.get("format") != FORMAT or "request" not in card:
        raise UsageError(f"{folder} holds a campaign of another version of roadgpt; name another folder")
    return card
