"""Writes the model card: what the model is, what it was trained on, how well it reads, and where it fails."""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path

from roadgpt_training import pretrained
from roadgpt_training.evaluate import HEAD, Reading, by, confusion, score, worst

MOST_CONFUSIONS = 25


def card(
    weights: Path,
    data: Mapping[str, int],
    found: Sequence[Reading],
    others: Mapping[str, Sequence[Reading]],
    shown: Sequence[Reading],
    training: str,
) -> str:
    """Returns the model card of a reader as Markdown; ``training`` is its paragraph on the training.

    Args:
        weights: folder of the exported model.
        data: number of pairs in each split of the data, by name of the split.
        found: the model's readings of the test split.
        others: readings of the same split by other readers, by name of the reader.
        shown: the model's readings of the validation split. The card shows confusions and mistakes from
            these readings. People who write training pairs may read the card, so the card quotes no
            description from the test split.
    """
    return "\n".join(
        [
            "# Model card: the trained reader",
            "",
            "Reads a description of a road in English, German, French, Spanish or Italian and writes a plan:"
            " the Brief on one line; reads a change request as well, and writes a plan of changes. One"
            " network reads single roads and changes; another one reads descriptions that may tell of"
            " junctions, lanes or maps. Their encoders are MiniLM, fine-tuned: that of the first was grown"
            " from 6 to 12 layers, the other one has 6; their decoders, with 3 layers each, began from random"
            " weights; all in int8. The tables below are of single roads.",
            "",
            *_files(weights),
            *_data(data),
            "## Training",
            "",
            training,
            "",
            *_scores(found, others),
            *_confusions(shown),
            *_misses(shown),
            "## Licence",
            "",
            f"The encoder starts from {pretrained.NAME}; its `model.safetensors` has the SHA-256"
            f" `{pretrained.HASH}`."
            " The data, the decoder and the changed weights are under this project's licence, Apache-2.0.",
            "",
        ]
    )


def _files(weights: Path) -> list[str]:
    rows = [
        f"| `{path.name}` | {path.stat().st_size / 1e6:.2f} | `{sha256(path.read_bytes()).hexdigest()}` |"
        for path in sorted(weights.iterdir())
        if path.is_file()
    ]
    return ["| file | MB | SHA-256 |", "|---|---|---|", *rows, ""]


def _data(data: Mapping[str, int]) -> list[str]:
    rows = [f"| {name} | {number:,} |" for name, number in data.items()]
    return ["## Data", "", "| part | pairs |", "|---|---|", *rows, ""]


def _scores(found: Sequence[Reading], others: Mapping[str, Sequence[Reading]]) -> list[str]:
    rows = [score(found).row("model")]
    rows += [score(its).row(name) for name, its in others.items()]
    languages = [its.row(f"model, {name}") for name, its in by(found, lambda pair: pair.lang).items()]
    families = [its.row(f"model, {name}") for name, its in by(found, lambda pair: pair.family).items()]
    text = (
        "Percentages on the test split: hand-written descriptions, in families of phrasing that do not occur"
        " in training. A Brief is exact if its normal form is that of the label. The columns for turns,"
        " slope, order and side count only descriptions that ask for a road."
    )
    return ["## How well it reads", "", text, "", HEAD, *rows, *languages, *families, ""]


def _confusions(found: Sequence[Reading]) -> list[str]:
    rows = [
        f"| `{wanted}` | `{got}` | {times} |"
        for (wanted, got), times in confusion(found).most_common(MOST_CONFUSIONS)
    ]
    head = ["| wanted | written | times |", "|---|---|---|"]
    return ["## Confusions", "", "On the validation split.", "", *head, *rows, ""]


def _misses(found: Sequence[Reading]) -> list[str]:
    rows = [
        f"| {reading.pair.text.replace('|', '/')} | `{reading.pair.plan.replace('|', '/')}` |"
        f" `{reading.got.replace('|', '/')}` | {reading.confidence:.2f} |"
        for reading in worst(found)
    ]
    head = ["| description | wanted | written | confidence |", "|---|---|---|---|"]
    text = (
        "The wrong readings with the highest confidence, from the validation split, since a test split whose"
        " misses are published cannot serve as a test any more."
    )
    return ["## The worst misses", "", text, "", *head, *rows, ""]
