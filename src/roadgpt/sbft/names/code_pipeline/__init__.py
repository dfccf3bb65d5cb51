"""Provides the names that generators of the SBFT tool competition import; other names are taken from a
checkout of the competition's code, if Python finds one."""

from pkgutil import extend_path

from roadgpt_inside import checkout

__path__ = extend_path(__path__, __name__)
checkout.watch()
