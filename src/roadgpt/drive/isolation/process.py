"""Child processes that answer messages one by one, within limits of time and memory: drivers of users, and
workers of campaigns.

A Child is this process's end of the connection, ``serve`` the other one. A process that is late, ends or
takes too much memory costs one answer; whoever asked starts another one. All that a process has started ends
with it, and it ends with its parent."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Any

from roadgpt import children

TICK = 0.2  # s between two checks of the clock and the memory
GRACE = 1.0  # s for a busy process to end the processes that it has started, and itself


class GoneError(Exception):
    """A process has ended. The message says how, in words that can follow its name."""

    def __init__(self, how: str, is_late: bool = False, is_blameless: bool = False) -> None:
        super().__init__(how)
        self.is_late = is_late
        self.is_blameless = is_blameless  # true if it had ended before it was asked: no answer cost it


class Child:
    """A Python process that answers messages one by one."""

    ended = "{}"  # words for a process that ended by itself, with how it did

    def __init__(self, entry: str, **how: Any) -> None:
        """Starts a process that runs ``main()`` of a module, which calls ``serve``; ``how`` is as in
        ``children.start``, but ``env`` is added to the environment. Raises OSError if the system cannot."""
        # -P: modules in the user's current folder do not replace ours
        words = [sys.executable, "-P", "-c", f"from {entry} import main; main()"]
        env = {**os.environ, **how.pop("env", {}), "PYTHONUNBUFFERED": "1", "MPLBACKEND": "Agg"}
        streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self.process = children.start(words, env=env, **streams, **how)
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self._down, self._up = self.process.stdin, self.process.stdout
        self._most = children.memory_limit()
        self._due = float("inf")  # of the answer that is waited for, seconds of the monotonic clock
        self._why, self._is_late = "", False  # why it was killed
        self._ends = threading.Event()
        threading.Thread(target=self._watch, name=entry, daemon=True).start()

    @property
    def is_alive(self) -> bool:
        """Whether the process is running and can take messages."""
        return not self._ends.is_set() and self.process.poll() is None

    def ask(self, seconds: float, message: Any) -> Any:
        """Returns the answer to a message; raises GoneError if the process has ended, or was ended because it
        did not answer within ``seconds`` or took too much memory."""
        is_blameless = not self.is_alive
        self._due = time.monotonic() + seconds
        try:
            self._down.write(pickled(message))
            self._down.flush()
            answer = self.read(self._up)
        except Exception:  # most often EOFError or OSError; whatever it is, there is no answer
            self.end()
            status = self.process.returncode
            how = f"was ended by signal {-status}" if (status or 0) < 0 else f"ended with status {status}"
            why = f"took longer than {seconds:g} s" if self._is_late else self._why
            raise GoneError(why or self.ended.format(how), self._is_late, is_blameless) from None
        except BaseException:  # this process is asked to stop; a late answer must not be read by others
            self.end()
            raise
        self._due = float("inf")
        return answer

    def read(self, stream: IO[bytes]) -> Any:
        """Reads one answer."""
        return pickle.load(stream)  # noqa: S301 - from our own process

    def kill(self) -> None:
        """Ends a busy process and those it has started; after a second, by force."""
        if os.name == "posix" and self.process.poll() is None:  # on Windows, ``children.kill`` reaches all
            with suppress(OSError):
                self.process.terminate()  # it ends those in sessions of their own, too
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(GRACE)
        children.kill(self.process)

    def end(self) -> None:
        """Ends the process at once."""
        self._ends.set()
        children.end(self.process)

    def close(self) -> None:
        """Lets an idle process end, which sees the end of its input, and cleans up after it."""
        with suppress(OSError, ValueError):
            self._down.close()
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(children.FAREWELL)
        self.end()
        self._up.close()

    def _watch(self) -> None:
        """Kills a process that is late, takes too much memory, or has ended and left children that hold its
        pipes open."""
        last = time.monotonic()
        while self.process.poll() is None:
            if self._ends.wait(TICK):
                return
            now = time.monotonic()
            if now - last > 10 * TICK:  # this process was suspended: the clock was too
                self._due += now - last
            elif now > self._due:
                self._is_late = True
                self.kill()
            elif (taken := children.memory_of(self.process.pid)) > self._most:
                share = f"more than {children.SHARE:.0%} of this machine's: let it keep less"
                self._why = f"took {taken / 1e9:.1f} GB of memory, {share}"
                self.kill()
            last = now
        children.kill(self.process)


def pickled(value: Any) -> bytes:
    """Returns a value as bytes."""
    return pickle.dumps(value, pickle.HIGHEST_PROTOCOL)


def serve(answer: Callable[[Any], Any], written: Callable[[Any], bytes] = pickled) -> None:
    """Answers the messages of a Child in its process, until the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C, and ends this process
    signal.signal(signal.SIGTERM, lambda *_: children.end_with_all())
    threading.Thread(target=_stay_while, args=(os.getppid(),), daemon=True).start()
    heard, said = children.private_streams()
    with suppress(EOFError, OSError, pickle.UnpicklingError):
        while True:
            said.write(written(answer(pickle.load(heard))))  # noqa: S301 - from our own process
            said.flush()


def _stay_while(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    children.end_with_all()
