"""The network of the model reader: the pretrained MiniLM encoder, and a small decoder that writes plans.

Attention is implemented here instead of taken from PyTorch, because only then can it be exported to ONNX with
variable lengths.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.nn import functional

ENCODER, DECODER = "layers.", "decoder."
"""How the names of the weights of a layer begin, before the number of the layer."""


@dataclass(frozen=True, slots=True)
class NetworkSizes:
    """The dimensions of the network."""

    pieces: int = 30522
    tokens: int = 93
    width: int = 384
    heads: int = 12
    inner: int = 1536
    layers: int = 6
    decoder_layers: int = 3
    decoder_inner: int = 1024
    decoder_heads: int = 6
    places: int = 128
    """Maximum length of a text, in word pieces."""
    plan_places: int = 96
    """The largest length of a plan in tokens."""


class Attention(nn.Module):
    """Multi-head attention over keys and values that are computed by the caller."""

    def __init__(self, width: int, heads: int, dropout: float) -> None:
        super().__init__()
        self.heads, self.size = heads, width // heads
        self.query, self.key, self.value, self.out = (nn.Linear(width, width) for _ in range(4))
        self.dropout = dropout

    def split(self, x: Tensor) -> Tensor:
        """Reshapes (batch, length, width) to (batch, heads, length, head size)."""
        return x.view(x.shape[0], x.shape[1], self.heads, self.size).transpose(1, 2)

    def keys(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Returns keys and values of x (batch, length, width), each (batch, heads, length, head size)."""
        return self.split(self.key(x)), self.split(self.value(x))

    def forward(self, x: Tensor, key: Tensor, value: Tensor, mask: Tensor | None) -> Tensor:
        """Returns the attended values, (batch, queries, width), for queries computed from x (batch, queries,
        width). Keys and values are split into heads, (batch, heads, length, head size); ``mask`` is added to
        the attention scores.
        """
        query = self.split(self.query(x))
        scores = query @ key.transpose(2, 3) / math.sqrt(self.size)
        if mask is not None:
            scores = scores + mask
        weights = functional.dropout(torch.softmax(scores, -1), self.dropout, self.training)
        mixed = (weights @ value).transpose(1, 2).reshape(x.shape[0], x.shape[1], -1)
        out: Tensor = self.out(mixed)
        return out


class EncoderLayer(nn.Module):
    """A layer of BERT, with layer normalisation after each residual sum."""

    def __init__(self, shape: NetworkSizes, dropout: float) -> None:
        super().__init__()
        self.attention = Attention(shape.width, shape.heads, dropout)
        self.norm = nn.LayerNorm(shape.width, eps=1e-12)
        self.wide, self.narrow = nn.Linear(shape.width, shape.inner), nn.Linear(shape.inner, shape.width)
        self.last_norm = nn.LayerNorm(shape.width, eps=1e-12)
        self.dropout = nn.Dropout(dropout)

    def forward(self, x: Tensor, mask: Tensor) -> Tensor:
        """Applies the layer to x (batch, length, width); ``mask`` is added to the attention scores."""
        x = self.norm(x + self.dropout(self.attention(x, *self.attention.keys(x), mask)))
        out: Tensor = self.last_norm(x + self.dropout(self.narrow(functional.gelu(self.wide(x)))))
        return out


