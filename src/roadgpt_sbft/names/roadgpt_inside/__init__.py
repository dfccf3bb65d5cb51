"""RoadGPT's code in a generator's process: the standard library alone, in the syntax of Python 3.8."""
