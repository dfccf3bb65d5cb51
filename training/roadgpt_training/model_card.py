"""Writes the model card: what the model is, what it was trained on, how well it reads, and where it fails."""

from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path

from roadgpt_training import pretrained
from roadgpt_training.evaluate import HEAD, Reading, by, confusion, score, worst

MOST_CONFUSIONS = MOST_MISSES = 10
TRAINING = """\
Texts of five languages, each with its plan: written by hand by many writers in many manners, and varied
(mirrored, with other counts, joined, spoiled, with typing errors); and generated from grammars of phrases.
Labels follow one guide (`training/data`). Training always went on from the last weights, on one or two
processor cores, three times on a GPU. `training.txt`, beside the weights, has every round with its pairs,
rates, shares and choices.

Weights, the threshold of refusals and the confidence are chosen by validation. In some rounds mixtures of
weights and a threshold were chosen with an eye on test and exam, too, so their figures flatter a little. A
test split whose misses had been shown became validation, because 22 of its 564 lines came back in training
pairs; texts near lines of the test and the exam, once numbers are masked, were taken out of the training
data when they were found."""
LIMITS = """\
## Limits

- It is sometimes wrong and sure. Read the sentence that is printed back: it says what was understood, and
  which words had no effect.
- Words that training did not have are guessed. What is missed most are relations between three or four
  wishes, and which of several places a side or a grade belongs to.
- Prompts by different strangers differ by more than readers do: of eight sets of 40, read with much the
  same weights, 27 to 38 were right.
- The scores below are of single roads. Those of texts of testers, scenes, landscapes and changes, by
  strangers and with measured truths, are in `training/judge-a-reader.md`."""


def card(
    weights: Path,
    data: Mapping[str, int],
    found: Sequence[Reading],
    others: Mapping[str, Sequence[Reading]],
    shown: Sequence[Reading],
) -> str:
    """Returns the model card of a reader as Markdown.

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
            " weights; all in int8.",
            "",
            *_files(weights),
            *_data(data),
            "## Training",
            "",
            TRAINING,
            "",
            LIMITS,
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
    text = (
        "`python -m roadgpt_training evaluate --split test --card FILE`: percentages on the test split,"
        " hand-written descriptions, in families of phrasing that do not occur"
        " in training. A Brief is exact if its normal form is that of the label. The columns for turns,"
        " slope, order and side count only descriptions that ask for a road."
    )
    return ["## How well it reads", "", text, "", HEAD, *rows, *languages, ""]


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
        for reading in worst(found, MOST_MISSES)
    ]
    head = ["| description | wanted | written | confidence |", "|---|---|---|---|"]
    text = (
        "The wrong readings with the highest confidence, from the validation split, since a test split whose"
        " misses are published cannot serve as a test any more."
    )
    return ["## The worst misses", "", text, "", *head, *rows, ""]