class DecoderLayer(nn.Module):
    """A decoder layer: attention to the plan so far, then to the description; layer normalisation before
    each.
    """

    def __init__(self, shape: NetworkSizes, dropout: float) -> None:
        super().__init__()
        self.own = Attention(shape.width, shape.decoder_heads, dropout)
        self.across = Attention(shape.width, shape.decoder_heads, dropout)
        self.norms = nn.ModuleList(nn.LayerNorm(shape.width) for _ in range(3))
        self.wide = nn.Linear(shape.width, shape.decoder_inner)
        self.narrow = nn.Linear(shape.decoder_inner, shape.width)
        self.dropout = nn.Dropout(dropout)

    def forward(
        self,
        x: Tensor,
        own: tuple[Tensor, Tensor],
        across: tuple[Tensor, Tensor],
        mask: Tensor | None,
        seen: Tensor,
    ) -> Tensor:
        """Applies the layer to embedded tokens x (batch, tokens, width).

        ``own`` has the keys and values of the plan so far, and ``across`` those of the description, each
        (batch, heads, length, head size). ``mask`` is added to the attention scores of the plan, and ``seen``
        to the attention scores of the description.
        """
        x = x + self.dropout(self.own(self.norms[0](x), *own, mask))
        x = x + self.dropout(self.across(self.norms[1](x), *across, seen))
        out: Tensor = x + self.dropout(self.narrow(functional.gelu(self.wide(self.norms[2](x)))))
        return out

    def own_keys(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Returns keys and values of new tokens, each (batch, heads, tokens, head size)."""
        return self.own.keys(self.norms[0](x))


class ReaderNetwork(nn.Module):
    """Maps the pieces of a description and a partial plan to scores for the next token."""

    def __init__(self, shape: NetworkSizes, dropout: float = 0.1) -> None:
        super().__init__()
        self.shape = shape
        width = shape.width
        self.pieces, self.places = nn.Embedding(shape.pieces, width), nn.Embedding(shape.places, width)
        self.kind = nn.Parameter(torch.zeros(width))  # BERT's first segment
        self.norm = nn.LayerNorm(width, eps=1e-12)
        self.layers = nn.ModuleList(EncoderLayer(shape, dropout) for _ in range(shape.layers))
        self.tokens, self.plan_places = (
            nn.Embedding(shape.tokens, width),
            nn.Embedding(shape.plan_places, width),
        )
        self.decoder = nn.ModuleList(DecoderLayer(shape, dropout) for _ in range(shape.decoder_layers))
        self.final = nn.LayerNorm(width)
        self.bias = nn.Parameter(torch.zeros(shape.tokens))
        self.dropout = nn.Dropout(dropout)
        for embedding in (self.tokens, self.plan_places):
            nn.init.normal_(embedding.weight, std=0.02)

    def encode(self, pieces: Tensor, seen: Tensor) -> Tensor:
        """Encodes piece numbers (batch, length) to (batch, length, width); the mask ``seen`` is added to
        the attention scores.
        """
        places = self.places.weight[: pieces.shape[1]]
        x = self.dropout(self.norm(self.pieces(pieces) + places + self.kind))
        for layer in self.layers:
            x = layer(x, seen)
        return x

    def start(self, memory: Tensor) -> list[tuple[Tensor, Tensor]]:
        """Returns the keys and values of the description, (batch, heads, pieces, head size), for every
        decoder layer.
        """
        return [layer.across.keys(memory) for layer in self.decoder]

    def write(self, tokens: Tensor, memory: Tensor, seen: Tensor) -> Tensor:
        """Returns the score of every possible next token, of shape (batch, length, tokens), at each position
        of complete plans of shape (batch, length). ``memory`` is the encoded descriptions, of shape (batch,
        pieces, width), and ``seen`` their mask, which is added to the attention scores.
        """
        length = tokens.shape[1]
        x = self.dropout(self.tokens(tokens) + self.plan_places.weight[:length])
        ahead = torch.full((length, length), -1e4, device=x.device, dtype=x.dtype).triu(1)
        for layer, across in zip(self.decoder, self.start(memory), strict=True):
            x = layer(x, layer.own_keys(x), across, ahead, seen)
        return self.scores(x)

    def scores(self, x: Tensor) -> Tensor:
        """Returns the scores (..., tokens) for x (..., width), computed with the token embeddings as output
        weights.
        """
        return functional.linear(self.final(x), self.tokens.weight) * self.shape.width**-0.5 * 8 + self.bias

    def forward(self, pieces: Tensor, tokens: Tensor) -> Tensor:
        """Returns the scores of the next token at every position of the plans, (batch, length, tokens), for
        descriptions (batch, chunks, pieces), in which piece 0 is padding, and plans (batch, length). Chunks
        are encoded one by one.
        """
        batch, chunks, length = pieces.shape
        hidden = (pieces == 0).flatten(0, 1)
        used = ~hidden.all(1)
        encoded = self.encode(pieces.flatten(0, 1)[used], hidden[used][:, None, None, :] * -1e4)
        memory = encoded.new_zeros((batch * chunks, length, self.shape.width))
        memory[used] = encoded
        seen = (pieces == 0).flatten(1)[:, None, None, :] * -1e4
        return self.write(tokens, memory.view(batch, chunks * length, -1), seen)


def layers_of(weights: Mapping[str, Tensor], part: str) -> int:
    """Returns the number of layers that the weights have in a part, ``ENCODER`` or ``DECODER``."""
    return 1 + max(int(name.split(".")[1]) for name in weights if name.startswith(part))


def network_of(weights: Mapping[str, Tensor], pieces: int, tokens: int) -> ReaderNetwork:
    """Returns the network with these weights; ``pieces`` and ``tokens`` are the sizes of its vocabularies."""
    encoder, decoder = (layers_of(weights, part) for part in (ENCODER, DECODER))
    reader = ReaderNetwork(NetworkSizes(pieces=pieces, tokens=tokens, layers=encoder, decoder_layers=decoder))
    reader.load_state_dict(weights)
    return reader


def load_minilm(reader: ReaderNetwork, path: Path, pieces: Sequence[str]) -> None:
    """Copies the pretrained weights of all-MiniLM-L6-v2 (safetensors) into the encoder. ``vocab.txt`` must be
    in the folder of the weights; ``pieces`` is a selection of this vocabulary in any order.
    """
    from safetensors.torch import load_file

    whole = (path.parent / "vocab.txt").read_text(encoding="utf-8").splitlines()
    place = {piece: index for index, piece in enumerate(whole)}
    rows = torch.tensor([place[piece] for piece in pieces])
    weights = {name.removeprefix("bert."): tensor for name, tensor in load_file(str(path)).items()}
    with torch.no_grad():
        reader.pieces.weight.copy_(weights["embeddings.word_embeddings.weight"][rows])
        reader.places.weight.copy_(weights["embeddings.position_embeddings.weight"][: reader.shape.places])
        reader.kind.copy_(weights["embeddings.token_type_embeddings.weight"][0])
        _copy(weights, reader)


def _copy(weights: Mapping[str, Tensor], reader: ReaderNetwork) -> None:
    """Copies the layers and norms of BERT's encoder."""
    own = dict(reader.named_parameters())
    names = {"norm": "embeddings.LayerNorm"}
    for index in range(reader.shape.layers):
        ours, theirs = f"layers.{index}", f"encoder.layer.{index}"
        names |= {
            f"{ours}.attention.query": f"{theirs}.attention.self.query",
            f"{ours}.attention.key": f"{theirs}.attention.self.key",
            f"{ours}.attention.value": f"{theirs}.attention.self.value",
            f"{ours}.attention.out": f"{theirs}.attention.output.dense",
            f"{ours}.norm": f"{theirs}.attention.output.LayerNorm",
            f"{ours}.wide": f"{theirs}.intermediate.dense",
            f"{ours}.narrow": f"{theirs}.output.dense",
            f"{ours}.last_norm": f"{theirs}.output.LayerNorm",
        }
    for ours, theirs in names.items():
        for part in ("weight", "bias"):
            own[f"{ours}.{part}"].copy_(weights[f"{theirs}.{part}"])
