"""A worker of its own: drives a road in BeamNG, waits for the other workers, and tells what it used.

python beamng_worker.py FOLDER NUMBER WORKERS
"""

import json
import sys
import time
from pathlib import Path

from roadgpt.road import Road
from roadgpt.run import Setup, prove
from roadgpt_beamng.session import session_of
from roadgpt_beamng.settings import BeamngSettings


def main() -> None:
    folder, number, workers = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    run = prove(Road.through([[40, 100], [70, 100], [100, 100]]), setup=Setup(simulator="beamng"))
    slot = session_of(BeamngSettings.of())._slot
    assert slot is not None
    told = {"outcome": run.outcome, "port": slot.port, "user": str(slot.user)}
    (folder / f"worker-{number}.json").write_text(json.dumps(told))
    due = time.monotonic() + 60
    while len(list(folder.glob("worker-*.json"))) < workers and time.monotonic() < due:
        time.sleep(0.05)  # all hold their BeamNG at the same time


main()
