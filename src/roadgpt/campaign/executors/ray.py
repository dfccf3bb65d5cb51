"""The executor ``ray``: workers that are actors on a Ray cluster, each on one core of any of its machines.

If a worker dies, its job runs again on another one. If a whole machine fails, the jobs that ran on it are run
again, and no job is blamed for the failure. Results return to this process, the only one that writes the
store.

Ray's own retries are off: Ray cannot distinguish between a job that kills its workers and a machine that was
switched off."""

import os
import socket
from collections.abc import Callable, Sequence
from typing import Any

from roadgpt import __version__
from roadgpt.campaign.workers import (
    VALUE,
    Worker,
    WorkerConfig,
    WorkerPool,
    answer,
    portable,
    unpickled,
    value_in,
)
from roadgpt.drive.isolation.process import GoneError, pickled
from roadgpt.errors import RoadGPTError, UsageError, to_install

ANSWER = 10.0  # s for the head of a cluster to accept a connection
PATIENCE = 600.0  # s for the cluster to find room for one worker


class Ray(WorkerPool):
    """Workers on a Ray cluster."""

    printed = "Ray's log"

    def __init__(self, staff: WorkerConfig) -> None:
        """Asks for workers: of the cluster that this process is connected to, or else of the one at
        ``WorkerConfig.address`` or RAY_ADDRESS, or else of a new one on this machine."""
        self._ray, self._is_ours = _connected(staff)
        super().__init__(staff)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers, as every executor does, and then the connection to Ray if it is ours; this ends a
        cluster that was started here."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        if self._is_ours and wait:
            self._ray.shutdown()
            self._is_ours = False

    def _start(self) -> "RayWorker":
        return RayWorker(self._ray, self._staff.patience, self._workers)


class RayWorker(Worker):
    """A worker, which Ray runs on some machine."""

    def __init__(self, ray: Any, patience: float, workers: Sequence[Worker]) -> None:
        self._ray, self._patience, self._workers = ray, patience, workers
        self._actor = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(RayActor).remote()
        self._node = ""

    def begin(self, prepare: Callable[[], object]) -> None:
        """Waits for a free core, as long as there are other workers, and prepares the worker there."""
        begun = self._actor.begin.remote(__version__, pickled(prepare))
        while not self._ray.wait([begun], timeout=PATIENCE)[0]:
            if not any(other.is_ready for other in self._workers):
                raise RoadGPTError(
                    f"Ray found no free core for a worker in {PATIENCE:g} s; see ray status, or ask later"
                )
        self._node = value_in(self._got(begun))

    def run(self, call: bytes) -> bytes:
        """Runs a job, and returns its value or error."""
        return self._got(self._actor.work.remote(call), self._patience)

    def _got(self, promised: Any, patience: float | None = None) -> bytes:
        errors = self._ray.exceptions
        try:
            data: bytes = self._ray.get(promised, timeout=patience)
        except errors.GetTimeoutError:
            raise GoneError(f"took longer than {patience:g} s", is_late=True) from None
        except errors.RayError as error:
            alive = {node["NodeID"] for node in self._ray.nodes() if node["Alive"]}
            reason = str(error).strip().partition("\n")[0]
            how = f"ended: {reason}" if reason else "ended"
            is_off = bool(self._node) and self._node not in alive
            raise GoneError(how, is_blameless=is_off) from None
        return data

    def kill(self) -> None:
        """Ends the worker."""
        self._ray.kill(self._actor)

    close = kill


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


class RayActor:
    """A worker's end of the connection; it runs in a process of its own."""

    def begin(self, version: str, prepare: bytes) -> bytes:
        """Prepares the worker. Returns the id of the Ray node, or an error, for ``value_in``."""
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
            return portable(error)
        return pickled((VALUE, ray.get_runtime_context().get_node_id()))

    def work(self, call: bytes) -> bytes:
        """Runs a job; returns its value or error for ``value_in``."""
        return answer(call)
