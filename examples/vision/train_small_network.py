"""Trains the network of small_network.py: ``pip install -e '.[learn]'``, then

    python examples/vision/train_small_network.py

It drives roads of several descriptions by the driver ``reference``, whose steering is disturbed now and then,
and keeps pictures with what ``reference`` would have answered there; so the network learns to come back, too.
Then the network drives and ``reference`` looks on and says what it would have done, for those are the places
where the network comes to (S. Ross et al., "A reduction of imitation learning and structured prediction to
no-regret online learning", 2011). Everything is drawn from one seed.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from pace import SpeedControl
from small_network import CAMERA, SCALE, STRIDES, WEIGHTS, answer
from torch import nn

from roadgpt.drive import Command, simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.road import World
from roadgpt.run import Setup, brief_of, perform

PROMPTS = (
    "a road",
    "a winding road",
    "a flat road with 5 turns",
    "a hilly road with 4 turns",
    "an uphill road with 3 sharp turns",
    "a downhill road with 3 turns",
    "a serpentine road",
)
CHANNELS, DENSE = (12, 20, 32, 32, 32), (50, 10, 1)
KERNELS = (5, 5, 5, 3, 3)
FLAT = 32 * 1 * 18  # of a picture of 200 by 66 pixels
EVERY = 6  # control steps between two pictures that are kept
DISTURBED, CALM = 0.5, 1.3  # s, mean lengths of a push and of the pause after it
PUSH = 0.09  # rad, standard deviation
SPEEDS = 20.0, 50.0  # km/h

Weights = list[NDArray[np.float32]]


class Watched(Reference):
    """Drives with pushes, or lets the network drive; keeps what it saw and what it wanted."""

    camera = CAMERA._replace(every=EVERY)

    def __init__(self, rng: np.random.Generator, kmh: float, weights: Weights | None) -> None:
        super().__init__()
        self.rng, self.pace, self.weights = rng, SpeedControl(kmh), weights
        self.images: list[NDArray[np.uint8]] = []
        self.wanted: list[float] = []
        self._push, self._until, self._step, self._own = 0.0, 1.0, 0, 0.0

    def steer(self, view):
        """As ``reference``, and a push on top of it, or as the network."""
        wanted = super().steer(view)
        if self._step % EVERY == 0:
            self.images.append(view.image)
            self.wanted.append(wanted.steer / SCALE)
            if self.weights is not None:
                self._own = SCALE * answer(self.weights, view.image)
        self._step += 1
        if view.time >= self._until:
            calm = self._push != 0.0
            self._push = 0.0 if calm else self.rng.normal(0.0, PUSH)
            self._until = view.time + self.rng.exponential(CALM if calm else DISTURBED)
        steer = wanted.steer + self._push if self.weights is None else self._own
        pedals = self.pace.pedals(view.speed, wanted.steer / self.wheelbase)
        return Command(steer, *pedals)


def frames(
    seed: int, first: int, count: int, weights: Weights | None = None
) -> Iterator[tuple[NDArray[np.uint8], NDArray[np.float32]]]:
    """Pictures (n, 66, 200, 3) and answers (n,) of ``count`` roads, from the road ``first`` on."""
    setup, world = Setup(drives=False), World()
    briefs = [brief_of(words, world, setup) for words in PROMPTS]
    for index in range(first, first + count):
        rng = np.random.default_rng((seed, index))
        run = perform(briefs[index % len(briefs)], seed, world, setup, index + 1)
        if run.road is None or not run.is_valid:
            continue
        driver = Watched(rng, rng.uniform(*SPEEDS), weights)
        simulate(run.road, world, driver)
        if driver.wanted:
            yield np.array(driver.images), np.array(driver.wanted, np.float32)


def network() -> nn.Sequential:
    """Five convolutions and three dense layers."""
    layers: list[nn.Module] = []
    before = 3
    for channels, kernel, stride in zip(CHANNELS, KERNELS, STRIDES, strict=True):
        layers += [nn.Conv2d(before, channels, kernel, stride), nn.ReLU()]
        before = channels
    layers.append(nn.Flatten())
    before = FLAT
    for width in DENSE:
        layers += [nn.Linear(before, width), nn.ReLU()]
        before = width
    return nn.Sequential(*layers[:-1]).to(memory_format=torch.channels_last)


def fitted(
    model: nn.Sequential, images: torch.Tensor, wanted: torch.Tensor, epochs: int, rate: float
) -> Iterator[float]:
    """Trains; gives the mean loss of each epoch."""
    size = 64
    steps = epochs * (len(images) // size)
    optimizer = torch.optim.AdamW(model.parameters(), lr=rate, weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps + 1, pct_start=0.15)
    for _ in range(epochs):
        total, order = 0.0, torch.randperm(len(images))
        for batch in order[: len(order) // size * size].split(size):
            x = images[batch].permute(0, 3, 1, 2).float() / 127.5 - 1.0
            tone = 1.0 + 0.15 * torch.randn(len(x), 1, 1, 1)  # other light
            loss = nn.functional.smooth_l1_loss(
                model(x * tone + 0.1 * torch.randn_like(tone))[:, 0], wanted[batch], beta=0.3
            )
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss.detach())
        yield total / (len(order) // size)


def weights_of(model: nn.Sequential) -> Weights:
    """Kernels, matrices and biases in their order."""
    return [np.ascontiguousarray(value.detach().numpy()) for value in model.parameters()]


def main() -> None:
    """Drive, train, let it drive, train on, keep."""
    parser = argparse.ArgumentParser(description="Train the network of small_network.py.")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--roads", type=int, default=21, help="in each round")
    parser.add_argument("--rounds", type=int, default=1, help="after the first, in which the network drives")
    parser.add_argument("--epochs", type=int, default=4)
    parser.add_argument("--out", type=Path, default=WEIGHTS)
    given = parser.parse_args()
    torch.manual_seed(given.seed)
    torch.set_num_threads(1)  # so small a network is trained as fast by one, and always alike
    model = network()
    print(f"{sum(value.numel() for value in model.parameters()):,} parameters")
    kept: list[tuple[NDArray[np.uint8], NDArray[np.float32]]] = []
    for number in range(given.rounds + 1):
        driving = None if number == 0 else weights_of(model)
        for made in frames(given.seed, number * given.roads, given.roads, driving):
            kept.append(made)
        images = torch.from_numpy(np.concatenate([each for each, _ in kept]))
        wanted = torch.from_numpy(np.concatenate([each for _, each in kept]))
        print(f"round {number}: {len(images):,} pictures, {time.process_time():.0f} s of processor time")
        for loss in fitted(model, images, wanted, given.epochs, 1.5e-3 if number == 0 else 1e-3):
            print(f"  loss {loss:.4f}, {time.process_time():.0f} s", flush=True)
        np.savez(given.out, **{f"{place:02d}": each for place, each in enumerate(weights_of(model))})
    print(f"kept in {given.out}")


if __name__ == "__main__":
    main()
