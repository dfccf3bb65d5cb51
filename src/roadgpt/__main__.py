"""The program ``roadgpt``, also as ``python -m roadgpt``.

It handles Ctrl-C before it imports anything else.
"""

from roadgpt import stopping


def main() -> None:
    """Runs a command and ends the process with its exit status."""
    stopping.install()
    try:
        from roadgpt.cli import main as command

        command()
    finally:
        stopping.leave()


if __name__ == "__main__":
    main()
