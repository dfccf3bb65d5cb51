"""The names that generators of the SBFT tool competition import; what is not here is looked for in a checkout
of the competition's own code, where Python finds one."""

from pkgutil import extend_path

from roadgpt_inside import elsewhere

__path__ = extend_path(__path__, __name__)
elsewhere.watch()
