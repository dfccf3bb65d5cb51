"""RoadGPT's half in a generator's process: the standard library alone, in the grammar of Python 3.8.

It runs in the generator's interpreter, whose libraries are its own. What takes more than the standard library
is asked for: of this interpreter where RoadGPT is installed in it, else of RoadGPT's own.
"""
