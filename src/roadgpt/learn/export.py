"""Exports the trained network as two ONNX graphs in int8: the encoder, and one step of the decoder."""

import json
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from hashlib import sha256
from itertools import islice
from pathlib import Path

import torch
from torch import Tensor, nn

from roadgpt.brief.readers.model import FILES
from roadgpt.brief.readers.model.coverage import Coverage
from roadgpt.brief.readers.model.network import Network
from roadgpt.brief.readers.model.vocabulary import TOKENS
from roadgpt.errors import LearnError
from roadgpt.learn.calibrate import calibrated
from roadgpt.learn.generator import Pair, pairs
from roadgpt.learn.known_words import known_words
from roadgpt.learn.network import NetworkSizes, ReaderNetwork
from roadgpt.learn.piece_vocabulary import read_vocabulary
from roadgpt.learn.pretrained import NOTICE

OPSET = 17
COUNTED = 20_000
"""Number of generated pairs in which words are counted to find those that the reader has learnt."""


class EncoderGraph(nn.Module):
    """Maps pieces (batch, n) to keys and values of shape (layers, 2, batch, heads, n, head size)."""

    def __init__(self, reader: ReaderNetwork) -> None:
        super().__init__()
        self.reader = reader

    def forward(self, pieces: Tensor) -> Tensor:
        """Returns the keys and values of a description; pieces with the number 0 are padding."""
        seen = (pieces == 0)[:, None, None, :] * -1e4
        memory = self.reader.encode(pieces, seen)
        return torch.stack([torch.stack(pair) for pair in self.reader.start(memory)])


class DecoderGraph(nn.Module):
    """One step of the decoder, which takes the last token of a plan and scores the next one.

    Inputs, for a plan of t tokens so far: ``token`` (batch, 1); ``place`` (1,), the position of the token;
    ``own`` (layers, 2, batch, heads, t, head size), the keys and values of the plan so far; ``across``, the
    keys and values of the description; ``seen`` (batch, 1, 1, n), the mask of the description. Outputs: the
    scores (batch, tokens), and ``own`` with t + 1 tokens.
    """

    def __init__(self, reader: ReaderNetwork) -> None:
        super().__init__()
        self.reader = reader

    def forward(
        self, token: Tensor, place: Tensor, own: Tensor, across: Tensor, seen: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Returns the scores of the next token, and ``own`` extended by the keys and values of ``token``."""
        reader = self.reader
        x = reader.tokens(token) + reader.plan_places(place)
        kept: list[Tensor] = []
        for index, layer in enumerate(reader.decoder):
            key, value = layer.own_keys(x)
            key = torch.cat([own[index, 0], key], 2)
            value = torch.cat([own[index, 1], value], 2)
            kept.append(torch.stack([key, value]))
            x = layer(x, (key, value), (across[index, 0], across[index, 1]), None, seen)
        return reader.scores(x)[:, 0], torch.stack(kept)


def export(reader: ReaderNetwork, folder: Path) -> None:
    """Writes the network to ``encoder.onnx`` and ``decoder.onnx``, with weights in int8."""
    from onnxruntime.quantization import QuantType, quantize_dynamic
    from onnxruntime.quantization.shape_inference import quant_pre_process

    folder.mkdir(parents=True, exist_ok=True)
    reader.train(False)
    for name, graph, inputs, names, outputs, axes in _graphs(reader):
        with tempfile.TemporaryDirectory() as beside:
            raw, ready = Path(beside) / "raw.onnx", Path(beside) / "ready.onnx"
            torch.onnx.export(
                graph, inputs, str(raw), input_names=names, output_names=outputs, dynamic_axes=axes,
                opset_version=OPSET, dynamo=False, do_constant_folding=True,
            )  # fmt: skip
            quant_pre_process(str(raw), str(ready), skip_symbolic_shape=True)
            quantize_dynamic(
                str(ready), str(folder / f"{name}.onnx"), weight_type=QuantType.QInt8, per_channel=True,
                op_types_to_quantize=["MatMul", "Gather", "Gemm"],
            )  # fmt: skip


def _graphs(
    reader: ReaderNetwork,
) -> Sequence[tuple[str, nn.Module, tuple[Tensor, ...], list[str], list[str], dict[str, dict[int, str]]]]:
    shape: NetworkSizes = reader.shape
    size = shape.width // shape.decoder_heads
    pieces = torch.ones((2, 9), dtype=torch.long)
    own = torch.zeros((shape.decoder_layers, 2, 2, shape.decoder_heads, 4, size))
    across = torch.zeros((shape.decoder_layers, 2, 2, shape.decoder_heads, 9, size))
    token, place = torch.ones((2, 1), dtype=torch.long), torch.tensor([4])
    seen = torch.zeros((2, 1, 1, 9))
    return (
        ("encoder", EncoderGraph(reader), (pieces,), ["pieces"], ["across"],
         {"pieces": {0: "batch", 1: "n"}, "across": {2: "batch", 4: "n"}}),
        ("decoder", DecoderGraph(reader), (token, place, own, across, seen),
         ["token", "place", "own", "across", "seen"],
         ["scores", "kept"],
         {"token": {0: "batch"}, "own": {2: "batch", 4: "t"}, "across": {2: "batch", 4: "n"},
          "seen": {0: "batch", 3: "n"}, "scores": {0: "batch"}, "kept": {2: "batch", 4: "t1"}}),
    )  # fmt: skip


def export_checkpoint(
    checkpoint: Path, folder: Path, train_pairs: Sequence[Pair], held_back: Sequence[Pair], seed: int
) -> None:
    """Writes all files that the reader needs, from the checkpoint of a training run.

    Args:
        checkpoint: folder with ``checkpoint.pt`` and ``pieces.txt``.
        folder: where the graphs, the pieces, the learnt words and the settings are written.
        train_pairs: hand-written pairs that the model was trained on.
        held_back: pairs that the model was not trained on, for the calibration of the confidence.
        seed: seed of the generated pairs from which the learnt words are determined.

    Raises:
        LearnError: there is no checkpoint.
    """
    if not (checkpoint / "checkpoint.pt").exists():
        raise LearnError(f"there is no checkpoint.pt in {checkpoint}; train first")
    pieces = read_vocabulary(checkpoint / "pieces.txt")
    reader = ReaderNetwork(NetworkSizes(pieces=len(pieces), tokens=len(TOKENS)))
    state = torch.load(checkpoint / "checkpoint.pt", map_location="cpu", weights_only=True)
    reader.load_state_dict(state["reader"])
    export(reader, folder)
    (folder / "pieces.txt").write_text("\n".join(pieces), encoding="utf-8")
    words = known_words([*islice(pairs(seed), COUNTED), *train_pairs])
    (folder / "words.txt").write_text("\n".join(words), encoding="utf-8")
    settings = calibrated(Network(folder), Coverage(frozenset(words)), held_back)
    (folder / "settings.json").write_text(json.dumps(asdict(settings), indent=2) + "\n", encoding="utf-8")
    (folder / "NOTICE").write_text(NOTICE, encoding="utf-8")
    sums = {name: sha256((folder / name).read_bytes()).hexdigest() for name in FILES}
    (folder / "sums.json").write_text(json.dumps(sums, indent=2) + "\n", encoding="utf-8")
