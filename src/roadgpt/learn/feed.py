"""Makes training batches in several processes, because a GPU trains faster than one core makes pairs."""

import multiprocessing
from collections.abc import Iterator, Mapping, Sequence
from itertools import cycle
from multiprocessing.queues import Queue
from queue import Empty
from typing import Any

from roadgpt.brief.readers.model.wordpiece import WordPieces
from roadgpt.errors import LearnError
from roadgpt.learn.data import Numbers, batches, examples
from roadgpt.learn.generator import Pair

WAITING = 6  # batches of each process that wait to be used
LONGEST = 300.0  # seconds until a process that sends nothing is taken for ended


def fed_batches(
    feeders: int,
    seed: int,
    hand: Sequence[Pair],
    pieces: Sequence[str],
    shares: Mapping[str, float],
    size: int,
    pool: int,
) -> Iterator[tuple[Numbers, Numbers]]:
    """Yields batches that several processes make, from each in turn; the same seed gives the same batches.

    Args:
        feeders: number of processes.
        seed: seed of the series; every process has a series of its own.
        hand: the hand-written pairs.
        pieces: the vocabulary of word pieces.
        shares: the share of each series of pairs, by the name of the series.
        size: number of examples in a batch.
        pool: number of batches cut from one group of examples.

    Raises:
        LearnError: a process has ended.
    """
    spawn = multiprocessing.get_context("spawn")
    queues = [spawn.Queue(WAITING) for _ in range(feeders)]
    workers = [
        spawn.Process(
            target=_feed, args=(queue, seed * feeders + n, hand, pieces, shares, size, pool), daemon=True
        )
        for n, queue in enumerate(queues)
    ]
    for worker in workers:
        worker.start()
    try:
        for queue in cycle(queues):
            yield queue.get(timeout=LONGEST)
    except Empty:
        raise LearnError("a process that makes training pairs has ended; start the training again") from None
    finally:
        for worker in workers:
            worker.kill()


def _feed(
    queue: "Queue[Any]",
    seed: int,
    hand: Sequence[Pair],
    pieces: Sequence[str],
    shares: Mapping[str, float],
    size: int,
    pool: int,
) -> None:
    """Runs one process: puts batches into the queue without end."""
    for batch in batches(examples(seed, hand, WordPieces(pieces), shares), size, pool, seed):
        queue.put(batch)
