"""Shared by executors: the queue of jobs, the main loop of a worker, and the messages between them."""
