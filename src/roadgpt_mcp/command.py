"""``roadgpt mcp`` serves agents; ``roadgpt skill`` writes what they have to know."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options

MCP_OPTIONS: list[click.Parameter] = [
    options.Option("--out", "Folder for the runs; agents see and write nothing else. [default: roadgpt-mcp]",
                   options.folder),
    options.Option("--drivers", "Folder whose files agents may name as drivers, by FILE.py:CLASS. [default: "
                   "installed drivers only]", options.folder),
    options.Option("--seconds", "Longest time that a call works.", options.whole(1, 86_400, "seconds"), 600),
    options.Option("--tests", "Most tests that a call makes.", options.whole(1, 1_000_000, "tests"), 100),
    options.Option("--disk", "Largest size of the folder, MB.", options.whole(1, 10_000_000, "MB"), 2_000),
    options.Option("-j --workers", "Tests driven at a time.", options.whole(1, 256, "workers"), 1),
    options.Option("--http", "Serve on this port of 127.0.0.1 (0: any) those that send the token, which is "
                   "printed. [default: standard streams]", click.IntRange(0, 65_535), metavar="PORT"),
]  # fmt: skip


@click.command(
    cls=options.GroupedCommand, params=MCP_OPTIONS, heading="Exchange",
    short_help="Serve agents (MCP), which make, drive, change and search tests.",
)  # fmt: skip
def mcp(out: Path | None, drivers: Path | None, http: int | None, **limits: Any) -> None:
    """Serve agents by the Model Context Protocol: they learn the language of plans, check plans, make, drive
    and change tests, run scenarios and campaigns, and export. Needs the extra mcp.

    \b
    roadgpt mcp --out runs --drivers my-drivers
    roadgpt mcp --http 8765"""
    from roadgpt.errors import needed

    needed("mcp", "serving agents")
    from roadgpt_mcp import serving
    from roadgpt_mcp.server import ToolServer
    from roadgpt_mcp.work import Workshop

    shop = Workshop((out or Path("roadgpt-mcp")).resolve(), drivers, **limits)
    serving.serve(ToolServer(shop).server, http)


@click.command(
    cls=options.GroupedCommand, params=[options.out("Folder for the skill. [default: roadgpt-skill]")],
    heading="Exchange", short_help="Write SKILL.md: what coding agents have to know.",
)  # fmt: skip
def skill(out: Path | None) -> None:
    """Write SKILL.md for coding agents: the language of plans, five texts with their plans, and how to check.
    Put its folder where your agent looks for skills.

    \b
    roadgpt skill --out skills/roadgpt"""
    from roadgpt.cli.roads import made
    from roadgpt.run.atomic import to_bytes, write_whole
    from roadgpt_mcp.knowledge import skill as page

    file = made(out or Path("roadgpt-skill")) / "SKILL.md"
    write_whole(file, to_bytes(page()))
    click.echo(str(file))
