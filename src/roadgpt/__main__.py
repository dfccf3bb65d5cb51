"""Starts the program ``roadgpt``, also with ``python -m roadgpt``.

It installs the handling of Ctrl-C before anything else is imported.
"""

from roadgpt import stopping


def main() -> None:
    """Runs the command in ``sys.argv`` and ends the process with the exit status of the command."""
    stopping.install()
    try:
        from roadgpt.cli import main as command

        command()
    finally:
        stopping.leave()


if __name__ == "__main__":
    main()
