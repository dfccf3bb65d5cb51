"""Contains RoadGPT's code that runs in a generator's process. This code uses only the standard library and
the syntax of Python 3.8.

The generator's interpreter may lack the libraries that RoadGPT needs. So every computation that needs
more than the standard library is requested from RoadGPT. RoadGPT runs in the interpreter that the environment
variable ROADGPT_PYTHON names or, if the variable is not set, in the generator's interpreter.
"""
