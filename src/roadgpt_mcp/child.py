"""The process of one call: it checks a plan, or does a command of the command line, and may count its tests.

It ends when the server ends, however that ends: nobody then holds the other end of its standard input."""

import json
import os
import sys
import time
from contextlib import suppress
from pathlib import Path
from threading import Thread

from roadgpt import children


def end_with_server(pipe: int) -> None:
    """Waits until the other end of a pipe is closed, and ends this process and all that it started."""
    while os.read(pipe, 1):
        pass
    children.end_with_all()


def count(folder: Path) -> None:
    """Prints once a second how many tests of a campaign have ended."""
    from roadgpt.campaign.status import status_of

    while True:
        time.sleep(1)
        with suppress(Exception):  # it has not begun
            status = status_of(folder)
            os.write(1, (json.dumps({"done": status.done, "total": status.total}) + "\n").encode())


if __name__ == "__main__":
    Thread(target=end_with_server, args=(os.dup(0),), daemon=True).start()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    if sys.argv[1] == "CHECK":
        from roadgpt_mcp.checking import checked

        print(json.dumps(checked(sys.argv[3], sys.argv[2])))
    else:
        if sys.argv[1] == "COUNT":
            Thread(target=count, args=(Path(sys.argv[2]),), daemon=True).start()
            del sys.argv[1:3]
        from roadgpt.cli import main

        main()
