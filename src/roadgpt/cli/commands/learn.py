"""``roadgpt learn``: descriptions with what they ask for, and how well readers read them."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.options import SEED, folder, whole
from roadgpt.errors import LearnError

if TYPE_CHECKING:
    from roadgpt.learn.generator import Pair

SPLITS = ("train", "validation", "test")
COUNT = whole(1, 10_000_000, "a number")
hand_option = click.option(
    "--hand",
    type=folder,
    default=Path("data/descriptions"),
    show_default=True,
    help="Folder with train, validation and test: JSON lines of text, plan, family, lang.",
)


@click.group()
def command() -> None:
    """Descriptions by hand and by the thousand, and how well readers read them."""


@command.command()
@click.argument("out", type=folder)
@hand_option
@click.option("--number", "-n", type=COUNT, default=100_000, show_default=True, help="Pairs to generate.")
@click.option("--seed", type=SEED, default=1, show_default=True, help="The same seed gives the same pairs.")
def data(out: Path, hand: Path, number: int, seed: int) -> None:
    """Check the hand-written pairs, and write generated ones into the folder OUT."""
    from roadgpt.learn.originality import report

    splits = {name: _pairs_of(hand / name) for name in SPLITS}
    for line in report({name: [pair.text for pair in its] for name, its in splits.items()}):
        click.echo(line)
    for name, its in splits.items():
        click.echo(f"{len(its)} pairs by hand for {name}")
    path = out / "generated.jsonl"
    seen = {_key(pair) for its in splits.values() for pair in its}
    out.mkdir(parents=True, exist_ok=True)
    click.echo(f"{_generate(path, number, seed, seen)} different pairs generated in {path}")


def _generate(path: Path, number: int, seed: int, seen: set[str]) -> int:
    """Writes pairs that have not been seen; how many."""
    from roadgpt.learn.generator import pairs

    written = 0
    with path.open("w", encoding="utf-8") as file:
        for pair in pairs(seed):
            if _key(pair) not in seen:
                seen.add(_key(pair))
                file.write(json.dumps(asdict(pair), ensure_ascii=False) + "\n")
                written += 1
            if written == number:
                break
    return written


@command.command()
@hand_option
@click.option("--split", type=click.Choice(SPLITS), default="validation", show_default=True)
@click.option("--reader", "names", multiple=True, default=("grammar",), show_default=True, help="Repeatable.")
@click.option("--misses", type=whole(0, 10_000, "a number"), default=0, help="Show so many of the misses.")
def evaluate(hand: Path, split: str, names: Sequence[str], misses: int) -> None:
    """Hold readers against hand-written labels."""
    from roadgpt import plugins
    from roadgpt.learn.evaluate import HEAD, readings, score, worst

    pairs = _pairs_of(hand / split)
    parts = {name: plugins.find("readers", name) for name in names}
    found = {
        name: readings(pairs, (part() if isinstance(part, type) else part).read)
        for name, part in parts.items()
    }
    click.echo(HEAD)
    for name, its in found.items():
        click.echo(score(its).row(name))
    for name, its in found.items():
        for miss in worst(its, misses):
            click.echo(f"{name}: '{miss.pair.text}'\n  asked for {miss.pair.plan}\n  read as {miss.got}")


def _key(pair: "Pair") -> str:
    """What makes two descriptions the same one."""
    return " ".join(pair.text.lower().split())


def _pairs_of(place: Path) -> "list[Pair]":
    """The pairs of all files of a folder.

    Raises:
        LearnError: there are none, or a line cannot be used.
    """
    from roadgpt.learn.labels import read_pairs

    found, problems = read_pairs(place.glob("*.jsonl"))
    if problems:
        raise LearnError(f"{len(problems)} lines cannot be used, the first is {problems[0]}")
    if not found:
        raise LearnError(f"there are no pairs in {place}; give the folder that has them with --hand")
    return found
