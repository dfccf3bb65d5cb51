"""Exports the trained network as two ONNX graphs in int8: the encoder, and one step of the decoder."""

import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor, nn

from roadgpt.brief.readers.model import ROUTES
from roadgpt.brief.readers.model.vocabulary import OF_ROADS
from roadgpt.errors import UsageError
from roadgpt_training.network import ReaderNetwork, network_of
from roadgpt_training.pretrained import NOTICE, read_vocabulary

OPSET = 17
SHARED = "reader.pieces.weight_quantized"
READS = {"": "single roads", ROUTES: "routes"}
EMBEDDING = "embedding.bin"
"""Name of the file that holds the tensor ``SHARED``; all encoders read this file."""


class EncoderGraph(nn.Module):
    """Maps word pieces (batch, n) to keys and values of shape (layers, 2, batch, heads, n, head size)."""

    def __init__(self, reader: ReaderNetwork) -> None:
        super().__init__()
        self.reader = reader

    def forward(self, pieces: Tensor) -> Tensor:
        """Returns the keys and values of a description; pieces with the number 0 are padding."""
        seen = (pieces == 0)[:, None, None, :] * -1e4
        memory = self.reader.encode(pieces, seen)
        return torch.stack([torch.stack(pair) for pair in self.reader.start(memory)])


class DecoderGraph(nn.Module):
    """One step of the decoder, which takes the last token of a plan and scores the next token.

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


def export(reader: ReaderNetwork, folder: Path, ending: str = "") -> None:
    """Writes the network to ``encoder.onnx`` and ``decoder.onnx``, or with ``ending`` before ".onnx", with
    weights in int8. The weights use 7 of the 8 bits, so that the files are an eighth smaller when compressed.
    """
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
                str(ready), str(folder / f"{name}{ending}.onnx"), weight_type=QuantType.QInt8,
                per_channel=True, reduce_range=True, op_types_to_quantize=["MatMul", "Gather", "Gemm"],
            )  # fmt: skip


def _graphs(
    reader: ReaderNetwork,
) -> Sequence[tuple[str, nn.Module, tuple[Tensor, ...], list[str], list[str], dict[str, dict[int, str]]]]:
    """Returns for each graph: name, module, inputs, their names, names of the outputs, and axes that vary."""
    shape = reader.shape
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


def export_checkpoints(
    checkpoints: Mapping[str, Path], folder: Path, fillers: Sequence[str], kept: Path | None
) -> None:
    """Writes all files that the reader needs, except its settings, from the checkpoints of training runs.

    Args:
        checkpoints: folders with ``checkpoint.pt`` and ``pieces.txt``, by what follows "encoder" and
            "decoder" in the names of the files: "" or ``ROUTES``.
        folder: where the files are written.
        fillers: see ``filler_words``.
        kept: the folder of an exported reader, which supplies the networks that are not in ``checkpoints``;
            None if there is none.

    Raises:
        UsageError: a checkpoint is missing or is of another kind of network, or the embeddings of the
            networks differ.
    """
    readers = {name: _trained(checkpoint, name) for name, checkpoint in checkpoints.items()}
    if kept and kept.resolve() != folder.resolve():
        shutil.copytree(kept, folder, dirs_exist_ok=True)
    for name, reader in readers.items():
        export(reader, folder, name)
        pieces = read_vocabulary(checkpoints[name] / "pieces.txt")
        (folder / "pieces.txt").write_text("\n".join(pieces), encoding="utf-8")
    (folder / "words.txt").write_text("\n".join(fillers), encoding="utf-8")
    share_embedding([path for name in ("", ROUTES) if (path := folder / f"encoder{name}.onnx").is_file()])
    (folder / "NOTICE").write_text(NOTICE, encoding="utf-8")


def _trained(checkpoint: Path, name: str) -> ReaderNetwork:
    """Returns the network that a training run saved; ``name`` says which one it must be."""
    if not (checkpoint / "checkpoint.pt").exists():
        raise UsageError(f"there is no checkpoint.pt in {checkpoint}; train first")
    pieces = read_vocabulary(checkpoint / "pieces.txt")
    weights = torch.load(checkpoint / "checkpoint.pt", map_location="cpu", weights_only=True)["reader"]
    tokens = weights["bias"].shape[0]
    found = ROUTES if tokens > len(OF_ROADS) else ""
    if found != name:
        raise UsageError(f"the network in {checkpoint} reads {READS[found]}, not {READS[name]}")
    return network_of(weights, len(pieces), tokens)


def share_embedding(encoders: Sequence[Path]) -> None:
    """Moves the embedding of the word pieces out of the encoders into ``EMBEDDING``, which all of them read.
    The embedding is not trained, so it is the same in all encoders.

    Raises:
        UsageError: the embeddings differ.
    """
    from onnx import load, save
    from onnx.external_data_helper import set_external_data
    from onnx.numpy_helper import to_array

    kept = b""
    for path in encoders:
        model = load(str(path))
        tensor = next(each for each in model.graph.initializer if each.name == SHARED)
        values = to_array(tensor).tobytes()
        if kept and values != kept:
            raise UsageError(f"{path.name} has another embedding of the word pieces than {encoders[0].name}")
        kept = values
        tensor.raw_data = values
        set_external_data(tensor, EMBEDDING, offset=0, length=len(values))
        tensor.ClearField("raw_data")
        save(model, str(path))
        (path.parent / EMBEDDING).write_bytes(kept)
