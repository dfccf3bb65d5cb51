"""Trains a network in several processes, one per core, that regularly average their weights (local SGD)."""

import multiprocessing
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from multiprocessing.process import BaseProcess
from pathlib import Path

import torch

from roadgpt.errors import LearnError
from roadgpt.learn.generator import Pair
from roadgpt.learn.train import TrainingSettings, train


def train_together(
    folder: Path,
    pieces: Sequence[str],
    weights: Path | None,
    hand: Sequence[Pair],
    plan: TrainingSettings,
    report: Callable[[str], None],
) -> None:
    """Trains as ``train`` does, but with ``plan.workers`` processes; on a GPU, only one process is used.

    Raises:
        LearnError: a worker process ended before its work was done.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for left_over in folder.glob("weights-*"):  # left by a training that was stopped between two saves
        left_over.unlink()
    if torch.cuda.is_available():
        plan = replace(plan, workers=1)
    spawn = multiprocessing.get_context("spawn")
    others: list[BaseProcess] = [
        spawn.Process(
            target=_work,
            args=(folder, pieces, weights, hand, replace(plan, rank=rank), os.getpid()),
            daemon=True,
        )
        for rank in range(1, plan.workers)
    ]
    for worker in others:
        worker.start()
    threads = torch.get_num_threads()
    torch.set_num_threads(1 if others else threads)
    try:
        train(folder, pieces, weights, hand, plan, report, lambda: _all_there(others))
    finally:
        torch.set_num_threads(threads)
        for worker in others:
            worker.join(timeout=10)
            worker.kill()


def _work(
    folder: Path,
    pieces: Sequence[str],
    weights: Path | None,
    hand: Sequence[Pair],
    plan: TrainingSettings,
    parent: int,
) -> None:
    """Runs one worker."""
    torch.set_num_threads(1)
    train(folder, pieces, weights, hand, plan, lambda line: None, lambda: _not_alone(parent))


def _not_alone(parent: int) -> None:
    """Ends this worker if its parent was killed; otherwise the worker would run on and write into the folder
    of the next training.
    """
    if os.getppid() != parent:
        raise SystemExit(1)


def _all_there(workers: Sequence[BaseProcess]) -> None:
    for worker in workers:
        if worker.exitcode not in (None, 0):
            raise LearnError(
                f"a training process ended with status {worker.exitcode}; "
                "run the same command again to resume from the last checkpoint"
            )
