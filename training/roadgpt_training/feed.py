"""Makes training batches in several processes, because a GPU trains faster than one core makes pairs."""

import multiprocessing
from collections.abc import Callable, Iterator
from itertools import cycle
from multiprocessing.queues import Queue
from queue import Empty
from typing import Any

from roadgpt.errors import UsageError
from roadgpt_training.data import Numbers

Make = Callable[[int], Iterator[tuple[Numbers, Numbers]]]
"""A function that can be sent to another process, and yields the batches of a seed without end."""
WAITING = 24  # batches of each process that wait to be used; a process makes as many at a time
LONGEST = 300.0  # seconds until a process that sends nothing is taken for ended


def fed_batches(feeders: int, seed: int, make: Make) -> Iterator[tuple[Numbers, Numbers]]:
    """Yields batches that several processes make, from each in turn; the same seed gives the same batches.

    Args:
        feeders: number of processes.
        seed: seed of the series; every process has a series of its own.
        make: makes the batches of one process.

    Raises:
        UsageError: a process has ended.
    """
    spawn = multiprocessing.get_context("spawn")
    queues = [spawn.Queue(WAITING) for _ in range(feeders)]
    workers = [
        spawn.Process(target=_feed, args=(queue, seed * feeders + n, make), daemon=True)
        for n, queue in enumerate(queues)
    ]
    for worker in workers:
        worker.start()
    try:
        for queue in cycle(queues):
            yield queue.get(timeout=LONGEST)
    except Empty:
        raise UsageError("a process that makes training pairs has ended; start the training again") from None
    finally:
        for worker in workers:
            worker.kill()


def _feed(queue: "Queue[Any]", seed: int, make: Make) -> None:
    for batch in make(seed):
        queue.put(batch)
