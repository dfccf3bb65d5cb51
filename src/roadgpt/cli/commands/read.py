"""``roadgpt read``: shows how a description is interpreted, without making a road."""

import json
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import whole

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief
    from roadgpt.road import World

FEW = whole(1, 10, "the number of readings")
LEAST = 0.01  # smallest chance of a reading that is listed
TEMPERATURE = 1.3  # sampling temperature for the readings after the likeliest one


OPTIONS = (
    options.PLAN,
    *named(options.SETUP, "reader"),
    *named(options.WORLD, "map_size", "friction"),
    Option("--table as_table", "Print a row for each turn and straight.", bool),
    options.json_option("Print the interpretation as JSON."),
    Option("--alternatives number", "Show up to this many different interpretations.", FEW, 1),
    *options.CHAT,
)


@click.command(cls=GroupedCommand, params=[options.WORDS, *OPTIONS])
def command(words: tuple[str, ...], as_table: bool, as_json: bool, number: int, **rest: Any) -> None:
    """Show how RoadGPT interprets a description, how confident it is, and whether the road fits on the map.

    \b
    roadgpt read "uphill, 3 turns, the last one a hairpin"
    roadgpt read "drei Kurven, dann 80 m geradeaus bergab" --table
    roadgpt read "a road" --alternatives 3
    """
    from roadgpt.brief import alternatives
    from roadgpt.cli.commands.run import understood
    from roadgpt.design.room import world_for
    from roadgpt.run import Setup, brief_of

    world, reader, text = options.world_of(rest), options.reader_of(rest), " ".join(words)
    chat = options.chat_of(rest, reader)
    briefs: Sequence[Brief] = (brief_of(text, world, Setup(reader=reader, chat=chat)),)
    if number > 1 and chat is None:  # a language model says what it takes for likeliest
        briefs = alternatives(text, number, reader, world.site.map_size, TEMPERATURE)
    if as_json:
        found = [_as_data(brief, world_for(brief, world), world) for brief in briefs]
        click.echo(json.dumps(found if number > 1 else found[0], indent=2, ensure_ascii=False))
        return
    if number > 1:
        click.echo("\n".join(_list(briefs, as_table)))
        return
    click.echo(understood(briefs[0], world_for(briefs[0], world), world))
    if as_table:
        click.echo(_table(briefs[0]))


def _as_data(brief: "Brief", world: "World", usual: "World") -> dict[str, object]:
    from roadgpt.brief import SURE, sentence
    from roadgpt.brief.plan import plan
    from roadgpt.cli.commands.run import all_remarks

    told = {"sentence": sentence(brief), "plan": plan(brief), "confidence": brief.confidence}
    told |= {"is_sure": brief.confidence >= SURE, "other": brief.other}
    map_size, friction = world.site.map_size, world.site.friction
    told |= {"map_size": map_size, "friction": friction, "remarks": all_remarks(brief, world, usual)}
    return {**told, "unused": brief.unused, "brief": brief.model_dump(exclude_defaults=True)}


def _list(briefs: "Sequence[Brief]", as_table: bool) -> Iterator[str]:
    """Yields the likely readings with their chances, and a warning if none is sure."""
    from roadgpt.brief import SURE
    from roadgpt.cli.commands.run import reading

    likely = [brief for place, brief in enumerate(briefs) if not place or brief.confidence >= LEAST]
    whole = max(1.0, sum(brief.confidence for brief in likely))  # each is judged on its own; one is meant
    for number, brief in enumerate(likely, 1):
        yield f"{number}. {100 * brief.confidence / whole:3.0f} %  {reading(brief)}"
        if as_table:
            yield _table(brief)
    if len(likely) == 1:
        yield f"no other reading has a chance of {100 * LEAST:.0f} %"
    if likely[0].confidence < SURE:
        yield "not sure of any: if none is what you mean, say it in other words"


def _table(brief: "Brief") -> str:
    """Returns a table of the features in driving order, then the requirements on the whole road."""
    from roadgpt.brief.normal import normal
    from roadgpt.brief.sentence import clause_columns, road_words

    said = normal(brief)
    rows = [("", "what", "how")]
    rows += [(str(number), *clause_columns(clause)) for number, clause in enumerate(said.clauses, 1)]
    wishes = road_words(said)
    if wishes or not said.clauses:
        rows.append(("", "whole road", wishes or "nothing is asked of it"))
    wide = [max(len(row[column]) for row in rows) for column in range(2)]
    return "\n".join(f"{row[0]:>{wide[0]}}  {row[1]:<{wide[1]}}  {row[2]}".rstrip() for row in rows)
