"""Code that executors share: the queue of jobs, the main loop of a worker, and the messages between them."""
