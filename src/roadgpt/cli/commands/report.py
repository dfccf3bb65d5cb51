"""``roadgpt report``: writes a report on a folder of runs, a campaign or a study."""

from pathlib import Path

import click

from roadgpt.cli import options
from roadgpt.cli.junit import write_folder
from roadgpt.cli.next_steps import next_steps, of_status
from roadgpt.cli.option import Argument
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.cli.roads import open_page
from roadgpt.errors import command_line


@click.command(cls=GroupedCommand, params=[Argument("folder", "DIR", kind=PATH), options.OPEN, options.JUNIT])
def command(folder: Path, opens: bool, junit: Path | None) -> None:
    """Write a report on a folder of runs, a campaign or a study.

    DIR is the folder that roadgpt run, roadgpt campaign or roadgpt study wrote. The command writes
    report.html, report.md and the tables as CSV and LaTeX into DIR. The page needs no network and no server,
    and links to the runs in DIR.

    \b
    roadgpt report roadgpt-runs/an-uphill-road-with-3-turns-7 --open
    """
    page = write_report(folder)
    if junit is not None:
        write_folder(junit, folder, {})
    click.echo(str(page))
    if opens:
        open_page(page)


def write_report(folder: Path) -> Path:
    """Writes the report on a folder of runs, a campaign or a study; returns the path of the HTML page."""
    from roadgpt.campaign.folder_record import is_store
    from roadgpt.campaign.status import status_of
    from roadgpt.study import plan, study_report
    from roadgpt.study.campaign_report import write_store_report

    if (folder / plan.CARD).is_file():
        return study_report.write_study(folder)
    steps = next_steps(of_status(status_of(folder)))
    write = write_store_report if is_store(folder) else study_report.write_run_report
    return write(folder, command_of(folder), steps)


def command_of(folder: Path) -> str:
    """Returns the command that repeats a campaign or a folder of runs; empty for runs without a description.
    Options cannot express some campaigns, such as a campaign with several cells; for these, returns the
    command that resumes the campaign.
    """
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.campaign.model import WITH_GOAL, WITHOUT_GOAL
    from roadgpt.cli.repeat_commands import request_words

    with open_record(folder) as record:
        cells, resume = record.cells(), record.to_resume()
    only, n = cells[0], cells[0].budget.tests
    if only.in_sequence and not only.request.words:
        return ""
    if len(cells) > 1 or not only.request.words or n is None or only.settings:
        return resume
    words = request_words(only.request, n, only.brief)
    words += ["--goal", only.goal] if only.goal else []
    if only.generator != (WITH_GOAL if only.goal else WITHOUT_GOAL):
        words += ["--generator", only.generator]
    words += ["--seconds", f"{only.budget.seconds:g}"] if only.budget.seconds else []
    return command_line("run" if only.in_sequence else "campaign", *words, "--out", folder)
