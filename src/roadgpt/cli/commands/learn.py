"""``roadgpt learn``: makes training pairs of descriptions and requirements; trains, evaluates and exports
readers.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Option
from roadgpt.cli.option_groups import CommandGroup
from roadgpt.cli.option_types import PATH, folder, measure, whole
from roadgpt.errors import LearnError, to_install

if TYPE_CHECKING:
    from roadgpt.learn.evaluate import Reading
    from roadgpt.learn.pair import Pair

SPLITS = ("train", "validation", "test", "exam")
NETWORKS_OF_READER = ("first", "second", "routes")
BOTH = "both"
COUNT = whole(1, 10_000_000, "a number")
TRAINED_ON = ("train", "contrasts", "free")
SPENT = tuple(
    f"data/outsiders/{name}.jsonl" for name in ("roads", "2026-11-26/descriptions", "2026-11-26/contrasts")
)
"""Files with prompts by outsiders; earlier evaluations of readers have already used these prompts."""
HELD_BACK = ("validation", "contrasts_validation", "free_validation")
"""Folders of the descriptions with which readers are trained (TRAINED_ON) and calibrated (HELD_BACK)."""
MEASURED = 600  # number of training pairs that are descriptions of measured roads
# fmt: off
HAND = Option(
    "--hand",
    "Folder with hand-written descriptions, as JSON lines in subfolders (train, contrasts, ...).",
    folder, Path("data/descriptions"),
)
CHANGES = Option(
    "--changes", "Folder with hand-written change requests, as JSON lines in its subfolder 'train'.",
    folder, Path("data/changes"),
)
NETWORKS = Option(
    "--networks", "Folder with hand-written routes with junctions, as JSON lines in its subfolder 'train'.",
    folder, Path("data/networks"),
)
OUT = Argument("out", "OUT", "Name the folder to write into.", folder)
CHECKPOINT = Argument("checkpoint", "CHECKPOINT", kind=folder)
OF_DATA = (
    *(OUT, HAND),
    Option("--number -n", "Number of pairs to generate.", COUNT, 100_000),
    options.seed("The same seed gives the same pairs.", 1),
)
OF_TRAIN = (
    *(OUT, HAND, CHANGES, NETWORKS),
    Option("--weights", "Folder of all-MiniLM-L6-v2: model.safetensors, vocab.txt.", folder),
    Option("--installed", "Start from the installed reader instead of --weights.", bool),
    Option("--steps", "Number of batches that each process trains on.", COUNT, 14_000),
    Option("--size", "Number of pairs in a batch.", COUNT, 48),
    Option("--second", "The installed reader has two neural networks for single roads; start from the second "
           "one.", bool),
    Option("--routes", "Train the neural network for routes and maps, not one for single roads.", bool),
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
    *(CHECKPOINT, OUT, HAND, CHANGES, NETWORKS),
    Option("--second", "Folder of another training run, whose neural network becomes the reader's second one "
           "for single roads.", folder),
    Option("--routes", "Folder of a training run with --routes; its neural network reads routes and maps.",
           folder),
    Option("--only", "The network that CHECKPOINT replaces in the installed reader; with 'both', CHECKPOINT "
           "and --second replace the two networks for single roads. The others stay as they are.",
           click.Choice((*NETWORKS_OF_READER, BOTH))),
    Option("--prompts", "File with prompts and truths. They calibrate the confidence that the reader reports "
           "for single roads. Repeat the option for more files.", default=SPENT, multiple=True),
    Option("--chats", "Also write this many pairs as chats, to fine-tune larger models.", COUNT),
    options.seed("Seed of the chats.", 1),
)
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
    from roadgpt.learn.generator import pairs
    from roadgpt.learn.near_duplicates import report

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
    second: bool,
    routes: bool,
    own: Path | None,
    seed: int,
    **rest: Any,
) -> None:
    """Train a reader, or continue from the checkpoint in the folder OUT.

    Ctrl-C loses only the batches since the last save; the same command continues from that save.

    \b
    roadgpt learn train runs/reader --weights MINILM
    roadgpt learn train runs/reader --installed --steps 2000 --own my-pairs
    """
    if rest["encoder_layers"] and not (installed or second):
        raise LearnError("--encoder-layers deepens the installed reader; add --installed or --second")
    try:
        from roadgpt.learn.train import TrainingSettings, train_together
    except ImportError as error:
        raise LearnError(f"this needs more libraries: {to_install('learn')}") from error
    from roadgpt.brief.readers.model import ROUTES, SECOND, WEIGHTS
    from roadgpt.learn.back_labelling import measured_pairs
    from roadgpt.learn.pretrained import begin

    installed |= second
    if weights and installed:
        raise LearnError("a training starts from --weights or from what is --installed; name one of them")
    pairs = [*_all_pairs(hand, TRAINED_ON, changes, networks, "train"), *(_pairs_of(own) if own else [])]
    pairs += islice(measured_pairs(seed), MEASURED)
    pieces = begin(out, weights, WEIGHTS if installed else None)
    start = weights / "model.safetensors" if weights else WEIGHTS if installed else None
    ending = SECOND if second else ROUTES if routes else ""
    plan = TrainingSettings(seed=seed, ending=ending, is_of_routes=routes, **rest)
    train_together(out, pieces, start, pairs, plan, click.echo)


@command.command(params=[*OF_EXPORT])
def export(
    checkpoint: Path,
    out: Path,
    hand: Path,
    changes: Path,
    networks: Path,
    second: Path | None,
    routes: Path | None,
    only: str | None,
    prompts: Sequence[str],
    chats: int | None,
    seed: int,
) -> None:
    """Write the reader saved in the folder CHECKPOINT into the folder OUT, quantised to int8."""
    if only == BOTH and (routes or not second):
        raise LearnError("--only both takes CHECKPOINT and --second; leave out --routes")
    if only and only != BOTH and (second or routes):
        raise LearnError(f"--only {only} takes CHECKPOINT alone; leave out --second and --routes")
    try:
        from roadgpt.learn.export import export_checkpoints
    except ImportError as error:
        raise LearnError(f"this needs more libraries: {to_install('learn')}") from error
    from roadgpt.brief.readers.model import MEANINGS, MEANINGS_OF_CHANGES, ROUTES, SECOND, WEIGHTS
    from roadgpt.learn.data import is_for_roads_only
    from roadgpt.learn.told_prompts import told_prompts
    from roadgpt.learn.word_meanings import filler_words, word_meanings

    told = _all_pairs(hand, HELD_BACK, changes, networks, "validation")
    held_back = [pair for pair in told if not is_for_roads_only(pair)]
    trained_on = _all_pairs(hand, TRAINED_ON, changes, networks, "train")
    meanings = {
        MEANINGS: word_meanings(trained_on),
        MEANINGS_OF_CHANGES: word_meanings(trained_on, of_changes=True),
    }
    words = filler_words(trained_on), meanings
    endings = dict(zip(NETWORKS_OF_READER, ("", SECOND, ROUTES), strict=True))
    first = endings.get(only or "first", "")
    found = {first: checkpoint, **({} if only in NETWORKS_OF_READER else {SECOND: second, ROUTES: routes})}
    checkpoints = {name: run for name, run in found.items() if run}
    told_by_others = [each for path in map(Path, prompts) if path.is_file() for each in told_prompts(path)]
    export_checkpoints(checkpoints, out, held_back, *words, WEIGHTS if only else None, told_by_others)
    click.echo(f"{sum(file.stat().st_size for file in out.iterdir()) / 1e6:.1f} MB in {out}")
    if chats:
        _write_chats(out, chats, seed)


def _all_pairs(hand: Path, folders: Sequence[str], changes: Path, networks: Path, part: str) -> list["Pair"]:
    """Returns the hand-written pairs in these folders of ``hand``, and those in one part of the others."""
    from roadgpt.learn.data import NETWORK

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
    from roadgpt.learn.fine_tuning_chats import brief_chats, design_chats
    from roadgpt.learn.generator import pairs
    from roadgpt.road import World

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
    from roadgpt.learn.evaluate import HEAD, readings, score, worst

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
    from roadgpt.learn.model_card import card

    counts = {
        f"hand-written, {name}": len(_pairs_of(hand / name)) for name in SPLITS if (hand / name).is_dir()
    }
    first, *others = found
    told = (WEIGHTS / "training.txt").read_text(encoding="utf-8").strip()
    text = card(WEIGHTS, counts, found[first], {name: found[name] for name in others}, shown, told)
    path.write_text(text, encoding="utf-8")
    click.echo(f"the card is in {path}")


def _key(pair: "Pair") -> str:
    """Returns a text that is equal for descriptions that differ in blanks and capitals only."""
    return " ".join(pair.text.lower().split())


def _pairs_of(place: Path, is_change: bool = False) -> "list[Pair]":
    """Returns the pairs of all files of a folder.

    Raises:
        LearnError: There are no pairs, or a line cannot be used.
    """
    from roadgpt.learn.labels import read_pairs

    found, problems = read_pairs(place.glob("*.jsonl"), is_change)
    if problems:
        raise LearnError(f"{len(problems)} lines cannot be used, the first is {problems[0]}")
    if not found:
        raise LearnError(f"there are no pairs in {place}; give the folder that has them with --hand")
    return found
