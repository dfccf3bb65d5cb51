"""Begins and runs campaigns: one process schedules tests and writes the store, and workers run the tests.

begin     makes a folder with a store; the store holds the plan, its cells and their Briefs
work      runs the remaining tests; interruptions do not change the resulting tables"""

import shutil
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.csv_tables import CELLS, RESULTS, write_tables
from roadgpt.campaign.folder_record import cannot_go_on, has_tests, is_store
from roadgpt.campaign.given import FOLDER as ROADS
from roadgpt.campaign.given import changes, content_of, given_roads, write_roads
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Record, Store, no_tests, refusals
from roadgpt.campaign.run_folder import campaign
from roadgpt.campaign.scheduler import Scheduler
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.traces import SUFFIX, TRACES
from roadgpt.campaign.workers import LOG, WorkerConfig
from roadgpt.chat import ChatSettings, Meter, Spent
from roadgpt.chat.config import key_for
from roadgpt.design.room import world_for
from roadgpt.drive import refuse_ignored
from roadgpt.drive.loading import require_permission
from roadgpt.errors import UsageError
from roadgpt.road import World
from roadgpt.run import Draw, brief_of
from roadgpt.run.atomic import LOCK, alone_in, is_new, refuse_links, set_aside, sweep, take_away
from roadgpt.run.versions import Versions, versions_now

USER_NAMES = {
    "prompts": "descriptions",
    "budget": "number of tests or seconds",
    "drives": "choice whether to drive",
}
"""The names under which users know fields of a Plan."""


def begin(plan: Plan, folder: Path, again: bool = False, roads: Sequence[bytes] = ()) -> bool:
    """Makes a campaign's folder, and reads its descriptions into Briefs, or keeps the files of the ``roads``
    that the plan is given; returns True if the folder already held the same campaign. With ``again``, the
    results in the folder are set aside first."""
    plan.check()
    _admit(plan)
    _refuse_ignored(plan, plan.world)
    versions = versions_now(plan.requests())
    if again:
        set_aside(folder, STORE)
    if folder.is_dir() and not (folder / STORE).is_file() and not is_new(folder, STORE):
        raise UsageError(f"{folder} is not empty and holds no campaign; name another folder")
    with alone_in(folder), _without_trace(folder):
        if (folder / STORE).is_file():
            _same(plan, folder, versions)
            return True
        briefs, spent = _briefs(plan)
        cells = plan.cells(briefs)
        _refuse_ignored(plan, *(world_for(brief, plan.world) for brief in briefs.values()))
        for name in plan.generators:  # a wrong setting raises an error now
            plugins.find("generators", name)(next(cell for cell in cells if cell.generator == name))
        if roads:
            with refusals(folder):
                write_roads(folder, given_roads(plan.settings), roads)
        Store.new(folder, plan.model_dump_json(), cells, versions, spent).close()
        return False


@contextmanager
def _without_trace(folder: Path) -> Iterator[None]:
    try:
        yield
    except BaseException:
        if {path.name for path in folder.iterdir()} <= {LOCK, ROADS}:
            shutil.rmtree(folder / ROADS, ignore_errors=True)
            take_away([folder / LOCK], [folder])
        raise


def _admit(plan: Plan) -> None:
    """Raises UsageError or ChatError for drivers and servers that only a file names and the user does not
    permit, before anything is stored, paid for or begun."""
    if plan.drives:
        for driver in plan.drivers:
            require_permission(driver)
    if plan.chat is not None and plan.chat.replay is None and plan.asks_a_model:
        key_for(plan.chat.base_url)


def _refuse_ignored(plan: Plan, *worlds: World) -> None:
    for simulator in plan.simulators if plan.drives else ():
        for world in worlds:
            refuse_ignored(plugins.find("simulators", simulator), world)


def _briefs(plan: Plan) -> tuple[dict[str, Brief], Spent]:
    request, _ = next(plan.requests())
    meter = Meter.of(plan.chat)
    words = dict.fromkeys(text for text in plan.prompts if text.strip())
    return {text: brief_of(text, plan.world, request.setup, meter) for text in words}, meter.spent


