"""``python -m roadgpt_training``: makes training pairs of descriptions and requirements; trains, evaluates
and exports readers.
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.options import PATH, Argument, CommandGroup, Option, folder, measure, whole
from roadgpt.errors import RoadGPTError, UsageError

if TYPE_CHECKING:
    from roadgpt_training.evaluate import Reading
    from roadgpt_training.pair import Pair

DATA = Path(__file__).parents[1] / "data"
SPLITS = ("train", "validation", "test", "exam")
INSTALL = "python -m pip install -r training/requirements.txt"
COUNT = whole(1, 10_000_000, "a number")
TRAINED_ON = ("train", "contrasts", "free")
HELD_BACK = ("validation", "contrasts_validation", "free_validation")
"""Folders of the descriptions with which readers are trained (TRAINED_ON) and calibrated (HELD_BACK)."""
MEASURED = 600  # number of training pairs that are descriptions of measured roads
# fmt: off
HAND = Option(
    "--hand",
    "Folder with hand-written descriptions, as JSON lines in subfolders (train, contrasts, ...).",
    folder, DATA / "descriptions",
)
CHANGES = Option(
    "--changes", "Folder with hand-written change requests, as JSON lines in its subfolder 'train'.",
    folder, DATA / "changes",
)
NETWORKS = Option(
    "--networks", "Folder with hand-written routes with junctions, as JSON lines in its subfolder 'train'.",
    folder, DATA / "networks",
)
FIELD_PAIRS = Option(
    "--field", "Folder with hand-written texts of the field, as JSON lines in its subfolder 'train'.",
    folder, DATA / "field",
)
ENDINGS = {"roads": "", "routes": "_routes"}
"""What follows 'encoder' and 'decoder' in the file names of each network."""
OUT = Argument("out", "OUT", "Name the folder to write into.", folder)
CHECKPOINT = Argument("checkpoint", "CHECKPOINT", kind=folder)
OF_DATA = (
    *(OUT, HAND),
    Option("--number -n", "Number of pairs to generate.", COUNT, 100_000),
    options.seed("The same seed gives the same pairs.", 1),
)
OF_TRAIN = (
    *(OUT, HAND, CHANGES, NETWORKS, FIELD_PAIRS),
    Option("--weights", "Folder of all-MiniLM-L6-v2: model.safetensors, vocab.txt.", folder),
    Option("--installed", "Start from the installed reader instead of --weights.", bool),
    Option("--steps", "Number of batches that each process trains on.", COUNT, 14_000),
    Option("--size", "Number of pairs in a batch.", COUNT, 48),
    Option("--network", "What it reads: single roads and changes, or routes, maps and texts of the field.",
           click.Choice(tuple(ENDINGS)), "roads"),
    Option("--decoder-layers", "Number of decoder layers; with --installed, a multiple of the number that "
           "the installed reader has.", whole(1, 24, "layers")),
    Option("--encoder-layers", "Number of encoder layers; with --installed, a multiple of the number that "
           "the installed reader has.", whole(1, 48, "layers")),
    Option("--frozen-layers", "Number of encoder layers, from the lowest, that are not trained.",
           whole(0, 24, "layers"), 0),
    Option("--cool-down", "Share of the steps, at the end, in which the learning rates fall to zero.",
           measure(0, 1), 0.3),
    Option("--encoder-rate", "Highest learning rate of the encoder.", measure(0, 1, above=True), 1.5e-4),
    Option("--decoder-rate", "Highest learning rate of the decoder.", measure(0, 1, above=True), 7e-4),
    Option("--workers", "Number of training processes; use one per core.", whole(1, 64, "processes"), 2),
    Option("--feeders", "Number of processes that make the pairs; with a GPU, one per core. 0: the training "
           "makes them itself.", whole(0, 64, "processes"), 0),
    Option("--own", "Folder with training pairs of your own, used in addition.", folder),
    options.seed("The same seed gives the same pairs.", 1),
)
OF_EXPORT = (
    *(OUT, HAND, CHANGES, NETWORKS, FIELD_PAIRS),
    *(Option(f"--{name}", f"Folder of a training of the network for {name}; without it, the installed one.",
             folder) for name in ENDINGS),
    Option("--chats", "Also write this many pairs as chats, to fine-tune larger models.", COUNT),
    options.seed("Seed of the chats.", 1),
)
OF_CALIBRATE = (Argument("weights", "WEIGHTS", kind=folder), HAND, CHANGES, NETWORKS, FIELD_PAIRS)
OF_CHATS = (
    OUT,
    Option("--number -n", "Number of pairs.", COUNT, 1000),
    options.seed("The same seed gives the same chats.", 1),
)
OF_EVALUATE = (
    HAND,
    Option("--split", "Pairs to evaluate on; exam: descriptions that must be refused, and valid ones, some of"
           " which look as if they must be refused.", click.Choice(SPLITS), "validation"),
    Option("--reader names", "Reader to evaluate; repeat the option for more readers.",
           default=("model",), multiple=True),
    Option("--misses", "Show this many descriptions that were misread.", whole(0, 10_000, "a number"), 0),
    Option("--card", "Write the model card of the first reader to this file.", PATH),
)
# fmt: on


@click.group(cls=CommandGroup)
def command() -> None:
    """Train, evaluate and export a reader of your own: the model that reads descriptions."""


@command.command(params=[*OF_DATA])
def data(out: Path, hand: Path, number: int, seed: int) -> None:
    """Check the hand-written training pairs, and write generated pairs into the folder OUT.

    A pair is a description and the requirements that it states.
    """
    from roadgpt_training.generator import pairs
    from roadgpt_training.near_duplicates import report

    splits = {name: _pairs_of(hand / name) for name in SPLITS if (hand / name).is_dir()}
    for line in report({name: [pair.text for pair in its] for name, its in splits.items()}):
        click.echo(line)
    for name, its in splits.items():
        click.echo(f"{len(its)} pairs by hand for {name}")
    path = out / "generated.jsonl"
    seen = {_key(pair) for its in splits.values() for pair in its}
    out.mkdir(parents=True, exist_ok=True)
    written = 0
    with path.open("w", encoding="utf-8") as file:
        for pair in pairs(seed):
            if _key(pair) not in seen:
                seen.add(_key(pair))
                file.write(json.dumps(asdict(pair), ensure_ascii=False) + "\n")
                written += 1
            if written == number:
                break
    click.echo(f"{written} different pairs generated in {path}")


@command.command(params=[*OF_TRAIN])
def train(
    out: Path,
    hand: Path,
    changes: Path,
    networks: Path,
    weights: Path | None,
    installed: bool,
    network: str,
    field: Path,
    own: Path | None,
    seed: int,
    **rest: Any,
) -> None:
    """Train a reader, or continue from the checkpoint in the folder OUT.

    Ctrl-C loses only the batches since the last save; the same command continues from that save.

    \b
    python -m roadgpt_training train runs/reader --weights MINILM
    python -m roadgpt_training train runs/reader --installed --steps 2000 --own my-pairs
    """
    if rest["encoder_layers"] and not installed:
        raise UsageError("--encoder-layers deepens the installed reader; add --installed")
    try:
        from roadgpt_training.train import TrainingSettings, train_together
    except ImportError as error:
        raise UsageError(f"this needs more libraries: {INSTALL}") from error
    from roadgpt.brief.readers.model import WEIGHTS
    from roadgpt_training.back_labelling import measured_pairs
    from roadgpt_training.pretrained import begin

    if weights and installed:
        raise UsageError("a training starts from --weights or from what is --installed; name one of them")
    pairs = [*_all_pairs(hand, TRAINED_ON, changes, networks, "train"), *(_pairs_of(own) if own else [])]
    pairs += [*_of_field(field / "train"), *_of_field(changes / "scenes", is_change=True)]
    pairs += islice(measured_pairs(seed), MEASURED)
    pieces = begin(out, weights, WEIGHTS if installed else None)
    start = weights / "model.safetensors" if weights else WEIGHTS if installed else None
    plan = TrainingSettings(seed=seed, ending=ENDINGS[network], network=network, **rest)
    train_together(out, pieces, start, pairs, plan, click.echo)


@command.command(params=[*OF_EXPORT])
def export(
    out: Path,
    hand: Path,
    changes: Path,
    networks: Path,
    field: Path,
    chats: int | None,
    seed: int,
    **trained: Path | None,
) -> None:
    """Write the reader with newly trained networks into the folder OUT, quantised to int8."""
    try:
        from roadgpt_training.export import export_checkpoints
    except ImportError as error:
        raise UsageError(f"this needs more libraries: {INSTALL}") from error
    from roadgpt.brief.readers.model import WEIGHTS
    from roadgpt_training.calibrate import write_settings
    from roadgpt_training.filler_words import filler_words

    words = filler_words(_all_pairs(hand, TRAINED_ON, changes, networks, "train"))
    checkpoints = {ENDINGS[name]: place for name, place in trained.items() if place}
    export_checkpoints(checkpoints, out, words, WEIGHTS if len(checkpoints) < len(ENDINGS) else None)
    write_settings(out, _held_back(hand, changes, networks, field))
    click.echo(f"{sum(file.stat().st_size for file in out.iterdir()) / 1e6:.1f} MB in {out}")
    if chats:
        _write_chats(out, chats, seed)


@command.command(params=[*OF_CALIBRATE])
def calibrate(weights: Path, hand: Path, changes: Path, networks: Path, field: Path) -> None:
    """Fit the confidence of the reader in the folder WEIGHTS again, on texts held back from training."""
    from roadgpt_training.calibrate import write_settings

    write_settings(weights, _held_back(hand, changes, networks, field))


def _held_back(hand: Path, changes: Path, networks: Path, field: Path) -> "list[Pair]":
    from roadgpt_training.data import is_for_roads_only

    told = _all_pairs(hand, HELD_BACK, changes, networks, "validation")
    of_field = [
        *_of_field(field / "validation"),
        *_of_field(changes / "scenes_validation", is_change=True),
    ]
    return [*(pair for pair in told if not is_for_roads_only(pair)), *of_field]


def _of_field(place: Path, is_change: bool = False) -> "list[Pair]":
    """Returns the texts of the field, or the requests that change a scene, in a folder; a mark in the family
    says that they are of the field.
    """
    from roadgpt_training.field import FIELD

    return [replace(pair, family=f"{FIELD}{pair.family}") for pair in _pairs_of(place, is_change)]


def _all_pairs(hand: Path, folders: Sequence[str], changes: Path, networks: Path, part: str) -> list["Pair"]:
    """Returns the hand-written pairs in these folders of ``hand``, and those in one part of the others."""
    from roadgpt_training.data import NETWORK

    pairs = [pair for folder in folders for pair in _pairs_of(hand / folder)]
    # the mark in the family says that they are routes with junctions
    pairs += [replace(pair, family=f"{NETWORK}{pair.family}") for pair in _pairs_of(networks / part)]
    return [*pairs, *_pairs_of(changes / part, is_change=True)]


@command.command(params=[*OF_CHATS])
def chats(out: Path, number: int, seed: int) -> None:
    """Write training pairs as chats into the folder OUT, for fine-tuning a larger model.

    The question of each chat is a generated description. In chat-brief.jsonl the answer is the requirements
    that the description states; in chat-design.jsonl it is a road that meets them.
    """
    out.mkdir(parents=True, exist_ok=True)
    _write_chats(out, number, seed)


def _write_chats(out: Path, number: int, seed: int) -> None:
    from roadgpt.road import World
    from roadgpt_training.fine_tuning_chats import brief_chats, design_chats
    from roadgpt_training.generator import pairs

    made = list(islice(pairs(seed), number))
    for name, lines in (("brief", brief_chats(made)), ("design", design_chats(made, World(), seed))):
        path = out / f"chat-{name}.jsonl"
        with path.open("w", encoding="utf-8") as file:
            written = sum(bool(file.write(line + "\n")) for line in lines)
        click.echo(f"{written} chats in {path}")


@command.command(params=[*OF_EVALUATE])
def evaluate(hand: Path, split: str, names: Sequence[str], misses: int, card: Path | None) -> None:
    """Evaluate readers on hand-written pairs."""
    from roadgpt.brief import reader_of
    from roadgpt_training.evaluate import HEAD, readings, score, worst

    pairs = _pairs_of(hand / split)
    readers = {name: reader_of(name) for name in names}
    found = {name: readings(pairs, reader.read) for name, reader in readers.items()}
    click.echo(HEAD)
    for name, its in found.items():
        click.echo(score(its).row(name))
    for name, its in found.items():
        for miss in worst(its, misses):
            click.echo(f"{name}: '{miss.pair.text}'\n  asked for {miss.pair.plan}\n  read as {miss.got}")
    if card:
        shown = readings(_pairs_of(hand / "validation"), readers[names[0]].read)
        _write_card(card, hand, found, shown)


def _write_card(path: Path, hand: Path, found: "dict[str, list[Reading]]", shown: "list[Reading]") -> None:
    from roadgpt.brief.readers.model import WEIGHTS
    from roadgpt_training.model_card import card

    counts = {
        f"hand-written, {name}": len(_pairs_of(hand / name)) for name in SPLITS if (hand / name).is_dir()
    }
    first, *others = found
    text = card(WEIGHTS, counts, found[first], {name: found[name] for name in others}, shown)
    path.write_text(text, encoding="utf-8")
    click.echo(f"the card is in {path}")


def _key(pair: "Pair") -> str:
    """Returns a text that is equal for descriptions that differ in blanks and capitals only."""
    return " ".join(pair.text.lower().split())


def _pairs_of(place: Path, is_change: bool = False) -> "list[Pair]":
    """Returns the pairs of all files of a folder.

    Raises:
        UsageError: There are no pairs, or a line cannot be used.
    """
    from roadgpt_training.labels import read_pairs

    found, problems = read_pairs(place.glob("*.jsonl"), is_change)
    if problems:
        raise UsageError(f"{len(problems)} lines cannot be used, the first is {problems[0]}")
    if not found:
        raise UsageError(f"there are no pairs in {place}; give the folder that has them with --hand")
    return found


if __name__ == "__main__":
    try:
        command(prog_name="python -m roadgpt_training")
    except RoadGPTError as error:
        sys.exit(f"roadgpt_training: {error}")
