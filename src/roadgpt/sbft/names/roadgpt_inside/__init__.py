"""RoadGPT's half in a generator's process: standard library alone, in the grammar of Python 3.8.

It runs in the generator's interpreter, which has libraries of its own. Whatever needs more than the standard
library is requested from RoadGPT: in this interpreter if it is installed there, else in its own.
"""
