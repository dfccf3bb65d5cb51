"""``roadgpt study survey``: makes, serves and analyses a survey in which people rate roads."""

from pathlib import Path

import click

from roadgpt.cli import options
from roadgpt.cli.options import PATH, Argument, CommandGroup, Option, folder, measure, whole
from roadgpt.cli.streams import warn
from roadgpt.errors import UsageError, command_line

PORT = 8765
FILE = "SURVEY.toml"
ASK = "say who asks, which raters read first: --asks 'Jane Roe, University of X' --contact jane@x.example"
DIRECTORY = Argument("directory", "DIR", kind=folder)
# fmt: off
OF_NEW = (
    Argument("file", "[SURVEY.toml]", kind=PATH, required=False),
    Option("--from study", "Choose roads at random from the folders of runs in STUDY_DIR.", folder,
           metavar="STUDY_DIR"),
    options.out("The survey's folder.", required=True, metavar="DIR"),
    Option("--asks", "With --from: who conducts the survey; shown to raters on the first page.", str, ""),
    Option("--contact", "With --from: where raters can send questions.", str, ""),
    Option("--pairs", "With --from: number of pairs of roads to compare.", whole(0, 20, "a number"), 2),
    options.seed("With --from: seed of the random choice.", 0),
    Option("--no-films", "Make no films, which take most of the time.", bool),
)
OF_SERVE = (
    DIRECTORY,
    Option("--raters", "Number of raters who each get a personal link.", whole(0, 10_000, "people"), 0),
    Option("--open is_open", "Let anyone join who has the shared link.", bool),
    Option("--port", "Port of the server; 0: a free one.", whole(0, 65_535, "a port"), PORT),
    Option("--host", "Who can reach the server; 127.0.0.1: only this machine, 0.0.0.0: all machines.",
           str, "127.0.0.1"),
    Option("--url", "Address at which raters reach the server, if it is behind a proxy.", str, ""),
)
OF_ANALYSE = (
    DIRECTORY,
    options.out("Folder for the report. [default: a subfolder of the survey's folder]", metavar="DIR"),
    Option("--synthetic", "Instead of real answers, analyse those of this many simulated raters.",
           whole(1, 10_000, "a number")),
    Option("--agreement", "With --synthetic: how often raters agree, 0 to 1.", measure(0, 1), 0.8),
    options.seed("With --synthetic: seed of the raters.", 0),
)
# fmt: on


@click.group("survey", cls=CommandGroup)
def command() -> None:
    """Ask people how well roads match their descriptions, as RoadGPT's thesis did."""


@command.command(params=[*OF_NEW])
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

    SURVEY.toml names the runs. With --from STUDY_DIR, no SURVEY.toml is needed: one valid road is chosen at
    random from each folder of runs in STUDY_DIR. From some of these folders, a pair of roads to compare is
    chosen, too. The choice is saved as a SURVEY.toml in the survey's folder, so that you can edit it.

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
    from roadgpt_study.survey.build import make_survey
    from roadgpt_study.survey.plan import plan_from_runs, plan_text, read_plan

    plan = read_plan(file) if file else plan_from_runs(study or Path(), asks, contact, seed, pairs)
    if no_films:
        plan = plan.model_copy(update={"films": False})
    survey = make_survey(plan, file.parent if file else Path(), out, click.echo)
    if study is not None:
        (out / FILE).write_text(plan_text(plan), encoding="utf-8")
        click.echo(f"{out / FILE} lists the chosen roads; edit it and make the survey again from it")
    if survey.lacks:
        warn(survey.lacks)
    serve_it = command_line("study", "survey", "serve", out, "--raters", 10)
    click.echo(f"{len(survey.items)} pages of roads in {out}; next: {serve_it}")


@command.command(params=[*OF_SERVE])
def serve(directory: Path, raters: int, is_open: bool, port: int, host: str, url: str) -> None:
    """Serve a survey until Ctrl-C; each answer is on the disk before it is confirmed.

    The same command resumes the survey later: links stay valid, and answers are kept. The server is an extra;
    in a checkout: pip install -e '.[survey]'.

    \b
    roadgpt study survey serve my-survey --raters 10
    roadgpt study survey serve my-survey --open --host 0.0.0.0 --url https://survey.x.example
    """
    from roadgpt_study.survey.serving import serve as serve_until_stopped

    serve_until_stopped(directory, click.echo, host, port, raters, is_open, url)


@command.command(params=[*OF_ANALYSE])
def analyse(directory: Path, out: Path | None, synthetic: int | None, agreement: float, seed: int) -> None:
    """Analyse the answers: medians, statistical tests, agreement of raters, comparison with measurements.

    Writes report.html, answers.csv, tables and figures. It also works while the survey is served.
    """
    from roadgpt_study.survey.analysis import analyse as analyse_into
    from roadgpt_study.survey.analysis import load_answers

    answers = load_answers(directory, synthetic, seed, agreement)
    target = out or directory / ("analysis-synthetic" if synthetic else "analysis")
    made_up = ["--synthetic", synthetic, "--agreement", f"{agreement:g}", "--seed", seed] if synthetic else []
    made_up += ["--out", out] if out else []
    again = command_line("study", "survey", "analyse", directory, *made_up)
    click.echo(str(analyse_into(answers, target, again)))
