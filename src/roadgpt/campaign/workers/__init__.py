"""What executors have in common: the desk that jobs wait on, a worker's inside, and what travels between."""
