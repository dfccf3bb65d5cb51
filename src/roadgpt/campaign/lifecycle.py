"""Begins and runs campaigns: one process schedules tests and writes the store, and workers run the tests.

begin     makes a folder with a store, which holds the plan and its cells with their Briefs
work      runs the tests that have not ended; interruptions do not change the resulting tables
"""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.executors import Executor, WorkerConfig
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Record, no_campaign
from roadgpt.campaign.scheduler import Progress, Scheduler
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.store import Store, refused
from roadgpt.campaign.store_check import reading_store
from roadgpt.campaign.table import CELLS, RESULTS, write_tables
from roadgpt.campaign.traces import OLD_SUFFIX, SUFFIX, TRACES
from roadgpt.campaign.workers.worker_log import LOG
from roadgpt.chat import Meter, Spent
from roadgpt.chat.config import key_for
from roadgpt.drive import refuse_ignored
from roadgpt.drive.isolation import driver_of
from roadgpt.drive.permission import require_permission
from roadgpt.errors import UsageError
from roadgpt.run import Setup, brief_of
from roadgpt.run.atomic import LOCK, alone_in, refuse_links, sweep
from roadgpt.run.versions import versions_of

USER_NAMES = {
    "prompts": "descriptions",
    "budget": "number of tests or seconds",
    "drives": "choice whether to drive",
}
"""The names under which users know fields of a Plan."""


def begin(plan: Plan, folder: Path) -> bool:
    """Prepares a campaign's folder: makes it, or checks that it already holds the same campaign.

    If the campaign is new, its descriptions are read into Briefs.

    Returns:
        True if the folder held the campaign already.

    Raises:
        UsageError: the plan cannot be carried out, or the folder holds something other than this campaign.
        DriverError: a driver did not finish its constructor in time.
        BriefError: a description cannot be read.
        ChatError: the language model that reads the descriptions did not answer.
    """
    plan.check()
    _admit(plan)
    _is_free(folder)
    with alone_in(folder), _without_trace(folder):
        if (folder / STORE).is_file():
            _same(plan, folder)
            return True
        _drivers_come(plan)
        briefs, spent = _briefs(plan)
        cells = plan.cells(briefs)
        for name in plan.generators:  # one that cannot use its settings says so now
            plugins.find("generators", name)(next(cell for cell in cells if cell.generator == name))
        versions = versions_of(cells[0].request.setup)
        Store.new(folder, plan.model_dump_json(), cells, versions, spent).close()
        return False


def _is_free(folder: Path) -> None:
    """Refuses a folder that holds something else."""
    if not folder.is_dir() or (folder / STORE).is_file():
        return
    if any(path.name != LOCK and not path.name.startswith(STORE) for path in folder.iterdir()):
        raise UsageError(f"{folder} is not empty and holds no campaign; name another folder")


@contextmanager
def _without_trace(folder: Path) -> Iterator[None]:
    """Removes the folder again if an error leaves nothing in it."""
    try:
        yield
    except BaseException:
        if [path.name for path in folder.iterdir()] == [LOCK]:
            with suppress(OSError):  # Windows removes no file that is open
                (folder / LOCK).unlink()
                folder.rmdir()
        raise


def _admit(plan: Plan) -> None:
    """Asks about code and servers that came with files, before anything is stored, paid for or begun.

    Raises:
        UsageError: a driver of the plan is code that the user does not name.
        ChatError: a server of the plan is one that the user does not name, and they have a key.
    """
    if plan.drives:
        for driver in plan.drivers:
            require_permission(driver)
    if plan.chat is not None and plan.chat.replay is None and plan.asks_a_model:
        key_for(plan.chat.base_url)


def _drivers_come(plan: Plan) -> None:
    """Reports a wrong name of a driver, and a setting that a simulator cannot obey, before anything is paid
    for."""
    if plan.drives:
        for simulator in plan.simulators:
            refuse_ignored(plugins.find("simulators", simulator), plan.world)
        for driver in dict.fromkeys(plan.drivers):
            driver_of(driver)


def _briefs(plan: Plan) -> tuple[dict[str, Brief], Spent]:
    """Returns what is read from each description, and what that cost."""
    request, _ = next(plan.requests())
    meter = Meter.of(plan.chat)
    words = dict.fromkeys(text for text in plan.prompts if text.strip())
    return {text: brief_of(text, plan.world, request.setup, meter) for text in words}, meter.spent


def _same(plan: Plan, folder: Path) -> None:
    with Store.opened(folder) as store:
        there = plan_of(store)
        kept = there.essence()
        other = [USER_NAMES.get(name, name) for name, value in plan.essence() if getattr(kept, name) != value]
        if other:
            raise UsageError(
                f"{folder} holds another campaign (different {', '.join(other)}); "
                "name another folder, "
                f"or resume it as it is: roadgpt resume {folder}"
            )
        store.set_plan(plan.model_dump_json())


def plan_of(record: Record) -> Plan:
    """Returns the plan that a store holds."""
    with reading_store(record.path):
        return Plan.model_validate_json(record.meta("plan")).came_with(record.path)


def work(
    folder: Path, workers: int = 1, executor: str = "processes", address: str = "", plan: Plan | None = None
) -> Iterator[Progress]:
    """Runs the tests of a campaign that have not ended; the work happens while the caller iterates.

    Args:
        folder: the campaign's folder, made by ``begin``.
        workers: number of workers.
        executor: name of an installed executor.
        address: address of the workers, for executors that connect to other machines.
        plan: the campaign's plan with changed limits; None: the stored plan.

    Yields:
        The progress, after every group of results.

    Raises:
        UsageError: there is no campaign, or another process is working on it, or a plug-in is not installed.
        ChatError: a language model could not be asked, or a limit is reached; finished tests are stored.
        RoadGPTError: a file cannot be written, or there are no workers.
    """
    kind: type[Executor] = plugins.find("executors", executor)
    if not (folder / STORE).is_file():
        raise no_campaign(folder)
    with alone_in(folder), Store.opened(folder) as store:
        if plan is not None:
            store.set_plan(plan.model_dump_json())
        else:
            plan = plan_of(store)
        if not store.meta("finished"):
            _admit(plan)
            try:
                _sweep(folder, store)
                staff = WorkerConfig(
                    workers, WorkerSetup(_setups(plan)), plan.patience, folder / LOG, address
                )
                yield from Scheduler(store, staff, kind, plan.budget.tests, plan.chat).run()
            except (OSError, sqlite3.Error) as error:
                raise refused(folder, error) from error
        if not store.meta("finished") or not all((folder / name).is_file() for name in (RESULTS, CELLS)):
            _conclude(folder, store)


def _setups(plan: Plan) -> tuple[Setup, ...]:
    return tuple(dict.fromkeys(request.setup for request, _ in plan.requests()))


def _conclude(folder: Path, store: Store) -> None:
    try:
        write_tables(store, folder)
        store.finish()
    except (OSError, sqlite3.Error) as error:
        raise refused(folder, error) from error


def _sweep(folder: Path, store: Store) -> None:
    """Removes what a killed process left: partial files, and drives whose results were not stored."""
    refuse_links(folder / TRACES, folder / LOG, folder / RESULTS, folder / CELLS)
    sweep(folder)
    if (folder / TRACES).is_dir():
        sweep(folder / TRACES)
        known = {name for (name,) in store.query("SELECT file FROM traces")}
        for path in (folder / TRACES).iterdir():
            if path.name not in known and path.suffix in (SUFFIX, OLD_SUFFIX) and path.stem.isdecimal():
                path.unlink()


__all__: Sequence[str] = ("begin", "plan_of", "work")
