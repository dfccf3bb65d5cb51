"""What generators of the SBFT tool competition import; what is missing comes from a checkout of its code."""

from pkgutil import extend_path

from roadgpt_inside import watch

__path__ = extend_path(__path__, __name__)
watch()