def _same(plan: Plan, folder: Path, versions: dict[str, Versions]) -> None:
    with Store.opened(folder) as store:
        if store.keeps_runs:
            raise UsageError(f"{folder} holds runs of 'roadgpt run'; name another folder")
        there = store.plan()
        kept = there.essence()
        now = {road.name: road.source for road in given_roads(plan.settings)}
        values = [each for each in plan.essence() if not (now and each[0] == "settings")]
        other = [USER_NAMES.get(name, name) for name, value in values if getattr(kept, name) != value]
        other += changes(given_roads(kept.settings), now)
        if not other:  # the plan may now set a friction that came from the descriptions before
            cells = store.cells()
            briefs = {cell.request.words: cell.brief for cell in cells if cell.brief is not None}
            asked = zip(cells, plan.cells(briefs), strict=True)
            other = ["friction"] if any(a.request.world != b.request.world for a, b in asked) else []
        if other:
            raise UsageError(
                f"{folder} holds another campaign (different {', '.join(other)}); "
                "name another folder, add --again to make all its tests anew, "
                f"or resume it as it is: {store.to_resume()}"
            )
        store.refuse_changed(versions)
        store.set_plan(plan.model_dump_json())


def work(
    folder: Path,
    workers: int = 1,
    executor: str = "processes",
    address: str = "",
    chat: ChatSettings | None = None,
    draw: Draw | None = None,
    again: bool = False,
) -> Iterator[Counter[str]]:
    """Runs the remaining tests of a campaign, or of a folder that ``roadgpt run`` made, lazily: they run
    while the caller iterates. Yields the number of tests with each outcome after every group of results.

    ``chat`` replaces the stored settings of the language model, whose limits may differ. ``draw`` draws the
    roads of a folder of runs. With ``again``, the results are set aside first."""
    kind: Callable[[WorkerConfig], Executor] = plugins.find("executors", executor)
    if not is_store(folder):
        raise cannot_go_on(folder) if has_tests(folder) else no_tests(folder)
    with Record.opened(folder) as record:
        keeps_runs, plan = record.keeps_runs, record.plan()
    if keeps_runs:
        if executor != "processes":
            raise UsageError("the roads of 'roadgpt run' are made on this machine; leave out --executor")
        yield from _make_runs(folder, workers, chat, draw, again)
        return
    if again:
        begin(plan, folder, again, [content_of(road, folder) for road in given_roads(plan.settings)])
    with alone_in(folder), Store.opened(folder) as store:
        if chat is not None:
            plan = plan.model_copy(update={"chat": chat})
            store.set_plan(plan.model_dump_json())
        if not (is_finished := bool(store.meta("finished"))):
            _admit(plan)
        store.refuse_changed(versions_now(plan.requests(), loads=not is_finished))
        if not is_finished:
            with refusals(folder, store):
                _sweep(folder, store)
                setups = tuple(dict.fromkeys(request.setup for request, _ in plan.requests()))
                staff = WorkerConfig(workers, WorkerSetup(setups), plan.patience, folder / LOG, address)
                scheduler = Scheduler([store], staff, kind, plan.chat)
                for _ in scheduler.run():
                    yield scheduler.outcomes
        if not is_finished or not all((folder / name).is_file() for name in (RESULTS, CELLS)):
            with refusals(folder, store):
                write_tables(store, folder)
                store.finish()


def _make_runs(
    folder: Path, workers: int, chat: ChatSettings | None, draw: Draw | None, again: bool
) -> Iterator[Counter[str]]:
    with Record.opened(folder) as record:
        cell = record.cell("")
    request, roads = cell.request, cell.budget.most
    setup = request.setup if chat is None else request.setup.model_copy(update={"chat": chat})
    require_permission(setup.driver)
    words = cell.brief or request.words
    made = campaign(words, roads, request.seed, request.world, setup, folder, draw, None, again, workers)
    outcomes = Counter[str](one.result.outcome for one in made.tests.values())
    for run in made:
        outcomes[run.outcome] += 1
        yield outcomes


def _sweep(folder: Path, store: Store) -> None:
    """Removes what a killed process left: partial files, and drives whose results were not stored."""
    refuse_links(folder / TRACES, folder / LOG, folder / RESULTS, folder / CELLS)
    sweep(folder)
    if (folder / TRACES).is_dir():
        sweep(folder / TRACES)
        known = {name for (name,) in store.query("SELECT file FROM traces")}
        for path in (folder / TRACES).iterdir():
            if path.name not in known and path.suffix == SUFFIX and path.stem.isdecimal():
                path.unlink()
