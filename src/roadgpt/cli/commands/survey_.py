"""``roadgpt study survey``: makes, serves and analyses a survey of people."""

from pathlib import Path

import click

from roadgpt.cli.flags import measure
from roadgpt.cli.option_groups import CommandGroup
from roadgpt.cli.options import SEED, folder, whole
from roadgpt.errors import UsageError

PORT = 8765
FILE = "SURVEY.toml"
ASK = "say who asks, which raters read first: --asks 'Jane Roe, University of X' --contact jane@x.example"
survey_folder = click.argument("directory", metavar="DIR", type=folder)


@click.group("survey", cls=CommandGroup)
def command() -> None:
    """Ask people how well roads match their descriptions, as RoadGPT's thesis did."""


@command.command()
@click.argument("file", metavar="[SURVEY.toml]", required=False, type=click.Path(path_type=Path))
@click.option(
    "--from", "study", type=folder, metavar="STUDY_DIR", help="Draw roads from its folders of runs."
)
@click.option("--out", type=folder, required=True, metavar="DIR", help="The survey's folder.")
@click.option("--asks", default="", help="With --from: who conducts the survey; raters see it first.")
@click.option("--contact", default="", help="With --from: where raters can send questions.")
@click.option(
    "--pairs",
    type=whole(0, 20, "a number"),
    default=2,
    show_default=True,
    help="With --from: number of pairs of roads to compare.",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="With --from: seed of the draw.")
@click.option("--no-films", is_flag=True, help="Make no films, which take most of the time.")
def new(
    file: Path | None,
    study: Path | None,
    out: Path,
    asks: str,
    contact: str,
    pairs: int,
    seed: int,
    no_films: bool,
) -> None:
    """Make a survey from runs: plots, films and 3-D views of every road, and the questions.

    SURVEY.toml names the runs. Instead, --from STUDY_DIR draws one valid road from each folder of runs in
    STUDY_DIR, and pairs of roads with the same description; it writes them as a SURVEY.toml, which you can
    edit, into the survey's folder.

    \b
    roadgpt study survey new SURVEY.toml --out my-survey
    roadgpt study survey new --from roadgpt-runs --out my-survey --asks "Jane Roe" --contact j@x.example
    """
    if (file is None) == (study is None):
        raise UsageError(
            f"a survey is made from a {FILE} or, with --from, from folders of runs; give one of the two"
        )
    if study is not None and not (asks.strip() and contact.strip()):
        raise UsageError(ASK)
    from roadgpt.study.survey.build import make_survey
    from roadgpt.study.survey.plan import plan_text, read_plan
    from roadgpt.study.survey.sampling import plan_from_runs

    plan = read_plan(file) if file else plan_from_runs(study or Path(), asks, contact, seed, pairs)
    if no_films:
        plan = plan.model_copy(update={"films": False})
    survey = make_survey(plan, file.parent if file else Path(), out, click.echo)
    if study is not None:
        (out / FILE).write_text(plan_text(plan), encoding="utf-8")
        click.echo(f"{out / FILE} lists the roads that were drawn; edit it and make the survey again from it")
    if survey.lacks:
        click.echo(f"roadgpt: {survey.lacks}", err=True)
    click.echo(
        f"{len(survey.items)} pages of roads in {out}; next: roadgpt study survey serve {out} --raters 10"
    )


@command.command()
@survey_folder
@click.option(
    "--raters",
    type=whole(0, 10_000, "people"),
    default=0,
    help="Number of raters who each get a personal link.",
)
@click.option("--open", "is_open", is_flag=True, help="Let anyone join who has the shared link.")
@click.option(
    "--port",
    type=whole(0, 65_535, "a port"),
    default=PORT,
    show_default=True,
    help="Port of the server; 0: a free one.",
)
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="127.0.0.1: only this machine; 0.0.0.0: all."
)
@click.option("--url", default="", help="Address at which raters reach the server, if it is behind a proxy.")
def serve(directory: Path, raters: int, is_open: bool, port: int, host: str, url: str) -> None:
    """Serve a survey until Ctrl-C; each answer is on the disk before it is confirmed.

    The same command resumes the survey later: links and answers stay. The server is an extra:
    python -m pip install 'roadgpt[survey]'.

    \b
    roadgpt study survey serve my-survey --raters 10
    roadgpt study survey serve my-survey --open --host 0.0.0.0 --url https://survey.x.example
    """
    from roadgpt.study.survey.serving import serve as serve_until_stopped

    serve_until_stopped(directory, click.echo, host, port, raters, is_open, url)


@command.command()
@survey_folder
@click.option("--out", type=folder, metavar="DIR", help="Folder for the report. [default: in the survey's]")
@click.option(
    "--synthetic",
    type=whole(1, 10_000, "a number"),
    help="Analyse answers of this many simulated raters instead.",
)
@click.option(
    "--agreement",
    type=measure(0, 1),
    default=0.8,
    show_default=True,
    help="With --synthetic: how often raters agree, 0 to 1.",
)
@click.option("--seed", type=SEED, default=0, show_default=True, help="With --synthetic: seed of the raters.")
def analyse(directory: Path, out: Path | None, synthetic: int | None, agreement: float, seed: int) -> None:
    """Analyse the answers: figures, medians, tests, agreement, and measurements.

    Writes report.html, report.md, answers.csv, tables and figures. It also works while the survey is served.
    """
    from roadgpt.study.survey.analysis import analyse as analyse_into
    from roadgpt.study.survey.analysis import load_answers

    answers = load_answers(directory, synthetic, seed, agreement)
    target = out or directory / ("analysis-synthetic" if synthetic else "analysis")
    made_up = f" --synthetic {synthetic} --agreement {agreement:g} --seed {seed}" if synthetic else ""
    click.echo(str(analyse_into(answers, target, f"roadgpt study survey analyse {directory}{made_up}")))
