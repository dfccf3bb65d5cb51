"""Trains the network: seeded, resumable from a checkpoint, with progress reports and a loss curve."""

import json
import math
import multiprocessing
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import torch
from torch import nn
from torch.nn import functional

from roadgpt.errors import UsageError
from roadgpt_training.data import TOKENS_OF, Numbers, training_batches
from roadgpt_training.feed import fed_batches
from roadgpt_training.growing import deepened, grown
from roadgpt_training.network import (
    DECODER,
    ENCODER,
    NetworkSizes,
    ReaderNetwork,
    layers_of,
    load_minilm,
    network_of,
)
from roadgpt_training.onnx_weights import exported_weights
from roadgpt_training.pair import Pair

POOL = 24  # number of batches whose examples are sorted by length together
SMOOTHING = 0.03
WARM_UP = 150  # steps at the start, in which the learning rate rises linearly
SAVE_EVERY = 100  # steps from one checkpoint to the next
SLOW_IN_BFLOAT16 = ("DEFAULT", "NO AVX", "AVX2")
"""Kinds of processors that multiply numbers of 16 bits some 70 times as slowly as numbers of 32 bits."""
FROZEN = ("pieces", "places", "kind", "norm")
"""Names of the encoder's embeddings, which are not trained, so that words that occur in no pair keep their
meaning."""


@dataclass(frozen=True, slots=True)
class TrainingSettings:
    """Settings of a training run."""

    steps: int = 14_000
    """Number of batches that each process trains on."""
    size: int = 48
    """Number of pairs in a batch."""
    encoder_rate: float = 1.5e-4
    """Highest learning rate of the encoder."""
    decoder_rate: float = 7e-4
    """Highest learning rate of the decoder."""
    cool_down: float = 0.3
    """Fraction of all steps (0 to 1), at the end of training, during which the learning rate falls to
    zero.
    """
    frozen_layers: int = 0
    """Number of encoder layers, from the lowest, that are not trained."""
    decoder_layers: int | None = None
    """Number of decoder layers. If training starts from an exported reader, give a multiple of the reader's
    number of decoder layers, or None to keep this number. For a new network, None means 3.
    """
    encoder_layers: int | None = None
    """Number of encoder layers: a multiple of the exported reader's number, or None to keep this number."""
    feeders: int = 0
    """Number of processes that make the batches; 0 makes them in the training process itself."""
    ending: str = ""
    """What follows 'encoder' and 'decoder' in the file names of the network that training starts from."""
    seed: int = 1
    workers: int = 1
    """Number of processes that train in parallel and average their weights at each checkpoint (local SGD)."""
    rank: int = 0
    """Number of this process, from 0; the process 0 writes the checkpoints."""
    network: str = "roads"
    """What the network reads: "roads" (and changes), or "routes" (and maps and texts of the field); it learns
    from other pairs for each.
    """


def train(
    folder: Path,
    pieces: Sequence[str],
    weights: Path | None,
    hand: Sequence[Pair],
    plan: TrainingSettings,
    report: Callable[[str], None],
    check: Callable[[], None],
) -> None:
    """Trains a network, and writes ``checkpoint.pt`` and ``losses.jsonl`` into the folder. The training
    begins with the checkpoint in the folder, or with ``weights`` if there is none.

    Args:
        folder: the folder of the training.
        pieces: the vocabulary of word pieces.
        weights: ``model.safetensors`` of all-MiniLM-L6-v2, or the folder of an exported reader; None if the
            folder has a checkpoint.
        hand: hand-written pairs for training.
        plan: settings of the training.
        report: called with a progress line from time to time.
        check: called before every step and while waiting for other workers; raises an error if a worker has
            ended.
    """
    folder.mkdir(parents=True, exist_ok=True)
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    torch.manual_seed(plan.seed)
    checkpoint = folder / "checkpoint.pt"
    state: dict[str, Any] = {}
    if checkpoint.exists():
        state = torch.load(checkpoint, map_location="cpu", weights_only=True)
    reader = _started(state.get("reader"), weights, pieces, plan).to(device)
    optimiser = _optimiser(reader, plan)
    if state:
        optimiser.load_state_dict(state["optimiser"])
    first = int(state.get("step", 0))
    # each start has its own stream, so that a resumed training does not see the same pairs again
    seed = (plan.seed * 1_000_003 + first) * 16 + plan.rank
    make = partial(
        training_batches, hand=hand, pieces=pieces, network=plan.network, size=plan.size, pool=POOL
    )
    stream = fed_batches(plan.feeders, seed, make) if plan.feeders else make(seed)
    began = time.monotonic()
    losses: list[torch.Tensor] = []
    reader.train()
    for step in range(first, plan.steps):
        check()
        losses.append(_step(reader, optimiser, next(stream), _rate(step, plan), device))
        if (step + 1) % 50 == 0 and plan.rank == 0:
            _note(folder, step + 1, plan, losses, (step + 1 - first) / (time.monotonic() - began), report)
            losses.clear()
        if (step + 1) % SAVE_EVERY == 0 or step + 1 == plan.steps:
            if plan.workers > 1:
                average(folder, reader, plan, step + 1, check)
            if plan.rank == 0:
                networks = {"reader": reader.state_dict(), "optimiser": optimiser.state_dict()}
                _save({**networks, "step": step + 1}, checkpoint)


