"""Makes trained weights fit a larger network, so that training goes on instead of beginning anew.

New tokens get small random embeddings. A new layer is a copy of the layer before it, but its outputs are
zero. Before further training, the larger network therefore writes the same plans as the smaller one. With
more encoder layers, the plans are only nearly the same, because each new layer normalises its input.
"""

from collections.abc import Mapping

import torch
from torch import Tensor

from roadgpt.errors import UsageError
from roadgpt_training.network import DECODER, ENCODER, layers_of

SILENT = ("attention.out.", "own.out.", "across.out.", "narrow.")
"""The output weights of a layer, by how their names go on after the layer's number; zero in a new layer."""
NORMS = ("norm.", "last_norm.")
"""The norms of an encoder layer, by how their names go on after the layer's number."""
SPREAD = 0.02


def deepened(weights: Mapping[str, Tensor], layers: int) -> dict[str, Tensor]:
    """Returns the weights with more encoder layers: each present layer is followed by silent copies. The
    norms of a copy give the copy's output the mean and the spread that the copy's input usually has.
    Therefore the copy changes its input little.

    Raises:
        UsageError: ``layers``, the new number of encoder layers, is not a multiple of the present number.
    """
    present = layers_of(weights, ENCODER)
    times, rest = divmod(layers, present)
    if rest or not times:
        raise UsageError(
            f"{present} encoder layers cannot grow to {layers}; "
            f"give a multiple of {present} with --encoder-layers"
        )
    out = _with_copies(weights, ENCODER, times)
    for first in range(0, layers, times):
        last = f"{ENCODER}{first}.{NORMS[-1]}"
        scale, shift = out[f"{last}weight"], out[f"{last}bias"]
        mean = shift.mean()
        spread = (scale.square().mean() + (shift - mean).square().mean()).sqrt()
        for copy in range(first + 1, first + times):
            for norm in NORMS:
                out[f"{ENCODER}{copy}.{norm}weight"] = torch.full_like(scale, float(spread))
                out[f"{ENCODER}{copy}.{norm}bias"] = torch.full_like(shift, float(mean))
    return out


def grown(weights: Mapping[str, Tensor], tokens: int, layers: int, seed: int = 0) -> dict[str, Tensor]:
    """Returns the weights for a network with more tokens or more decoder layers. The embeddings of
    new tokens are random, with the seed ``seed``.

    Raises:
        UsageError: ``tokens`` is too small, or ``layers`` is not a multiple of the present number.
    """
    present, old = layers_of(weights, DECODER), weights["bias"].shape[0]
    times, rest = divmod(layers, present)
    if rest or not times or tokens < old:
        raise UsageError(
            f"{present} decoder layers and {old} tokens cannot grow to {layers} and {tokens}; give a "
            f"multiple of {present} with --decoder-layers"
        )
    out = _with_copies(weights, DECODER, times)
    generator = torch.Generator().manual_seed(seed)
    new = torch.randn((tokens - old, weights["tokens.weight"].shape[1]), generator=generator) * SPREAD
    out["tokens.weight"] = torch.cat([weights["tokens.weight"], new])
    out["bias"] = torch.cat([weights["bias"], torch.zeros(tokens - old)])
    return out


def _with_copies(weights: Mapping[str, Tensor], part: str, times: int) -> dict[str, Tensor]:
    """Returns the weights with each layer of a part followed by silent copies, ``times`` layers in all."""
    out: dict[str, Tensor] = {}
    for name, value in weights.items():
        if not name.startswith(part):
            out[name] = value
            continue
        _, layer, own = name.split(".", 2)
        for copy in range(times):
            is_silent = copy > 0 and own.startswith(SILENT)
            new = torch.zeros_like(value) if is_silent else value.clone()
            out[f"{part}{int(layer) * times + copy}.{own}"] = new
    return out
