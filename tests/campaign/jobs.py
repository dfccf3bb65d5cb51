"""Jobs for workers, good and bad. As a program: two workers at a job that does not end, and their pids."""

import atexit
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roadgpt import children
from roadgpt.campaign.executors import Shared, WorkerConfig
from roadgpt.errors import UsageError

if TYPE_CHECKING:  # workers, which read this file, need none of it
    from roadgpt.campaign.executors.processes import Processes

TESTS = Path(__file__).resolve().parents[1]


def nothing() -> None:
    """Prepares nobody."""


def refuses() -> None:
    raise UsageError("there is no driver of that name")


def leaves() -> None:
    os._exit(5)


def square(number: int) -> int:
    return number * number


def plus(number: int, *values: Shared[int]) -> int:
    return number + sum(each.value for each in values)


def identity(value: Shared[object]) -> tuple[int, int]:
    """The worker's pid, and where the value lies in its memory."""
    SEEN.append(value.value)  # so that no other value can take its place
    return os.getpid(), id(value.value)


SEEN: list[object] = []


def fails_at_three(number: int) -> int:
    if number == 3:
        raise ValueError("no number 3")
    return number


def unanswerable(number: int) -> Any:
    return lambda: number


class HeavyError(Exception):
    """An error that pickles and cannot be read again."""

    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"cannot travel {one} {two}")


def raises_what_cannot_travel(number: int) -> None:
    raise HeavyError(number, number)


def is_large(number: int) -> bytes:
    return bytes(number) + b"end"


def prints(number: int) -> int:
    print("a driver that prints", flush=True)
    os.write(1, b"and writes\n")
    assert sys.stdin.read() == ""
    return number


def talks(number: int) -> None:
    print(f"{number} says so\n" * 200, end="", flush=True)


def starts_a_program(file: str) -> int:
    """Starts something in a session of its own, as a simulator is started; writes down its pid."""
    words = [sys.executable, "-c", "import time; time.sleep(300)"]
    pid = children.start(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL).pid
    Path(file).write_text(str(pid), encoding="utf-8")
    return pid


def starts_a_program_and_works(file: str) -> None:
    starts_a_program(file)
    time.sleep(300)


def leaves_its_programs(file: str) -> int:
    """As a simulator does that is left politely when Python ends."""
    atexit.register(children.kill_all)
    return starts_a_program(file)


def dies(status: int) -> None:
    os._exit(status)


def eats(megabytes: int) -> int:
    eaten = [b"x" * 1_000_000 for _ in range(megabytes)]
    time.sleep(300)
    return len(eaten)


def sleeps(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


def is_alive(pid: int) -> bool:
    """Is there a process of this number that has not ended?"""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def at_work(workers: "Processes") -> list[int]:
    """The processes that are at work on a job."""
    from roadgpt.campaign.executors.processes import Process

    busy = [each for each in workers._workers if each.is_ready and each.is_busy]
    return [each.process.pid for each in busy if isinstance(each, Process)]


def main() -> None:
    from roadgpt.campaign.executors.processes import Processes

    workers = Processes(WorkerConfig(2, nothing, 1000.0, Path(os.devnull)))
    for _ in range(2):
        workers.submit(sleeps, 1000.0)
    while len(pids := at_work(workers)) < 2:
        time.sleep(0.05)
    print(*pids, flush=True)
    time.sleep(1000)


if __name__ == "__main__":
    sys.path.insert(0, str(TESTS))
    import campaign.jobs

    campaign.jobs.main()