def _started(
    kept: dict[str, torch.Tensor] | None, weights: Path | None, pieces: Sequence[str], plan: TrainingSettings
) -> ReaderNetwork:
    """Returns the network with the weights of a checkpoint, of an exported reader or of MiniLM.

    Raises:
        UsageError: there are no such weights.
    """
    tokens = len(TOKENS_OF[plan.network])
    if kept is None and weights and weights.is_dir():
        exported = exported_weights(weights, plan.ending)
        kept = {name: torch.from_numpy(array) for name, array in exported.items()}
        kept = grown(kept, tokens, plan.decoder_layers or layers_of(kept, DECODER), plan.seed)
        kept = deepened(kept, plan.encoder_layers or layers_of(kept, ENCODER))
    if kept:
        return network_of(kept, len(pieces), tokens)
    if weights is None:
        raise UsageError("a new training starts from --weights, or from the reader that is --installed")
    layers = plan.decoder_layers or NetworkSizes().decoder_layers
    reader = ReaderNetwork(NetworkSizes(pieces=len(pieces), tokens=tokens, decoder_layers=layers))
    load_minilm(reader, weights, pieces)
    return reader


def _optimiser(reader: nn.Module, plan: TrainingSettings) -> torch.optim.Optimizer:
    own = ("tokens", "plan_places", "decoder", "final", "bias")
    groups: dict[bool, list[nn.Parameter]] = {True: [], False: []}
    for name, parameter in reader.named_parameters():
        room = name.split(".")[0]
        is_frozen = name.startswith(tuple(f"layers.{index}." for index in range(plan.frozen_layers)))
        parameter.requires_grad_(not (is_frozen or room in FROZEN))
        groups[room in own].append(parameter)
    return torch.optim.AdamW(
        [
            {"params": groups[False], "lr": plan.encoder_rate, "top": plan.encoder_rate},
            {"params": groups[True], "lr": plan.decoder_rate, "top": plan.decoder_rate},
        ],
        betas=(0.9, 0.98),
        weight_decay=0.01,
        fused=True,
    )


def _rate(step: int, plan: TrainingSettings) -> float:
    """Returns the share of the full learning rate: a linear rise, a constant part, a cosine fall."""
    if step < WARM_UP:
        return (step + 1) / WARM_UP
    left = (plan.steps - step) / max(1.0, plan.cool_down * plan.steps)
    return 1.0 if left >= 1 else 0.5 - 0.5 * math.cos(math.pi * left)


