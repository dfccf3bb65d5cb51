"""A worker on a Ray cluster. It is prepared once; then it runs the jobs of each message one after another."""

import faulthandler
import os
import socket
import sys
from collections.abc import Sequence
from typing import Any

from roadgpt.campaign.workers.messages import pickled, unpickled
from roadgpt.campaign.workers.process_loop import ERROR, READY, JobMessage, answer, portable
from roadgpt.errors import UsageError


class RayActor:
    """A worker of the executor ``ray``, which Ray runs in a process of its own."""

    def __init__(self, patience: float) -> None:
        """Takes the seconds after which a job is treated as hanging and the worker ends; they apply only to
        messages with several jobs."""
        self._patience = patience
        self._shared: dict[str, Any] = {}

    def begin(self, version: str, prepare: bytes) -> tuple[int, bytes]:
        """Prepares the worker.

        Returns:
            READY, and pickled: the id of the Ray node, and a text with host name and process id; or ERROR and
            the pickled error.
        """
        import ray

        from roadgpt import __version__

        os.environ.setdefault("MPLBACKEND", "Agg")
        os.environ.setdefault("NUMBA_NUM_THREADS", "1")  # it has one core
        here = socket.gethostname()
        try:
            if __version__ != version:
                raise UsageError(
                    f"{here} has RoadGPT {__version__} and this machine {version}; install the same on all"
                )
            unpickled(prepare)()
        except Exception as error:  # whatever it is, the campaign has to hear of it
            return ERROR, portable(error)
        return READY, pickled((ray.get_runtime_context().get_node_id(), f"{here}, {os.getpid()}"))

    def work(self, orders: Sequence[JobMessage]) -> list[tuple[int, bytes]]:
        """Runs jobs one after another; returns how each job ended, and its pickled value or error.

        If ``orders`` holds several jobs, the worker limits the time of each job, and ends if a job hangs. If
        ``orders`` holds one job, the sender limits the time.
        """
        if len(orders) == 1:
            return [answer(orders[0], self._shared)]
        return [self._timed(order) for order in orders]

    def _timed(self, order: JobMessage) -> tuple[int, bytes]:
        # the timer is no Python code, so that it ends a worker that hangs in a library, too
        faulthandler.dump_traceback_later(self._patience, exit=True, file=sys.__stderr__ or 2)
        try:
            return answer(order, self._shared)
        finally:
            faulthandler.cancel_dump_traceback_later()
