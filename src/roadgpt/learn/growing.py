"""Makes trained weights fit a larger network, so that training goes on instead of beginning anew.

New tokens get small random embeddings. A new layer is a copy of the layer before it, but its outputs are
zero. Before further training, the larger network therefore writes the same plans as the smaller one; with
more encoder layers it does so nearly, because each of them normalises what passes through it.
"""

import re
from collections.abc import Mapping

import torch
from torch import Tensor

from roadgpt.errors import LearnError

LAYER = re.compile(r"decoder\.(\d+)\.(.+)")
ENCODER_LAYER = re.compile(r"layers\.(\d+)\.(.+)")
SILENT = ("own.out.", "across.out.", "narrow.")
"""How the names of the output weights of a decoder layer begin; these weights are zero in a new layer."""
SILENT_IN_ENCODER = ("attention.out.", "narrow.")
"""The same for the layers of the encoder."""
NORMS = ("norm.", "last_norm.")
SPREAD = 0.02


def decoder_layers(weights: Mapping[str, Tensor]) -> int:
    """Returns the number of decoder layers that the weights have."""
    return 1 + max(int(match[1]) for name in weights if (match := LAYER.match(name)))


def encoder_layers(weights: Mapping[str, Tensor]) -> int:
    """Returns the number of encoder layers that the weights have."""
    return 1 + max(int(match[1]) for name in weights if (match := ENCODER_LAYER.match(name)))


def deepened(weights: Mapping[str, Tensor], layers: int) -> dict[str, Tensor]:
    """Returns the weights with more encoder layers: each present layer is followed by silent copies.

    The norms of a copy have one mean and one spread, those that its input usually has, so that the copy
    changes its input little.

    Args:
        weights: the weights of the present network, keyed by parameter name.
        layers: the number of encoder layers of the new network: a multiple of the present number.

    Raises:
        LearnError: ``layers`` is not a multiple of the present number.
    """
    present = encoder_layers(weights)
    times, rest = divmod(layers, present)
    if rest or not times:
        raise LearnError(
            f"{present} encoder layers cannot grow to {layers}; "
            f"give a multiple of {present} with --encoder-layers"
        )
    out: dict[str, Tensor] = {}
    for name, value in weights.items():
        match = ENCODER_LAYER.match(name)
        if match is None:
            out[name] = value
            continue
        last = f"layers.{match[1]}.last_norm."
        scale, shift = weights[f"{last}weight"], weights[f"{last}bias"]
        mean = shift.mean()
        usual = {"weight": (scale.square().mean() + (shift - mean).square().mean()).sqrt(), "bias": mean}
        for copy in range(times):
            new = value.clone()
            if copy and match[2].startswith(SILENT_IN_ENCODER):
                new = torch.zeros_like(value)
            elif copy and match[2].startswith(NORMS):
                new = torch.full_like(value, float(usual[match[2].rsplit(".", 1)[1]]))
            out[f"layers.{int(match[1]) * times + copy}.{match[2]}"] = new
    return out


def grown(weights: Mapping[str, Tensor], tokens: int, layers: int, seed: int = 0) -> dict[str, Tensor]:
    """Returns the weights for a larger network, with more tokens or more decoder layers.

    Args:
        weights: the weights of the present network, keyed by parameter name.
        tokens: the number of tokens of the new network; not less than the present number.
        layers: the number of decoder layers of the new network: a multiple of the present number.
        seed: seed of the new tokens' embeddings.

    Raises:
        LearnError: ``tokens`` is too small, or ``layers`` is not a multiple of the present number.
    """
    present, old = decoder_layers(weights), weights["bias"].shape[0]
    times, rest = divmod(layers, present)
    if rest or not times or tokens < old:
        raise LearnError(
            f"{present} decoder layers and {old} tokens cannot grow to {layers} and {tokens}; give a "
            f"multiple of {present} with --decoder-layers"
        )
    out: dict[str, Tensor] = {}
    for name, value in weights.items():
        match = LAYER.match(name)
        if match is None:
            out[name] = value
            continue
        for copy in range(times):
            is_silent = copy > 0 and match[2].startswith(SILENT)
            out[f"decoder.{int(match[1]) * times + copy}.{match[2]}"] = (
                torch.zeros_like(value) if is_silent else value.clone()
            )
    generator = torch.Generator().manual_seed(seed)
    new = torch.randn((tokens - old, weights["tokens.weight"].shape[1]), generator=generator) * SPREAD
    out["tokens.weight"] = torch.cat([weights["tokens.weight"], new])
    out["bias"] = torch.cat([weights["bias"], torch.zeros(tokens - old)])
    return out
