"""A driver that sees: a small convolutional network steers by the picture from behind the windscreen.

    roadgpt run "a winding road" -n 3 --driver examples/vision/small_network.py:SmallNetwork
    SPEED_KMH=40 roadgpt run ...                                    faster than its 25 km/h

Its shape is that of DAVE-2, with fewer channels (M. Bojarski et al., "End to end learning for self-driving
cars", 2016): five convolutions and three dense layers, 71 thousand numbers, which lie in small_network.npz
beside this file. ``train_small_network.py`` made them. Besides the picture it looks at the speedometer only.
"""

from pathlib import Path

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from pace import WHEELBASE, SpeedControl

from roadgpt.drive import Camera, Command

WEIGHTS = Path(__file__).with_name("small_network.npz")
CAMERA = Camera(width=200, height=66, field_of_view=0.87, down=0.25)
"""DAVE-2's picture; little of it is sky."""
STRIDES = (2, 2, 2, 1, 1)
SCALE = 0.1  # rad of steer for an output of 1
SMALL = 200_000
"""Multiplications of one product: larger ones are shared out among threads, which wait for each other longer
than they work wherever several drives go on side by side."""

Floats = NDArray[np.float32]


class SmallNetwork:
    """Steers as its network says."""

    name = "small_network"
    camera = CAMERA

    def __init__(self, weights: Path = WEIGHTS, speed_kmh: float | None = None) -> None:
        """With weights from a file of ``train_small_network.py``."""
        self.pace = SpeedControl(speed_kmh)
        with np.load(weights, allow_pickle=False) as file:
            self._weights = [file[name].astype(np.float32) for name in sorted(file.files)]

    def start(self, road, world, seed):
        """Forgets the road before; looks at nothing but the signs with the speed limit."""
        del road, seed
        self._limit, self._image, self._steer = world.limits.speed_limit, None, 0.0

    def steer(self, view):
        """A new answer for each new picture."""
        if view.image is not self._image:
            self._image, self._steer = view.image, SCALE * answer(self._weights, view.image)
        return Command(self._steer, *self.pace.pedals(view.speed, self._steer / WHEELBASE, self._limit))


def answer(weights: list[Floats], image: NDArray[np.uint8]) -> float:
    """What the network answers to a picture (66, 200, 3): 1 is 0.1 rad of the front wheels to the left.

    Args:
        weights: kernels (out, in, height, width) and matrices (out, in), each followed by its bias (out).
        image: bytes, red first.
    """
    layers = list(zip(weights[::2], weights[1::2], strict=True))
    x = image.transpose(2, 0, 1).astype(np.float32) / np.float32(127.5) - np.float32(1.0)
    for (kernel, bias), stride in zip(layers, STRIDES, strict=False):
        x = np.maximum(_convolved(x, kernel, bias, stride), 0)
    flat = x.ravel()
    for matrix, bias in layers[len(STRIDES) : -1]:
        flat = np.maximum(matrix @ flat + bias, 0)
    matrix, bias = layers[-1]
    return float((matrix @ flat + bias)[0])


def _convolved(x: Floats, kernel: Floats, bias: Floats, stride: int) -> Floats:
    """A convolution without a rim, as one product of matrices: (in, h, w) -> (out, h', w')."""
    windows = sliding_window_view(x, kernel.shape[2:], axis=(1, 2))[:, ::stride, ::stride]
    _, high, wide, *_ = windows.shape
    columns = windows.transpose(0, 3, 4, 1, 2).reshape(-1, high * wide)
    flat = kernel.reshape(len(kernel), -1)
    parts = np.array_split(columns, 1 + flat.shape[0] * columns.size // SMALL, axis=1)
    made: Floats = np.concatenate([flat @ part for part in parts], axis=1) + bias[:, None]
    return made.reshape(-1, high, wide)
