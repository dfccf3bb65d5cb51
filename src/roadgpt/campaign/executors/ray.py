"""The executor ``ray``: workers that are actors on a Ray cluster, each on one core of any of its machines.

Several short jobs are sent in one message, because each message costs time. If a worker dies, the jobs of its
last message are run again one by one, so that only the job that killed the worker is given up. If a whole
machine fails, the jobs that ran on it are run again, and no job is blamed for the failure. Results return to
this process, the only one that writes the store.

Ray's own retries are off: Ray cannot distinguish between a job that kills its workers and a machine that was
switched off.
"""

import faulthandler
import os
import queue
import socket
import sys
import threading
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from roadgpt import __version__
from roadgpt.campaign.jobs import WorkerConfig
from roadgpt.campaign.workers.job_queue import JobQueue, QueuedJob, QueueWorker
from roadgpt.campaign.workers.process_loop import (
    ERROR,
    READY,
    JobMessage,
    answer,
    pickled,
    portable,
    unpickled,
)
from roadgpt.errors import RoadGPTError, UsageError, to_install

ROUND = 0.5  # s between two looks at all workers
TOGETHER = 16  # jobs in one message, at most
# Messages per worker into which the waiting jobs are divided: none is so long that all wait for one worker.
PER_WORKER = 3
ANSWER = 10.0  # s for the head of a cluster to accept a connection
PATIENCE = 600.0  # s for the cluster to find room for one worker


@dataclass(eq=False, kw_only=True)
class _Worker(QueueWorker):
    actor: Any
    node: str = ""


