"""``roadgpt read``: what a description is read as, without making a road."""

import json
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.dashes import DescribedCommand
from roadgpt.cli.options import chat_of, chat_options_but, setup_options, whole, world_of, world_options

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief
    from roadgpt.chat import ChatSettings

FEW = whole(1, 10, "the number of readings")
TEMPERATURE = 1.3  # of readings beside the likeliest one


@click.command(cls=DescribedCommand)
@click.argument("words", nargs=-1, required=True, metavar="DESCRIPTION")
@setup_options("reader")
@world_options("map_size")
@click.option("--table", "as_table", is_flag=True, help="One row for each thing along the road.")
@click.option("--json", "as_json", is_flag=True, help="The Brief as JSON, with its sentence and its plan.")
@click.option("--alternatives", "number", type=FEW, default=1, help="Show up to so many different readings.")
@chat_options_but("repair", "strategy")
def command(
    words: tuple[str, ...],
    reader: str,
    map_size: float,
    as_table: bool,
    as_json: bool,
    number: int,
    **asked: Any,
) -> None:
    """Say how a description is read, and how sure the reader is.

    \b
    roadgpt read "uphill, 3 turns, the last one a hairpin"
    roadgpt read "drei Kurven, dann 80 m geradeaus bergab" --table
    roadgpt read "a road" --alternatives 3
    """
    from roadgpt.cli.work import understood

    side = world_of({"map_size": map_size}).map_size
    briefs = _readings(" ".join(words), reader, side, number, chat_of(asked, reader))
    if as_json:
        found = [_as_data(brief) for brief in briefs]
        click.echo(json.dumps(found if number > 1 else found[0], indent=2, ensure_ascii=False))
        return
    for brief in briefs:
        click.echo(understood(brief))
        if as_table:
            click.echo(_table(brief))


def _readings(
    words: str, reader: str, map_size: float, number: int, chat: "ChatSettings | None"
) -> "tuple[Brief, ...]":
    from roadgpt.brief import alternatives, read

    if number == 1 or chat is not None:  # a language model says what it takes for likeliest
        return (read(words, reader, map_size, chat=chat),)
    return alternatives(words, number, reader, map_size, TEMPERATURE)


def _as_data(brief: "Brief") -> dict[str, object]:
    from roadgpt.brief import sentence
    from roadgpt.brief.plan import plan

    told = {"sentence": sentence(brief), "plan": plan(brief), "confidence": brief.confidence}
    return {**told, "unused": brief.unused, "brief": brief.model_dump(exclude_defaults=True)}


def _table(brief: "Brief") -> str:
    """What stands along the road, in driving order, then the wishes for the whole road."""
    from roadgpt.brief.plan import plan

    things, _, wishes = plan(brief).partition("|")
    rows = [("", "what", "how")]
    for number, thing in enumerate(filter(None, (part.strip() for part in things.split(";"))), 1):
        kind, _, how = thing.partition(" ")
        rows.append((str(number), kind, how))
    if wishes.strip():
        rows.append(("", "whole road", wishes.strip()))
    wide = [max(len(row[column]) for row in rows) for column in range(2)]
    return "\n".join(f"{row[0]:>{wide[0]}}  {row[1]:<{wide[1]}}  {row[2]}".rstrip() for row in rows)
