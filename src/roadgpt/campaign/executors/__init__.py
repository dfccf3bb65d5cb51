"""Executors: plug-ins that run the jobs of a campaign on workers. Each file defines one kind of worker.

An executor is a class whose constructor takes a WorkerConfig; ``Executor`` describes its methods. An executor
only runs jobs. The process that created it chooses the tests, receives their results, and is the only one
that writes the store.

A job runs ``function(item, *values)`` with the shared values that it needs; the function must be defined at
the top level of a module. A job may run more than once: a worker that dies or hangs (sends no sign of life,
or takes longer for one job than ``WorkerConfig.patience``) is replaced, and its job is given to another
worker, until ``MOST_DEATHS`` workers have died while running it. Each job ends with exactly one FinishedJob.
A job that is run again, on any worker, returns the same value, so an executor keeps no record of past jobs.

``WorkerConfig.prepare`` runs once in each worker before its first job; it imports the modules that take
seconds to import.
"""

from roadgpt.campaign.jobs import MOST_DEATHS, Executor, FinishedJob, Job, RunningJob, WorkerConfig

__all__ = ["MOST_DEATHS", "Executor", "FinishedJob", "Job", "RunningJob", "WorkerConfig"]
