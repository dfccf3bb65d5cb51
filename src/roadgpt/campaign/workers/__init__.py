"""Code that executors share, such as the queue of jobs, and a worker's main loop and messages."""
