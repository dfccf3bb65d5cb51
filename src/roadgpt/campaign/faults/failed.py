"""The failed Runs of a folder, whoever made it."""

from collections.abc import Iterator
from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.run import Run, read_run
from roadgpt.run.campaign import finished
from roadgpt.run.folder import is_run, run_folder


def failed_runs(folder: Path) -> Iterator[Run]:
    """Those of one run, or of a campaign's folder, one after another.

    Raises:
        UsageError: nothing of the kind is there, or a file cannot be read.
    """
    if is_run(folder):
        folders = [folder]
    else:
        folders = [run_folder(folder, index) for index in finished(folder)]
    if not folders:
        raise UsageError(f"there are no roads in {folder}; give the folder of a run or of a campaign")
    for each in folders:
        run = read_run(each)
        if run.outcome == "FAIL":
            yield run