class Ray(JobQueue[_Worker]):
    """Workers on a Ray cluster."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Asks the cluster for workers.

        If this process is connected to Ray already, that cluster is used. Otherwise ``WorkerConfig.address``
        is the address of the cluster's head; if it is empty, the environment variable RAY_ADDRESS is read. If
        that is empty too, a cluster is started on this machine.

        Raises:
            UsageError: Ray is not installed.
            RoadGPTError: no cluster answers.
        """
        super().__init__(staff)
        self._ray, self._is_ours = _connected(staff)
        self._alone: set[QueuedJob] = set()  # sent singly, since a worker died while it had them and others
        self._since = time.monotonic()  # since then no worker has been ready
        self._events: queue.SimpleQueue[tuple[_Worker, Any]] = queue.SimpleQueue()
        with self._changed:
            for _ in range(staff.workers):
                self._hire()
        self._thread = threading.Thread(target=self._listen, name="roadgpt-ray", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Ends every worker. If this executor opened the connection to Ray, closes the connection; this ends
        a cluster that the executor started."""
        if self._stops.is_set():
            return
        self._stops.set()
        self._thread.join()
        for worker in self._workers:
            self._ray.kill(worker.actor)
        if self._is_ours:
            self._ray.shutdown()

    def _hire(self) -> None:
        self._started += 1
        kind = self._ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(RayActor)
        worker = _Worker(name=f"worker {self._started}", actor=kind.remote(self._staff.patience))
        self._workers.append(worker)
        self._expect(worker, worker.actor.begin.remote(__version__, self._prepare))

    def _expect(self, worker: _Worker, answer_to_come: Any) -> None:
        answer_to_come.future().add_done_callback(lambda future: self._events.put((worker, future)))

    def _listen(self) -> None:
        """Handles the messages of workers, in the order in which they come."""
        while not self._stops.is_set():
            try:
                worker, future = self._events.get(timeout=ROUND)
            except queue.Empty:
                self._look_round()
                continue
            error = future.exception()
            with self._changed:
                if worker not in self._workers:
                    continue
                if error is None:
                    self._hear(worker, future.result())
                else:
                    self._bury(worker, worker.fault or _reason(error))
                self._changed.notify_all()

    def _hear(self, worker: _Worker, answers: Sequence[tuple[str, bytes]]) -> None:
        self._alone.difference_update(worker.works)
        if answers[0][0] == READY:
            worker.node, where = unpickled(answers[0][1])
            worker.name += f" ({where})"
        super()._hear(worker, answers)

    def _send(self, worker: _Worker, works: Sequence[QueuedJob]) -> None:
        orders = [self._message(worker, work) for work in works]
        self._expect(worker, worker.actor.work.remote(orders))

    def _some(self, waiting: deque[QueuedJob]) -> list[QueuedJob]:
        """Takes jobs for one message: some of the waiting jobs, or one job that may have killed a worker."""
        most = min(TOGETHER, -(-len(waiting) // (PER_WORKER * self._staff.workers)))
        works: list[QueuedJob] = []
        while waiting and len(works) < most and not (works and waiting[0] in self._alone):
            works.append(waiting.popleft())
            if works[0] in self._alone:
                break
        return works

    def _bury(self, worker: _Worker, how: str) -> None:
        """Replaces a worker that has ended, and gives its jobs to others."""
        self._workers.remove(worker)
        is_nodes_fault = bool(worker.node) and worker.node not in self._nodes()
        for work in reversed(worker.works):
            if is_nodes_fault:
                (self._waiting if work.key is not None else self._urgent).appendleft(work)
            else:
                self._alone.add(work)
                self._give_again(work, how)
        if not any(other.is_ready for other in self._workers):
            self._since = time.monotonic()
        self._replace(worker, how, "Ray's log")
        self._hand_out()

    def _nodes(self) -> set[str]:
        return {node["NodeID"] for node in self._ray.nodes() if node["Alive"]}

    def _look_round(self) -> None:
        """Ends workers that hang, and stops waiting for a cluster that has no free core."""
        now = time.monotonic()
        with self._changed:
            for worker in self._workers:
                patience = self._staff.patience * max(len(worker.works), 1)
                if worker.works and now - worker.begun > patience and not worker.fault:
                    worker.fault = f"took longer than {patience:g} s"
                    self._ray.kill(worker.actor)
            is_idle = not any(worker.is_ready for worker in self._workers)
            if is_idle and now - self._since > PATIENCE and self._broken is None:
                self._broken = RoadGPTError(
                    f"Ray found no free core for a worker in {PATIENCE:g} s; see ray status, or ask later"
                )
                self._changed.notify_all()


def _connected(staff: WorkerConfig) -> tuple[Any, bool]:
    """Connects to Ray; returns the module ``ray``, and whether this function made the connection."""
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"  # a cluster of ours reports to nobody
    try:
        import ray
    except ImportError as error:
        raise UsageError(f"the executor 'ray' needs Ray; say {to_install('ray')}") from error
    if ray.is_initialized():
        return ray, False
    address = staff.address or os.environ.get("RAY_ADDRESS", "")
    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
    try:
        if address:
            _knock(address)
            ray.init(address=address, **quiet)
        else:
            ray.init(address="local", num_cpus=staff.workers, include_dashboard=False, **quiet)
    except (ray.exceptions.RayError, OSError, RuntimeError, ValueError) as error:
        reason = str(error).strip().partition("\n")[0]
        place = address or "this machine"
        raise RoadGPTError(
            f"no Ray cluster answers at {place} ({reason}); start one with ray start --head"
        ) from error
    return ray, True


def _knock(address: str) -> None:
    """Checks that something listens at a cluster's address; Ray itself would keep trying for minutes."""
    host, _, port = address.rpartition(":")
    if host and port.isdecimal() and "/" not in host:
        socket.create_connection((host.strip("[]"), int(port)), ANSWER).close()


def _reason(error: BaseException) -> str:
    """Returns the first line of Ray's message about the end of a worker."""
    reason = str(error).strip().partition("\n")[0]
    return f"ended: {reason}" if reason else "ended"


class RayActor:
    """A worker, which Ray runs in a process of its own: it is prepared once, and then runs the jobs of each
    message one after another."""

    def __init__(self, patience: float) -> None:
        """Takes the seconds after which a job is treated as hanging and the worker ends; they apply only to
        messages with several jobs."""
        self._patience = patience
        self._shared: dict[str, Any] = {}

    def begin(self, version: str, prepare: bytes) -> list[tuple[str, bytes]]:
        """Prepares the worker. Returns READY and, pickled, the id of the Ray node and a text with host name
        and process id; or ERROR and the pickled error."""
        import ray

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
            return [(ERROR, portable(error))]
        return [(READY, pickled((ray.get_runtime_context().get_node_id(), f"{here}, {os.getpid()}")))]

    def work(self, orders: Sequence[JobMessage]) -> list[tuple[str, bytes]]:
        """Runs jobs one after another; returns how each job ended, and its pickled value or error. If there
        are several jobs, this worker limits the time of each, and ends if a job hangs. If there is only one
        job, the sender limits its time."""
        if len(orders) == 1:
            return [answer(orders[0], self._shared)]
        return [self._timed(order) for order in orders]

    def _timed(self, order: JobMessage) -> tuple[str, bytes]:
        # the timer is no Python code, so that it ends a worker that hangs in a library, too
        faulthandler.dump_traceback_later(self._patience, exit=True, file=sys.__stderr__ or 2)
        try:
            return answer(order, self._shared)
        finally:
            faulthandler.cancel_dump_traceback_later()
