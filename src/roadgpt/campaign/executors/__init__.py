"""Executors: plug-ins that run the jobs of a campaign on workers. Each file defines one kind of worker.

An executor is a ``concurrent.futures.Executor`` whose constructor takes a WorkerConfig. An executor only runs
jobs. The process that created it chooses the tests, receives their results, and is the only one that writes
the store.

The function of a job must be defined at the top level of a module. A worker hangs if it takes longer for one
job than ``WorkerConfig.patience``. A worker that dies or hangs is replaced, and its job runs again on another
worker; a job that has cost three workers ends with a LostWorkerError. A job that is run again, on any worker,
returns the same value, so an executor keeps no record of past jobs. Each job ends exactly once.

``WorkerConfig.prepare`` runs once in each worker before its first job; it imports the modules that take
seconds to import. Arguments that many jobs need are wrapped in a ``Shared``. The calls of ``map`` should go
to free workers before the jobs that wait, and ``shutdown(cancel_futures=True)`` should end busy workers as
well."""

from roadgpt.campaign.workers import LostWorkerError, Shared, WorkerConfig

__all__ = ["LostWorkerError", "Shared", "WorkerConfig"]
