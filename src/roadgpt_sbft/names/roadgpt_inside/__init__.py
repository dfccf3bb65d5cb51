"""Contains RoadGPT's code that runs in a generator's process. This code uses only the standard library and
the syntax of Python 3.8; ``asking`` requests every other computation from RoadGPT."""
