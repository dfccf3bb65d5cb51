"""Runs a function on many items in several processes of this machine."""

import signal
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from roadgpt.provenance import NameOrigins, join, known
from roadgpt.stopping import look, shielded

T = TypeVar("T")
U = TypeVar("U")


def shared(function: Callable[[T], U], items: Iterable[T], workers: int) -> Iterator[U]:
    """Yields the result of ``function`` for every item as soon as it is ready; a single worker runs in this
    process.

    The workers end when the iteration is stopped, by Ctrl-C or otherwise.

    Args:
        function: A function at the top level of a module.
        items: The arguments of ``function``; with several workers, items and results must be picklable.
        workers: The number of processes.

    Raises:
        Exception: Any error that ``function`` raises.
    """
    if workers == 1:
        for item in items:
            look()
            yield function(item)
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import active_children, get_context

    before = {*active_children()}
    pool = ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_begun, initargs=(known(),)
    )
    try:
        with shielded():
            futures = [pool.submit(function, item) for item in items]
        for future in as_completed(futures):
            look()
            yield future.result()
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        ours = {*active_children()} - before
        for child in ours:
            child.terminate()
        for child in ours:
            # the pool's own thread waits for it as well, and only one of the two is told that it ended
            while child.is_alive():
                child.join(0.02)
        raise
    pool.shutdown()


def _begun(names: tuple[NameOrigins, NameOrigins]) -> None:
    """Prepares a worker: it leaves Ctrl-C to the first process, and learns from it whose code may run."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    join(names)
