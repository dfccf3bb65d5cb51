"""Code that executors share, such as the queue of jobs, a worker's main loop, and its messages."""
