"""The command line as a user types it, in this process."""

from click.testing import CliRunner, Result

from roadgpt.cli import app


def invoke(*words: object) -> Result:
    """Returns what a command said, and how it ended: never with an error of the program itself."""
    done = CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")
    assert done.exit_code != 70, done.output
    assert "Traceback" not in done.output
    return done


def roadgpt(*words: object) -> Result:
    """The same of a command that does what it was asked for."""
    done = invoke(*words)
    assert done.exit_code == 0, done.output
    return done