def _step(
    reader: ReaderNetwork,
    optimiser: torch.optim.Optimizer,
    batch: tuple[Numbers, Numbers],
    rate: float,
    device: torch.device,
) -> torch.Tensor:
    for group in optimiser.param_groups:
        group["lr"] = group["top"] * rate
    pieces, tokens = (torch.from_numpy(part).to(device) for part in batch)
    with torch.autocast(device.type, torch.bfloat16, enabled=_is_fast_in_bfloat16(device)):
        scores = reader(pieces, tokens[:, :-1])
    loss = functional.cross_entropy(
        scores.float().flatten(0, 1), tokens[:, 1:].flatten(), ignore_index=0, label_smoothing=SMOOTHING
    )
    optimiser.zero_grad(set_to_none=True)
    loss.backward()
    nn.utils.clip_grad_norm_(reader.parameters(), 1.0)
    optimiser.step()
    return loss.detach()  # a tensor: to ask for its number here would make the GPU wait


def _is_fast_in_bfloat16(device: torch.device) -> bool:
    return device.type != "cpu" or torch.backends.cpu.get_cpu_capability() not in SLOW_IN_BFLOAT16


def _note(
    folder: Path,
    step: int,
    plan: TrainingSettings,
    losses: list[torch.Tensor],
    speed: float,
    report: Callable[[str], None],
) -> None:
    loss = float(sum(losses)) / len(losses)
    with (folder / "losses.jsonl").open("a", encoding="utf-8") as file:
        file.write(
            json.dumps({"step": step, "pairs": step * plan.size * plan.workers, "loss": round(loss, 4)})
            + "\n"
        )
    left = (plan.steps - step) / speed
    report(
        f"step {step}/{plan.steps}  loss {loss:.4f}"
        f"  {speed * plan.size * plan.workers:.0f} pairs/s  {left / 60:.0f} min left"
    )


def average(
    folder: Path, reader: nn.Module, plan: TrainingSettings, step: int, check: Callable[[], None]
) -> None:
    """Saves the weights of ``reader``, waits until all workers have saved theirs at this step, and loads the
    mean of all weights into ``reader``.
    """
    _save(reader.state_dict(), folder / f"weights-{step}-{plan.rank}.pt")
    paths = [folder / f"weights-{step}-{rank}.pt" for rank in range(plan.workers)]
    while not all(path.exists() for path in paths):
        check()
        time.sleep(0.2)
    states = [torch.load(path, map_location="cpu", weights_only=True) for path in paths]
    reader.load_state_dict({name: sum(state[name] for state in states) / len(states) for name in states[0]})
    older = folder / f"weights-{step - SAVE_EVERY}-{plan.rank}.pt"
    older.unlink(missing_ok=True)  # by now every worker has read it


def _save(state: dict[str, Any], path: Path) -> None:
    """Writes a file completely or not at all, by way of a temporary file."""
    beside = path.with_suffix(".new")
    torch.save(state, beside)
    beside.replace(path)


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
        UsageError: a worker process ended before its work was done.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for left_over in folder.glob("weights-*"):  # left by a training that was stopped between two saves
        left_over.unlink()
    if torch.cuda.is_available():
        plan = replace(plan, workers=1)
    spawn = multiprocessing.get_context("spawn")
    task = partial(train, folder, pieces, weights, hand)
    others: list[BaseProcess] = [
        spawn.Process(target=_work, args=(task, replace(plan, rank=rank), os.getpid()), daemon=True)
        for rank in range(1, plan.workers)
    ]
    for worker in others:
        worker.start()
    threads = torch.get_num_threads()
    torch.set_num_threads(1 if others else threads)
    try:
        task(plan, report, lambda: _all_there(others))
    finally:
        torch.set_num_threads(threads)
        for worker in others:
            worker.join(timeout=10)
            worker.kill()


def _work(task: Callable[..., None], plan: TrainingSettings, parent: int) -> None:
    """Runs ``train`` in one worker."""
    torch.set_num_threads(1)
    task(plan, lambda line: None, lambda: _not_alone(parent))


def _not_alone(parent: int) -> None:
    """Ends this worker if its parent was killed; otherwise the worker would run on and write into the folder
    of the next training.
    """
    if os.getppid() != parent:
        raise SystemExit(1)


def _all_there(workers: Sequence[BaseProcess]) -> None:
    for worker in workers:
        if worker.exitcode not in (None, 0):
            raise UsageError(
                f"a training process ended with status {worker.exitcode}; "
                "run the same command again to resume from the last checkpoint"
            )
