"""Makes many Runs in one folder: each is written when it is finished, and an interrupted campaign can be
resumed."""

from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from roadgpt.chat import ChatError, Meter, ReplyError
from roadgpt.errors import DesignError, RoadGPTError, UsageError
from roadgpt.road import Design
from roadgpt.run.atomic import PART, held, json_text, missing, refuse_links, sweep, take_away, write_whole
from roadgpt.run.card import CARD, Card, read_card
from roadgpt.run.folder import RUNS, Draw, read_run, remove_run, run_folder, write_run
from roadgpt.run.folder_names import HOME, new_folder
from roadgpt.run.lost_drives import LostDrives
from roadgpt.run.model import Request, Run
from roadgpt.run.sbft_json import test_name
from roadgpt.run.seeds import seed_of
from roadgpt.run.tables import DESCRIPTION, TABLES, Tally, write_description
from roadgpt.stopping import look

LOCK = "campaign.lock"
GIVE_UP = 3  # roads that cannot be designed, before any that could

Perform = Callable[[int, Sequence[Design]], Run]
"""Makes the Run with the given index, with a design that differs from the given earlier designs."""


@dataclass
class Campaign:
    """Makes the Runs of one description; iterate over it to make them. Each Run is on disk when it is
    yielded."""

    folder: Path
    request: Request
    roads: int
    """Number of roads requested."""
    perform: Perform
    draw: Draw | None = None
    made: tuple[Path, ...] = ()
    """Folders that were created for this campaign, the innermost first; removed if no road can be
    designed."""
    meter: Meter = field(default_factory=Meter)
    """Counts the use of language models, for earlier roads of the folder as well."""
    _finished: set[int] = field(default_factory=set)
    _tally: Tally = field(default_factory=Tally)
    _losses: LostDrives[Run] = field(default_factory=LostDrives)
    # Numbers of the roads that have a design, in their order, and those designs.
    _numbers: list[int] = field(default_factory=list)
    _designs: list[Design] = field(default_factory=list)

    @classmethod
    def opened(
        cls,
        request: Request,
        roads: int,
        out: Path | str | None,
        perform: Perform,
        draw: Draw | None,
        meter: Meter | None = None,
    ) -> "Campaign":
        """Opens a campaign in its folder: creates a new campaign, or continues the one that the folder holds.

        Raises:
            UsageError: the folder holds something other than this campaign, or cannot be created.
        """
        if roads < 1:
            raise UsageError(f"{roads} roads cannot be made; ask for 1 or more")
        if out is None:
            made = missing(HOME)
            folder = new_folder(request.words, request.seed)
            return cls(folder, request, roads, perform, draw, (folder, *made), meter or Meter())
        folder = Path(out)
        try:
            made = missing(folder)
            folder.mkdir(parents=True, exist_ok=True)
            is_new = all(_may_lie_in_a_new_folder(path) for path in folder.iterdir())
        except OSError as error:
            raise UsageError(f"cannot use {folder}: {error.strerror}; name another folder") from error
        campaign = cls(folder, request, roads, perform, draw, made, meter or Meter())
        if not is_new:
            campaign._take_up()
        return campaign

    def __repr__(self) -> str:
        done = f"{len(self._finished)} of {self.roads} roads"
        return f"Campaign({self.request.words!r}, seed {self.request.seed}, {done}, in {str(self.folder)!r})"

    @property
    def kept(self) -> tuple[int, ...]:
        """Numbers of the finished roads."""
        return tuple(sorted(self._finished))

    @property
    def is_complete(self) -> bool:
        """True if all roads are finished."""
        return len(self._finished) >= self.roads

    def __iter__(self) -> Iterator[Run]:
        """Yields the Runs that are still to be made, one by one; raises what ``all_runs`` raises."""
        return self._runs(with_earlier=False)

    def all_runs(self) -> Iterator[Run]:
        """Yields the Runs that exist, read from disk, then makes the missing ones and yields them.

        Raises:
            DesignError: no road could be designed; the folder is removed, unless it was there before.
            ChatError: a language model cannot be asked, or a limit is reached; the roads finished before this
                are saved.
            GivenUpError: the simulator failed three times in a row; the three roads have to be made again.
            UsageError: a plug-in is not installed, or another process is using the folder.
            RoadGPTError: a file cannot be written.
        """
        return self._runs(with_earlier=True)

    def _runs(self, with_earlier: bool) -> Iterator[Run]:
        with ExitStack() as stack:
            with self._writing():
                try:
                    stack.enter_context(held(self.folder / LOCK))
                except BlockingIOError as error:
                    raise UsageError(
                        f"another process is at work in {self.folder}; wait for it or name another folder"
                    ) from error
                is_finished = self._begin()
            if with_earlier:
                yield from self.earlier_runs()
            if not is_finished:
                yield from self._work()

    def _work(self) -> Iterator[Run]:
        """Makes the missing roads, and then the page of all of them."""
        try:
            yield from self._made_runs()
        except (DesignError, ChatError):
            with self._writing():
                self._go_without_trace()
            raise
        except BaseException:
            # however it ends, the tables tell of every road that is there
            with self._writing():
                self._tally.write(self.folder)
            raise
        with self._writing():
            self._tally.write(self.folder)
            if self.draw is not None:
                self.draw.of_campaign(self.folder)
            self._write_card(is_finished=True)

    def _made_runs(self) -> Iterator[Run]:
        """Makes road after road; each is written and counted before it is yielded.

        Roads that cannot be designed are held back until one can be: a description that no road can keep
        leaves no
        tests behind.
        """
        lacking = [index for index in range(1, self.roads + 1) if index not in self._finished]
        held_back: list[Run] = []
        for index in lacking:
            look()
            held_back.append(self._one(index))
            if held_back[-1].road is None and not self._tally.with_road:
                if len(held_back) == min(GIVE_UP, len(lacking)):
                    raise DesignError(held_back[-1].description)
                continue
            for run in held_back:
                with self._writing():
                    write_run(run, self.folder, self.draw)
                    self._count(run)
                    self._tally.write(self.folder)
                yield run
                if self._losses.count(run, run.is_lost):
                    self._give_up(run)
            held_back = []

    def _give_up(self, last: Run) -> NoReturn:
        """Removes the roads that the simulator lost, so that they are made when the campaign continues."""
        with self._writing():
            for run in self._losses.lost:
                remove_run(run.index, self.folder)
                self._tally.take_back(run)
                self._finished.discard(run.index)
        raise self._losses.given_up(
            last.description, f"fix it and continue with the same command and --out {self.folder}"
        )

    def _go_without_trace(self) -> None:
        """Removes what was made for roads that cannot be designed; earlier files stay."""
        if self._finished:
            self._tally.write(self.folder)
            return
        names = (CARD, DESCRIPTION, *TABLES, LOCK)
        take_away((self.folder / name for name in names), (self.folder / RUNS, *self.made))

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Turns an error of the system while writing into one clear sentence."""
        try:
            yield
        except OSError as error:
            raise RoadGPTError(
                f"cannot write into {self.folder}: {error.strerror or error}; make room there and continue "
                "with the same command and --out"
            ) from error

    def earlier_runs(self) -> Iterator[Run]:
        """Yields the Runs that an earlier session made, read from disk."""
        for index in self.kept:
            yield read_run(run_folder(self.folder, index))

    def _one(self, index: int) -> Run:
        earlier = self._designs[: bisect_left(self._numbers, index)]
        before = self.meter.spent
        try:
            return self.perform(index, earlier)
        except (DesignError, ReplyError) as error:
            own = seed_of(self.request.seed, index)
            spent = self.meter.spent.since(before)
            return Run(
                self.request,
                index,
                own,
                outcome="ERROR",
                description=str(error),
                spent=spent if spent.calls else None,
            )

    def _count(self, run: Run) -> None:
        self._finished.add(run.index)
        self._tally.add(run)
        if run.design is not None:
            place = bisect_left(self._numbers, run.index)
            self._numbers.insert(place, run.index)
            self._designs.insert(place, run.design)

    def _begin(self) -> bool:
        """Prepares the folder; returns True if the campaign is finished.

        Another process may have worked in it since it was opened.
        """
        if (self.folder / CARD).is_file() and self._take_up().is_finished and self.is_complete:
            return True
        refuse_links(self.folder / RUNS)
        sweep(self.folder)
        self._write_card(is_finished=False)
        (self.folder / RUNS).mkdir(exist_ok=True)
        sweep(self.folder / RUNS)
        write_description(self.request, self.roads, self.folder)
        return False

    def _write_card(self, is_finished: bool) -> None:
        card = Card(request=self.request, roads=self.roads, is_finished=is_finished)
        write_whole(self.folder / CARD, json_text(card.model_dump(mode="json")))

    def _take_up(self) -> Card:
        """Reads what is in the folder, and keeps the roads that are finished."""
        card = read_card(self.folder)
        there_was = card.request.essence()
        other = [name for name, value in self.request.essence() if getattr(there_was, name) != value]
        if other:
            raise UsageError(
                f"{self.folder} holds other roads (different {' and '.join(other)}); name another folder"
            )
        there = finished(self.folder)
        if there and there[-1] > self.roads:
            raise UsageError(
                f"{self.folder} holds road {there[-1]} already; ask for at least so many "
                "roads or name another folder"
            )
        for index in there:
            if index not in self._finished:
                self._keep(index)
        return card

    def _keep(self, index: int) -> None:
        """Counts a road that is there; one that cannot be read is made again."""
        try:
            run = read_run(run_folder(self.folder, index))
        except UsageError:
            return
        if run.index == index:
            self._count(run)
            if run.spent is not None:
                self.meter.add(run.spent)


def _may_lie_in_a_new_folder(path: Path) -> bool:
    """Checks for a file of a campaign that was stopped before it had a card."""
    return path.name == LOCK or (path.name.startswith(CARD) and path.name.endswith(PART))


def finished(folder: Path) -> list[int]:
    """Returns the numbers of the finished roads in a campaign's folder, in ascending order."""
    numbers = (path.name.split(".")[1] for path in folder.glob("test.*.json"))
    indices = sorted({int(number) for number in numbers if number.isdecimal()})
    return [
        index
        for index in indices
        if (folder / test_name(index)).is_file() and run_folder(folder, index).is_dir()
    ]
