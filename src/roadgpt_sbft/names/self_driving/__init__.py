"""Provides classes and functions that generators of the SBFT tool competition import. Those that this package
lacks are imported from a checkout of the competition's code, if one is on Python's search path.
"""

from pkgutil import extend_path

from roadgpt_inside import checkout

__path__ = extend_path(__path__, __name__)
checkout.watch()
